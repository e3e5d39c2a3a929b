//! What a sheet that was laid measures, and what it could bear at best.
use loadframe_api::spec::paper_tensile::{PaperTensile, Specimen as Kind};
use nalgebra::Matrix3;

use crate::sheet::{Histogram, Sheet, Statistics};

/// Bins of the fibre lengths.
const BINS: usize = 20;

/// Measures of a laid sheet, in the units of the lab.
pub(super) struct Laid {
    pub(super) grammage_g_per_m2: f64,
    /// Nothing of a sheet without fibres.
    pub(super) statistics: Option<Statistics>,
    /// Thickness by which Young's modulus is told, when it was given [µm].
    pub(super) given_thickness_um: Option<f64>,
    pub(super) cox: Option<Cox>,
}

/// Stiffness over mass of the same fibres, were they straight from edge to edge and strained as the
/// sheet is [kN m/g].
///
/// With the direction t of every segment, C₁₁ = Σ E A l tₓ⁴ and so on over the mass. A sheet that is
/// free to contract has 1/S₁₁ with S = C⁻¹ [Cox1952]: E/(3 ρ) for uniform directions. Where jaws hold
/// the width it has C₁₁, E 3/(8 ρ), and never more: that bound holds for any beams and bonds, since
/// straining all points alike is one way to move them (without the shear of beams that do not turn).
#[derive(Clone, Copy)]
pub(super) struct Cox {
    pub(super) free: f64,
    pub(super) held: f64,
}

/// Measures `sheet`; `modulus_gpa` is that of a pulp of the plan.
pub(super) fn measure(
    sheet: &Sheet,
    modulus_gpa: impl Fn(usize) -> f64,
    spec: &PaperTensile,
) -> Laid {
    let statistics = Statistics::of(sheet, BINS);
    let mass_ug: f64 = sheet.fibres.iter().map(|fibre| fibre.mass_ug()).sum();
    let given_thickness_um = match &spec.specimen {
        Kind::Sheet(made) => made.thickness_um,
        Kind::SingleFibre(_) | Kind::Explicit(_) => None,
    };
    Laid {
        // 1 µg/µm² is 10⁶ g/m²
        grammage_g_per_m2: 1e6 * mass_ug / sheet.area_um2(),
        statistics,
        given_thickness_um,
        cox: cox(sheet, modulus_gpa, mass_ug),
    }
}

impl Laid {
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

fn cox(sheet: &Sheet, modulus_gpa: impl Fn(usize) -> f64, mass_ug: f64) -> Option<Cox> {
    let mut stiffness = Matrix3::<f64>::zeros();
    for fibre in &sheet.fibres {
        let section = fibre.section;
        let area = crate::sheet::wall_area_um2(section.width_um, section.wall_um);
        for ends in fibre.centre_line_um.windows(2) {
            let along: [f64; 3] = std::array::from_fn(|axis| ends[1][axis] - ends[0][axis]);
            let length = along.iter().map(|part| part * part).sum::<f64>().sqrt();
            if length > 0.0 {
                let [x, y, _] = along.map(|part| part / length);
                // the strain of a fibre is tᵢ εᵢⱼ tⱼ = g · (ε₁₁, ε₂₂, γ₁₂)
                let g = nalgebra::Vector3::new(x * x, y * y, x * y);
                stiffness += g * g.transpose() * (modulus_gpa(fibre.pulp) * area * length);
            }
        }
    }
    // mN µm/µg is 10⁻⁹ J over 10⁻⁶ g: 10⁻³ N m/g, 10⁻⁶ kN m/g
    let stiffness = stiffness * (1e-6 / mass_ug);
    let softness = stiffness.try_inverse()?;
    Some(Cox {
        free: 1.0 / softness[(0, 0)],
        held: stiffness[(0, 0)],
    })
}
