//! What is read off the first pull at a given strain: secant stiffness and lateral contraction.
use loadframe_api::Quantity;
use loadframe_harness::{ReportBuilder, curve};

use super::{experiment::StopReason, specimen::Specimen};

/// Nominal strain at which every test is read, as in [Zilka2022] table 4.
pub(super) const USUAL_STRAIN: f64 = 0.1;
/// N/mm in N/m.
pub(super) const N_PER_M: f64 = 1e3;
/// N/mm² in Pa.
pub(super) const PA: f64 = 1e6;
/// N m/g in N/tex, with the tex of a gram per kilometre.
pub(super) const N_PER_TEX: f64 = 1e-3;
/// Decimals of a strain in percent: its smallest, 1e-6, has four.
const DECIMALS: f64 = 1e6;

/// Why results have no value that are related to the width, of a specimen that has none.
pub(super) fn without_width(specimen: &Specimen) -> Option<&'static str> {
    let has_none = specimen.width <= 0.0;
    has_none
        .then_some("the specimen has no width: all its nodes have one x, and width_mm is not given")
}

/// The curve up to where the jaw first came back.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pull<'a> {
    pub(super) specimen: &'a Specimen,
    /// Nominal strain, and force on the moving jaw [N].
    pub(super) forces: &'a [(f64, f64)],
    /// Nominal strain, and that of the width; not a number where it has none.
    pub(super) width_strains: &'a [(f64, f64)],
    pub(super) stop_reason: StopReason,
}

/// What a pull has at a strain.
#[derive(Clone, Debug)]
pub(super) struct Reading<'a> {
    specimen: &'a Specimen,
    strain: f64,
    /// At the strain, where the jaw rested ([`Path::rest`](super::path::Path::rest)) [N].
    force: Option<f64>,
    width_strain: Option<f64>,
    /// Why there is no force.
    reason: String,
}

impl<'a> Pull<'a> {
    /// Reads forces and width at a nominal strain.
    pub(super) fn read(&self, strain: f64) -> Reading<'a> {
        Reading {
            specimen: self.specimen,
            strain,
            force: curve::interpolate(self.forces, strain),
            width_strain: curve::interpolate(self.width_strains, strain)
                .filter(|strain| strain.is_finite()),
            reason: self.reason(strain),
        }
    }

    fn reason(&self, strain: f64) -> String {
        let ends = self.forces.first().zip(self.forces.last());
        let Some(((first, _), (last, _))) = ends else {
            return "the test has no point".to_owned();
        };
        if strain < *first {
            return format!("the first point is at a nominal strain of {first:.6}");
        }
        let end = match self.stop_reason {
            StopReason::ForceDropped | StopReason::NoLoadPath => "the specimen had parted before",
            StopReason::MaxStrain => "the test had ended before",
            StopReason::HistoryFinished => "the first pull had ended before",
        };
        format!("{end}, at a nominal strain of {last:.6}")
    }
}

impl Reading<'_> {
    /// Stiffness per width and by itself, and contraction.
    pub(super) fn stiffness(&self, report: &mut ReportBuilder) {
        let (percent, strain) = (self.percent(), self.strain);
        let name = self.name();
        let width = self.specimen.width;
        let secant = self.secant();
        self.add(
            report,
            &format!("modulus_at_{name}_percent"),
            secant.map(|secant| secant / width * N_PER_M),
            "N/m",
            &format!(
                "Secant stiffness per width: force at {percent} % nominal strain over {strain} and the width."
            ),
        );
        self.add(
            report,
            &format!("secant_stiffness_at_{name}_percent"),
            secant,
            "N",
            &format!("Force at {percent} % nominal strain over {strain}."),
        );
        // as every test has it, it goes without its strain
        let name = match name.as_str() {
            "10" => "poisson_ratio".to_owned(),
            name => format!("poisson_ratio_at_{name}_percent"),
        };
        let about = format!(
            "Lateral contraction of the middle third over nominal strain, at {percent} % nominal strain."
        );
        let ratio = self.width_strain.map(|width| -width / strain);
        let quantity = Quantity::new(ratio.unwrap_or(f64::NAN), "1", &about);
        let reason = match self.force {
            Some(_) => "nothing in the middle third spreads across the pull",
            None => &self.reason,
        };
        report.insert(&name, quantity.or_because(reason));
    }

    /// Stiffness over the cross-section, of a specimen whose thickness is known.
    pub(super) fn stress(&self, report: &mut ReportBuilder) {
        let Some(thickness) = self.specimen.thickness else {
            return;
        };
        let area = self.specimen.width * thickness;
        self.add(
            report,
            &format!("modulus_at_{}_percent_pa", self.name()),
            self.secant().map(|secant| secant / area * PA),
            "Pa",
            &format!(
                "Force at {} % nominal strain over {}, width and thickness.",
                self.percent(),
                self.strain
            ),
        );
    }

    /// Stiffness over the mass per length, of a specimen whose grammage is known.
    pub(super) fn per_mass(&self, report: &mut ReportBuilder) {
        let Some(grammage) = self.specimen.grammage else {
            return;
        };
        let index = |force: f64| force / self.specimen.width * N_PER_M / grammage;
        self.add(
            report,
            &format!("modulus_at_{}_percent_per_tex", self.name()),
            self.secant().map(|secant| N_PER_TEX * index(secant)),
            "N/tex",
            &format!(
                "Force at {} % nominal strain over {} and the mass per length of the specimen.",
                self.percent(),
                self.strain
            ),
        );
    }

    fn secant(&self) -> Option<f64> {
        self.force.map(|force| force / self.strain)
    }

    fn add(
        &self,
        report: &mut ReportBuilder,
        name: &str,
        value: Option<f64>,
        unit: &str,
        about: &str,
    ) {
        let quantity = Quantity::new(value.unwrap_or(f64::NAN), unit, about);
        let reason = match (self.force, without_width(self.specimen)) {
            (Some(_), Some(reason)) => reason,
            _ => &self.reason,
        };
        report.insert(name, quantity.or_because(reason));
    }

    fn percent(&self) -> f64 {
        (100.0 * self.strain * DECIMALS).round() / DECIMALS
    }

    /// The percentage within the names of results.
    fn name(&self) -> String {
        self.percent().to_string().replace('.', "_")
    }
}
