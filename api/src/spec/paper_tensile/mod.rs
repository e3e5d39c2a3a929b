//! Spec of a paper tensile test: pulps whose fibres are hollow tubes, alone or in a sheet.
//!
//! A single fibre is the mass-spring tube of [LiuShen2025]: springs along, around, across and along the
//! diagonals of a ring of points, their stiffness from E, ν and G in closed form. In a sheet fibres are
//! beams, bars or such tubes, bonded where they touch. Lengths are in mm and
//! µm, moduli in GPa, strengths in MPa; x is the pulling direction.
//!
//! The parts, each in its own file: what the fibres are ([`Pulp`],
//! [`MeasuredFibres`]), what is tested ([`Specimen`], of it
//! the [`ExplicitSheet`] and the [`MadeSheet`]), how fibres hold one another ([`Bond`]), how they are modelled ([`Model`]), what is done ([`Test`]), and
//! how exactly ([`Accuracy`]).
mod accuracy;
mod bond;
mod checks;
pub mod equilibrium;
mod estimate;
mod expected;
mod job_kind;
mod measured;
mod model;
mod pulp;
mod results;
mod sheet;
mod sheet_checks;
mod specimen;
mod study;
mod test;
mod tube_checks;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use accuracy::{Accuracy, BondsAt, Knobs};
pub use bond::Bond;
pub use measured::FibreSizes;
pub use model::{Level, Model, OnInadmissible, Ring};
pub use pulp::{MeasuredFibres, Pulp, Yielding};
pub use sheet::{
    AngleHistogram, Deposition, ExplicitBond, ExplicitFibre, ExplicitSheet, MadeSheet, Orientation,
    Placement, RandomPlacement, VonMises,
};
pub use specimen::{SingleFibre, SingleFibreLoad, Specimen};
pub use test::{Direction, Dynamics, Test, TestType};

/// A virtual tensile test of paper, or of one of its fibres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PaperTensile {
    /// Version of this spec's format.
    #[schemars(range(min = 1, max = 1))]
    pub version: u32,
    /// Seed of every random stream of the test; repeats count on from it. A single fibre has none.
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

/// Columns of the curve of a sheet.
pub const SHEET_CURVE: [&str; 7] = [
    "nominal_strain",
    "force_n",
    "force_bottom_jaw_n",
    "broken_bonds",
    "residual_ratio",
    "broken_segments",
    "stored_energy_n_mm",
];

impl SingleFibreLoad {
    /// Columns of the curve of a fibre; tension, and moments that act with the turn, are positive.
    pub fn curve_columns(self) -> &'static [&'static str] {
        match self {
            // as far as a sheet's go
            Self::Pull | Self::Buckle => &SHEET_CURVE[..5],
            Self::Twist => &["twist_rad_per_mm", "torque_n_mm", "residual_ratio"],
            Self::Bend => &["curvature_per_mm", "moment_n_mm", "residual_ratio"],
        }
    }
}

/// What is written beside the results.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Steps of the curve of a single fibre from one picture to the next; 0 for no pictures. Of a sheet
    /// there are pictures at the start, at the largest force and at the end.
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
            Some(name) => self.pulp_named(name),
            None => self.pulp.first(),
        }
    }

    /// The pulp of a name.
    pub fn pulp_named(&self, name: &str) -> Option<&Pulp> {
        self.pulp.iter().find(|pulp| pulp.name == name)
    }

    /// Whether fibres of the sheet yield.
    pub fn yields(&self) -> bool {
        self.pulp.iter().any(|pulp| pulp.yielding.is_some())
    }

    /// Width of the narrowest fibre [µm].
    pub fn narrowest_um(&self) -> f64 {
        let widths = self.pulp.iter().map(|pulp| pulp.widths_um()[0]);
        widths.fold(f64::INFINITY, f64::min)
    }

    /// Length of the straight parts of fibres of a sheet that is made [µm]: as asked, else by the
    /// accuracy and the width of the narrowest. Of tubes what is asked is the length of their segments, whose rings
    /// follow the straight parts.
    pub fn sheet_segment_um(&self) -> f64 {
        let by_accuracy = self.accuracy.knobs().segment_widths * self.narrowest_um();
        let asked = self
            .model
            .segment_um
            .filter(|_| self.level() != Level::Tube);
        asked.unwrap_or(by_accuracy)
    }

    /// How fibres are modelled: as asked, else a single fibre as a tube and those of sheets as beams.
    pub fn level(&self) -> Level {
        self.model
            .level
            .unwrap_or(if self.specimen.is_single_fibre() {
                Level::Tube
            } else {
                Level::Beam
            })
    }

    /// Specimens that are tested, each in every direction.
    pub fn specimens(&self) -> u32 {
        self.test.repeats.unwrap_or(1)
    }
}

fn one() -> u64 {
    1
}
