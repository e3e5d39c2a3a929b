//! The way out of a simulation: curve points, files, progress, checkpoints.
//!
//! Physics has no clock, no path and no network; whoever runs it brings a [`Recorder`] that has.
use std::io::{self, Write};

/// Receives what a simulation has to say, in the order it happens.
pub trait Recorder {
    /// Names of the curve's columns, units included; called once, before the first point. After a
    /// resume it is called again, followed by all points up to the checkpoint, so that a recorder
    /// always ends with the whole curve.
    fn columns(&mut self, names: &[&str]) -> io::Result<()>;

    /// One point of the curve, in the order of the columns.
    fn point(&mut self, values: &[f64]) -> io::Result<()>;

    /// Writes (or writes again, after a resume) the result file `name`, a relative path with `/`.
    fn file(
        &mut self,
        name: &str,
        write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()>;

    /// How far the run is: `fraction` of the work from 0 to 1, and what it is doing.
    fn progress(&mut self, fraction: f64, phase: &str);

    /// A line for the job's log.
    fn log(&mut self, message: &str);

    /// True when enough time has passed since the last checkpoint. Asked between steps.
    fn checkpoint_due(&self) -> bool;

    /// Keeps a state from which [`crate::simulate`] can go on. Files written before must be kept
    /// with it: the resumed run does not write them again.
    fn checkpoint(&mut self, bytes: &[u8]) -> io::Result<()>;
}

/// A recorder around another: what it does not take for itself goes on to that one. Around [`Unrecorded`] it
/// keeps what it takes and nothing else.
pub trait Decorator {
    /// The other.
    fn inner(&self) -> &dyn Recorder;

    /// The other.
    fn inner_mut(&mut self) -> &mut dyn Recorder;

    /// [`Recorder::columns`].
    fn columns(&mut self, names: &[&str]) -> io::Result<()> {
        self.inner_mut().columns(names)
    }

    /// [`Recorder::point`].
    fn point(&mut self, values: &[f64]) -> io::Result<()> {
        self.inner_mut().point(values)
    }

    /// [`Recorder::file`].
    fn file(
        &mut self,
        name: &str,
        write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        self.inner_mut().file(name, write)
    }

    /// [`Recorder::progress`].
    fn progress(&mut self, fraction: f64, phase: &str) {
        self.inner_mut().progress(fraction, phase);
    }

    /// [`Recorder::log`].
    fn log(&mut self, message: &str) {
        self.inner_mut().log(message);
    }

    /// [`Recorder::checkpoint_due`].
    fn checkpoint_due(&self) -> bool {
        self.inner().checkpoint_due()
    }

    /// [`Recorder::checkpoint`].
    fn checkpoint(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.inner_mut().checkpoint(bytes)
    }
}

impl<D: Decorator> Recorder for D {
    fn columns(&mut self, names: &[&str]) -> io::Result<()> {
        Decorator::columns(self, names)
    }

    fn point(&mut self, values: &[f64]) -> io::Result<()> {
        Decorator::point(self, values)
    }

    fn file(
        &mut self,
        name: &str,
        write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        Decorator::file(self, name, write)
    }

    fn progress(&mut self, fraction: f64, phase: &str) {
        Decorator::progress(self, fraction, phase);
    }

    fn log(&mut self, message: &str) {
        Decorator::log(self, message);
    }

    fn checkpoint_due(&self) -> bool {
        Decorator::checkpoint_due(self)
    }

    fn checkpoint(&mut self, bytes: &[u8]) -> io::Result<()> {
        Decorator::checkpoint(self, bytes)
    }
}

/// A request to stop early, seen by the solver within a fraction of a second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interrupt {
    /// Give up; nothing of the run is wanted.
    Cancel,
    /// Leave a checkpoint and stop.
    Suspend,
}

/// Where a running simulation looks for an [`Interrupt`].
pub trait InterruptSource: Sync {
    fn interrupt(&self) -> Option<Interrupt>;
}

/// Never interrupts.
#[derive(Clone, Copy, Debug, Default)]
pub struct Uninterrupted;

impl InterruptSource for Uninterrupted {
    fn interrupt(&self) -> Option<Interrupt> {
        None
    }
}

/// Keeps nothing, for runs of which only the report is wanted.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unrecorded;

impl Recorder for Unrecorded {
    fn columns(&mut self, _names: &[&str]) -> io::Result<()> {
        Ok(())
    }

    fn point(&mut self, _values: &[f64]) -> io::Result<()> {
        Ok(())
    }

    fn file(
        &mut self,
        _name: &str,
        write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        write(&mut io::sink())
    }

    fn progress(&mut self, _fraction: f64, _phase: &str) {}

    fn log(&mut self, _message: &str) {}

    fn checkpoint_due(&self) -> bool {
        false
    }

    fn checkpoint(&mut self, _bytes: &[u8]) -> io::Result<()> {
        Ok(())
    }
}
