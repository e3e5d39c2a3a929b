//! Who listens to a test under way: the recorder, or nobody but who asks it to stop.
use std::io;

use loadframe_harness::checkpoint::{self, Fingerprint};
use loadframe_harness::{Interrupt, Recorder, RunContext, SimulationError};
use serde::{Deserialize, Serialize};

use super::progress::Progress;
use crate::error::CompositeError;
use crate::motion::Motion;

/// How far a run is, and the spec it belongs to.
#[derive(Serialize, Deserialize)]
pub(super) struct Checkpoint {
    pub(super) spec: Fingerprint,
    pub(super) points: Vec<Vec<f64>>,
    pub(super) progress: Option<Progress>,
}

/// What a test tells while it is under way.
pub(super) trait Watch {
    /// Names of the curve's columns.
    fn columns(&mut self, names: &[&str]) -> io::Result<()>;
    /// A point of the curve.
    fn point(&mut self, values: &[f64]) -> io::Result<()>;
    /// How far it is, from 0 to 1, and whether to go on; `state` is asked for when it is to be kept.
    fn look(&mut self, fraction: f64, state: &mut dyn FnMut() -> Progress) -> Result<(), Halt>;
    /// Ends the test because somebody asked for it.
    fn halt(&mut self, interrupt: Interrupt, state: &mut dyn FnMut() -> Progress) -> Halt;
}

/// Why a test ended before its end.
pub(super) enum Halt {
    Interrupted(Interrupt),
    /// Its grid is too coarse for cracks with their fracture energies.
    TooCoarse(CompositeError),
    Failed(SimulationError),
}

impl From<CompositeError> for Halt {
    fn from(error: CompositeError) -> Self {
        match error {
            CompositeError::CellTooLarge { .. } | CompositeError::FaceInsideCells { .. } => {
                Self::TooCoarse(error)
            }
            error => Self::Failed(error.into()),
        }
    }
}

impl From<io::Error> for Halt {
    fn from(error: io::Error) -> Self {
        Self::Failed(error.into())
    }
}

/// Tells the recorder, and keeps what a checkpoint needs.
pub(super) struct Recorded<'a, 'b> {
    pub(super) context: RunContext<'a>,
    pub(super) recorder: &'b mut dyn Recorder,
    pub(super) fingerprint: Fingerprint,
    pub(super) points: Vec<Vec<f64>>,
    /// Part of the whole work that the test on the finest grid is.
    pub(super) part: f64,
}

impl Recorded<'_, '_> {
    pub(super) fn keep(&mut self, progress: Option<Progress>) -> Result<(), SimulationError> {
        let checkpoint = Checkpoint {
            spec: self.fingerprint,
            points: self.points.clone(),
            progress,
        };
        self.recorder.checkpoint(&checkpoint::pack(&checkpoint)?)?;
        Ok(())
    }
}

impl Watch for Recorded<'_, '_> {
    fn columns(&mut self, names: &[&str]) -> io::Result<()> {
        self.recorder.columns(names)?;
        for point in &self.points {
            self.recorder.point(point)?;
        }
        Ok(())
    }

    fn point(&mut self, values: &[f64]) -> io::Result<()> {
        self.points.push(values.to_vec());
        self.recorder.point(values)
    }

    fn look(&mut self, fraction: f64, state: &mut dyn FnMut() -> Progress) -> Result<(), Halt> {
        self.recorder.progress(self.part * fraction, "test");
        if let Some(interrupt) = self.context.interrupt.interrupt() {
            return Err(self.halt(interrupt, state));
        }
        if self.recorder.checkpoint_due() {
            self.keep(Some(state())).map_err(Halt::Failed)?;
        }
        Ok(())
    }

    fn halt(&mut self, interrupt: Interrupt, state: &mut dyn FnMut() -> Progress) -> Halt {
        match interrupt {
            Interrupt::Suspend => match self.keep(Some(state())) {
                Ok(()) => Halt::Interrupted(interrupt),
                Err(error) => Halt::Failed(error),
            },
            Interrupt::Cancel => Halt::Interrupted(interrupt),
        }
    }
}

/// Listens to nothing but a request to stop.
pub(super) struct Unwatched<'a>(pub(super) RunContext<'a>);

impl Watch for Unwatched<'_> {
    fn columns(&mut self, _names: &[&str]) -> io::Result<()> {
        Ok(())
    }

    fn point(&mut self, _values: &[f64]) -> io::Result<()> {
        Ok(())
    }

    fn look(&mut self, _fraction: f64, state: &mut dyn FnMut() -> Progress) -> Result<(), Halt> {
        match self.0.interrupt.interrupt() {
            Some(interrupt) => Err(self.halt(interrupt, state)),
            None => Ok(()),
        }
    }

    fn halt(&mut self, interrupt: Interrupt, _state: &mut dyn FnMut() -> Progress) -> Halt {
        Halt::Interrupted(interrupt)
    }
}

/// Shares a motion among the run's threads, where there is enough to share.
pub(super) fn share(motion: &mut Motion<'_>, context: RunContext<'_>) -> Result<(), Halt> {
    /// A step of fewer particles takes about as long as to wake a thread for it.
    const LEAST_SHARED: usize = 20_000;
    if motion.displacements_mm().len() / 2 >= LEAST_SHARED {
        let shared = motion.share(context.threads);
        shared.map_err(|error| Halt::Failed(error.into()))?;
    }
    Ok(())
}
