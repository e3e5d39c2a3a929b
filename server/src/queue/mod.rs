//! The life of a job: one diagram, and the one function that decides every step in it.
//!
//! ```text
//!                  ┌──────────── resume ─────────────┐
//!                  ▼                                 │
//!  submit ───▶  queued  ──────── pause ──────────▶ paused ── cancel ─▶ finished (cancelled)
//!               ▲  │  │                              ▲
//!               │  │  └── cancel ─▶ finished (cancelled)
//!               │  │                                 │
//!               │ claim            ┌── the attempt ends, pause was asked
//!               │  ▼               │
//!               │  │               ├── it has taken far more than estimated
//!               │ running ─────────┼── the attempt ends, cancel was asked ─▶ finished (cancelled)
//!               │  │  ↻ cancel, pause, resume: asked, and told to the worker
//!               │  │
//!               │  ├── complete ───────────────────▶ finished (succeeded)
//!               │  ├── fail ───────────────────────▶ finished (failed)
//!               │  ├── time is over ───────────────▶ finished (timed_out)
//!               ├──┼── release (planned stop), or a lease that was never used
//!               ├──┼── fault (of the machine) ── the third machine ─▶ finished (failed)
//!               └──┴── lose (lease ran out) ── third time ─▶ finished (quarantined)
//!
//!  finished, but not succeeded ── retry ─▶ queued
//! ```
//!
//! The function is pure: it knows neither clock nor database. The store brings the state of a job
//! and what happened, and writes down what comes out, inside one transaction.
//!
//! Who works on what next is decided beside it, as purely: [`needs`] tells which machine a job fits,
//! [`turns`] whose job is next.
use loadframe_api::worker::Command;
use loadframe_api::{AttemptEnd, JobOutcome, ReasonCode};

pub mod needs;
#[cfg(test)]
mod tests;
pub mod turns;

/// A job whose workers fell silent this often is set aside: it may be the job that kills them.
pub const LOSSES_UNTIL_QUARANTINE: u32 = 3;

/// A job that so many machines could not carry out is at fault itself.
pub const MACHINES_UNTIL_FAILED: u32 = 3;

/// Where a job is in its life.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    Queued {
        losses: u32,
    },
    Running {
        losses: u32,
        asked: Option<UserRequest>,
    },
    Paused {
        losses: u32,
    },
    /// Never changes again, except by a retry of what has not succeeded.
    Finished(JobOutcome),
}

/// What a user wants of a running attempt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UserRequest {
    Cancel,
    Pause,
}

/// What can happen to a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    Claim,
    Cancel,
    Pause,
    Resume,
    Retry,
    Complete,
    /// The simulation has no result.
    Fail,
    /// A fault of the machine. So many could not carry out the job, this one included.
    Fault {
        machines: u32,
    },
    /// The worker gives the job back, for whatever reason: what becomes of it follows from what
    /// the user asked.
    Release,
    /// The lease ran out.
    Lose,
    /// The lease ran out before its worker was ever heard of: it may never have got it.
    NeverUse,
    /// The job has taken longer than it may.
    ExceedTime,
    /// The job has taken far more than was estimated, and its worker has left a checkpoint.
    ExceedEstimate,
}

/// What a step leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    pub state: State,
    /// `None` leaves the reason as it is.
    pub reason: Option<ReasonCode>,
    /// How the running attempt ended, if it did.
    pub attempt_end: Option<AttemptEnd>,
}

/// A step that is not taken: the job's state does not allow it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    #[error("the job is not running")]
    NotRunning,
    #[error("the job is not waiting in the queue")]
    NotQueued,
    #[error("the job has finished; retry it or submit it again")]
    Finished,
    #[error("the job has succeeded; submit it again to run it again")]
    Succeeded,
    #[error("the job is being cancelled")]
    BeingCancelled,
    #[error("the job is running; cancel it first")]
    StillRunning,
    #[error("the job is paused; resume it")]
    StillPaused,
}

