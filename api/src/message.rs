//! Messages other than submissions, read as carefully.
use std::sync::OnceLock;

use schemars::JsonSchema;
use serde::de::DeserializeOwned;

use crate::allocations::AllocationReport;
use crate::comparison::{ComparisonChanges, NewComparison};
use crate::json::{check_size, parse, typed};
use crate::people::{
    Acceptance, HandOver, MailVerification, NewGroup, NewInvitation, NewMail, NewProject, NewShare,
    NewToken, NewWebhook, PasswordChange, PersonChanges, PersonLimits, ProjectChanges,
    RetentionRule, SignIn,
};
use crate::schema::Checker;
use crate::spec::calibrate::MeasuredCurve;
use crate::study::ParameterStudy;
use crate::worker::{
    ClaimRequest, CompleteRequest, FailRequest, FaultRequest, MOST_CURVE_POINTS, ProgressReport,
    ReleaseRequest,
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

fn checked<T: Message>(body: &[u8], checker: &Checker) -> Result<T, SubmissionError> {
    let violations = checker.violations(&parse(body)?);
    if violations.is_empty() {
        typed(body, "")
    } else {
        Err(SubmissionError::Invalid(violations))
    }
}

/// A report in order, read in one pass: its points are nearly all of it, and of them the schema says no more
/// than that they are lists of numbers, and how many; so it is held against the rest. `None` where anything is
/// wrong, or may be.
fn report_in_order(body: &[u8], checker: &Checker) -> Option<ProgressReport> {
    check_size(body).ok()?;
    let mut report: ProgressReport = serde_json::from_slice(body).ok()?;
    let rows = report
        .points
        .as_mut()
        .map(|of| std::mem::take(&mut of.rows));
    let rest = serde_json::to_value(&report).ok()?;
    if !checker.violations(&rest).is_empty() {
        return None;
    }
    if let (Some(points), Some(rows)) = (&mut report.points, rows) {
        points.rows = rows;
    }
    let points = report.points.as_ref();
    points
        .is_none_or(|of| of.rows.len() <= MOST_CURVE_POINTS)
        .then_some(report)
}

macro_rules! messages {
    ($($message:ty $(, first by $quickly:ident)?;)+) => {
        $(impl Message for $message {
            fn from_slice(body: &[u8]) -> Result<Self, SubmissionError> {
                static CHECKER: OnceLock<Checker> = OnceLock::new();
                let checker = CHECKER.get_or_init(Checker::of::<Self>);
                $(if let Some(message) = $quickly(body, checker) {
                    return Ok(message);
                })?
                checked(body, checker)
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

messages! {
    JobChanges;
    SignIn;
    PasswordChange;
    NewInvitation;
    Acceptance;
    PersonChanges;
    PersonLimits;
    HandOver;
    NewToken;
    NewGroup;
    NewProject;
    ProjectChanges;
    NewShare;
    AllocationReport;
    RetentionRule;
    NewWebhook;
    NewMail;
    MailVerification;
    NewComparison;
    ComparisonChanges;
    MeasuredCurve;
    ClaimRequest;
    ProgressReport, first by report_in_order;
    CompleteRequest;
    FailRequest;
    FaultRequest;
    ReleaseRequest;
    ParameterStudy;
}

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

    /// Whatever is taken quickly is taken as it is by all checks; everything is tried that a wrong byte makes of
    /// a report.
    #[test]
    fn reports_are_read_in_one_pass_as_they_are_by_all_checks() {
        let checker = Checker::of::<ProgressReport>();
        let report = br#"{"progress": 1, "phase": "a", "eta_s": null, "log": ["x", ""], "log_from": 3,
            "points": {"columns": ["a", "b"], "first": 7, "rows": [[1.5, -2e-3], [0, 18446744073709551615]]}}"#;
        assert!(report_in_order(report, &checker).is_some());
        let mut taken = 0;
        for place in 0..report.len() {
            for byte in *b"0179-.eE+\"\\,:[]{} nabyx\0\xff" {
                let mut body = report.to_vec();
                body[place] = byte;
                if let Some(quickly) = report_in_order(&body, &checker) {
                    taken += 1;
                    let all = checked::<ProgressReport>(&body, &checker);
                    assert_eq!(
                        all.ok(),
                        Some(quickly),
                        "{}",
                        String::from_utf8_lossy(&body)
                    );
                }
            }
        }
        // most that is taken has another digit or letter somewhere
        assert!(taken > 300, "{taken}");
        let with_rows = |rows: usize| {
            let rows = vec!["[]"; rows].join(",");
            format!(
                r#"{{"progress": 0, "phase": "", "points": {{"columns": ["a"], "first": 0, "rows": [{rows}]}}}}"#
            )
        };
        for (rows, fit) in [(MOST_CURVE_POINTS, true), (MOST_CURVE_POINTS + 1, false)] {
            let body = with_rows(rows);
            assert_eq!(report_in_order(body.as_bytes(), &checker).is_some(), fit);
            assert_eq!(ProgressReport::from_slice(body.as_bytes()).is_ok(), fit);
        }
    }

    #[test]
    fn what_is_no_json_is_told_apart() {
        let broken = FailRequest::from_slice(b"{\"code\":");
        assert!(matches!(broken, Err(SubmissionError::Syntax(_))));
    }
}
