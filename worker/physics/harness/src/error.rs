//! Why a simulation has no result.
use std::{fmt, io};

use loadframe_api::section::error::CompositeError;
use loadframe_numerics::ThreadsError;

use crate::checkpoint::CheckpointError;
use crate::recorder::Interrupt;

/// Why a test did not come to its end.
#[derive(Debug)]
pub enum Halt {
    Interrupted(Interrupt),
    Failed(SimulationError),
}

impl From<Interrupt> for Halt {
    fn from(interrupt: Interrupt) -> Self {
        Self::Interrupted(interrupt)
    }
}

impl<E: Into<SimulationError>> From<E> for Halt {
    fn from(error: E) -> Self {
        Self::Failed(error.into())
    }
}

/// What made a result impossible. Wrong input is caught before, by the spec's own validation; what
/// is left are states no honest result can come from.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// The spec leaves open something the model needs.
    #[error("the spec cannot be built: {0}")]
    Unbuildable(String),
    /// A number left the range of finite numbers.
    #[error("{quantity} of node {node} is not finite in strain step {step}")]
    NonFinite {
        node: usize,
        step: u64,
        quantity: &'static str,
    },
    /// A body left the range of finite numbers.
    #[error("{quantity} of body {body} is not finite after step {step}")]
    BodyNotFinite {
        body: usize,
        step: u64,
        quantity: &'static str,
    },
    /// A given time step is beyond the critical one.
    #[error(
        "after step {step} the time step {given_s:e} s is beyond the critical step {critical_s:e} s \
         that the contacts of {body}, the stiffest with {partner}, allow as they are pressed now: \
         choose a smaller one, {better:e} s or \"auto\"", better = 0.2 * critical_s
    )]
    Unstable {
        given_s: f64,
        critical_s: f64,
        step: u64,
        body: String,
        partner: String,
    },
    /// A body would jump over what it should touch.
    #[error(
        "body {body} moves {speed_m_per_s:e} m/s after step {step}, more than a tenth of its radius \
         in a time step: choose a time step of at most {largest_step_s:e} s or \"auto\""
    )]
    TooFast {
        body: usize,
        step: u64,
        speed_m_per_s: f64,
        largest_step_s: f64,
    },
    /// A wall would jump over what it should touch.
    #[error(
        "wall {wall:?} moves more than a tenth of the smallest radius in the time step after step \
         {step}: choose a time step of at most {largest_step_s:e} s or \"auto\""
    )]
    WallTooFast {
        wall: String,
        step: u64,
        largest_step_s: f64,
    },
    /// A plane is too soft for what presses on it.
    #[error(
        "body {body} was pushed through plane {plane:?} in step {step}: the load is more than the \
         plane can carry; choose a smaller load or a higher Young's modulus"
    )]
    PushedThrough { body: u32, plane: String, step: u64 },
    /// The integration makes energy.
    #[error(
        "energy grows by itself, {created_j:e} J until step {step} at {step_ratio} of the critical \
         time step: choose a smaller time step"
    )]
    EnergyGrowth {
        step: u64,
        created_j: f64,
        step_ratio: f64,
    },
    /// A section of a composite has no result.
    #[error(transparent)]
    Section(#[from] CompositeError),
    /// A specimen of paper has no result.
    #[error("the specimen of paper has no result: {0}")]
    Paper(String),
    /// A calibration has nothing to go by.
    #[error("the calibration cannot be carried out: {0}")]
    Calibration(String),
    /// The checkpoint cannot be resumed from.
    #[error("the checkpoint cannot be used")]
    Checkpoint(#[from] CheckpointError),
    /// The recorder could not keep what it was given.
    #[error("a result could not be written")]
    Recorder(#[from] io::Error),
    /// The threads asked for could not be started.
    #[error(transparent)]
    Threads(#[from] ThreadsError),
}

impl SimulationError {
    /// Of a specimen of paper.
    pub fn of_paper(error: impl fmt::Display) -> Self {
        Self::Paper(error.to_string())
    }

    /// Whether it follows from the spec, so that it would come again anywhere.
    pub fn is_of_the_spec(&self) -> bool {
        !matches!(
            self,
            Self::Checkpoint(_) | Self::Recorder(_) | Self::Threads(_)
        )
    }
}