/// Decides what `input` makes of a job in `state`. A step to the same state without a reason means
/// that all is as asked already.
///
/// # Errors
/// [`Refusal`] when the state does not allow the input.
pub fn transition(state: State, input: Input) -> Result<Step, Refusal> {
    use State::{Finished, Paused, Queued, Running};
    match (state, input) {
        (Queued { losses }, Input::Claim) => Ok(Step {
            state: Running {
                losses,
                asked: None,
            },
            // why it was queued stays worth knowing while it runs
            reason: None,
            attempt_end: None,
        }),
        (_, Input::Claim) => Err(Refusal::NotQueued),

        (Queued { .. } | Paused { .. }, Input::Cancel) => Ok(cancelled(None)),
        (Queued { losses }, Input::Pause) => Ok(quiet(Paused { losses }, ReasonCode::PausedByUser)),
        (Queued { .. }, Input::Resume | Input::Retry) => Ok(unchanged(state)),

        (Paused { .. }, Input::Pause) => Ok(unchanged(state)),
        (Paused { losses }, Input::Resume) => {
            Ok(quiet(Queued { losses }, ReasonCode::ResumedByUser))
        }
        (Paused { .. }, Input::Retry) => Err(Refusal::StillPaused),

        (Finished(JobOutcome::Cancelled), Input::Cancel) => Ok(unchanged(state)),
        (Finished(JobOutcome::Succeeded), Input::Retry) => Err(Refusal::Succeeded),
        // a fresh start: the losses before were dealt with
        (Finished(_), Input::Retry) => Ok(quiet(Queued { losses: 0 }, ReasonCode::RetriedByUser)),
        (Finished(_), Input::Cancel | Input::Pause | Input::Resume) => Err(Refusal::Finished),

        (Running { losses, asked }, input) => running(losses, asked, input),
        (Queued { .. } | Paused { .. } | Finished(_), _) => Err(Refusal::NotRunning),
    }
}

