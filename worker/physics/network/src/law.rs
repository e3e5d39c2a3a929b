//! The law of a single bond.

/// Multiplied by, where kernels would divide by three.
const THIRD: f64 = 1.0 / 3.0;

/// What the kernels ask of a law.
pub(crate) trait StrainLaw: Copy {
    /// T(u) [N].
    fn tension(&self, strain: f64) -> f64;

    /// (a − b) l [N], what the axial stiffness (7) has more than the transverse one, times the
    /// length: T'(1 + u) − T. Never negative.
    fn axial_excess(&self, strain: f64) -> f64;

    /// Energy stored per rest length [N mm/mm].
    fn energy(&self, strain: f64) -> f64;
}

/// Force and energy of a bond as functions of its strain u = (l − l₀)/l₀ [-].
///
/// T = e u + f_r u² for u ≥ 0 (1), T = r_c u for u < 0 (2), with modulus e [N], friction modulus
/// f_r [N] and compression stiffness r_c [N]; tension positive. The force is continuous and has a
/// potential, but its slope jumps at u = 0 from r_c to e.
///
/// Source: [Zilka2022] eq. 1 and 2, there split into spring and friction term.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BondLaw {
    /// e [N].
    pub(crate) modulus: f64,
    /// f_r [N].
    pub(crate) friction_modulus: f64,
    /// r_c [N].
    pub(crate) compression_stiffness: f64,
}

impl BondLaw {
    /// u at which a tension T ≥ 0 [N] is reached, the positive root of f_r u² + e u − T = 0 (1).
    pub(crate) fn strain(&self, tension: f64) -> f64 {
        let discriminant = self.modulus * self.modulus + 4.0 * self.friction_modulus * tension;
        // in the form that also holds for f_r = 0
        2.0 * tension / (self.modulus + discriminant.sqrt())
    }

    /// T'(u) [N]. At u = 0 it is e, so that an unloaded network has its tensile stiffness.
    #[inline(always)]
    pub(crate) fn slope(&self, strain: f64) -> f64 {
        if strain < 0.0 {
            self.compression_stiffness
        } else {
            self.modulus + 2.0 * self.friction_modulus * strain
        }
    }
}

impl StrainLaw for BondLaw {
    /// (1) and (2).
    #[inline(always)]
    fn tension(&self, strain: f64) -> f64 {
        if strain < 0.0 {
            self.compression_stiffness * strain
        } else {
            (self.modulus + self.friction_modulus * strain) * strain
        }
    }

    /// e + f_r u (2 + u), or r_c in compression.
    #[inline(always)]
    fn axial_excess(&self, strain: f64) -> f64 {
        if strain < 0.0 {
            self.compression_stiffness
        } else {
            self.modulus + self.friction_modulus * strain * (2.0 + strain)
        }
    }

    /// e u²/2 + f_r u³/3, or r_c u²/2 (3).
    #[inline(always)]
    fn energy(&self, strain: f64) -> f64 {
        let square = strain * strain;
        if strain < 0.0 {
            0.5 * self.compression_stiffness * square
        } else {
            (0.5 * self.modulus + self.friction_modulus * strain * THIRD) * square
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PET: BondLaw = BondLaw {
        modulus: 0.399,
        friction_modulus: 1.473,
        compression_stiffness: 0.157,
    };
    /// A handful of roundings of numbers of order one.
    const ROUND_OFF: f64 = 1e-15;

    #[test]
    fn tension_follows_equations_1_and_2() {
        assert!((PET.tension(0.5) - (0.399 * 0.5 + 1.473 * 0.25)).abs() < ROUND_OFF);
        assert!((PET.tension(-0.5) - (-0.157 * 0.5)).abs() < ROUND_OFF);
    }

    #[test]
    fn strain_is_the_inverse_of_tension() {
        let straight = BondLaw {
            friction_modulus: 0.0,
            ..PET
        };
        for law in [PET, straight] {
            assert!((law.strain(law.tension(1.1)) - 1.1).abs() < 4.0 * ROUND_OFF);
        }
    }

    #[test]
    fn energy_follows_equation_3() {
        assert!((PET.energy(0.5) - (0.399 / 8.0 + 1.473 / 24.0)).abs() < ROUND_OFF);
        assert!((PET.energy(-0.5) - 0.157 / 8.0).abs() < ROUND_OFF);
    }

    #[test]
    fn energy_tension_and_slope_are_derivatives_of_each_other() {
        // central differences of step h are exact for quadratics and off by T''' h²/6 = f_r h²/3
        // at most for the cubic energy; round-off adds 1e-16/h
        let step = 1e-5;
        for strain in [-0.9, -0.1, 0.1, 1.3] {
            let of = |function: fn(&BondLaw, f64) -> f64| {
                (function(&PET, strain + step) - function(&PET, strain - step)) / (2.0 * step)
            };
            assert!((of(StrainLaw::energy) - PET.tension(strain)).abs() < 1e-9);
            assert!((of(StrainLaw::tension) - PET.slope(strain)).abs() < 1e-9);
        }
    }
}
