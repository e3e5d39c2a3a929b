//! How a lease is ended: completed, failed, released, or with a fault of this machine.
use loadframe_api::worker::{
    CompleteRequest, FailCode, FailRequest, FaultCode, FaultRequest, ReleaseReason, ReleaseRequest,
};
use loadframe_client::ServerError;
use loadframe_run::{Ended, RunError, StopCause};
use std::io;
use tokio::sync::oneshot::error::RecvError;

use super::lease_client::LeaseClient;
use super::stop::AttemptSwitch;

/// What became of a run: what the simulation said, or why its thread did not come back.
pub(super) type RunEnd = Result<Result<Ended, RunError>, RecvError>;

/// The request that ends a lease.
#[derive(Debug, PartialEq)]
enum LeaseEnd {
    Complete(Box<CompleteRequest>),
    Fail(FailCode, String),
    Fault(FaultCode, String),
    Release(ReleaseReason),
    /// It has taken more than it may.
    Exceeded,
}

/// Ends the lease of a run that ended as `run`, whose results arrived as `uploaded` says.
pub(super) async fn end(
    lease: &LeaseClient,
    switch: &AttemptSwitch,
    run: RunEnd,
    uploaded: Result<(), ServerError>,
) -> Result<(), ServerError> {
    let release = |reason, detail| ReleaseRequest { reason, detail };
    match lease_end(switch.cause(), run, uploaded)? {
        LeaseEnd::Complete(request) => lease.complete(&request).await,
        LeaseEnd::Fail(code, reason) => lease.fail(&FailRequest { code, reason }).await,
        LeaseEnd::Fault(code, reason) => lease.fault(&FaultRequest { code, reason }).await,
        LeaseEnd::Release(reason) => lease.release(&release(reason, None)).await,
        LeaseEnd::Exceeded => {
            let request = release(ReleaseReason::BeyondEstimate, switch.excess());
            lease.release(&request).await
        }
    }
}

fn lease_end(
    cause: Option<StopCause>,
    run: RunEnd,
    uploaded: Result<(), ServerError>,
) -> Result<LeaseEnd, ServerError> {
    match cause {
        Some(StopCause::LeaseLost) => return Err(ServerError::LeaseLost),
        Some(StopCause::Cancel) => return Ok(LeaseEnd::Release(ReleaseReason::Cancelled)),
        Some(StopCause::TimeLimit) => {
            let reason = "the job took longer than it may".to_owned();
            return Ok(LeaseEnd::Fail(FailCode::TimeLimit, reason));
        }
        Some(StopCause::BeyondEstimate | StopCause::Pause | StopCause::Shutdown) | None => {}
    }
    match uploaded {
        Ok(()) => {}
        Err(error) if error.is_transient() || matches!(error, ServerError::LeaseLost) => {
            return Err(error);
        }
        // a file of this machine's disk that cannot be read any more
        Err(error @ ServerError::File { .. }) => {
            return Ok(LeaseEnd::Fault(FaultCode::Disk, error.to_string()));
        }
        // what the server does not take from this machine it takes from no other
        Err(error) => {
            let reason = format!("the server does not take its results: {error}");
            return Ok(LeaseEnd::Fail(FailCode::SimulationError, reason));
        }
    }
    Ok(match run {
        Ok(Ok(Ended::Finished { outcome, files })) => {
            LeaseEnd::Complete(Box::new(CompleteRequest {
                outcome: *outcome,
                files,
            }))
        }
        Ok(Ok(Ended::Suspended)) if cause == Some(StopCause::BeyondEstimate) => LeaseEnd::Exceeded,
        Ok(Ok(Ended::Suspended)) if cause == Some(StopCause::Pause) => {
            LeaseEnd::Release(ReleaseReason::Paused)
        }
        Ok(Ok(Ended::Suspended | Ended::Cancelled)) => LeaseEnd::Release(ReleaseReason::Shutdown),
        Ok(Err(error)) => match fault_of(&error) {
            Some(code) => LeaseEnd::Fault(code, chain(&error)),
            None => LeaseEnd::Fail(FailCode::SimulationError, chain(&error)),
        },
        Err(error) => LeaseEnd::Fault(
            FaultCode::Other,
            format!("the simulation's thread did not end well: {error}"),
        ),
    })
}

