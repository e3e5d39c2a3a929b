//! What is tested.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{ExplicitSheet, MadeSheet};

/// The body that is tested.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Specimen {
    /// One fibre, of the mean length and the curl of its pulp.
    SingleFibre(SingleFibre),
    /// A sheet given fibre by fibre.
    Explicit(ExplicitSheet),
    /// A sheet made of the pulps.
    Sheet(MadeSheet),
}

impl Specimen {
    /// Whether it is one fibre alone.
    pub fn is_single_fibre(&self) -> bool {
        matches!(self, Self::SingleFibre(_))
    }
}

/// A fibre alone. Its E, ν, G and E I are measured whatever the load is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SingleFibre {
    pub load: SingleFibreLoad,
    /// Name of its pulp. Left out: the first.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pulp: Option<String>,
}

/// What the curve and the pictures show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SingleFibreLoad {
    /// The curled fibre, glued at both ends, is pulled along its chord; displacements of any size.
    Pull,
    /// The fibre, straight, is twisted until `max_strain` is the shear strain on the ring of points;
    /// small displacements.
    Twist,
    /// The fibre, straight, is bent by moments until `max_strain` is the strain on the ring of points;
    /// small displacements.
    Bend,
    /// The fibre, straight and pinned at its ends, is pushed until it buckles.
    Buckle,
}
