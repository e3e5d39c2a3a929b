//! A bond law whose kink is rounded off, on the way to the true one.
//!
//! In T = r_c u + (e − r_c) w(u) + f_r max(u, 0)² the kink of the bond law is w(u) = max(u, 0).
//! Within ±μ of it a parabola takes its place,
//!
//!   w = 0 for u ≤ −μ, (u + μ)²/4μ for |u| < μ, u for u ≥ μ (9)
//!
//! which has the same force and slope at ±μ; the force is off by (e − r_c) μ/4 at most.
//!
//! Source: a piecewise quadratic smoothing of the plus function, see [ChenMangasarian1996].
use super::{
    Laws,
    law::{BondLaw, StrainLaw},
};

/// A law rounded over a strain μ > 0 to either side of u = 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RoundedLaw {
    pub(crate) law: BondLaw,
    /// μ [-].
    pub(crate) rounding: f64,
}

impl RoundedLaw {
    /// The law of every bond with this rounding.
    #[inline(always)]
    pub(crate) fn each(laws: &Laws, rounding: f64) -> impl Fn(usize) -> Self + Copy {
        move |bond| Self {
            law: laws.of(bond),
            rounding,
        }
    }

    /// w and w'.
    #[inline(always)]
    fn kink(&self, strain: f64) -> [f64; 2] {
        let rounding = self.rounding;
        if strain >= rounding {
            [strain, 1.0]
        } else if strain <= -rounding {
            [0.0, 0.0]
        } else {
            let beyond = strain + rounding;
            [
                beyond * beyond / (4.0 * rounding),
                beyond / (2.0 * rounding),
            ]
        }
    }

    /// ∫ w du.
    #[inline(always)]
    fn kink_energy(&self, strain: f64) -> f64 {
        let rounding = self.rounding;
        if strain >= rounding {
            0.5 * strain * strain + rounding * rounding / 6.0
        } else if strain <= -rounding {
            0.0
        } else {
            let beyond = strain + rounding;
            beyond * beyond * beyond / (12.0 * rounding)
        }
    }

    #[inline(always)]
    fn jump(&self) -> f64 {
        self.law.modulus - self.law.compression_stiffness
    }
}

impl StrainLaw for RoundedLaw {
    #[inline(always)]
    fn tension(&self, strain: f64) -> f64 {
        let [kink, _] = self.kink(strain);
        let friction = self.law.friction_modulus * strain.max(0.0) * strain.max(0.0);
        self.law.compression_stiffness * strain + self.jump() * kink + friction
    }

    #[inline(always)]
    fn axial_excess(&self, strain: f64) -> f64 {
        let [kink, slope] = self.kink(strain);
        let stretch = strain.max(0.0);
        let friction = self.law.friction_modulus * stretch * (2.0 + stretch);
        self.law.compression_stiffness + self.jump() * (slope * (1.0 + strain) - kink) + friction
    }

    #[inline(always)]
    fn energy(&self, strain: f64) -> f64 {
        let stretch = strain.max(0.0);
        let friction = self.law.friction_modulus * stretch * stretch * stretch / 3.0;
        let linear = 0.5 * self.law.compression_stiffness * strain * strain;
        linear + self.jump() * self.kink_energy(strain) + friction
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROUNDED: RoundedLaw = RoundedLaw {
        law: BondLaw {
            modulus: 0.399,
            friction_modulus: 1.473,
            compression_stiffness: 0.157,
        },
        rounding: 0.01,
    };

    #[test]
    fn energy_tension_and_slope_are_derivatives_of_each_other() {
        // central differences: the third derivative is at most (e − r_c)/2μ = 12 N, so that the
        // error is 2 h² at most; round-off adds 1e-16/h. At u = 0 itself the slope of the friction
        // term has its kink
        let step = 1e-5;
        for strain in [-0.9, -0.02, -0.007, -0.001, 0.004, 0.02, 1.3] {
            let of = |function: fn(&RoundedLaw, f64) -> f64| {
                let change = function(&ROUNDED, strain + step) - function(&ROUNDED, strain - step);
                change / (2.0 * step)
            };
            let tension = ROUNDED.tension(strain);
            assert!((of(StrainLaw::energy) - tension).abs() < 1e-9, "{strain}");
            // (a − b) l = T'(1 + u) − T
            let excess = of(StrainLaw::tension) * (1.0 + strain) - tension;
            assert!(
                (ROUNDED.axial_excess(strain) - excess).abs() < 1e-8,
                "{strain}"
            );
        }
    }

    #[test]
    fn outside_the_rounding_it_is_the_law_itself_and_within_it_is_close() {
        for strain in [-0.5, -0.01, 0.01, 0.5] {
            let difference = ROUNDED.tension(strain) - ROUNDED.law.tension(strain);
            assert!(difference.abs() < 1e-16, "{strain}: {difference}");
        }
        let most = 0.25 * (0.399 - 0.157) * 0.01;
        for strain in [-0.005, 0.0, 0.005] {
            let difference = ROUNDED.tension(strain) - ROUNDED.law.tension(strain);
            assert!(
                (0.0..=most * (1.0 + 1e-12)).contains(&difference),
                "{strain}: {difference}"
            );
        }
    }
}
