//! Onset of damage: the load at which the first point of matrix, fibre or interface reaches its
//! limit.
//!
//! Stresses are linear in the load, so that one solution gives the factor. They are means over a
//! pixel, or over about three along a face: where fibres nearly touch they grow with a finer grid.
use nalgebra::{Matrix3, Vector6};

use super::effective::{Effective, Load};
use super::phase::Space;
use super::pixels::{FIBRE, MATRIX, Pixels};
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

    /// The least limit of matrix, fibre and interface [MPa]; 0 where there is none.
    fn least(&self) -> [f64; 3] {
        let least = |limits: [Option<f64>; 2]| {
            let least = limits.into_iter().flatten().fold(f64::INFINITY, f64::min);
            if least.is_finite() { least } else { 0.0 }
        };
        [
            least([self.matrix_tension_mpa, None]),
            least([self.fibre_tension_mpa, self.fibre_compression_mpa]),
            least([self.interface_normal_mpa, self.interface_shear_mpa]),
        ]
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

/// Fewest pixels across a fibre: with fewer none may lie whole in it.
const FEWEST_ACROSS: f64 = 4.0;

/// A stress this small against the largest of the cell is round-off.
const ROUND_OFF: f64 = 1e-9;

impl Effective {
    /// How many times a load begins to damage the cell, and where.
    ///
    /// Whole pixels of matrix have their mean stress. Of a pixel cut by a face the stresses across the
    /// face are good and those along it are not, least of all on the stiff side; strains and stresses
    /// are therefore taken as the mean over all cut pixels among it and its eight neighbours. Along
    /// a face stresses across it change little over three pixels. The fibre is judged by whole pixels
    /// alone, and as the mean over those among nine.
    ///
    /// # Errors
    /// When a strength is not positive, a load not finite, or a fibre thinner than 4 pixels.
    pub fn onset(&self, load: &Load, strengths: &Strengths) -> Result<Onset, CompositeError> {
        strengths.checked()?;
        let pixels = &self.pixels;
        if pixels.across_fibre < FEWEST_ACROSS {
            return Err(CompositeError::OutOfRange {
                quantity: "the number of pixels across the thinnest fibre, for onset of damage",
                given: pixels.across_fibre,
                allowed: "at least 4",
            });
        }
        let phases: [Space; 2] = [MATRIX, FIBRE].map(|kind| pixels.stiffness[kind as usize]);
        let strains = self.strains(load)?;
        // largest share of a limit, and the pixel that has it
        let mut worst = [(0.0, 0); 3];
        let mut largest = 0.0_f64;
        let mut meet = |part: Part, share: f64, pixel: usize| {
            let worst = &mut worst[part as usize];
            if share > worst.0 {
                *worst = (share, pixel);
            }
        };
        for (pixel, strain) in strains.iter().enumerate() {
            if let Some(cut) = pixels.cut(pixel) {
                let is_cut = |near| pixels.cut(near).is_some();
                let (strain, stress) = around(pixels, &strains, pixel, is_cut);
                let matrix = cut.matrix_side(&phases[0], &strain, &stress);
                meet(Part::Matrix, strengths.of_matrix(&matrix), pixel);
                meet(Part::Interface, strengths.of_interface(&matrix), pixel);
                continue;
            }
            let stress = pixels.stress(pixel, strain);
            largest = largest.max(stress.amax());
            if pixels.kind[pixel] == MATRIX {
                meet(Part::Matrix, strengths.of_matrix(&stress), pixel);
            } else {
                let is_fibre = |near: usize| pixels.kind[near] == FIBRE;
                let (_, stress) = around(pixels, &strains, pixel, is_fibre);
                meet(Part::Fibre, strengths.of_fibre(&stress), pixel);
            }
        }
        let limits = strengths.least();
        let site = |part: Part| {
            let (share, pixel) = worst[part as usize];
            (share * limits[part as usize] > ROUND_OFF * largest).then(|| Site {
                factor: 1.0 / share,
                at_mm: pixels.middle_mm(pixel),
            })
        };
        Ok(Onset {
            matrix: site(Part::Matrix),
            fibre: site(Part::Fibre),
            interface: site(Part::Interface),
        })
    }
}

/// Mean strain and stress over those among a pixel and its neighbours that are like it.
fn around(
    pixels: &Pixels,
    strains: &[Vector6<f64>],
    pixel: usize,
    is_like: impl Fn(usize) -> bool,
) -> (Vector6<f64>, Vector6<f64>) {
    let (mut strain, mut stress) = (Vector6::zeros(), Vector6::zeros());
    let mut count = 0.0;
    for near in pixels.around(pixel) {
        if is_like(near) {
            strain += strains[near];
            stress += pixels.stress(near, &strains[near]);
            count += 1.0;
        }
    }
    (strain / count, stress / count)
}
