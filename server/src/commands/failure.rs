//! How a command ends when it does not end well.
use std::fmt;
use std::process::ExitCode;

use loadframe_api::{JobOutcome, JobView};
use loadframe_client::ServerError;

/// Exit codes, as the help lists them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Code {
    /// The job has no result, or the server refused.
    Failed = 1,
    /// Wrong usage or an invalid spec; also what clap exits with.
    Usage = 2,
    Unreachable = 3,
    Cancelled = 4,
    /// Stopped by a signal; the same command goes on.
    Interrupted = 5,
}

/// An exit code with what is said on standard error.
#[derive(Debug)]
pub(crate) struct Failure {
    code: Code,
    message: String,
}

impl Failure {
    pub(crate) fn new(code: Code, message: impl Into<String>) -> Self {
        Self {
            code,
            message: message.into(),
        }
    }

    /// A failure of this machine, with all its causes.
    pub(crate) fn of(error: &dyn std::error::Error) -> Self {
        Self::new(Code::Failed, chain(error))
    }

    /// The failure that a finished job without a result is, if it is one.
    pub(crate) fn of_job(job: &JobView) -> Option<Self> {
        let code = match job.outcome {
            None | Some(JobOutcome::Succeeded) => return None,
            Some(JobOutcome::Cancelled) => Code::Cancelled,
            Some(JobOutcome::Failed | JobOutcome::TimedOut | JobOutcome::Quarantined) => {
                Code::Failed
            }
        };
        Some(Self::new(code, format!("job {}: {}", job.id, job.reason)))
    }

    /// The process's exit code.
    pub(crate) fn exit_code(&self) -> ExitCode {
        ExitCode::from(self.code as u8)
    }
}

/// What is said on standard error.
impl fmt::Display for Failure {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "loadframe: {}", self.message)
    }
}

impl From<ServerError> for Failure {
    fn from(error: ServerError) -> Self {
        let code = match &error {
            error if error.is_transient() => Code::Unreachable,
            ServerError::Address { .. } => Code::Usage,
            ServerError::Refused(problem) if matches!(problem.status, 400 | 422) => Code::Usage,
            _ => Code::Failed,
        };
        let hint = match &error {
            ServerError::Unreachable { .. } => {
                "\nIs it running? `loadframe lab` starts one here; --server names another."
            }
            ServerError::Refused(problem) if problem.status == 401 => {
                "\nGive the token with --token-file or LOADFRAME_TOKEN."
            }
            _ => "",
        };
        Self::new(code, format!("{error}{hint}"))
    }
}

/// An error with all its causes.
pub(crate) fn chain(error: &dyn std::error::Error) -> String {
    let causes = std::iter::successors(Some(error), |error| error.source());
    let causes: Vec<String> = causes.map(ToString::to_string).collect();
    causes.join(": ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use loadframe_api::Problem;

    #[test]
    fn scripts_can_tell_failures_apart() {
        let refused = |status| ServerError::Refused(Problem::new(status, "x", "x", "x"));
        let away = ServerError::Unreachable {
            server: "http://lab".to_owned(),
            reason: "connection refused".to_owned(),
        };
        for (error, code) in [
            (away, Code::Unreachable),
            (refused(422), Code::Usage),
            (refused(404), Code::Failed),
            (refused(401), Code::Failed),
        ] {
            assert_eq!(Failure::from(error).code, code);
        }
    }
}
