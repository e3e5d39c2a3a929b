//! Normal springs of logarithmic strain: spheres do not pass through each other.
//!
//! With the distance d of the centres and the distance d₀ at which they just touch,
//!
//!   F_N = −k_N d₀ ln(d/d₀) for d < d₀ (G.14)
//!
//! which is k_N δ for small overlaps and grows without bound as the centres meet. Of spheres whose
//! centres are closer than 2⁻²⁰ d₀ it does not grow further. Everything else is as with linear
//! springs.
//!
//! Source: T 3.15, the strain ε_N = ln(|C₂ − C₁|/d₀) of a compressed contact.
use pulp::Simd;

use super::{
    Touch,
    normal::{Linear, Normal, Spring},
};
use crate::{
    contact::stiffness::{Side, Springs},
    numbers::lanes::Lanes,
};

/// F_N = −k_N d₀ ln(d/d₀).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Logarithmic;

/// Smallest d/d₀ that is told apart: 2⁻²⁰.
const CLOSEST: f64 = 1.0 / 1_048_576.0;

/// Terms of the series of ln: the largest argument is 0.172, whose 23rd power is below round-off.
const TERMS: usize = 11;

impl Normal for Logarithmic {
    fn springs(a: &Side, b: &Side) -> Springs {
        Linear::between(a, b)
    }

    #[inline(always)]
    fn force<S: Simd>(simd: S, touch: &Touch<S>) -> Lanes<S> {
        let ratio = logarithm(simd, touch.reach - touch.overlap, touch.reach);
        -(touch.stiffness * touch.reach * ratio)
    }

    fn tangent(spring: &Spring) -> f64 {
        spring.constant / (1.0 - spring.overlap / spring.reach).max(CLOSEST)
    }

    /// k_N d₀² (y + (1 − y) ln(1 − y)) with y = δ/d₀; as a series where y is small.
    fn energy(spring: &Spring, _force_square: f64) -> f64 {
        let y = (spring.overlap / spring.reach).min(1.0 - CLOSEST);
        let shape = if y < 1e-3 {
            // Σ yⁿ/(n(n − 1)), from n = 2
            y * y * (0.5 + y * (1.0 / 6.0 + y * (1.0 / 12.0 + y * (0.05 + y / 30.0))))
        } else {
            y + (1.0 - y) * (-y).ln_1p()
        };
        spring.constant * spring.reach * spring.reach * shape
    }

    fn foreseen(own: &Side, speed: f64) -> f64 {
        Linear::foreseen(own, speed)
    }
}

/// ln(d/d₀) for d ≤ d₀, the same bits everywhere: the distance is doubled until it is within a
/// factor √2 of d₀, then ln x = 2 atanh((x − 1)/(x + 1)).
#[inline(always)]
fn logarithm<S: Simd>(simd: S, distance: Lanes<S>, touching: Lanes<S>) -> Lanes<S> {
    let splat = |value: f64| Lanes::splat(simd, value);
    let closest = touching * splat(CLOSEST);
    let mut distance = closest.only_if(distance.below(closest), distance);
    let limit = touching * splat(std::f64::consts::SQRT_2);
    let mut doublings = splat(0.0);
    for doubled in [16, 8, 4, 2, 1_i32] {
        let larger = distance * splat(f64::from(1 << doubled));
        let fits = larger.at_most(limit);
        distance = larger.only_if(fits, distance);
        let more = doublings + splat(f64::from(doubled));
        doublings = more.only_if(fits, doublings);
    }
    let argument = (distance - touching).over(distance + touching);
    let square = argument * argument;
    let mut series = splat(1.0 / (2 * TERMS + 1) as f64);
    for term in (0..TERMS).rev() {
        series = series * square + splat(1.0 / (2 * term + 1) as f64);
    }
    splat(2.0) * argument * series - doublings * splat(std::f64::consts::LN_2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use pulp::Scalar;

    #[test]
    fn the_logarithm_is_that_of_the_library_to_round_off() {
        let simd = Scalar::new();
        for power in 0..20_000 {
            let ratio = (-f64::from(power) * 6.9e-4_f64).exp();
            let found = logarithm(
                simd,
                Lanes::splat(simd, 0.3 * ratio),
                Lanes::splat(simd, 0.3),
            );
            let expected = (0.3 * ratio / 0.3).ln();
            // the quotient is rounded once
            assert!(
                (found.value - expected).abs() <= 4.0 * f64::EPSILON * (1.0 + expected.abs()),
                "{ratio}: {} is not {expected}",
                found.value
            );
        }
    }

    #[test]
    fn energy_is_the_integral_of_the_force_and_tangent_its_derivative() {
        let spring = |overlap: f64| Spring {
            constant: 3e5,
            shear_ratio: 0.0,
            overlap,
            reach: 0.02,
        };
        for overlap in [1e-6, 9e-6, 1e-4, 5e-3, 0.015] {
            let step = 1e-4 * overlap;
            let [before, after] = [-step, step].map(|shift| spring(overlap + shift));
            let force = spring(overlap).force::<Logarithmic>();
            let rise = (Logarithmic::energy(&after, 0.0) - Logarithmic::energy(&before, 0.0))
                / (2.0 * step);
            let slope =
                (after.force::<Logarithmic>() - before.force::<Logarithmic>()) / (2.0 * step);
            // differences over 1e-4 of the overlap: the order, and cancellation
            assert!(
                (rise / force - 1.0).abs() < 1e-6,
                "{overlap}: {rise} {force}"
            );
            let tangent = Logarithmic::tangent(&spring(overlap));
            assert!(
                (slope / tangent - 1.0).abs() < 1e-6,
                "{overlap}: {slope} {tangent}"
            );
        }
        // small overlaps are linear, half of the reach is not
        let small = spring(2e-8);
        assert!((small.force::<Logarithmic>() / (3e5 * 2e-8) - 1.0).abs() < 1e-6);
        let half = spring(0.01).force::<Logarithmic>();
        assert!((half / (3e5 * 0.02 * std::f64::consts::LN_2) - 1.0).abs() < 1e-15);
    }
}
