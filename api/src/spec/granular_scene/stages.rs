//! What is done to the bodies, one stage after the other.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A stage, with its own end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// Lets the bodies move.
    Run(Run),
    /// The same, while a plane moves along its axis.
    MovePlane(MovePlane),
}

/// How long bodies move: `steps` or `time_s`, exactly one of the two.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Run {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 1_000_000_000_000_u64))]
    pub steps: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-15, max = 1e9), extend("x-unit" = "s"))]
    pub time_s: Option<f64>,
}

/// A plane's motion: for `steps` or for `time_s`, exactly one of the two.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MovePlane {
    /// Name of the plane.
    pub name: String,
    /// Along the plane's axis.
    #[schemars(range(min = -1e6, max = 1e6), extend("x-unit" = "m/s"))]
    pub velocity_m_per_s: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 1_000_000_000_000_u64))]
    pub steps: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-15, max = 1e9), extend("x-unit" = "s"))]
    pub time_s: Option<f64>,
}

impl Stage {
    /// Steps or time [s] of the stage.
    pub fn duration(&self) -> Run {
        match self {
            Self::Run(run) => *run,
            Self::MovePlane(stage) => Run {
                steps: stage.steps,
                time_s: stage.time_s,
            },
        }
    }

    /// Its name on the wire.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Run(_) => "run",
            Self::MovePlane(_) => "move_plane",
        }
    }
}
