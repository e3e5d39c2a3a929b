//! Elastic materials and their plane stiffness.
//!
//! What a spec may leave out is filled in here, and every such choice is told as a [`Note`].
mod orthotropic;

#[cfg(test)]
mod tests;

use nalgebra::{Matrix3, Matrix6};

use crate::section::error::{CompositeError, finite, positive};
pub use crate::section::stiffness::PlaneState;
use crate::section::stiffness::{Stiffness, direction};

pub use orthotropic::{Note, Orthotropic, hubers_shear_modulus};

/// A linear elastic material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Material {
    /// The same in all directions.
    Isotropic {
        youngs_modulus_mpa: f64,
        poisson_ratio: f64,
    },
    /// Three planes of symmetry; 1 lies along the fibre, 2 in the section's plane, 3 out of it
    /// unless it is turned.
    Orthotropic(Orthotropic),
}

impl Material {
    /// Plane stiffness [MPa] in the material's own axes, and what had to be assumed for it.
    ///
    /// # Errors
    /// As [`Material::stiffness_out_of_plane`].
    pub fn stiffness(&self, state: PlaneState) -> Result<(Stiffness, Vec<Note>), CompositeError> {
        self.stiffness_out_of_plane(state, 0.0)
    }

    /// Plane stiffness [MPa] of the material turned about its axis 2, which stays y, so that axis 1
    /// makes `angle_deg` with x (0° along x, 90° across the plane); and what had to be assumed.
    /// Either sense of the turn gives the same.
    ///
    /// # Errors
    /// When a constant is not a finite number in its range, or when the material would not be
    /// stable: -1 < ν < 1/2; |ν_ij| < √(E_i/E_j), and all three together where all matter.
    pub fn stiffness_out_of_plane(
        &self,
        state: PlaneState,
        angle_deg: f64,
    ) -> Result<(Stiffness, Vec<Note>), CompositeError> {
        match *self {
            Self::Isotropic {
                youngs_modulus_mpa,
                poisson_ratio,
            } => Ok((
                isotropic(youngs_modulus_mpa, poisson_ratio, state)?,
                Vec::new(),
            )),
            Self::Orthotropic(constants) => {
                finite("an angle out of the plane [°]", angle_deg)?;
                constants.stiffness(state, direction(angle_deg))
            }
        }
    }

    /// Stiffness of all six strains [MPa] in the material's own axes, in the order 11, 22, 33, 23, 13,
    /// 12 with shears twice the tensor's, and what had to be assumed.
    ///
    /// # Errors
    /// As [`Material::stiffness_out_of_plane`], where all constants matter.
    pub fn stiffness_of_space(&self) -> Result<(Matrix6<f64>, Vec<Note>), CompositeError> {
        let (e, nu) = match *self {
            Self::Isotropic {
                youngs_modulus_mpa,
                poisson_ratio,
            } => (youngs_modulus_mpa, poisson_ratio),
            Self::Orthotropic(constants) => return constants.stiffness_of_space(),
        };
        // refuses what is out of range
        isotropic(e, nu, PlaneState::Strain)?;
        let shear = e / (2.0 * (1.0 + nu));
        let lame = e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
        let mut stiffness = Matrix6::zeros();
        for i in 0..3 {
            for j in 0..3 {
                stiffness[(i, j)] = lame;
            }
            stiffness[(i, i)] = lame + 2.0 * shear;
            stiffness[(i + 3, i + 3)] = shear;
        }
        Ok((stiffness, Vec::new()))
    }

    /// Young's modulus [MPa] and Poisson ratio for the paper's rule of bond stiffness, which knows
    /// one pair for each material: of an orthotropic one those along the fibre.
    pub fn along(&self) -> (f64, f64) {
        match self {
            Self::Isotropic {
                youngs_modulus_mpa,
                poisson_ratio,
            } => (*youngs_modulus_mpa, *poisson_ratio),
            Self::Orthotropic(constants) => (constants.modulus_1_mpa, constants.poisson_ratio_12),
        }
    }
}

fn isotropic(e: f64, nu: f64, state: PlaneState) -> Result<Stiffness, CompositeError> {
    positive("Young's modulus [MPa]", e)?;
    // what keeps its volume can still be a thin sheet, which gives way out of the plane
    let (is_stable, allowed) = match state {
        PlaneState::Stress => (nu > -1.0 && nu <= 0.5, "above -1 and at most 0.5"),
        PlaneState::Strain => (
            nu > -1.0 && nu < 0.5,
            "above -1 and below 0.5 in plane strain",
        ),
    };
    if !is_stable {
        return Err(CompositeError::OutOfRange {
            quantity: "the Poisson ratio",
            given: nu,
            allowed,
        });
    }
    // Plane strain is plane stress of E / (1 - ν²), ν / (1 - ν).
    let (e, nu) = match state {
        PlaneState::Stress => (e, nu),
        PlaneState::Strain => (e / (1.0 - nu * nu), nu / (1.0 - nu)),
    };
    let c11 = e / (1.0 - nu * nu);
    let shear = e / (2.0 * (1.0 + nu));
    Ok(Matrix3::new(
        c11,
        c11 * nu,
        0.0,
        c11 * nu,
        c11,
        0.0,
        0.0,
        0.0,
        shear,
    ))
}
