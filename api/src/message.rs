//! Messages other than submissions, read as carefully.
use std::sync::OnceLock;

use schemars::JsonSchema;
use serde::de::DeserializeOwned;

use crate::allocations::AllocationReport;
use crate::comparison::{ComparisonChanges, NewComparison};
use crate::json::{parse, typed};
use crate::people::{
    Acceptance, HandOver, MailVerification, NewGroup, NewInvitation, NewMail, NewProject, NewShare,
    NewToken, NewWebhook, PasswordChange, PersonChanges, PersonLimits, ProjectChanges,
    RetentionRule, SignIn,
};
use crate::schema::Checker;
use crate::spec::calibrate::MeasuredCurve;
use crate::study::ParameterStudy;
use crate::worker::{
    ClaimRequest, CompleteRequest, FailRequest, FaultRequest, ProgressReport, ReleaseRequest,
};
use crate::{JobChanges, SubmissionError};

/// The body of a request, or a file that is no submission.
pub trait Message: DeserializeOwned + JsonSchema {
    /// Reads and checks a message.
    ///
    /// # Errors
    /// Every violation of the message's schema, with pointers into the body.
    fn from_slice(body: &[u8]) -> Result<Self, SubmissionError>;
}

macro_rules! messages {
    ($($message:ty),+ $(,)?) => {
        $(impl Message for $message {
            fn from_slice(body: &[u8]) -> Result<Self, SubmissionError> {
                static CHECKER: OnceLock<Checker> = OnceLock::new();
                let checker = CHECKER.get_or_init(Checker::of::<Self>);
                let violations = checker.violations(&parse(body)?);
                if violations.is_empty() {
                    typed(body, "")
                } else {
                    Err(SubmissionError::Invalid(violations))
                }
            }
        })+

        /// Reads a body as each of the messages there are, one after the other; how many take it. Tests hold
        /// foreign bytes against it, so that no message is left out.
        pub fn messages_that_take(body: &[u8]) -> usize {
            let taken = [$(<$message>::from_slice(body).is_ok()),+];
            taken.into_iter().filter(|is_taken| *is_taken).count()
        }
    };
}

messages!(
    JobChanges,
    SignIn,
    PasswordChange,
    NewInvitation,
    Acceptance,
    PersonChanges,
    PersonLimits,
    HandOver,
    NewToken,
    NewGroup,
    NewProject,
    ProjectChanges,
    NewShare,
    AllocationReport,
    RetentionRule,
    NewWebhook,
    NewMail,
    MailVerification,
    NewComparison,
    ComparisonChanges,
    MeasuredCurve,
    ClaimRequest,
    ProgressReport,
    CompleteRequest,
    FailRequest,
    FaultRequest,
    ReleaseRequest,
    ParameterStudy
);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_held_against_their_schema() {
        let good = br#"{"progress": 0.5, "phase": "step 3", "points": {"columns": ["a"], "first": 0, "rows": [[1.5]]}}"#;
        let report = ProgressReport::from_slice(good).expect("a good report");
        assert_eq!(report.points.map(|block| block.rows), Some(vec![vec![1.5]]));

        let bad = br#"{"progress": 2, "phase": 3, "surprise": 1, "points": {"columns": [], "first": -1, "rows": []}}"#;
        let Err(SubmissionError::Invalid(violations)) = ProgressReport::from_slice(bad) else {
            panic!("accepted");
        };
        let pointers: Vec<_> = violations.iter().map(|v| v.pointer.as_str()).collect();
        for pointer in ["/progress", "/phase", "/surprise"] {
            assert!(pointers.contains(&pointer), "{pointer} in {pointers:?}");
        }
    }

    #[test]
    fn what_is_no_json_is_told_apart() {
        let broken = FailRequest::from_slice(b"{\"code\":");
        assert!(matches!(broken, Err(SubmissionError::Syntax(_))));
    }
}
