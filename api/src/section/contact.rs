//! Where rollers touch a section: what says how fine its grid is beneath them.
use super::stiffness::{Stiffness, compliance};

/// Cells through half the width of a roller's contact on the finest of graded grids: Hertz's contact is then
/// known to some per cent, and what it adds to a deflection far better.
pub const CONTACT_CELLS: usize = 4;
/// Over Hertz's contact, how far cells are that fine: on layers the contact may be wider than on a half-space.
pub const CONTACT_REACH: f64 = 1.5;

/// Half width [mm] of the contact of a rigid cylinder with a half-space, b² = 4 F R / (π E* t), for
/// the force F over the thickness t.
///
/// The half-space has a plane stiffness with the axes of its face: 1/E* =
/// ½ √(S₂₂ (2 S₁₂ + S₆₆ + 2 √(S₁₁S₂₂))) with 2 along the normal, which is 1/E in isotropic plane stress
/// and (1 - ν²)/E in plane strain. Source: [Johnson1985] (4.43), E* by the characteristic equation of
/// [Lekhnitskii1968]. Coupling of stretch and shear is left out.
#[must_use]
pub fn hertz_half_width_mm(
    stiffness: &Stiffness,
    thickness_mm: f64,
    radius_mm: f64,
    force_n: f64,
) -> f64 {
    let s = compliance(stiffness);
    let sum = 2.0 * s[(0, 1)] + s[(2, 2)] + 2.0 * (s[(0, 0)] * s[(1, 1)]).sqrt();
    let flexible = 0.5 * (s[(1, 1)] * sum).sqrt();
    (4.0 * force_n * radius_mm * flexible / (std::f64::consts::PI * thickness_mm)).sqrt()
}
