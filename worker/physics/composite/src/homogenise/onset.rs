//! Onset of damage: the load at which the first point of matrix, fibre or interface reaches its
//! limit.
//!
//! Stresses are linear in the load, so that one solution gives the factor. They are means of a
//! pixel, or of its matrix and of its fibre beside the face that cuts it: what is told is a stress
//! over about a pixel, and grows with a finer grid where fibres nearly touch.
use nalgebra::{Matrix3, Vector6};

use super::effective::{Effective, Load};
use super::phase::{Sides, Space};
use super::pixels::{FIBRE, MATRIX};
use crate::error::{CompositeError, positive};

/// Limits of stress; what has none does not fail.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Strengths {
    /// Largest principal stress in the matrix [MPa].
    pub matrix_tension_mpa: Option<f64>,
    /// Stress along the fibre [MPa].
    pub fibre_tension_mpa: Option<f64>,
    /// The same in compression, as a positive number [MPa].
    pub fibre_compression_mpa: Option<f64>,
    /// Tension σ across the interface [MPa], and shear τ along it [MPa]:
    /// (max(σ, 0)/σ₀)² + (τ/τ₀)² = 1. Source: [BrewerLagace1988].
    pub interface_normal_mpa: Option<f64>,
    pub interface_shear_mpa: Option<f64>,
}

/// Where a limit is reached first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Site {
    /// How many times the given load; of a unit stress, the stress [MPa].
    pub factor: f64,
    /// Middle of the pixel [mm].
    pub at_mm: [f64; 2],
}

/// What damage may begin in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    Matrix,
    Fibre,
    Interface,
}

/// Loads at which parts of a cell reach their limits, each as if the others held; `None` where no
/// limit is given or the load never reaches it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Onset {
    pub matrix: Option<Site>,
    pub fibre: Option<Site>,
    pub interface: Option<Site>,
}

impl Onset {
    /// The part that fails first, and where.
    #[must_use]
    pub fn first(&self) -> Option<(Part, Site)> {
        [
            (Part::Matrix, self.matrix),
            (Part::Fibre, self.fibre),
            (Part::Interface, self.interface),
        ]
        .into_iter()
        .filter_map(|(part, site)| Some((part, site?)))
        .min_by(|a, b| a.1.factor.total_cmp(&b.1.factor))
    }
}

impl Strengths {
    fn checked(&self) -> Result<(), CompositeError> {
        for (quantity, given) in [
            (
                "the matrix' strength in tension [MPa]",
                self.matrix_tension_mpa,
            ),
            (
                "the fibre's strength in tension [MPa]",
                self.fibre_tension_mpa,
            ),
            (
                "the fibre's strength in compression [MPa]",
                self.fibre_compression_mpa,
            ),
            (
                "the interface's strength in tension [MPa]",
                self.interface_normal_mpa,
            ),
            (
                "the interface's strength in shear [MPa]",
                self.interface_shear_mpa,
            ),
        ] {
            given.map(|given| positive(quantity, given)).transpose()?;
        }
        Ok(())
    }

    /// Share of its limit that a stress in the matrix has.
    fn of_matrix(&self, stress: &Vector6<f64>) -> f64 {
        self.matrix_tension_mpa
            .map_or(0.0, |limit| largest_principal(stress) / limit)
    }

    fn of_fibre(&self, stress: &Vector6<f64>) -> f64 {
        let share = |limit: Option<f64>, stress: f64| limit.map_or(0.0, |limit| stress / limit);
        share(self.fibre_tension_mpa, stress[0]).max(share(self.fibre_compression_mpa, -stress[0]))
    }

    /// Of a stress in the frame of the face, whose 2 is the normal.
    fn of_interface(&self, stress: &Vector6<f64>) -> f64 {
        let share =
            |limit: Option<f64>, square: f64| limit.map_or(0.0, |limit| square / (limit * limit));
        let shear = stress[3] * stress[3] + stress[5] * stress[5];
        let tension = stress[1].max(0.0);
        (share(self.interface_normal_mpa, tension * tension)
            + share(self.interface_shear_mpa, shear))
        .sqrt()
    }
}

/// Of a stress in the order 11, 22, 33, 23, 13, 12.
fn largest_principal(stress: &Vector6<f64>) -> f64 {
    let [s11, s22, s33, s23, s13, s12] = (*stress).into();
    Matrix3::new(s11, s12, s13, s12, s22, s23, s13, s23, s33)
        .symmetric_eigenvalues()
        .max()
}

impl Effective {
    /// How many times a load begins to damage the cell, and where.
    ///
    /// # Errors
    /// When a strength is not positive, or a load not finite.
    pub fn onset(&self, load: &Load, strengths: &Strengths) -> Result<Onset, CompositeError> {
        strengths.checked()?;
        let phases: [Space; 2] = [MATRIX, FIBRE].map(|kind| self.pixels.stiffness[kind as usize]);
        // largest share of a limit, and the pixel that has it
        let mut worst = [(0.0, 0); 3];
        let mut meet = |part: Part, share: f64, pixel: usize| {
            let worst = &mut worst[part as usize];
            if share > worst.0 {
                *worst = (share, pixel);
            }
        };
        self.for_pixels(load, |pixel, strain, stress| {
            if let Some(cut) = self.pixels.cut(pixel) {
                let Sides { matrix, fibre } = cut.sides(&phases[0], &phases[1], strain, stress);
                meet(Part::Matrix, strengths.of_matrix(&matrix), pixel);
                meet(Part::Fibre, strengths.of_fibre(&fibre), pixel);
                meet(Part::Interface, strengths.of_interface(&matrix), pixel);
            } else if self.pixels.kind[pixel] == MATRIX {
                meet(Part::Matrix, strengths.of_matrix(stress), pixel);
            } else {
                meet(Part::Fibre, strengths.of_fibre(stress), pixel);
            }
        })?;
        let [matrix, fibre, interface] = worst.map(|(share, pixel)| {
            (share > 0.0).then(|| Site {
                factor: 1.0 / share,
                at_mm: self.pixels.middle_mm(pixel),
            })
        });
        Ok(Onset {
            matrix,
            fibre,
            interface,
        })
    }
}
