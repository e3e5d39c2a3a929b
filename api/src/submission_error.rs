//! Why a submission is not accepted, and the answer to it.
use uuid::Uuid;

use crate::earlier::UNKNOWN_RESULTS;
use crate::problem::{Problem, Violation};
use crate::violations::LISTED;

/// Why a submission is not accepted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SubmissionError {
    /// The text is not JSON.
    #[error("not JSON: {}", .0.detail)]
    Syntax(Box<Violation>),
    /// It is JSON, but not a job that can be run.
    #[error("{} violations", .0.len())]
    Invalid(Vec<Violation>),
}

impl SubmissionError {
    /// Jobs whose results would be needed to go on.
    pub fn wanted_jobs(&self) -> Vec<Uuid> {
        let Self::Invalid(violations) = self else {
            return Vec::new();
        };
        let wanted = violations
            .iter()
            .filter(|violation| violation.code == UNKNOWN_RESULTS);
        let mut ids: Vec<Uuid> = wanted
            .filter_map(|violation| violation.value.as_ref()?.as_str()?.parse().ok())
            .collect();
        ids.sort_unstable();
        ids.dedup();
        ids
    }

    /// Everything that is wrong.
    pub fn violations(self) -> Vec<Violation> {
        match self {
            Self::Syntax(violation) => vec![*violation],
            Self::Invalid(violations) => violations,
        }
    }

    /// The answer a client gets.
    pub fn into_problem(self) -> Problem {
        match self {
            Self::Syntax(violation) => Problem {
                violations: vec![(*violation).clone()],
                ..Problem::new(400, "not-json", "The body is not JSON", violation.detail)
            },
            Self::Invalid(violations) => {
                let detail = match violations.len() {
                    1 => format!("{}", violations[0]),
                    LISTED.. => format!(
                        "at least {LISTED} things are wrong; the first are listed under violations"
                    ),
                    count => format!("{count} things are wrong; each is listed under violations"),
                };
                Problem {
                    violations,
                    ..Problem::new(422, "invalid-job", "The job cannot be accepted", detail)
                }
            }
        }
    }
}
