//! Nine engineering constants and the stiffness they come from.
use nalgebra::Matrix6;

/// Engineering constants of an orthotropic material; 1 along the fibres, ν_ij minus the strain along
/// j over that along i when pulled along i.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constants {
    pub e1_mpa: f64,
    pub e2_mpa: f64,
    pub e3_mpa: f64,
    pub nu12: f64,
    pub nu13: f64,
    pub nu23: f64,
    pub g12_mpa: f64,
    pub g13_mpa: f64,
    pub g23_mpa: f64,
}

impl Constants {
    /// Names with units, in the order of [`Constants::values`].
    pub const NAMES: [&'static str; 9] = [
        "E₁ [MPa]",
        "E₂ [MPa]",
        "E₃ [MPa]",
        "ν₁₂",
        "ν₁₃",
        "ν₂₃",
        "G₁₂ [MPa]",
        "G₁₃ [MPa]",
        "G₂₃ [MPa]",
    ];

    /// By the compliance S of all six strains [1/MPa], order 11, 22, 33, 23, 13, 12: E_i = 1/S_ii,
    /// ν_ij = -S_ij/S_ii, G = 1/S of the shears. Couplings beyond an orthotropic material's, which a
    /// cell without its symmetry has, are in S and not in these.
    pub(super) fn of_compliance(s: &Matrix6<f64>) -> Self {
        Self {
            e1_mpa: 1.0 / s[(0, 0)],
            e2_mpa: 1.0 / s[(1, 1)],
            e3_mpa: 1.0 / s[(2, 2)],
            nu12: -s[(0, 1)] / s[(0, 0)],
            nu13: -s[(0, 2)] / s[(0, 0)],
            nu23: -s[(1, 2)] / s[(1, 1)],
            g12_mpa: 1.0 / s[(5, 5)],
            g13_mpa: 1.0 / s[(4, 4)],
            g23_mpa: 1.0 / s[(3, 3)],
        }
    }

    /// All nine, in the order of [`Constants::NAMES`].
    #[must_use]
    pub fn values(&self) -> [f64; 9] {
        [
            self.e1_mpa,
            self.e2_mpa,
            self.e3_mpa,
            self.nu12,
            self.nu13,
            self.nu23,
            self.g12_mpa,
            self.g13_mpa,
            self.g23_mpa,
        ]
    }

    /// From nine values in the order of [`Constants::NAMES`].
    #[must_use]
    pub fn of_values(v: [f64; 9]) -> Self {
        Self {
            e1_mpa: v[0],
            e2_mpa: v[1],
            e3_mpa: v[2],
            nu12: v[3],
            nu13: v[4],
            nu23: v[5],
            g12_mpa: v[6],
            g13_mpa: v[7],
            g23_mpa: v[8],
        }
    }
}
