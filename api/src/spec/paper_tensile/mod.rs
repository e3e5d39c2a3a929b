//! Spec of a paper tensile test: pulps whose fibres are hollow tubes, alone.
//!
//! The fibre is the mass-spring tube of [LiuShen2025]: springs along, around, across and along the
//! diagonals of a ring of points, their stiffness from E, ν and G in closed form. Lengths are in mm and
//! µm, moduli in GPa, strengths in MPa; x is the pulling direction.
//!
//! The parts, each in its own file: what the fibres are ([`Pulp`]), what is tested ([`Specimen`]), how
//! fibres hold one another ([`Bond`]), how they are modelled ([`Model`]), what is done ([`Test`]), and
//! how exactly ([`Accuracy`]).
mod accuracy;
mod bond;
mod checks;
mod estimate;
mod job_kind;
mod model;
mod pulp;
mod specimen;
mod study;
mod test;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use accuracy::{Accuracy, Knobs, Preset};
pub use bond::Bond;
pub use model::{Level, Model, OnInadmissible, Ring};
pub use pulp::Pulp;
pub use specimen::{SingleFibre, SingleFibreLoad, Specimen};
pub use test::{Direction, Test};

/// A virtual tensile test of paper, or of one of its fibres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PaperTensile {
    /// Version of this spec's format.
    #[schemars(range(min = 1, max = 1))]
    pub version: u32,
    /// Seed of every random stream of the test. A single fibre has none.
    #[serde(default = "one")]
    #[schemars(range(max = 9_007_199_254_740_991_u64))]
    pub seed: u64,
    /// The fibres, sort by sort.
    #[schemars(length(min = 1, max = 20))]
    pub pulp: Vec<Pulp>,
    pub specimen: Specimen,
    /// A single fibre has no bonds and does not use this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bond: Option<Bond>,
    #[serde(default)]
    pub model: Model,
    #[serde(default)]
    pub test: Test,
    #[serde(default)]
    pub accuracy: Accuracy,
    #[serde(default)]
    pub output: Output,
}

/// What is written beside the results.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Steps of the curve from one picture to the next; 0 for no pictures.
    #[schemars(range(max = 1_000_000), extend("x-unit" = "1"))]
    pub snapshot_every_steps: u32,
}

impl Default for Output {
    fn default() -> Self {
        Self {
            snapshot_every_steps: 10,
        }
    }
}

impl PaperTensile {
    /// The pulp of a single fibre: the one named, or else the first.
    pub fn pulp_of(&self, fibre: &SingleFibre) -> Option<&Pulp> {
        match &fibre.pulp {
            Some(name) => self.pulp.iter().find(|pulp| pulp.name == *name),
            None => self.pulp.first(),
        }
    }
}

fn one() -> u64 {
    1
}
