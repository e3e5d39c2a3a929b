//! What a run is given beside its job.
use std::path::Path;
use std::time::Duration;

use super::engine::Engine;
use super::stop::StopSwitch;

/// How a run is to be carried out.
#[derive(Clone, Copy, Debug)]
pub struct Plan<'a> {
    /// What computes.
    pub engine: Engine,
    /// Where result files are written.
    pub folder: &'a Path,
    pub threads: usize,
    /// Time between checkpoints.
    pub checkpoint_every: Duration,
    pub switch: &'a StopSwitch,
}
