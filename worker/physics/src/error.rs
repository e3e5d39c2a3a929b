//! Why a simulation has no result.
use std::io;

use crate::checkpoint::CheckpointError;

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
    /// The checkpoint cannot be resumed from.
    #[error("the checkpoint cannot be used")]
    Checkpoint(#[from] CheckpointError),
    /// The recorder could not keep what it was given.
    #[error("a result could not be written")]
    Recorder(#[from] io::Error),
    /// The threads asked for could not be started.
    #[error("{threads} threads could not be started: {reason}")]
    Threads { threads: usize, reason: String },
}
