//! Materials with three planes of symmetry, in a section they may stand out of.
use std::fmt;

use nalgebra::{Matrix3, Matrix6};

use crate::section::error::{CompositeError, finite, positive};
use crate::section::stiffness::{PlaneState, Stiffness, compliance};

/// Constants of an orthotropic material. ν_ij is minus the strain along j over that along i when
/// pulled along i.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orthotropic {
    /// E₁ [MPa].
    pub modulus_1_mpa: f64,
    /// E₂ [MPa].
    pub modulus_2_mpa: f64,
    /// ν₁₂ [-].
    pub poisson_ratio_12: f64,
    /// G₁₂ [MPa]; `None` takes Huber's estimate.
    pub shear_modulus_12_mpa: Option<f64>,
    /// E₃ [MPa]; `None` takes E₂. This and what follows matters in plane strain, or when the
    /// material is turned out of the plane.
    pub modulus_3_mpa: Option<f64>,
    /// ν₁₃ [-]; `None` takes ν₁₂.
    pub poisson_ratio_13: Option<f64>,
    /// ν₂₃ [-]; `None` takes ν₁₂.
    pub poisson_ratio_23: Option<f64>,
    /// G₁₃ [MPa]; `None` takes G₁₂.
    pub shear_modulus_13_mpa: Option<f64>,
    /// G₂₃ [MPa]; `None` takes E₂ / (2 (1 + ν₂₃)).
    pub shear_modulus_23_mpa: Option<f64>,
}

/// A constant that was not given, and what was taken for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Note {
    /// Symbol of the constant.
    pub constant: &'static str,
    /// Value taken, in MPa for moduli.
    pub value: f64,
    /// Where it comes from.
    pub origin: &'static str,
}

impl fmt::Display for Note {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            formatter,
            "{} was not given; taken as {} by {}",
            self.constant, self.value, self.origin
        )
    }
}

/// Huber's estimate of the in-plane shear modulus [MPa] of an orthotropic material,
/// G₁₂ = √(E₁E₂) / (2 (1 + √(ν₁₂ν₂₁))): right for an isotropic one. Of negative ν₁₂ the root of
/// ν₁₂ν₂₁ is taken negative, which keeps the isotropic limit.
#[must_use]
pub fn hubers_shear_modulus(modulus_1: f64, modulus_2: f64, poisson_ratio_12: f64) -> f64 {
    let mean_ratio = poisson_ratio_12 * (modulus_2 / modulus_1).sqrt();
    (modulus_1 * modulus_2).sqrt() / (2.0 * (1.0 + mean_ratio))
}

impl Orthotropic {
    /// The material's axis 1 lies at cosine c to x and sine s to z.
    ///
    /// The compliance of all six strains is turned into the section's axes. Without stress out of
    /// the plane its block of the plane is inverted; without strain out of the plane, what the
    /// stresses there undo is taken away before: S_pp - S_po S_oo⁻¹ S_op, whose inverse is the
    /// plane's block of the stiffness.
    pub(super) fn stiffness(
        &self,
        state: PlaneState,
        [c, s]: [f64; 2],
    ) -> Result<(Stiffness, Vec<Note>), CompositeError> {
        let strain = state == PlaneState::Strain;
        let (own, notes) = self.own_compliance(strain, [c != 0.0, s != 0.0])?;
        let turn = strains_turned([c, s]);
        let all = turn * own * turn.transpose();
        let part = |row: usize, column: usize| all.fixed_view::<3, 3>(row, column).into_owned();
        let mut plane = part(0, 0);
        if strain {
            let coupling = part(0, 3);
            plane -= coupling * compliance(&part(3, 3)) * coupling.transpose();
        }
        Ok((compliance(&plane), notes))
    }

    /// By the compliance of normal strains, whose inverse it is; shears stand alone.
    pub(super) fn stiffness_of_space(&self) -> Result<(Matrix6<f64>, Vec<Note>), CompositeError> {
        let (own, notes) = self.own_compliance(true, [true, true])?;
        // Where the normal strains 11, 22, 33 and the shears 23, 13, 12 stand in its order.
        let normal = [0, 1, 3];
        let normals = compliance(&Matrix3::from_fn(|i, j| own[(normal[i], normal[j])]));
        let mut stiffness = Matrix6::zeros();
        stiffness.fixed_view_mut::<3, 3>(0, 0).copy_from(&normals);
        for (place, shear) in [(3, 4), (4, 5), (5, 2)] {
            stiffness[(place, place)] = 1.0 / own[(shear, shear)];
        }
        Ok((stiffness, notes))
    }

