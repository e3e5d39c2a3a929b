//! Onset of damage: the load at which the first point of matrix, fibre or interface reaches its
//! limit.
//!
//! Stresses are linear in the load, so that one solution gives the factor. They are means over a
//! pixel, or over about three along a face: where fibres nearly touch they grow with a finer grid.
use nalgebra::{Matrix3, Vector6};

use super::effective::{Effective, Load};
use super::phase::Space;
use super::pixels::{FIBRE, MATRIX, Pixels};
use crate::breaking::{check_interface, check_strength};
use crate::error::CompositeError;
use crate::strength::{InterfaceStrength, Limit, Strength};

/// What a phase bears.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PhaseStrength {
    /// Whether it has fibres of its own along axis 1: its limits are then those of its axes, else those of
    /// principal stresses.
    pub is_orthotropic: bool,
    /// Limits [MPa]. Energies that cracks take do not matter to where damage begins.
    pub limits: Strength,
}

/// Limits of stress; what has none does not fail.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Strengths {
    pub matrix: PhaseStrength,
    pub fibre: PhaseStrength,
    /// Tension σ across the interface and shear τ along it [MPa]:
    /// (max(σ, 0)/σ₀)² + (τ/τ₀)² = 1. Source: [BrewerLagace1988].
    pub interface: Option<InterfaceStrength>,
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

impl PhaseStrength {
    /// The least limit [MPa]; 0 where there is none.
    fn least(&self) -> f64 {
        let Strength {
            tension,
            compression,
            across_tension,
            across_compression,
            shear,
        } = self.limits;
        least([
            tension,
            compression,
            across_tension,
            across_compression,
            shear,
        ])
    }

    /// Share of its limit that a stress has, whose 1 lies along the fibres.
    ///
    /// - Isotropic: the largest principal stress of all three over `tension`, the least over `compression`.
    /// - Orthotropic: the stress along axis 1 over `tension` or `compression`, or the sum of squares of
    ///   [`between_fibres`].
    ///
    /// The laws of a section that breaks ([`crate::breaking`]), whose stresses lie in its plane, in space.
    fn share(&self, stress: &Vector6<f64>) -> f64 {
        let limits = &self.limits;
        if limits.is_unbreakable() {
            return 0.0;
        }
        let of =
            |limit: Option<Limit>, stress: f64| limit.map_or(0.0, |limit| stress / limit.limit);
        if self.is_orthotropic {
            let along = of(limits.tension, stress[0]).max(of(limits.compression, -stress[0]));
            along.max(between_fibres(limits, stress).sqrt())
        } else {
            let [least, largest] = principal(stress);
            of(limits.tension, largest).max(of(limits.compression, -least))
        }
    }
}

/// Of all planes along axis 1 the largest (σ/Y)² + (τ/S)², with σ [MPa] across the plane, Y the limit across
/// fibres in tension or compression, τ [MPa] along axis 1 and S the limit in shear: [Hashin1980]'s quadratic sum
/// on the plane it acts on. Shear of the plane across axis 1, for which materials here have no limit, is left
/// out.
fn between_fibres(limits: &Strength, stress: &Vector6<f64>) -> f64 {
    if [
        limits.across_tension,
        limits.across_compression,
        limits.shear,
    ]
    .iter()
    .all(Option::is_none)
    {
        return 0.0;
    }
    let [_, s22, s33, s23, s13, s12] = (*stress).into();
    let square = |limit: Option<Limit>, stress: f64| {
        limit.map_or(0.0, |limit| (stress / limit.limit).powi(2))
    };
    let on = |angle: f64| {
        let (s, c) = angle.sin_cos();
        let across = c * c * s22 + s * s * s33 + 2.0 * c * s * s23;
        let limit = if across > 0.0 {
            limits.across_tension
        } else {
            limits.across_compression
        };
        square(limit, across) + square(limits.shear, c * s12 + s * s13)
    };
    let mut step = std::f64::consts::PI / f64::from(PLANES);
    let (mut worst, mut at) = (0.0, 0.0);
    let meet = |angle: f64, (worst, at): (f64, f64)| {
        let sum = on(angle);
        if sum > worst {
            (sum, angle)
        } else {
            (worst, at)
        }
    };
    for place in 0..PLANES {
        (worst, at) = meet(f64::from(place) * step, (worst, at));
    }
    for _ in 0..HALVINGS {
        step *= 0.5;
        for angle in [at - step, at + step] {
            (worst, at) = meet(angle, (worst, at));
        }
    }
    worst
}

/// Planes that are tried, the sum having no harmonic of the angle above the fourth: none of its peaks is missed by
/// more than 1.5 % of it. The highest found is then followed, its step halved as often as to leave 1e-8.
const PLANES: u32 = 36;
const HALVINGS: u32 = 12;

/// The least of some limits [MPa]; 0 where there is none.
fn least<const N: usize>(limits: [Option<Limit>; N]) -> f64 {
    let limits = limits.into_iter().flatten().map(|limit| limit.limit);
    let least = limits.fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

impl Strengths {
    /// Whether nothing fails.
    #[must_use]
    pub fn are_none(&self) -> bool {
        let is_firm = |phase: &PhaseStrength| phase.limits.is_unbreakable();
        is_firm(&self.matrix) && is_firm(&self.fibre) && self.interface.is_none()
    }

    fn checked(&self) -> Result<(), CompositeError> {
        check_strength(&self.matrix.limits)?;
        check_strength(&self.fibre.limits)?;
        self.interface.as_ref().map_or(Ok(()), check_interface)
    }

    /// The least limit of matrix, fibre and interface [MPa]; 0 where there is none.
    fn least(&self) -> [f64; 3] {
        let interface = self.interface;
        [
            self.matrix.least(),
            self.fibre.least(),
            least([
                interface.map(|interface| interface.normal),
                interface.map(|interface| interface.shear),
            ]),
        ]
    }

    /// Of a stress in the frame of the face, whose 2 is the normal.
    fn of_interface(&self, stress: &Vector6<f64>) -> f64 {
        let share = |limit: Limit, square: f64| square / (limit.limit * limit.limit);
        let shear = stress[3] * stress[3] + stress[5] * stress[5];
        let tension = stress[1].max(0.0);
        self.interface.map_or(0.0, |interface| {
            (share(interface.normal, tension * tension) + share(interface.shear, shear)).sqrt()
        })
    }
}

/// The least and the largest of a stress in the order 11, 22, 33, 23, 13, 12.
fn principal(stress: &Vector6<f64>) -> [f64; 2] {
    let [s11, s22, s33, s23, s13, s12] = (*stress).into();
    let all = Matrix3::new(s11, s12, s13, s12, s22, s23, s13, s23, s33).symmetric_eigenvalues();
    [all.min(), all.max()]
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
                meet(Part::Matrix, strengths.matrix.share(&matrix), pixel);
                meet(Part::Interface, strengths.of_interface(&matrix), pixel);
                continue;
            }
            let stress = pixels.stress(pixel, strain);
            largest = largest.max(stress.amax());
            if pixels.kind[pixel] == MATRIX {
                meet(Part::Matrix, strengths.matrix.share(&stress), pixel);
            } else {
                let is_fibre = |near: usize| pixels.kind[near] == FIBRE;
                let (_, stress) = around(pixels, &strains, pixel, is_fibre);
                meet(Part::Fibre, strengths.fibre.share(&stress), pixel);
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
