//! What theories say of a sheet that was laid, every term taken from the sheet itself.
//!
//! Stiffness: [`Cox`], a bound, and the same with the strain of fibres built up through their bonds.
//! Strength: the zero-span index of the fibres alone, and [`Page`]'s equation, into which it goes.
use loadframe_api::spec::paper_tensile::Pulp;
use nalgebra::{Matrix3, Vector3};

use super::bonds::MPA;
use crate::frame::FrameBond;
use crate::sheet::{Sheet, SheetFibre, Statistics, wall_area_um2};

/// mN µm/µg is 10⁻⁹ J over 10⁻⁶ g.
const N_M_PER_G: f64 = 1e-3;
/// MPa µm² over µg/µm is 10⁻⁶ N over g/m.
const MPA_N_M_PER_G: f64 = 1e-6;
const PER_KILO: f64 = 1e-3;
/// Below this 1 - tanh(x)/x is x²/3 to double precision.
const SMALL: f64 = 1e-4;

/// What is known of a laid sheet by theory.
pub(super) struct Theory {
    pub(super) cox: Option<Cox>,
    /// As [`Cox::free`], with every fibre's strain built up through its bonds [kN m/g].
    pub(super) shear_lag: Option<f64>,
    /// Largest force per width over grammage when jaws without a gap hold every fibre [N m/g]; none
    /// where a fibre never breaks.
    pub(super) zero_span: Option<f64>,
    /// None where neither fibres nor bonds break.
    pub(super) page: Option<Page>,
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

/// Page's equation, 1/T = 9/(8 Z) + 12 c/(b P L RBA) [Page1969].
///
/// Z is the zero-span index, b the shear strength of bonds, c the coarseness and L the length of the
/// fibres (as the edges cut them, weighted by length), RBA the share of both their sides that is bonded,
/// and P twice the width, the girth of those sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Page {
    /// T [N m/g].
    pub(super) index: f64,
    /// The share of the second term, that of the bonds, in 1/T.
    pub(super) bond_share: f64,
}

impl Theory {
    /// Of a sheet whose fibres are of `pulps` and joined by `bonds`, one for each contact or none at all;
    /// `shear_strength_mpa` is the mean one of bonds.
    pub(super) fn of(
        sheet: &Sheet,
        pulps: &[&Pulp],
        bonds: &[FrameBond],
        measured: Option<&Statistics>,
        shear_strength_mpa: Option<f64>,
    ) -> Self {
        let mass_ug: f64 = sheet.fibres.iter().map(SheetFibre::mass_ug).sum();
        let modulus_gpa = |fibre: &SheetFibre| pulps[fibre.pulp].youngs_modulus_gpa;
        let whole = stiffness(sheet, mass_ug, |fibre| modulus_gpa(&sheet.fibres[fibre]));
        let cox = free(&whole).map(|free| Cox {
            free,
            held: whole[(0, 0)],
        });
        let built_up = built_up(sheet, bonds, modulus_gpa);
        let lagging = stiffness(sheet, mass_ug, |fibre| {
            built_up[fibre] * modulus_gpa(&sheet.fibres[fibre])
        });
        let zero_span = zero_span(sheet, pulps, mass_ug);
        Self {
            cox,
            shear_lag: free(&lagging),
            zero_span,
            page: measured.and_then(|measured| {
                Page::new(
                    zero_span,
                    shear_strength_mpa,
                    mass_ug / measured.fibre_length_um,
                    measured,
                )
            }),
        }
    }
}

/// C of [`Cox`] by the modulus [GPa] of each fibre; of the strains ε₁₁, ε₂₂, γ₁₂ [kN m/g].
fn stiffness(sheet: &Sheet, mass_ug: f64, modulus_gpa: impl Fn(usize) -> f64) -> Matrix3<f64> {
    let mut stiffness = Matrix3::<f64>::zeros();
    for (index, fibre) in sheet.fibres.iter().enumerate() {
        let rigidity_mn = modulus_gpa(index) * area_um2(fibre);
        for ([x, y], length) in directions(fibre) {
            // the strain of a fibre is tᵢ εᵢⱼ tⱼ = g · (ε₁₁, ε₂₂, γ₁₂)
            let g = Vector3::new(x * x, y * y, x * y);
            stiffness += g * g.transpose() * (rigidity_mn * length);
        }
    }
    stiffness * (PER_KILO * N_M_PER_G / mass_ug)
}

/// 1/S₁₁ with S = C⁻¹.
fn free(stiffness: &Matrix3<f64>) -> Option<f64> {
    stiffness
        .try_inverse()
        .map(|softness| 1.0 / softness[(0, 0)])
}

