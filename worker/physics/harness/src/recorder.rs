//! The way out of a simulation: curve points, files, progress, checkpoints.
//!
//! Physics has no clock, no path and no network; whoever runs it brings a [`Recorder`] that has.
use std::fmt;
use std::io::{self, Write};

/// Receives what a simulation has to say, in the order it happens.
pub trait Recorder {
    /// Names of the curve's columns, units included; called once, before the first point. After a
    /// resume it is called again, followed by all points up to the checkpoint, so that a recorder
    /// always ends with the whole curve.
    fn columns(&mut self, names: &[&str]) -> io::Result<()>;

    /// One point of the curve, in the order of the columns.
    fn point(&mut self, values: &[f64]) -> io::Result<()>;

    /// Writes (or writes again, after a resume) the result file `name`, a relative path with `/`. Whoever
    /// prepares much before it writes flushes meanwhile, so that a run that is given up ends soon.
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

    /// Looks whether nothing of what is being done is wanted any more.
    fn is_cancelled(&self) -> bool {
        self.interrupt() == Some(Interrupt::Cancel)
    }

    /// Looks, and ends what is being done if it is to end.
    ///
    /// # Errors
    /// The interrupt found.
    fn heed(&self) -> Result<(), Interrupt> {
        self.interrupt().map_or(Ok(()), Err)
    }
}

/// A way to somewhere that is left once nothing of the run is wanted any more: whatever is written takes no
/// longer to give up than a buffer takes to fill. It looks with every call, and so belongs behind a buffer.
#[derive(Clone, Copy)]
pub struct Wanted<'a, W> {
    out: W,
    interrupt: &'a dyn InterruptSource,
}

impl<'a, W> Wanted<'a, W> {
    pub fn new(out: W, interrupt: &'a dyn InterruptSource) -> Self {
        Self { out, interrupt }
    }

    /// Where it led.
    pub fn into_inner(self) -> W {
        self.out
    }

    fn look(&self) -> io::Result<()> {
        // a run that is to leave a checkpoint finishes the file it is at
        match self.interrupt.is_cancelled() {
            false => Ok(()),
            true => Err(io::Error::other("it is not wanted any more")),
        }
    }
}

impl<W: Write> Write for Wanted<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.look()?;
        self.out.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.look()?;
        self.out.flush()
    }
}

impl<W: fmt::Debug> fmt::Debug for Wanted<'_, W> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_struct("Wanted")
            .field("out", &self.out)
            .finish_non_exhaustive()
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicBool, Ordering};

    /// Says one thing once it is set.
    struct Asked(AtomicBool, Interrupt);

    impl InterruptSource for Asked {
        fn interrupt(&self) -> Option<Interrupt> {
            self.0.load(Ordering::Relaxed).then_some(self.1)
        }
    }

    #[test]
    fn what_nobody_wants_is_not_written_on_and_what_is_to_go_on_later_is() {
        let cancel = Asked(AtomicBool::new(false), Interrupt::Cancel);
        let mut out = Wanted::new(Vec::new(), &cancel);
        out.write_all(b"ab").expect("wanted");
        cancel.0.store(true, Ordering::Relaxed);
        assert!(out.write_all(b"cd").is_err() && out.flush().is_err());
        assert_eq!(out.into_inner(), b"ab");
        let suspend = Asked(AtomicBool::new(true), Interrupt::Suspend);
        let mut out = Wanted::new(Vec::new(), &suspend);
        out.write_all(b"ab").expect("wanted later");
        assert_eq!(
            (out.into_inner(), suspend.heed()),
            (b"ab".to_vec(), Err(Interrupt::Suspend))
        );
    }
}
