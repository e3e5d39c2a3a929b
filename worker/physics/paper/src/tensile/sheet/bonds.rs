//! What bonds are given that are not told one by one: stiffness, and strengths with their scatter.
use loadframe_api::spec::paper_tensile::{Bond, PaperTensile};
use loadframe_harness::rng::{Purpose, Streams};
use rand_distr::{Distribution as _, StandardNormal};

use crate::frame::FrameBond;

/// 1 MPa in mN/µm².
pub(super) const MPA: f64 = 1e-3;
/// Transverse over axial Young's modulus of a fibre [KallmesPerez1965].
const TRANSVERSE: f64 = 0.1;
/// 1 N/m per µm² in mN/µm³.
const N_PER_M_PER_UM2: f64 = 1e-3;

/// A fibre as a bond sees it: thickness of its flattened wall [µm], and Young's modulus [GPa].
#[derive(Clone, Copy)]
pub(super) struct Side {
    pub(super) thickness_um: f64,
    pub(super) youngs_modulus_gpa: f64,
}

/// Stiffness of a bond over its area [mN/µm³]: as given, else that of what lies between the two centre
/// lines, 1/(t₁/(2 E₁) + t₂/(2 E₂)) with the thickness t of flattened walls and the transverse moduli.
pub(super) fn stiffness(bond: Option<&Bond>, sides: [Side; 2]) -> f64 {
    if let Some(given) = bond.and_then(|bond| bond.stiffness_n_per_m_per_um2) {
        return N_PER_M_PER_UM2 * given;
    }
    let [one, other] =
        sides.map(|side| 0.5 * side.thickness_um / (TRANSVERSE * side.youngs_modulus_gpa));
    1.0 / (one + other)
}

/// Least and largest stiffness over the area [N/m/µm²] where none is given.
pub(super) fn assumed(spec: &PaperTensile, bonds: &[FrameBond]) -> Option<[f64; 2]> {
    let given = spec
        .bond
        .as_ref()
        .and_then(|bond| bond.stiffness_n_per_m_per_um2);
    if given.is_some() || bonds.is_empty() {
        return None;
    }
    let all = || {
        bonds
            .iter()
            .map(|bond| bond.stiffness_mn_per_um3 / N_PER_M_PER_UM2)
    };
    Some([
        all().fold(f64::INFINITY, f64::min),
        all().fold(0.0, f64::max),
    ])
}

/// Strengths of bonds by their area, with a scatter that each draws by its number.
pub(super) struct Strengths<'a> {
    bond: Option<&'a Bond>,
    /// σ and μ of the logarithm of a factor of mean 1.
    sigma: f64,
    mu: f64,
    streams: Streams,
}

impl<'a> Strengths<'a> {
    pub(super) fn new(spec: &'a PaperTensile) -> Self {
        let bond = spec.bond.as_ref();
        let variation = bond.map_or(0.0, |bond| bond.strength_variation);
        // of a log-normal factor: σ² = ln(1 + v²), μ = -σ²/2
        let variance = variation.powi(2).ln_1p();
        Self {
            bond,
            sigma: variance.sqrt(),
            mu: -0.5 * variance,
            streams: Streams::new(spec.seed, Purpose::Strength),
        }
    }

    /// Normal and shear strength [mN] of a bond of this area.
    pub(super) fn of(&self, bond: usize, area_um2: f64) -> [Option<f64>; 2] {
        let Some(given) = self.bond else {
            return [None; 2];
        };
        let factor = if self.sigma > 0.0 {
            let normal: f64 = StandardNormal.sample(&mut self.streams.of(bond));
            (self.mu + self.sigma * normal).exp()
        } else {
            1.0
        };
        [given.normal_strength_mpa, given.shear_strength_mpa]
            .map(|strength| strength.map(|strength| MPA * strength * area_um2 * factor))
    }
}