/// Shares of the sheet's strain that fibres have on average when bonds of a stiffness k for each length of
/// fibre pull them along: 1 - tanh(x)/x with x = L/2 √(k/(E A)) [Cox1952]. A jaw that holds an end is
/// the middle of a fibre twice as long, one at either end leaves no lag at all.
fn built_up(
    sheet: &Sheet,
    bonds: &[FrameBond],
    modulus_gpa: impl Fn(&SheetFibre) -> f64,
) -> Vec<f64> {
    let mut held_mn_per_um = vec![0.0; sheet.fibres.len()];
    for bond in bonds.iter().filter(|bond| !bond.is_void()) {
        for fibre in bond.fibres {
            held_mn_per_um[fibre as usize] += bond.stiffness_mn_per_um3 * bond.area_um2;
        }
    }
    let fibres = sheet.fibres.iter().zip(held_mn_per_um);
    fibres
        .map(|(fibre, held_mn_per_um)| {
            let line = &fibre.centre_line_um;
            let is_held = |[x, _, _]: [f64; 3]| x <= 0.0 || x >= sheet.size_um[0];
            let length = fibre.length_um();
            let rate = (held_mn_per_um / (length * modulus_gpa(fibre) * area_um2(fibre))).sqrt();
            match [line[0], line[line.len() - 1]].map(is_held) {
                [true, true] => 1.0,
                [false, false] => share(0.5 * rate * length),
                _ => share(rate * length),
            }
        })
        .collect()
}

/// 1 - tanh(x)/x.
fn share(x: f64) -> f64 {
    if x < SMALL {
        x * x / 3.0
    } else {
        1.0 - x.tanh() / x
    }
}

/// Zero-span index by the fibres [N m/g]: of the mean section of the sheet, whose segments of length l
/// have the tension E A ε tₓ² with the share tₓ² along the pull, l tₓ of them for each width and length,
/// yield, and break at their strength. The largest of Σ l E A tₓ⁴ ε over the whole, the broken left out:
/// 3/8 of strength over density for uniform directions [VanDenAkker1958].
fn zero_span(sheet: &Sheet, pulps: &[&Pulp], mass_ug: f64) -> Option<f64> {
    // strain at which a part begins to bear by another line, and what that adds to force and slope
    let mut turns = Vec::new();
    for fibre in &sheet.fibres {
        let pulp = pulps[fibre.pulp];
        let modulus_gpa = pulp.youngs_modulus_gpa;
        let strength_gpa = MPA * pulp.strength_mpa?;
        for ([x, _], length) in directions(fibre) {
            if x == 0.0 {
                continue;
            }
            let weight = length * area_um2(fibre) * x * x;
            let breaks_at = |offset: f64, slope: f64| (strength_gpa - offset) / (slope * x * x);
            let elastic = [0.0, weight * modulus_gpa * x * x];
            match pulp.yielding {
                None => turns.push((breaks_at(0.0, modulus_gpa), elastic)),
                Some(yielding) => {
                    let stress_gpa = MPA * yielding.stress_mpa;
                    let slope = yielding.hardening_modulus_gpa;
                    let offset = stress_gpa * (1.0 - slope / modulus_gpa);
                    let flowing = [weight * offset, weight * slope * x * x];
                    turns.push((breaks_at(offset, slope), flowing));
                    let back = [elastic[0] - flowing[0], elastic[1] - flowing[1]];
                    turns.push((stress_gpa / (modulus_gpa * x * x), back));
                }
            }
        }
    }
    turns.sort_by(|one, other| one.0.total_cmp(&other.0));
    // from the last that breaks: what is left of a difference, at the strains that fibres across the pull
    // endure, would be larger than all
    let (mut force, mut slope, mut most) = (0.0, 0.0, 0.0_f64);
    for (strain, [offset, more]) in turns.into_iter().rev() {
        force += offset;
        slope += more;
        most = most.max(force + strain * slope);
    }
    (mass_ug > 0.0).then(|| N_M_PER_G * most / mass_ug)
}

fn area_um2(fibre: &SheetFibre) -> f64 {
    wall_area_um2(fibre.section.width_um, fibre.section.wall_um)
}

/// Direction in the plane, of a unit vector in space, and length [µm] of every segment.
fn directions(fibre: &SheetFibre) -> impl Iterator<Item = ([f64; 2], f64)> + '_ {
    fibre.centre_line_um.windows(2).filter_map(|ends| {
        let along: [f64; 3] = std::array::from_fn(|axis| ends[1][axis] - ends[0][axis]);
        let length = along.iter().map(|part| part * part).sum::<f64>().sqrt();
        (length > 0.0).then(|| ([along[0] / length, along[1] / length], length))
    })
}

impl Page {
    /// With Z [N m/g], b [MPa] and c [µg/µm]; a strength that is none is without limit.
    fn new(
        zero_span: Option<f64>,
        shear_strength_mpa: Option<f64>,
        coarseness: f64,
        measured: &Statistics,
    ) -> Option<Self> {
        let of_fibres = zero_span.map_or(0.0, |index| 9.0 / (8.0 * index));
        let of_bonds = shear_strength_mpa.map_or(0.0, |strength| {
            let girth_um = 2.0 * measured.mean_width_um;
            let bonded_um2 = girth_um * measured.length_weighted_um * measured.relative_bonded_area;
            12.0 * coarseness / (MPA_N_M_PER_G * strength * bonded_um2)
        });
        let whole = of_fibres + of_bonds;
        (whole > 0.0).then(|| Self {
            index: 1.0 / whole,
            bond_share: if of_bonds.is_finite() {
                of_bonds / whole
            } else {
                1.0
            },
        })
    }
}

#[cfg(test)]
mod tests;
