//! Elastic materials and their plane stiffness.
//!
//! What a spec may leave out is filled in here, and every such choice is told as a [`Note`].
use std::fmt;

use nalgebra::{Matrix3, Matrix6};

use crate::section::error::{CompositeError, finite, positive};
use crate::section::stiffness::{Stiffness, compliance, direction};

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
    /// Three planes of symmetry; 1 lies along the fibre, 2 in the section's plane, 3 out of it
    /// unless it is turned.
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

impl Orthotropic {
    /// The material's axis 1 lies at cosine c to x and sine s to z.
    ///
    /// The compliance of all six strains is turned into the section's axes. Without stress out of
    /// the plane its block of the plane is inverted; without strain out of the plane, what the
    /// stresses there undo is taken away before: S_pp - S_po S_oo⁻¹ S_op, whose inverse is the
    /// plane's block of the stiffness.
    fn stiffness(
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
    fn stiffness_of_space(&self) -> Result<(Matrix6<f64>, Vec<Note>), CompositeError> {
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
        shear_modulus_13_mpa: None,
        shear_modulus_23_mpa: None,
    };

    /// A carbon fibre ply with nine constants, none of them like another.
    const PLY: Orthotropic = Orthotropic {
        modulus_1_mpa: 140_000.0,
        modulus_2_mpa: 10_000.0,
        poisson_ratio_12: 0.30,
        shear_modulus_12_mpa: Some(5_000.0),
        modulus_3_mpa: Some(9_000.0),
        poisson_ratio_13: Some(0.25),
        poisson_ratio_23: Some(0.45),
        shear_modulus_13_mpa: Some(4_000.0),
        shear_modulus_23_mpa: Some(3_300.0),
    };

    /// Round-off of turned and inverted compliances, over the largest stiffness.
    const ROUND_OFF: f64 = 1e-12;

    #[test]
    fn along_the_plane_a_ply_has_the_formulas_of_its_state() {
        let (e1, e2, e3) = (140_000.0, 10_000.0, 9_000.0);
        let (nu12, nu13, nu23) = (0.30, 0.25, 0.45);
        let (stress, notes) = Material::Orthotropic(PLY)
            .stiffness(PlaneState::Stress)
            .unwrap();
        assert!(notes.is_empty());
        let d = 1.0 - nu12 * nu12 * e2 / e1;
        for (found, expected) in [
            (stress[(0, 0)], e1 / d),
            (stress[(0, 1)], nu12 * e2 / d),
            (stress[(1, 1)], e2 / d),
            (stress[(2, 2)], 5_000.0),
        ] {
            assert!((found / expected - 1.0).abs() < ROUND_OFF);
        }
        assert!(stress[(0, 2)] == 0.0 && stress[(1, 2)] == 0.0);
        // Plane strain: C₁₁ = E₁ (1 - ν₂₃ν₃₂)/Δ, C₁₂ = E₁ (ν₂₁ + ν₃₁ν₂₃)/Δ, C₂₂ = E₂ (1 - ν₁₃ν₃₁)/Δ.
        let (nu21, nu31, nu32) = (nu12 * e2 / e1, nu13 * e3 / e1, nu23 * e3 / e2);
        let delta = 1.0 - nu12 * nu21 - nu23 * nu32 - nu13 * nu31 - 2.0 * nu21 * nu32 * nu13;
        let (strain, _) = Material::Orthotropic(PLY)
            .stiffness(PlaneState::Strain)
            .unwrap();
        for (found, expected) in [
            (strain[(0, 0)], e1 * (1.0 - nu23 * nu32) / delta),
            (strain[(0, 1)], e1 * (nu21 + nu31 * nu23) / delta),
            (strain[(1, 1)], e2 * (1.0 - nu13 * nu31) / delta),
            (strain[(2, 2)], 5_000.0),
        ] {
            assert!((found / expected - 1.0).abs() < ROUND_OFF);
        }
    }

    #[test]
    fn across_the_plane_a_ply_shows_its_axes_3_and_2() {
        let (e2, e3, nu23) = (10_000.0, 9_000.0, 0.45);
        let nu32 = nu23 * e3 / e2;
        for angle in [90.0, -90.0, 270.0] {
            let (stress, _) = Material::Orthotropic(PLY)
                .stiffness_out_of_plane(PlaneState::Stress, angle)
                .unwrap();
            let d = 1.0 - nu23 * nu32;
            for (found, expected) in [
                (stress[(0, 0)], e3 / d),
                (stress[(0, 1)], nu32 * e2 / d),
                (stress[(1, 1)], e2 / d),
                (stress[(2, 2)], 3_300.0),
            ] {
                assert!((found / expected - 1.0).abs() < ROUND_OFF);
            }
        }
        // Axes named anew: 1 and 3 of the material change places.
        let renamed = Orthotropic {
            modulus_1_mpa: 9_000.0,
            modulus_3_mpa: Some(140_000.0),
            poisson_ratio_12: 0.45 * 9_000.0 / 10_000.0,
            poisson_ratio_13: Some(0.25 * 9_000.0 / 140_000.0),
            poisson_ratio_23: Some(0.30 * 10_000.0 / 140_000.0),
            shear_modulus_12_mpa: Some(3_300.0),
            shear_modulus_23_mpa: Some(5_000.0),
            ..PLY
        };
        let (turned, _) = Material::Orthotropic(PLY)
            .stiffness_out_of_plane(PlaneState::Strain, 90.0)
            .unwrap();
        let (expected, _) = Material::Orthotropic(renamed)
            .stiffness(PlaneState::Strain)
            .unwrap();
        assert!((turned - expected).amax() < ROUND_OFF * expected.amax());
    }

    #[test]
    fn an_oblique_ply_stretches_and_shears_by_the_turned_compliance() {
        // 1/E_x = c⁴/E₁ + s⁴/E₃ + c²s² (1/G₁₃ - 2ν₁₃/E₁), 1/G_xy = c²/G₁₂ + s²/G₂₃,
        // ν_xy/E_x = c² ν₁₂/E₁ + s² ν₃₂/E₃.
        for (angle, sense) in [(30.0_f64, 1.0), (45.0, -1.0), (75.0, 1.0)] {
            let (s, c) = angle.to_radians().sin_cos();
            let (stiffness, notes) = Material::Orthotropic(PLY)
                .stiffness_out_of_plane(PlaneState::Stress, sense * angle)
                .unwrap();
            assert!(notes.is_empty());
            let found = compliance(&stiffness);
            let stretch = c.powi(4) / 140_000.0
                + s.powi(4) / 9_000.0
                + c * c * s * s * (1.0 / 4_000.0 - 2.0 * 0.25 / 140_000.0);
            let contraction = c * c * 0.30 / 140_000.0 + s * s * 0.45 / 10_000.0;
            let shear = c * c / 5_000.0 + s * s / 3_300.0;
            assert!((found[(0, 0)] / stretch - 1.0).abs() < ROUND_OFF);
            assert!((found[(0, 1)] / -contraction - 1.0).abs() < ROUND_OFF);
            assert!((found[(2, 2)] / shear - 1.0).abs() < ROUND_OFF);
            assert!((found[(1, 1)] * 10_000.0 - 1.0).abs() < ROUND_OFF);
        }
    }

    #[test]
    fn an_isotropic_material_with_nine_constants_is_the_same_at_every_angle() {
        let (e, nu) = (85.0, 0.3);
        let all = Material::Orthotropic(Orthotropic {
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
            let (expected, _) = isotropic.stiffness(state).unwrap();
            for angle in [0.0, 17.0, 45.0, 90.0, 133.0] {
                let (found, _) = all.stiffness_out_of_plane(state, angle).unwrap();
                assert!(
                    (found - expected).amax() < ROUND_OFF * e,
                    "{state:?} {angle}"
                );
            }
        }
    }

    #[test]
    fn only_constants_that_matter_are_told() {
        let told = |state, angle| -> Vec<&str> {
            let (_, notes) = Material::Orthotropic(FIBRE)
                .stiffness_out_of_plane(state, angle)
                .unwrap();
            notes.iter().map(|note| note.constant).collect()
        };
        assert_eq!(told(PlaneState::Stress, 0.0), ["G₁₂ [MPa]"]);
        assert_eq!(
            told(PlaneState::Stress, 90.0),
            ["E₃ [MPa]", "ν₂₃", "G₂₃ [MPa]"]
        );
        assert_eq!(
            told(PlaneState::Strain, 45.0),
            [
                "G₁₂ [MPa]",
                "E₃ [MPa]",
                "ν₁₃",
                "ν₂₃",
                "G₁₃ [MPa]",
                "G₂₃ [MPa]"
            ]
        );
        // Three ratios that do not go together are refused where all three matter.
        let together = Material::Orthotropic(Orthotropic {
            poisson_ratio_23: Some(0.97),
            poisson_ratio_12: 0.6,
            ..FIBRE
        });
        assert!(together.stiffness(PlaneState::Stress).is_ok());
        assert!(matches!(
            together.stiffness_out_of_plane(PlaneState::Stress, 45.0),
            Err(CompositeError::UnstableTogether { .. })
        ));
    }

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
        assert!(isotropic.stiffness(PlaneState::Stress).is_ok());
        let refused = isotropic.stiffness(PlaneState::Strain).unwrap_err();
        assert!(refused.to_string().contains("plane strain"), "{refused}");
    }

    #[test]
    fn the_stiffness_of_space_holds_that_of_plane_strain_and_undoes_the_compliance() {
        let (space, notes) = Material::Orthotropic(PLY).stiffness_of_space().unwrap();
        assert!(notes.is_empty());
        let (plane, _) = Material::Orthotropic(PLY)
            .stiffness(PlaneState::Strain)
            .unwrap();
        for (i, j, place) in [
            (0, 0, (0, 0)),
            (0, 1, (0, 1)),
            (1, 1, (1, 1)),
            (5, 5, (2, 2)),
        ] {
            assert!((space[(i, j)] - plane[place]).abs() < ROUND_OFF * 140_000.0);
        }
        // Pulled along 3 it stretches by 1/E₃ and thins by ν₂₃/E₂ along 2, ν₁₃/E₁ along 1.
        let strain = [-0.25 / 140_000.0, -0.45 / 10_000.0, 1.0 / 9_000.0];
        for row in 0..3 {
            let stress: f64 = (0..3).map(|j| space[(row, j)] * strain[j]).sum();
            let expected = if row == 2 { 1.0 } else { 0.0 };
            assert!((stress - expected).abs() < 1e-12, "{row}: {stress}");
        }
        assert_eq!((space[(3, 3)], space[(4, 4)]), (3_300.0, 4_000.0));
        let (isotropic, _) = Material::Isotropic {
            youngs_modulus_mpa: 85.0,
            poisson_ratio: 0.3,
        }
        .stiffness_of_space()
        .unwrap();
        // E (1 - ν)/((1 + ν)(1 - 2ν)) and E/(2 (1 + ν))
        assert!((isotropic[(2, 2)] - 85.0 * 0.7 / (1.3 * 0.4)).abs() < 1e-12 * 85.0);
        assert!((isotropic[(4, 4)] - 85.0 / 2.6).abs() < 1e-12 * 85.0);
    }
}