/// What `input` makes of a running job.
fn running(losses: u32, asked: Option<UserRequest>, input: Input) -> Result<Step, Refusal> {
    let state = State::Running { losses, asked };
    let now_asked = |asked| State::Running { losses, asked };
    let finished = |outcome, reason, end| Step {
        state: State::Finished(outcome),
        reason: Some(reason),
        attempt_end: Some(end),
    };
    match (input, asked) {
        (Input::Claim, _) => Err(Refusal::NotQueued),
        (Input::Retry, _) => Err(Refusal::StillRunning),

        // asking: the worker hears of it in the answer to its next message
        (Input::Cancel, Some(UserRequest::Cancel))
        | (Input::Pause, Some(UserRequest::Pause))
        | (Input::Resume, None) => Ok(unchanged(state)),
        (Input::Pause | Input::Resume, Some(UserRequest::Cancel)) => Err(Refusal::BeingCancelled),
        (Input::Cancel, _) => Ok(quiet(
            now_asked(Some(UserRequest::Cancel)),
            ReasonCode::CancelRequested,
        )),
        (Input::Pause, None) => Ok(quiet(
            now_asked(Some(UserRequest::Pause)),
            ReasonCode::PauseRequested,
        )),
        (Input::Resume, Some(UserRequest::Pause)) => {
            Ok(quiet(now_asked(None), ReasonCode::ResumedByUser))
        }

        // a cancel that was accepted first holds, whatever the attempt has come to meanwhile
        (Input::Lose | Input::NeverUse, Some(UserRequest::Cancel)) => {
            Ok(cancelled(Some(AttemptEnd::Lost)))
        }
        (_, Some(UserRequest::Cancel)) => Ok(cancelled(Some(AttemptEnd::Cancelled))),

        (Input::Complete, _) => Ok(finished(
            JobOutcome::Succeeded,
            ReasonCode::Completed,
            AttemptEnd::Completed,
        )),
        (Input::Fail, _) => Ok(finished(
            JobOutcome::Failed,
            ReasonCode::SimulationError,
            AttemptEnd::Failed,
        )),
        (Input::Fault { machines }, _) if machines >= MACHINES_UNTIL_FAILED => Ok(finished(
            JobOutcome::Failed,
            ReasonCode::WorkerError,
            AttemptEnd::Faulted,
        )),
        (Input::ExceedTime, _) => Ok(finished(
            JobOutcome::TimedOut,
            ReasonCode::TimeLimit,
            AttemptEnd::TimedOut,
        )),

        (Input::ExceedEstimate, _) => Ok(Step {
            state: State::Paused { losses },
            reason: Some(ReasonCode::BeyondEstimate),
            attempt_end: Some(AttemptEnd::Paused),
        }),

        (Input::Release, Some(UserRequest::Pause)) => Ok(Step {
            state: State::Paused { losses },
            reason: Some(ReasonCode::PausedByUser),
            attempt_end: Some(AttemptEnd::Paused),
        }),
        (Input::Release, None) => Ok(Step {
            state: State::Queued { losses },
            reason: Some(ReasonCode::WorkerReleased),
            attempt_end: Some(AttemptEnd::Released),
        }),

        // what is no fault of the job's costs it nothing
        (Input::Fault { .. } | Input::NeverUse, Some(UserRequest::Pause)) => Ok(Step {
            state: State::Paused { losses },
            reason: Some(ReasonCode::PausedByUser),
            attempt_end: Some(unpaid_end(input)),
        }),
        (Input::Fault { .. } | Input::NeverUse, None) => Ok(Step {
            state: State::Queued { losses },
            reason: Some(match input {
                Input::Fault { .. } => ReasonCode::WorkerFault,
                _ => ReasonCode::WorkerLost,
            }),
            attempt_end: Some(unpaid_end(input)),
        }),

        (Input::Lose, Some(UserRequest::Pause)) => Ok(Step {
            state: State::Paused { losses: losses + 1 },
            reason: Some(ReasonCode::PausedByUser),
            attempt_end: Some(AttemptEnd::Lost),
        }),
        (Input::Lose, None) if losses + 1 >= LOSSES_UNTIL_QUARANTINE => Ok(finished(
            JobOutcome::Quarantined,
            ReasonCode::TooManyLosses,
            AttemptEnd::Lost,
        )),
        (Input::Lose, None) => Ok(Step {
            state: State::Queued { losses: losses + 1 },
            reason: Some(ReasonCode::WorkerLost),
            attempt_end: Some(AttemptEnd::Lost),
        }),
    }
}

/// How an attempt ended that costs the job nothing.
fn unpaid_end(input: Input) -> AttemptEnd {
    match input {
        Input::Fault { .. } => AttemptEnd::Faulted,
        _ => AttemptEnd::Lost,
    }
}

impl UserRequest {
    /// What the worker is told.
    pub fn command(asked: Option<Self>) -> Command {
        match asked {
            None => Command::Continue,
            Some(Self::Cancel) => Command::Cancel,
            Some(Self::Pause) => Command::Pause,
        }
    }
}

/// Whether a job that ended this way keeps its checkpoints, and goes on from them when it is retried:
/// all do that have no result. Who wants to begin anew submits it again.
pub fn keeps_checkpoint(outcome: JobOutcome) -> bool {
    outcome != JobOutcome::Succeeded
}

fn unchanged(state: State) -> Step {
    Step {
        state,
        reason: None,
        attempt_end: None,
    }
}

fn quiet(state: State, reason: ReasonCode) -> Step {
    Step {
        state,
        reason: Some(reason),
        attempt_end: None,
    }
}

fn cancelled(attempt_end: Option<AttemptEnd>) -> Step {
    Step {
        state: State::Finished(JobOutcome::Cancelled),
        reason: Some(ReasonCode::CancelledByUser),
        attempt_end,
    }
}
