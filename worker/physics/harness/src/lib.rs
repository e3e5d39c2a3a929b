//! What every simulation is run in: the ways in and out that do not know any mechanics.
//!
//! A [`Run`] is given a [`RunContext`] and a [`Recorder`]. It tells the recorder points of its curve,
//! files (through [`csv`] and [`vtk`]), progress and checkpoints ([`checkpoint`]), and ends with an
//! [`Ending`], whose report a [`ReportBuilder`] makes, or a [`SimulationError`]. [`plan`] carries out a job of several tests side by side and
//! joins their reports; [`statistics`] is about what differs between them. [`rng`] gives the named
//! random streams of a seed, [`curve`] reads values off a curve, an [`ErrorTable`] says how wrong results may
//! be for how they were computed.
pub mod checkpoint;
pub mod csv;
pub mod curve;
mod error;
mod error_table;
pub mod plan;
mod recorder;
mod report;
pub mod rng;
pub mod statistics;
pub mod vtk;

use std::fmt;

use loadframe_api::Report;

pub use checkpoint::CheckpointError;
pub use error::{Halt, SimulationError};
pub use error_table::{ErrorTable, Likeness};
pub use recorder::{
    Decorator, Interrupt, InterruptSource, Recorder, Uninterrupted, Unrecorded, Wanted,
};
pub use report::ReportBuilder;
pub use statistics::{Sample, Welch};

/// How a simulation ended.
#[derive(Debug)]
#[allow(clippy::large_enum_variant, reason = "there is one per run")]
pub enum Ending {
    /// It ran to its own end; all files are with the recorder.
    Finished(Report),
    /// It was asked to give up.
    Cancelled,
    /// It was asked to stop, and its checkpoint is with the recorder, if it had done anything yet.
    Suspended,
}

impl From<Interrupt> for Ending {
    fn from(interrupt: Interrupt) -> Self {
        match interrupt {
            Interrupt::Cancel => Self::Cancelled,
            Interrupt::Suspend => Self::Suspended,
        }
    }
}

/// How a job is run of whose spec only the kind's engine knows anything.
pub type Run<S> = fn(&S, RunContext<'_>, &mut dyn Recorder) -> Result<Ending, SimulationError>;

/// How its specimen is drawn before the test: pictures to the recorder, and what they show is returned, in a
/// sentence or two. Of several specimens it is the first. There is nothing to go on from.
pub type Preview<S> = fn(&S, RunContext<'_>, &mut dyn Recorder) -> Result<String, Halt>;

/// What a run is given beside its spec.
#[derive(Clone, Copy)]
pub struct RunContext<'a> {
    /// Threads to use; the result does not depend on it.
    pub threads: usize,
    pub interrupt: &'a dyn InterruptSource,
    /// Bytes an earlier run of the same spec gave to [`Recorder::checkpoint`].
    pub checkpoint: Option<&'a [u8]>,
}

impl fmt::Debug for RunContext<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let checkpoint_bytes = self.checkpoint.map(<[u8]>::len);
        formatter
            .debug_struct("RunContext")
            .field("threads", &self.threads)
            .field("checkpoint_bytes", &checkpoint_bytes)
            .finish_non_exhaustive()
    }
}
