//! Hertz's contact of elastic spheres: effective moduli, and the stiffness an impact comes to.
//!
//! 1/E* = Σ (1 − ν²)/E, 1/G* = Σ 2(2 − ν)(1 + ν)/E, 1/R* = Σ 1/r.
//! An impact at speed v compresses δ = (15 m* v²/(16 E* √R*))^(2/5), where the tangent stiffness is
//! 2 E* √(R* δ).
//!
//! Source: [Johnson1985], sections 4.2, 7.3 and 11.4.

/// An elastic body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solid {
    /// E [Pa].
    pub youngs_modulus: f64,
    /// ν.
    pub poisson_ratio: f64,
}

/// A body that nothing deforms.
pub const RIGID: Solid = Solid {
    youngs_modulus: f64::INFINITY,
    poisson_ratio: 0.0,
};

/// Part of the radius that contacts are thought to be compressed by at least when the time step is
/// chosen beforehand. Grains at rest are often compressed less: the step is then up to
/// (10⁻³ r/δ)^¼ smaller than it had to be.
const LEAST_COMPRESSION: f64 = 1e-3;

/// E* [Pa].
pub fn effective_modulus(a: Solid, b: Solid) -> f64 {
    let softness = |solid: Solid| (1.0 - solid.poisson_ratio.powi(2)) / solid.youngs_modulus;
    1.0 / (softness(a) + softness(b))
}

/// G* [Pa].
pub fn effective_shear_modulus(a: Solid, b: Solid) -> f64 {
    let softness = |solid: Solid| {
        2.0 * (2.0 - solid.poisson_ratio) * (1.0 + solid.poisson_ratio) / solid.youngs_modulus
    };
    1.0 / (softness(a) + softness(b))
}

/// R* [m] of two curvatures [1/m], of which a flat wall's is 0.
pub fn effective_radius(a: f64, b: f64) -> f64 {
    1.0 / (a + b)
}

/// Largest tangent stiffness [N/m] of an impact at `speed` [m/s], of a contact with E* [Pa],
/// R* [m] and 1/m* [1/kg].
pub fn impact_stiffness(modulus: f64, radius: f64, inverse_mass: f64, speed: f64) -> f64 {
    let square = speed * speed / inverse_mass;
    let deepest = (15.0 * square / (16.0 * modulus * radius.sqrt())).powf(0.4);
    2.0 * modulus * (radius * deepest.max(LEAST_COMPRESSION * radius)).sqrt()
}