    /// Compliance [1/MPa] of the strains 11, 22, 12, 33, 23, 13 in the material's axes, and what had
    /// to be assumed. `strain`: whether what happens out of the plane matters; `along` and `out`:
    /// whether axis 1 has a part in the section's plane, and out of it.
    fn own_compliance(
        &self,
        strain: bool,
        [along, out]: [bool; 2],
    ) -> Result<(Matrix6<f64>, Vec<Note>), CompositeError> {
        // Which constants the result depends on.
        let oblique = along && out;
        let matters_23 = strain || out;
        let matters_13 = strain || oblique;

        let e1 = positive("modulus 1 [MPa]", self.modulus_1_mpa)?;
        let e2 = positive("modulus 2 [MPa]", self.modulus_2_mpa)?;
        let nu12 = bounded("ν₁₂", self.poisson_ratio_12, e1, e2)?;
        let mut notes = Vec::new();
        let mut choose = |given: Option<f64>, matters, constant, value, origin| {
            given.unwrap_or_else(|| {
                if matters {
                    notes.push(Note {
                        constant,
                        value,
                        origin,
                    });
                }
                value
            })
        };
        let isotropy = "transverse isotropy about axis 1";
        let alike = "the in-plane ν₁₂, for want of a measured value";
        let huber = hubers_shear_modulus(e1, e2, nu12);
        let g12 = choose(
            self.shear_modulus_12_mpa,
            along,
            "G₁₂ [MPa]",
            huber,
            "Huber's estimate",
        );
        let g12 = positive("shear modulus 12 [MPa]", g12)?;
        let e3 = choose(self.modulus_3_mpa, matters_23, "E₃ [MPa]", e2, isotropy);
        let e3 = positive("modulus 3 [MPa]", e3)?;
        let nu13 = choose(self.poisson_ratio_13, matters_13, "ν₁₃", nu12, isotropy);
        let nu23 = choose(self.poisson_ratio_23, matters_23, "ν₂₃", nu12, alike);
        if matters_13 {
            bounded("ν₁₃", nu13, e1, e3)?;
        }
        if matters_23 {
            bounded("ν₂₃", nu23, e2, e3)?;
        }
        if matters_13 && matters_23 {
            let (nu21, nu31, nu32) = (nu12 * e2 / e1, nu13 * e3 / e1, nu23 * e3 / e2);
            let determinant =
                1.0 - nu12 * nu21 - nu23 * nu32 - nu13 * nu31 - 2.0 * nu21 * nu32 * nu13;
            if determinant <= 0.0 {
                return Err(CompositeError::UnstableTogether { determinant });
            }
        }
        let g13 = choose(
            self.shear_modulus_13_mpa,
            oblique,
            "G₁₃ [MPa]",
            g12,
            isotropy,
        );
        let g13 = positive("shear modulus 13 [MPa]", g13)?;
        let transverse = e2 / (2.0 * (1.0 + nu23));
        let g23 = choose(
            self.shear_modulus_23_mpa,
            out,
            "G₂₃ [MPa]",
            transverse,
            isotropy,
        );
        // Of a ν₂₃ that does not matter here the estimate may be anything.
        let g23 = if out {
            positive("shear modulus 23 [MPa]", g23)?
        } else {
            g23
        };

        // Strains in the order 11, 22, 12 and 33, 23, 13: the plane first.
        let mut own = Matrix6::zeros();
        own[(0, 0)] = 1.0 / e1;
        own[(1, 1)] = 1.0 / e2;
        own[(2, 2)] = 1.0 / g12;
        own[(3, 3)] = 1.0 / e3;
        own[(4, 4)] = 1.0 / g23;
        own[(5, 5)] = 1.0 / g13;
        for (i, j, value) in [(0, 1, -nu12 / e1), (0, 3, -nu13 / e1), (1, 3, -nu23 / e2)] {
            own[(i, j)] = value;
            own[(j, i)] = value;
        }
        Ok((own, notes))
    }
}

/// The strains xx, yy, xy, zz, yz, xz (shears twice the tensor's) from those in a material's axes
/// 1 = (c, 0, s), 2 = y, 3 = (-s, 0, c). Stresses in the material's axes follow from those in the
/// section's by the transpose, so that a compliance S becomes N S Nᵀ.
fn strains_turned([c, s]: [f64; 2]) -> Matrix6<f64> {
    let mut turn = Matrix6::zeros();
    for (row, column, value) in [
        (0, 0, c * c),
        (0, 3, s * s),
        (0, 5, -c * s),
        (1, 1, 1.0),
        (2, 2, c),
        (2, 4, -s),
        (3, 0, s * s),
        (3, 3, c * c),
        (3, 5, c * s),
        (4, 2, s),
        (4, 4, c),
        (5, 0, 2.0 * c * s),
        (5, 3, -2.0 * c * s),
        (5, 5, c * c - s * s),
    ] {
        turn[(row, column)] = value;
    }
    turn
}

/// |ν_ij| < √(E_i / E_j): beyond, pulling along one axis and pushing along the other gives energy.
fn bounded(
    quantity: &'static str,
    given: f64,
    modulus_i: f64,
    modulus_j: f64,
) -> Result<f64, CompositeError> {
    finite(quantity, given)?;
    let bound = (modulus_i / modulus_j).sqrt();
    if given.abs() < bound {
        Ok(given)
    } else {
        Err(CompositeError::UnstableMaterial {
            quantity,
            given,
            bound,
        })
    }
}
