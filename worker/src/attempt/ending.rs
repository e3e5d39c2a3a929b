//! The last word to the server on a lease.
use loadframe_api::worker::{
    CompleteRequest, FailCode, FailRequest, ReleaseReason, ReleaseRequest,
};

use super::RunEnd;
use super::lease_client::LeaseClient;
use crate::client::ServerError;
use crate::run::{Ended, RunError};
use crate::stop::StopCause;

/// What is left to say about a lease.
#[derive(Debug, PartialEq)]
enum LastWord {
    Complete(Box<CompleteRequest>),
    Fail(FailCode, String),
    Release(ReleaseReason),
}

/// Ends the lease of a run that ended as `run`, whose results arrived as `delivered` says.
pub(super) async fn end(
    lease: &LeaseClient,
    cause: Option<StopCause>,
    run: RunEnd,
    delivered: Result<(), ServerError>,
) -> Result<(), ServerError> {
    match last_word(cause, run, delivered)? {
        LastWord::Complete(request) => lease.complete(&request).await,
        LastWord::Fail(code, reason) => lease.fail(&FailRequest { code, reason }).await,
        LastWord::Release(reason) => lease.release(&ReleaseRequest { reason }).await,
    }
}

fn last_word(
    cause: Option<StopCause>,
    run: RunEnd,
    delivered: Result<(), ServerError>,
) -> Result<LastWord, ServerError> {
    match cause {
        Some(StopCause::LeaseLost) => return Err(ServerError::LeaseLost),
        Some(StopCause::Cancel) => return Ok(LastWord::Release(ReleaseReason::Cancelled)),
        Some(StopCause::TimeLimit) => {
            let reason = "the job took longer than it may".to_owned();
            return Ok(LastWord::Fail(FailCode::TimeLimit, reason));
        }
        Some(StopCause::Pause | StopCause::Shutdown) | None => {}
    }
    let worker_error = |reason: String| LastWord::Fail(FailCode::WorkerError, reason);
    match delivered {
        Ok(()) => {}
        Err(error) if error.is_transient() || matches!(error, ServerError::LeaseLost) => {
            return Err(error);
        }
        Err(error) => {
            let reason = format!("the results could not be brought to the server: {error}");
            return Ok(worker_error(reason));
        }
    }
    Ok(match run {
        Ok(Ok(Ended::Finished { outcome, files })) => {
            LastWord::Complete(Box::new(CompleteRequest {
                outcome: *outcome,
                files,
            }))
        }
        Ok(Ok(Ended::Suspended)) if cause == Some(StopCause::Pause) => {
            LastWord::Release(ReleaseReason::Paused)
        }
        Ok(Ok(Ended::Suspended | Ended::Cancelled)) => LastWord::Release(ReleaseReason::Shutdown),
        Ok(Err(error @ (RunError::Simulation(_) | RunError::Bug(_)))) => {
            LastWord::Fail(FailCode::SimulationError, chain(&error))
        }
        Ok(Err(error)) => worker_error(chain(&error)),
        Err(error) => worker_error(format!("the simulation's thread did not end well: {error}")),
    })
}

/// An error with all its causes.
fn chain(error: &dyn std::error::Error) -> String {
    let causes = std::iter::successors(Some(error), |error| error.source());
    let causes: Vec<String> = causes.map(ToString::to_string).collect();
    causes.join(": ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use loadframe_api::Problem;
    use std::io;

    fn word(cause: Option<StopCause>, run: Result<Ended, RunError>) -> LastWord {
        last_word(cause, Ok(run), Ok(())).expect("a lease that is held")
    }

    #[test]
    fn a_suspended_run_is_released_for_the_reason_it_was_stopped() {
        let paused = word(Some(StopCause::Pause), Ok(Ended::Suspended));
        assert_eq!(paused, LastWord::Release(ReleaseReason::Paused));
        let stopped = word(Some(StopCause::Shutdown), Ok(Ended::Suspended));
        assert_eq!(stopped, LastWord::Release(ReleaseReason::Shutdown));
    }

    #[test]
    fn a_cancelled_run_is_released_whatever_it_came_to() {
        for run in [Ok(Ended::Cancelled), Err(RunError::Bug("x".to_owned()))] {
            let end = word(Some(StopCause::Cancel), run);
            assert_eq!(end, LastWord::Release(ReleaseReason::Cancelled));
        }
    }

    #[test]
    fn nothing_is_said_about_a_lost_lease() {
        let end = last_word(Some(StopCause::LeaseLost), Ok(Ok(Ended::Suspended)), Ok(()));
        assert!(matches!(end, Err(ServerError::LeaseLost)));
    }

    #[test]
    fn whose_fault_a_failure_is_follows_from_where_it_happened() {
        let full = RunError::Results(io::Error::other("disk full"));
        assert_eq!(
            word(None, Err(full)),
            LastWord::Fail(
                FailCode::WorkerError,
                "the results could not be kept: disk full".to_owned()
            )
        );
        let LastWord::Fail(code, reason) = word(None, Err(RunError::Bug("index 3".to_owned())))
        else {
            panic!("a panic fails the job");
        };
        assert_eq!(code, FailCode::SimulationError);
        assert!(
            reason.contains("index 3") && reason.contains("bug"),
            "{reason}"
        );
    }

    #[test]
    fn refused_results_fail_the_job_and_an_absent_server_does_not() {
        let refused = ServerError::Refused(Problem::new(422, "x", "Too long", "a file name"));
        let end = last_word(None, Ok(Ok(Ended::Suspended)), Err(refused));
        assert!(matches!(end, Ok(LastWord::Fail(FailCode::WorkerError, _))));
        let away = ServerError::Unreachable {
            server: "lab".to_owned(),
            reason: "refused".to_owned(),
        };
        let end = last_word(None, Ok(Ok(Ended::Suspended)), Err(away));
        assert!(matches!(end, Err(ServerError::Unreachable { .. })));
    }
}