/// What is wrong with this machine, if that is why the run has no result.
fn fault_of(error: &RunError) -> Option<FaultCode> {
    match error {
        // a name that no disk takes is the engine's doing
        RunError::Results(error) => match error.kind() {
            io::ErrorKind::InvalidInput => None,
            io::ErrorKind::OutOfMemory => Some(FaultCode::Memory),
            _ => Some(FaultCode::Disk),
        },
        RunError::Machine(_) => Some(FaultCode::Threads),
        _ => None,
    }
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

    fn end_of(cause: Option<StopCause>, run: Result<Ended, RunError>) -> LeaseEnd {
        lease_end(cause, Ok(run), Ok(())).expect("a lease that is held")
    }

    #[test]
    fn a_suspended_run_is_released_for_the_reason_it_was_stopped() {
        let paused = end_of(Some(StopCause::Pause), Ok(Ended::Suspended));
        assert_eq!(paused, LeaseEnd::Release(ReleaseReason::Paused));
        let stopped = end_of(Some(StopCause::Shutdown), Ok(Ended::Suspended));
        assert_eq!(stopped, LeaseEnd::Release(ReleaseReason::Shutdown));
        let exceeded = end_of(Some(StopCause::BeyondEstimate), Ok(Ended::Suspended));
        assert_eq!(exceeded, LeaseEnd::Exceeded);
    }

    #[test]
    fn a_cancelled_run_is_released_whatever_it_came_to() {
        for run in [Ok(Ended::Cancelled), Err(RunError::Bug("x".to_owned()))] {
            let end = end_of(Some(StopCause::Cancel), run);
            assert_eq!(end, LeaseEnd::Release(ReleaseReason::Cancelled));
        }
    }

    #[test]
    fn nothing_is_said_about_a_lost_lease() {
        let end = lease_end(Some(StopCause::LeaseLost), Ok(Ok(Ended::Suspended)), Ok(()));
        assert!(matches!(end, Err(ServerError::LeaseLost)));
    }

    #[test]
    fn whose_fault_a_failure_is_follows_from_where_it_happened() {
        let full = RunError::Results(io::Error::other("disk full"));
        assert_eq!(
            end_of(None, Err(full)),
            LeaseEnd::Fault(
                FaultCode::Disk,
                "the results could not be kept: disk full".to_owned()
            )
        );
        let bad_name = io::Error::new(io::ErrorKind::InvalidInput, "a name");
        assert!(matches!(
            end_of(None, Err(RunError::Results(bad_name))),
            LeaseEnd::Fail(FailCode::SimulationError, _)
        ));
        let LeaseEnd::Fail(code, reason) = end_of(None, Err(RunError::Bug("index 3".to_owned())))
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
        let end = lease_end(None, Ok(Ok(Ended::Suspended)), Err(refused));
        assert!(matches!(
            end,
            Ok(LeaseEnd::Fail(FailCode::SimulationError, _))
        ));
        let unreadable = ServerError::File {
            path: "a".to_owned(),
            reason: "input/output error".to_owned(),
        };
        let end = lease_end(None, Ok(Ok(Ended::Suspended)), Err(unreadable));
        assert!(matches!(end, Ok(LeaseEnd::Fault(FaultCode::Disk, _))));
        let away = ServerError::Unreachable {
            server: "lab".to_owned(),
            reason: "refused".to_owned(),
        };
        let end = lease_end(None, Ok(Ok(Ended::Suspended)), Err(away));
        assert!(matches!(end, Err(ServerError::Unreachable { .. })));
    }
}
