//! What a sheet that was laid measures, in the units of the lab.
use loadframe_api::spec::paper_tensile::{PaperTensile, Specimen as Kind};

use super::theory::Theory;
use crate::sheet::{Histogram, Sheet, SheetFibre, Statistics};

/// Bins of the fibre lengths.
const BINS: usize = 20;

/// Measures of a laid sheet.
pub(super) struct Laid {
    pub(super) grammage_g_per_m2: f64,
    /// Nothing of a sheet without fibres.
    pub(super) statistics: Option<Statistics>,
    /// Thickness by which Young's modulus is told, when it was given [µm].
    given_thickness_um: Option<f64>,
    pub(super) theory: Theory,
}

impl Laid {
    /// Measures `sheet`; `theory` says what is known of it beside its statistics.
    pub(super) fn measure(
        sheet: &Sheet,
        spec: &PaperTensile,
        theory: impl FnOnce(Option<&Statistics>) -> Theory,
    ) -> Self {
        let statistics = Statistics::of(sheet, BINS);
        let mass_ug: f64 = sheet.fibres.iter().map(SheetFibre::mass_ug).sum();
        let given_thickness_um = match &spec.specimen {
            Kind::Sheet(made) => made.thickness_um,
            Kind::SingleFibre(_) | Kind::Explicit(_) => None,
        };
        Self {
            // 1 µg/µm² is 10⁶ g/m²
            grammage_g_per_m2: 1e6 * mass_ug / sheet.area_um2(),
            theory: theory(statistics.as_ref()),
            statistics,
            given_thickness_um,
        }
    }

    /// Thickness by which Young's modulus is told [µm].
    pub(super) fn thickness_um(&self) -> Option<f64> {
        let mean = self
            .statistics
            .as_ref()
            .map(|measured| measured.mean_thickness_um);
        self.given_thickness_um.or(mean)
    }

    pub(super) fn lengths(&self) -> Option<&Histogram> {
        self.statistics
            .as_ref()
            .map(|measured| &measured.lengths_um)
    }
}
