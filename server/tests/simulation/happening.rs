//! What may happen in a world, and to whom.
use crate::server::{Answer, Request};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Party {
    Worker(usize),
    Person(usize),
}

/// A process of a party, and which of its two lines to the server: one for heartbeats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Line {
    pub(crate) party: Party,
    pub(crate) process: u64,
    pub(crate) is_heartbeat: bool,
}

pub(crate) enum Happening {
    /// A message reaches the server.
    Arrives(Line, u64, Request),
    /// An answer reaches who asked.
    Answered(Line, u64, Answer),
    /// Somebody acts.
    Acts(Line),
    /// The answer has not come.
    Waited(Line, u64),
    Sweep,
    Follow,
    /// The server is killed: at once, or when it has done what it is asked next.
    Kill {
        after_next: bool,
    },
    Start,
    /// The server does nothing for so long [ms].
    Freeze(i64),
    /// Its clock is set by so much [ms].
    Leap(i64),
    /// Nothing reaches a worker or leaves it for so long [ms].
    Cut(usize, i64),
    /// A worker does nothing for so long [ms].
    FreezeWorker(usize, i64),
    KillWorker(usize),
    /// Bad times are over.
    Mend,
}

/// What somebody has asked and waits for.
pub(crate) struct Call {
    pub(crate) number: u64,
    pub(crate) request: Request,
}
