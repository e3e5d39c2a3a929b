//! How a test within a plan speaks: through messages to the thread that has the recorder.
use std::io::{self, Write};
use std::sync::atomic::{AtomicU8, AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc::SyncSender;

use crate::{Ending, Interrupt, InterruptSource, Recorder, SimulationError};

/// Nominal strain and force [N] of every step.
pub(super) type Curve = Vec<[f64; 2]>;

/// What a test says. Messages of one test arrive in the order in which it said them.
#[derive(Debug)]
pub(super) enum Message {
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
    /// It ended, after this curve.
    Ended {
        run: usize,
        result: Box<Result<Ending, SimulationError>>,
        curve: Curve,
    },
}

/// What the job's recorder gets of a test.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Share {
    /// Curve and files.
    All,
    /// Files, in a folder of this name.
    Folder(String),
    /// Nothing: only nominal strain and force are kept.
    Nothing,
}

impl Share {
    /// Name in the job of a file that a test shared like this calls `name`.
    pub(super) fn name(&self, name: &str) -> String {
        match self {
            Self::Folder(folder) => format!("{folder}/{name}"),
            Self::All | Self::Nothing => name.to_owned(),
        }
    }
}

/// The recorder of one test.
#[derive(Debug)]
pub(super) struct Relay<'a> {
    pub(super) run: usize,
    pub(super) share: Share,
    pub(super) curve: Curve,
    pub(super) messages: SyncSender<Message>,
    /// Number of checkpoints asked for so far.
    pub(super) requests: &'a AtomicU64,
    /// The last of them that was answered.
    pub(super) answered: u64,
}

impl Relay<'_> {
    fn send(&self, message: Message) -> io::Result<()> {
        // nobody listens any more when the recorder failed, which is told there
        let deaf = |_| io::Error::from(io::ErrorKind::BrokenPipe);
        self.messages.send(message).map_err(deaf)
    }
}

impl Recorder for Relay<'_> {
    fn columns(&mut self, names: &[&str]) -> io::Result<()> {
        self.curve.clear();
        if self.share != Share::All {
            return Ok(());
        }
        let names = names.iter().map(|name| (*name).to_owned());
        self.send(Message::Columns(names.collect()))
    }

    fn point(&mut self, values: &[f64]) -> io::Result<()> {
        // strain and force lead every curve
        if let [strain, force, ..] = values {
            self.curve.push([*strain, *force]);
        }
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
        let mut bytes = Vec::new();
        write(&mut bytes)?;
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

/// What may stop tests side by side: an interrupt that one of them saw stops all, a failure stops
/// those behind it.
pub(super) struct Gate<'a> {
    source: &'a dyn InterruptSource,
    /// The highest interrupt seen: 0 for none, 1 for suspend, 2 for cancel.
    seen: AtomicU8,
    /// The first test in the plan's order that failed so far.
    failed: AtomicUsize,
}

impl<'a> Gate<'a> {
    pub(super) fn new(source: &'a dyn InterruptSource) -> Self {
        Self {
            source,
            seen: AtomicU8::new(0),
            failed: AtomicUsize::new(usize::MAX),
        }
    }

    /// Stops every test.
    pub(super) fn stop(&self, interrupt: Interrupt) {
        let rank = match interrupt {
            Interrupt::Suspend => 1,
            Interrupt::Cancel => 2,
        };
        self.seen.fetch_max(rank, Ordering::Relaxed);
    }

    /// Stops the tests behind `run`. Those before it go on: one of them may fail as well, and the
    /// error told is that of the first in the plan on any number of threads.
    pub(super) fn fail(&self, run: usize) {
        self.failed.fetch_min(run, Ordering::Relaxed);
    }

    /// What was seen so far.
    pub(super) fn seen(&self) -> Option<Interrupt> {
        match self.seen.load(Ordering::Relaxed) {
            0 => None,
            1 => Some(Interrupt::Suspend),
            _ => Some(Interrupt::Cancel),
        }
    }

    /// Whether test `run` need not begin.
    pub(super) fn is_closed(&self, run: usize) -> bool {
        self.seen().is_some() || self.failed.load(Ordering::Relaxed) < run
    }
}

/// The gate as test `run` sees it.
pub(super) struct Passage<'a> {
    pub(super) gate: &'a Gate<'a>,
    pub(super) run: usize,
}

impl InterruptSource for Passage<'_> {
    fn interrupt(&self) -> Option<Interrupt> {
        if let Some(interrupt) = self.gate.source.interrupt() {
            self.gate.stop(interrupt);
        }
        if self.gate.failed.load(Ordering::Relaxed) < self.run {
            return Some(Interrupt::Cancel);
        }
        self.gate.seen()
    }
}
