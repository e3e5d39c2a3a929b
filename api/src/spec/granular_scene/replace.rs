//! Spheres that become clumps where they lie.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Body, Clump, whole::Whole};

/// Puts a clump in the place of every sphere of a material, at once: its centre of mass where the
/// sphere's was, turned at random by the seed, with the sphere's velocity and spin. What is fixed, and what
/// a stage drives or sets down, stays a sphere.
///
/// Clumps have numbers of their own from the start, after those of all bodies before.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Replace {
    /// Name of the material of the spheres, which is that of the clumps. It has no bonds.
    pub material: String,
    /// The clump, which is scaled for every sphere.
    pub clump: Clump,
    #[serde(default)]
    pub equal: Equal,
}

/// What a clump has in common with the sphere that it replaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Equal {
    /// The size: the ball around the clump, about its centre of mass, is the sphere, so that nothing
    /// overlaps more than before, and the clump is lighter. "Clumps of the same size" in [Dubina2014] 5.1,
    /// of the simulation in [Lim2004].
    #[default]
    Size,
    /// The mass, and with it the solid volume: the clump stands out of the sphere, into its neighbours. A
    /// `relax` stage, which must follow, takes them apart.
    Mass,
}

impl Equal {
    /// Radius of the sphere that a clump replaces as it is given [m].
    pub(crate) fn radius(self, clump: &Whole) -> f64 {
        match self {
            Self::Size => clump.reach,
            Self::Mass => clump.equal_radius(),
        }
    }

    #[allow(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
    pub(in crate::spec) fn is_size(&self) -> bool {
        *self == Self::Size
    }
}

impl Replace {
    /// What its clump is as a whole; `None` when it cannot be filled.
    pub(super) fn whole(&self) -> Option<Whole> {
        let clump = self.clump.resolved().ok()?;
        Some(Whole::of(&clump.members))
    }

    /// Whether it takes the place of a body, of those that no stage drives.
    pub fn replaces(&self, body: &Body) -> bool {
        body.sphere.is_some() && body.fixed.is_empty() && body.material == self.material
    }
}
