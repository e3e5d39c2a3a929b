//! What a cell is made of, and how each of it cracks.
//!
//! Parts crack on planes across one of two axes at right angles. Those of what has fibres lie along
//! and across them, those of an isotropic material are fixed by its first crack.
use serde::{Deserialize, Serialize};

use super::saw::Saw;
use crate::stiffness::Stiffness;
use crate::strength::{Criterion, Limit};

/// Which part of a cell broke.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum BrokenPart {
    /// The matrix, or a ply.
    Matrix,
    /// The fibre of this place.
    Fibre(u32),
    /// The face between the fibre of this place and what it lies in.
    Interface(u32),
    /// The face above the ply of this place, from the bottom.
    PlyFace(u32),
}

/// Limits on a plane of a part. Normal and shear add up as (σ/σ_n)² + (τ/τ_s)² = 1, as in
/// [Hashin1980] for cracks between fibres.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct PlaneLaw {
    pub(crate) tension: Option<Limit>,
    pub(crate) compression: Option<Limit>,
    pub(crate) shear: Option<Limit>,
    /// Whether an open crack on it slides freely too.
    pub(crate) slides: bool,
}

impl PlaneLaw {
    pub(crate) fn is_unbreakable(&self) -> bool {
        self.limits().all(|limit| limit.is_none())
    }

    pub(crate) fn limits(&self) -> impl Iterator<Item = Option<Limit>> {
        [self.tension, self.compression, self.shear].into_iter()
    }
}

/// How a material or a face cracks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Law {
    /// Place of the material whose limits these are.
    pub(crate) material: usize,
    /// Normal of the first plane; the second's is a quarter turn further. `None`: fixed by the first
    /// crack, across the largest or smallest principal stress.
    pub(crate) axis: Option<[f64; 2]>,
    pub(crate) planes: [PlaneLaw; 2],
    pub(crate) criterion: Criterion,
}

impl Law {
    pub(crate) fn is_unbreakable(&self) -> bool {
        self.planes.iter().all(PlaneLaw::is_unbreakable)
    }
}

/// A layer of a cell, or a face in it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Part {
    pub(crate) cell: u32,
    pub(crate) kind: BrokenPart,
    /// Place of its law.
    pub(crate) law: u32,
    /// Layers of one stage lie side by side; what they make is a layer of the next stage.
    pub(crate) stage: u32,
    /// Along the layers of its stage.
    pub(crate) along: [f64; 2],
    /// Along what lies beside it in the cell: the fibre of a matrix, the plies of a ply.
    pub(crate) beside: [f64; 2],
    /// Of the cell's area; 1 for a face.
    pub(crate) share: f64,
    /// Intact, in the section's axes [MPa]; of a face not used.
    pub(crate) stiffness: Stiffness,
    /// Of faces: moduli across and along [MPa] of what they lie in, against which they soften.
    pub(crate) bed: [f64; 2],
    /// Its strength over the law's.
    pub(crate) strength: f64,
    /// Its fracture energy over the law's.
    pub(crate) toughness: f64,
}

impl Part {
    pub(crate) fn is_face(&self) -> bool {
        matches!(self.kind, BrokenPart::Interface(_) | BrokenPart::PlyFace(_))
    }

    /// Whether an open crack slides freely. Fibres that are broken beside matrix do not: their shear
    /// is that of the whole cell, which would be lost with them.
    pub(crate) fn slides(&self, law: &Law, plane: usize) -> bool {
        law.planes[plane].slides || self.share >= 1.0
    }

    /// Width [mm] of the part across a crack with a normal, in a cell of the given sides: the cell's
    /// area over the length of the crack through its middle, and only the part's own share of that
    /// where the crack runs along the layers.
    pub(crate) fn width_mm(&self, [a, b]: [f64; 2], normal: [f64; 2]) -> f64 {
        let cell = (a * normal[0].abs()).max(b * normal[1].abs());
        let across = normal[1] * self.beside[0] - normal[0] * self.beside[1];
        if across * across > 0.5 {
            cell * self.share
        } else {
            cell
        }
    }
}

/// Damage on one plane of a part.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct PlaneDamage {
    /// Teeth that are broken.
    pub(crate) level: u16,
    /// Teeth that the normal stiffness lost: fewer where the plane slid under pressure.
    pub(crate) opened: u16,
    /// Whether its faces meet: pressed, it has all of its normal stiffness.
    pub(crate) is_closed: bool,
    /// Whether it was pressure that took the normal stiffness.
    pub(crate) is_crushed: bool,
    /// √x₀ of the saws of normal and shear.
    pub(crate) roots: [f64; 2],
    /// Area of the crack when it is open [mm²].
    pub(crate) area_mm2: f64,
}

/// Damage of a part.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Damage {
    /// Normal of the first plane.
    pub(crate) axis: [f64; 2],
    pub(crate) planes: [PlaneDamage; 2],
}

impl Damage {
    /// None yet.
    pub(crate) fn none(law: &Law) -> Self {
        Self {
            axis: law.axis.unwrap_or([1.0, 0.0]),
            planes: [PlaneDamage::default(); 2],
        }
    }

    /// The second plane as of a face that was never bonded: it slides, bears pressure, and opens where
    /// it is pulled.
    pub(crate) fn unbonded(law: &Law, teeth: u16) -> Self {
        let mut damage = Self::none(law);
        damage.planes[1] = PlaneDamage {
            level: teeth,
            opened: teeth,
            is_closed: true,
            is_crushed: false,
            // of no softening, they do not matter
            roots: [0.5; 2],
            area_mm2: 0.0,
        };
        damage
    }

    pub(crate) fn is_none(&self) -> bool {
        self.planes.iter().all(|plane| plane.level == 0)
    }

    /// Normal of a plane.
    pub(crate) fn normal(&self, plane: usize) -> [f64; 2] {
        let [c, s] = self.axis;
        if plane == 0 { [c, s] } else { [-s, c] }
    }
}

impl PlaneDamage {
    pub(crate) fn saw(&self, teeth: u16, kind: usize) -> Saw {
        Saw::of_root(teeth, self.roots[kind])
    }

    /// Whether tension opened it, so that its faces can meet.
    pub(crate) fn has_faces(&self) -> bool {
        self.opened > 0 && !self.is_crushed
    }

    /// By how much softer the plane is than intact, 1/ω - 1: normal and shear.
    pub(crate) fn softness(&self, teeth: u16, slides: bool) -> [f64; 2] {
        let of = |level: u16, kind: usize| {
            if level == 0 {
                0.0
            } else {
                1.0 / self.saw(teeth, kind).integrity(level) - 1.0
            }
        };
        [
            if self.is_closed {
                0.0
            } else {
                of(self.opened, 0)
            },
            if slides { of(self.level, 1) } else { 0.0 },
        ]
    }
}
