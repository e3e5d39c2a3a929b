//! How a test within a plan speaks: through messages to the thread that has the recorder.
use std::io::{self, BufWriter, Write};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::SyncSender;

use super::gate::Passage;
use crate::{Interrupt, Recorder, SimulationError, Wanted};

/// How a test, or a plan, came to its end.
#[derive(Debug)]
pub enum Conclusion<T> {
    Finished(T),
    Interrupted(Interrupt),
}

/// What a test says. Messages of one test arrive in the order in which it said them.
#[derive(Debug)]
pub(super) enum Message<T> {
    /// It begins; the checkpoint requests so far do not concern it.
    Started {
        run: usize,
        answered: u64,
    },
    /// Columns and points of the job's own curve.
    Columns(Vec<String>),
    Point(Vec<f64>),
    /// A result file.
    File {
        name: String,
        bytes: Vec<u8>,
    },
    Progress {
        run: usize,
        fraction: f64,
    },
    /// A state to go on from, and the request it answers.
    Checkpoint {
        run: usize,
        bytes: Vec<u8>,
        answered: u64,
    },
    /// It ended.
    Ended {
        run: usize,
        result: Box<Result<Conclusion<T>, SimulationError>>,
    },
}

/// What the job's recorder gets of a test.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Share {
    /// Curve and files.
    All,
    /// Files, in a folder of this name.
    Folder(String),
    /// Nothing: what is kept of it is its result.
    Nothing,
}

impl Share {
    /// Name in the job of a file that a test shared like this calls `name`.
    pub fn name(&self, name: &str) -> String {
        match self {
            Self::Folder(folder) => format!("{folder}/{name}"),
            Self::All | Self::Nothing => name.to_owned(),
        }
    }
}

/// Bytes of a file between two looks whether it is still wanted.
const BUFFER_BYTES: usize = 1 << 16;

/// The recorder of one test.
pub(super) struct Relay<'a, T> {
    pub(super) run: usize,
    pub(super) passage: &'a Passage<'a>,
    pub(super) share: Share,
    pub(super) messages: SyncSender<Message<T>>,
    /// Number of checkpoints asked for so far.
    pub(super) requests: &'a AtomicU64,
    /// The last of them that was answered.
    pub(super) answered: u64,
}

impl<T> Relay<'_, T> {
    fn send(&self, message: Message<T>) -> io::Result<()> {
        // nobody listens any more when the recorder failed, which is told there
        let deaf = |_| io::Error::from(io::ErrorKind::BrokenPipe);
        self.messages.send(message).map_err(deaf)
    }
}

impl<T> Recorder for Relay<'_, T> {
    fn columns(&mut self, names: &[&str]) -> io::Result<()> {
        if self.share != Share::All {
            return Ok(());
        }
        let names = names.iter().map(|name| (*name).to_owned());
        self.send(Message::Columns(names.collect()))
    }

    fn point(&mut self, values: &[f64]) -> io::Result<()> {
        if self.share != Share::All {
            return Ok(());
        }
        self.send(Message::Point(values.to_vec()))
    }

    fn file(
        &mut self,
        name: &str,
        write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        if self.share == Share::Nothing {
            return Ok(());
        }
        let wanted = Wanted::new(Vec::new(), self.passage);
        let mut out = BufWriter::with_capacity(BUFFER_BYTES, wanted);
        write(&mut out)?;
        let bytes = out.into_inner().map_err(io::IntoInnerError::into_error)?;
        let bytes = bytes.into_inner();
        let name = self.share.name(name);
        self.send(Message::File { name, bytes })
    }

    fn progress(&mut self, fraction: f64, _phase: &str) {
        let run = self.run;
        // the next word that may fail tells that nobody listens
        let _ = self.send(Message::Progress { run, fraction });
    }

    /// Nothing: lines of tests side by side would be in another order in every run.
    fn log(&mut self, _message: &str) {}

    fn checkpoint_due(&self) -> bool {
        self.requests.load(Ordering::Relaxed) > self.answered
    }

    fn checkpoint(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.answered = self.requests.load(Ordering::Relaxed);
        self.send(Message::Checkpoint {
            run: self.run,
            bytes: bytes.to_vec(),
            answered: self.answered,
        })
    }
}
