//! What may be changed of a job after its submission.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use uuid::Uuid;

/// The body of `PATCH /v1/jobs/{id}`; what is left out stays as it is.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct JobChanges {
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "String", length(min = 1, max = 200))]
    pub name: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "String", length(max = 10_000))]
    pub notes: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(
        with = "Vec<String>",
        length(max = 20),
        inner(length(min = 1, max = 50))
    )]
    pub tags: Option<Vec<String>>,
    /// Higher runs first.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "i32", range(min = -1000, max = 1000))]
    pub priority: Option<i32>,
    /// How many times its estimate the job may take before it is paused (dimensionless).
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", range(min = 1.0, max = 1e6))]
    pub overrun_factor: Option<f64>,
    /// Moves the job to this project.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Uuid")]
    pub project: Option<Uuid>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Message, SubmissionError};

    #[test]
    fn changes_keep_to_the_limits_of_a_submission() {
        let changes = JobChanges::from_slice(br#"{"priority": 5, "tags": ["a"]}"#).expect("valid");
        assert_eq!(changes.priority, Some(5));
        assert_eq!(changes.name, None);
        let refused =
            br#"{"priority": 1001, "name": null, "tags": [""], "spec": {}, "overrun_factor": 0.5}"#;
        let Err(SubmissionError::Invalid(violations)) = JobChanges::from_slice(refused) else {
            panic!("accepted");
        };
        let mut pointers: Vec<_> = violations.iter().map(|v| v.pointer.as_str()).collect();
        pointers.sort_unstable();
        assert_eq!(
            pointers,
            ["/name", "/overrun_factor", "/priority", "/spec", "/tags/0"]
        );
    }
}
