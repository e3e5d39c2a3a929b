//! How far a test is: what a checkpoint keeps of it.
use serde::{Deserialize, Serialize};

use super::errors::Finding;
use super::swing::Swing;
use super::tested::{Look, Tested};
use crate::breaking::{BreakingState, Event};
use crate::motion::MotionState;
use crate::solve::{PathState, RollingState};

/// How far the test on the finest grid is.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) enum Progress {
    Rest(RestState),
    Rollers(RollersState),
    History(HistoryState),
    Cracks(Box<CracksState>),
    /// The test is over, and of its comparisons those that are known.
    Done(Box<(Tested, Finding)>),
}

/// How far the way to rest is.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) enum RestState {
    Path(PathState),
    Motion(MotionState),
}

/// How far bending is.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct RollersState {
    /// Steps done.
    pub(super) done: u32,
    /// Where the rollers are, in large displacements.
    pub(super) rolling: Option<RollingState>,
    /// Part of the drive at the first rest that was not stable.
    pub(super) unstable: Option<f64>,
}

/// How far the motion is.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct HistoryState {
    pub(super) motion: MotionState,
    pub(super) swing: Swing,
    pub(super) written: u32,
}

/// How far breaking is.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct CracksState {
    pub(super) state: BreakingState,
    pub(super) events: Vec<Event>,
    pub(super) peak: Option<Look>,
}
