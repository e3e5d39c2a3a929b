//! Elastic materials and their plane stiffness.
//!
//! What a spec may leave out is filled in here, and every such choice is told as a [`Note`].
use std::fmt;

use nalgebra::Matrix3;

use crate::section::error::{CompositeError, finite, positive};
use crate::section::stiffness::Stiffness;

/// What is known of the third direction, out of the plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlaneState {
    /// A thin sheet: no stress out of the plane.
    Stress,
    /// A long body: no strain out of the plane.
    Strain,
}

/// A linear elastic material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Material {
    /// The same in all directions.
    Isotropic {
        youngs_modulus_mpa: f64,
        poisson_ratio: f64,
    },
    /// Three planes of symmetry; 1 lies along the fibre, 2 in the section's plane, 3 out of it.
    Orthotropic(Orthotropic),
}

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
    /// E₃ [MPa]; `None` takes E₂. Needed in plane strain only, as are the next two.
    pub modulus_3_mpa: Option<f64>,
    /// ν₁₃ [-]; `None` takes ν₁₂.
    pub poisson_ratio_13: Option<f64>,
    /// ν₂₃ [-]; `None` takes ν₁₂.
    pub poisson_ratio_23: Option<f64>,
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

impl Material {
    /// Plane stiffness [MPa] in the material's own axes, and what had to be assumed for it.
    ///
    /// # Errors
    /// When a constant is not a finite number in its range, or when the material would not be
    /// stable: -1 < ν < 1/2; |ν_ij| < √(E_i/E_j), and all three together.
    pub fn stiffness(&self, state: PlaneState) -> Result<(Stiffness, Vec<Note>), CompositeError> {
        match *self {
            Self::Isotropic {
                youngs_modulus_mpa,
                poisson_ratio,
            } => Ok((
                isotropic(youngs_modulus_mpa, poisson_ratio, state)?,
                Vec::new(),
            )),
            Self::Orthotropic(constants) => constants.stiffness(state),
        }
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
    if !(nu > -1.0 && nu < 0.5) {
        return Err(CompositeError::OutOfRange {
            quantity: "the Poisson ratio",
            given: nu,
            allowed: "above -1 and below 0.5",
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

impl Orthotropic {
    fn stiffness(&self, state: PlaneState) -> Result<(Stiffness, Vec<Note>), CompositeError> {
        let e1 = positive("modulus 1 [MPa]", self.modulus_1_mpa)?;
        let e2 = positive("modulus 2 [MPa]", self.modulus_2_mpa)?;
        let nu12 = bounded("ν₁₂", self.poisson_ratio_12, e1, e2)?;
        let mut notes = Vec::new();
        let mut choose = |given: Option<f64>, constant, value, origin| {
            given.unwrap_or_else(|| {
                notes.push(Note {
                    constant,
                    value,
                    origin,
                });
                value
            })
        };
        let g12 = choose(
            self.shear_modulus_12_mpa,
            "G₁₂ [MPa]",
            hubers_shear_modulus(e1, e2, nu12),
            "Huber's estimate",
        );
        let g12 = positive("shear modulus 12 [MPa]", g12)?;
        // Compliances of the plane; plane strain takes away what σ₃₃ adds.
        let mut s11 = 1.0 / e1;
        let mut s12 = -nu12 / e1;
        let mut s22 = 1.0 / e2;
        if state == PlaneState::Strain {
            let isotropy = "transverse isotropy about axis 1";
            let alike = "the in-plane ν₁₂, for want of a measured value";
            let e3 = choose(self.modulus_3_mpa, "E₃ [MPa]", e2, isotropy);
            let e3 = positive("modulus 3 [MPa]", e3)?;
            let nu13 = choose(self.poisson_ratio_13, "ν₁₃", nu12, isotropy);
            let nu13 = bounded("ν₁₃", nu13, e1, e3)?;
            let nu23 = choose(self.poisson_ratio_23, "ν₂₃", nu12, alike);
            let nu23 = bounded("ν₂₃", nu23, e2, e3)?;
            let (nu21, nu31, nu32) = (nu12 * e2 / e1, nu13 * e3 / e1, nu23 * e3 / e2);
            let determinant =
                1.0 - nu12 * nu21 - nu23 * nu32 - nu13 * nu31 - 2.0 * nu21 * nu32 * nu13;
            if determinant <= 0.0 {
                return Err(CompositeError::UnstableTogether { determinant });
            }
            s11 -= nu13 * nu31 / e1;
            s12 -= nu13 * nu32 / e1;
            s22 -= nu23 * nu32 / e2;
        }
        let determinant = s11 * s22 - s12 * s12;
        let stiffness = Matrix3::new(
            s22 / determinant,
            -s12 / determinant,
            0.0,
            -s12 / determinant,
            s11 / determinant,
            0.0,
            0.0,
            0.0,
            g12,
        );
        Ok((stiffness, notes))
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::section::stiffness::compliance;

    const FIBRE: Orthotropic = Orthotropic {
        modulus_1_mpa: 11_500.0,
        modulus_2_mpa: 6_430.0,
        poisson_ratio_12: 0.28,
        shear_modulus_12_mpa: None,
        modulus_3_mpa: None,
        poisson_ratio_13: None,
        poisson_ratio_23: None,
    };

    #[test]
    fn hubers_estimate_of_the_papers_fibre() {
        let (stiffness, notes) = Material::Orthotropic(FIBRE)
            .stiffness(PlaneState::Stress)
            .unwrap();
        assert!((stiffness[(2, 2)] - 3_555.2).abs() < 0.05);
        assert_eq!(notes.len(), 1);
        assert_eq!(notes[0].constant, "G₁₂ [MPa]");
        assert!((hubers_shear_modulus(85.0, 85.0, 0.3) - 85.0 / 2.6).abs() < 1e-12);
        assert!((hubers_shear_modulus(85.0, 85.0, -0.3) - 85.0 / 1.4).abs() < 1e-12);
    }

    #[test]
    fn plane_stress_gives_back_its_constants() {
        let (stiffness, _) = Material::Orthotropic(FIBRE)
            .stiffness(PlaneState::Stress)
            .unwrap();
        let s = compliance(&stiffness);
        assert!((1.0 / s[(0, 0)] - 11_500.0).abs() < 1e-8);
        assert!((1.0 / s[(1, 1)] - 6_430.0).abs() < 1e-8);
        assert!((-s[(0, 1)] / s[(0, 0)] - 0.28).abs() < 1e-12);
    }

    #[test]
    fn an_isotropic_material_written_as_an_orthotropic_one_is_the_same_in_plane_strain() {
        let (e, nu) = (85.0, 0.3);
        let orthotropic = Material::Orthotropic(Orthotropic {
            modulus_1_mpa: e,
            modulus_2_mpa: e,
            poisson_ratio_12: nu,
            ..FIBRE
        });
        let isotropic = Material::Isotropic {
            youngs_modulus_mpa: e,
            poisson_ratio: nu,
        };
        for state in [PlaneState::Stress, PlaneState::Strain] {
            let (a, _) = orthotropic.stiffness(state).unwrap();
            let (b, _) = isotropic.stiffness(state).unwrap();
            assert!((a - b).amax() < 1e-12 * e, "{state:?}");
        }
        let (strain, notes) = orthotropic.stiffness(PlaneState::Strain).unwrap();
        let constrained = e * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
        assert!((strain[(0, 0)] - constrained).abs() < 1e-12 * e);
        assert_eq!(notes.len(), 4, "G₁₂, E₃, ν₁₃ and ν₂₃ are told");
    }

    #[test]
    fn constants_of_no_stable_material_are_refused_with_the_bound() {
        let refused = |constants| {
            Material::Orthotropic(constants)
                .stiffness(PlaneState::Strain)
                .unwrap_err()
                .to_string()
        };
        let unstable = refused(Orthotropic {
            poisson_ratio_12: 1.4,
            ..FIBRE
        });
        assert!(unstable.contains("ν₁₂ is 1.4") && unstable.contains("1.337"));
        assert!(
            refused(Orthotropic {
                modulus_2_mpa: 0.0,
                ..FIBRE
            })
            .contains("modulus 2")
        );
        let together = refused(Orthotropic {
            poisson_ratio_23: Some(0.97),
            poisson_ratio_12: 0.6,
            ..FIBRE
        });
        assert!(together.contains("must be positive"), "{together}");
        let isotropic = Material::Isotropic {
            youngs_modulus_mpa: 85.0,
            poisson_ratio: 0.5,
        };
        assert!(isotropic.stiffness(PlaneState::Stress).is_err());
    }
}
