//! What is done to the bodies, one stage after the other.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    Cut, GranularScene, Insert, Place, Relax, Replace, Stiffen, Vibrate,
    drive::{Drive, swing},
};

/// A stage, with its own end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// Lets the bodies move.
    Run(Run),
    /// The same, while a plane moves along its axis.
    MovePlane(MovePlane),
    /// The same, while a force pushes a plane that has a mass and is free along its axis: a plate.
    LoadPlane(LoadPlane),
    /// The same, while any walls and bodies are moved or pushed.
    Drive(Drive),
    /// Lets the bodies move until they are at rest.
    Settle(Settle),
    /// Takes bodies apart that sit in each other.
    Relax(Relax),
    /// Lets the bodies move while they are shaken, with less friction if asked for.
    Vibrate(Vibrate),
    /// Puts bodies in while the others move.
    Insert(Box<Insert>),
    /// Takes bodies out.
    Cut(Cut),
    /// Sets a wall down where it touches the bodies.
    Place(Place),
    /// Puts clumps in the places of spheres.
    Replace(Box<Replace>),
    /// Makes every material stiffer or softer while the bodies move.
    Stiffen(Stiffen),
}

/// A plane under a force, for `steps` or for `time_s`, exactly one of the two. It starts at rest and
/// stays where the stage leaves it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LoadPlane {
    /// Name of the plane.
    pub name: String,
    /// Mass of the plate; it has no weight.
    #[schemars(range(min = 1e-12, max = 1e12), extend("x-unit" = "kg"))]
    pub mass_kg: f64,
    /// Force along the plane's axis, at the start of the stage.
    #[schemars(range(min = -1e15, max = 1e15), extend("x-unit" = "N"))]
    pub force_n: f64,
    /// Left out, the force is constant. Otherwise it swings between `force_n` and this,
    /// F = F₀ + (F₁ − F₀)(1 − cos 2πt/T)/2.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -1e15, max = 1e15), extend("x-unit" = "N"))]
    pub peak_force_n: Option<f64>,
    /// T of the swing; needed with `peak_force_n`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-15, max = 1e9), extend("x-unit" = "s"))]
    pub period_s: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 1_000_000_000_000_u64))]
    pub steps: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-15, max = 1e9), extend("x-unit" = "s"))]
    pub time_s: Option<f64>,
}

/// An end by rest, or after `steps` or `time_s` at the latest, exactly one of the two.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Settle {
    /// At rest: the mean resultant force on a body over the mean contact force is below this, and for every
    /// plate the resultant, and the force that would stop it, over its load.
    #[serde(default = "unbalanced")]
    #[schemars(range(min = 1e-12, max = 1.0), extend("x-unit" = "1"))]
    pub unbalanced_force_ratio: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 1_000_000_000_000_u64))]
    pub steps: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-15, max = 1e9), extend("x-unit" = "s"))]
    pub time_s: Option<f64>,
}

/// A bed at this ratio does not visibly move any more.
fn unbalanced() -> f64 {
    0.01
}

impl LoadPlane {
    /// Force at `time` [s] of the stage [N].
    pub fn force_at(&self, time: f64) -> f64 {
        swing(self.force_n, self.peak_force_n, self.period_s, time)
    }
}

/// How long bodies move: `steps` or `time_s`, exactly one of the two. A stage ends at its time: the last
/// step is as short as that needs.
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
            Self::LoadPlane(stage) => Run {
                steps: stage.steps,
                time_s: stage.time_s,
            },
            Self::Drive(stage) => Run {
                steps: stage.steps,
                time_s: stage.time_s,
            },
            Self::Settle(stage) => Run {
                steps: stage.steps,
                time_s: stage.time_s,
            },
            Self::Relax(stage) => Run {
                steps: Some(stage.steps),
                time_s: None,
            },
            Self::Vibrate(stage) => Run {
                steps: stage.steps,
                time_s: stage.time_s,
            },
            Self::MovePlane(stage) => Run {
                steps: stage.steps,
                time_s: stage.time_s,
            },
            Self::Insert(stage) => Run {
                steps: stage.steps,
                time_s: stage.time_s,
            },
            Self::Stiffen(stage) => Run {
                steps: Some(stage.steps),
                time_s: None,
            },
            Self::Cut(_) | Self::Place(_) | Self::Replace(_) => Run {
                steps: None,
                time_s: None,
            },
        }
    }

    /// Whether bodies are made to move, other than by gravity.
    pub fn is_driven(&self) -> bool {
        match self {
            Self::MovePlane(_) | Self::LoadPlane(_) | Self::Drive(_) => true,
            Self::Run(_)
            | Self::Settle(_)
            | Self::Relax(_)
            | Self::Vibrate(_)
            | Self::Insert(_)
            | Self::Cut(_)
            | Self::Place(_)
            | Self::Replace(_)
            | Self::Stiffen(_) => false,
        }
    }

    /// Whether it is done between two steps.
    pub fn is_instant(&self) -> bool {
        matches!(self, Self::Cut(_) | Self::Place(_) | Self::Replace(_))
    }

    /// Whether it is meant to be so slow that bodies are close to rest all the time.
    pub fn is_quasi_static(&self) -> bool {
        match self {
            Self::Drive(drive) => !drive.flow,
            _ => self.is_driven(),
        }
    }

    /// Its name on the wire.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Run(_) => "run",
            Self::MovePlane(_) => "move_plane",
            Self::LoadPlane(_) => "load_plane",
            Self::Drive(_) => "drive",
            Self::Settle(_) => "settle",
            Self::Relax(_) => "relax",
            Self::Vibrate(_) => "vibrate",
            Self::Insert(_) => "insert",
            Self::Cut(_) => "cut",
            Self::Place(_) => "place",
            Self::Replace(_) => "replace",
            Self::Stiffen(_) => "stiffen",
        }
    }
}

impl GranularScene {
    /// Bodies that some stage sets down.
    pub(super) fn placed_bodies(&self) -> impl Iterator<Item = u32> {
        self.stages.iter().filter_map(|stage| match stage {
            Stage::Place(place) => place.body,
            _ => None,
        })
    }
}
