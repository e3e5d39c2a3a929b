//! A submission: the envelope around a spec, taken apart so that every error keeps its place.
use std::sync::OnceLock;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use serde_json::value::RawValue;

use crate::calibration::{Calibration, Estimate};
use crate::earlier::Earlier;
use crate::json::{parse, typed};
use crate::kind_schemas::spec_violations;
use crate::kinds::{JobKind, JobSpec, SpecVisitor};
use crate::limits::OVERRUN_FACTOR;
use crate::problem::Violation;
use crate::schema::Checker;
use crate::spec_trait::Spec;
use crate::submission_error::SubmissionError;
use crate::violations::Violations;

/// The body of `POST /v1/jobs`, its spec still raw.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Envelope {
    pub kind: JobKind,
    /// A name for people; left out, the kind's title.
    #[serde(default)]
    #[schemars(length(max = 200))]
    pub name: String,
    #[serde(default)]
    #[schemars(length(max = 10_000))]
    pub notes: String,
    #[serde(default)]
    #[schemars(length(max = 20), inner(length(min = 1, max = 50)))]
    pub tags: Vec<String>,
    /// Higher runs first.
    #[serde(default)]
    #[schemars(range(min = -1000, max = 1000))]
    pub priority: i32,
    /// Threads that its worker must have at least; left out, one will do. Results do not depend on it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 4096))]
    pub threads: Option<u32>,
    /// How many times its estimated time, memory and files the job may take before it is paused with its
    /// checkpoint (dimensionless).
    #[serde(default = "overrun_factor")]
    #[schemars(range(min = 1.0, max = 1e6))]
    pub overrun_factor: f64,
    /// The kind's spec, see `/v1/kinds/{kind}/schema`.
    #[schemars(with = "serde_json::Map<String, Value>")]
    pub spec: Box<RawValue>,
}

fn overrun_factor() -> f64 {
    OVERRUN_FACTOR
}

/// A submission that has passed every check.
#[derive(Clone, Debug, PartialEq)]
pub struct Submission {
    pub name: String,
    pub notes: String,
    pub tags: Vec<String>,
    pub priority: i32,
    /// Threads that its worker must have at least.
    pub threads: Option<u32>,
    /// How many times its estimate the job may take.
    pub overrun_factor: f64,
    pub spec: JobSpec,
}

impl Submission {
    /// Reads and checks a submission.
    ///
    /// # Errors
    /// Every violation found, with pointers into the whole body.
    pub fn from_slice(body: &[u8]) -> Result<Self, SubmissionError> {
        Self::from_slice_after(body, &Earlier::default())
    }

    /// What the job will take, also on the threads that it asks for, at the speed that was `measured`.
    pub fn estimate(&self, measured: Option<Calibration>) -> Estimate {
        let alone = self.spec.estimate(&measured.unwrap_or_default());
        Estimate {
            calibrated: measured.is_some(),
            ..alone.on_threads(self.threads)
        }
    }

    /// Reads and checks a submission that may refer to results of `earlier` jobs.
    ///
    /// # Errors
    /// As [`Self::from_slice`].
    pub fn from_slice_after(body: &[u8], earlier: &Earlier) -> Result<Self, SubmissionError> {
        let value = parse(body)?;
        let mut violations = envelope_violations(&value);
        let kind = value["kind"]
            .as_str()
            .and_then(|name| name.parse::<JobKind>().ok());
        if let (Some(kind), Some(spec)) = (kind, value.get("spec").filter(|spec| spec.is_object()))
        {
            violations.extend(spec_violations(kind, spec).into_iter().map(within_spec));
        }
        drop(value);
        if !violations.is_empty() {
            return Err(SubmissionError::Invalid(violations));
        }
        // the schema is content, so what the types refuse now is rare: 1.0 for 1
        let envelope: Envelope = typed(body, "")?;
        let spec = envelope.kind.visit(ReadSpec {
            text: envelope.spec.get(),
            earlier,
        })?;
        let name = match envelope.name.trim() {
            "" => envelope.kind.title().to_owned(),
            name => name.to_owned(),
        };
        let Envelope {
            notes,
            tags,
            priority,
            threads,
            overrun_factor,
            ..
        } = envelope;
        Ok(Self {
            name,
            notes,
            tags,
            priority,
            threads,
            overrun_factor,
            spec,
        })
    }
}

/// Reads a kind's spec from its raw text, checks and normalises it.
struct ReadSpec<'a> {
    text: &'a str,
    earlier: &'a Earlier,
}

impl SpecVisitor for ReadSpec<'_> {
    type Output = Result<JobSpec, SubmissionError>;

    fn visit<T: Spec>(self, wrap: fn(T) -> JobSpec) -> Self::Output {
        let mut spec: T = typed(self.text.as_bytes(), "/spec")?;
        let mut violations = Violations::default();
        spec.learn(self.earlier, &mut violations);
        if violations.is_empty() {
            spec.check(&mut violations);
        }
        if violations.is_empty() {
            spec.normalise();
            Ok(wrap(spec))
        } else {
            let violations = violations.into_vec().into_iter().map(within_spec);
            Err(SubmissionError::Invalid(violations.collect()))
        }
    }
}

impl JobSpec {
    /// Reads a spec that was normalised before, as workers get it.
    ///
    /// # Errors
    /// As [`Submission::from_slice`].
    pub fn from_json(kind: JobKind, text: &str) -> Result<Self, SubmissionError> {
        kind.visit(ReadSpec {
            text,
            earlier: &Earlier::default(),
        })
    }
}

impl JobSpec {
    /// Reads a spec as users write it, by itself.
    ///
    /// # Errors
    /// As [`Submission::from_slice`], with pointers that begin with `/spec`.
    pub fn from_text(kind: JobKind, text: &str) -> Result<Self, SubmissionError> {
        let violations = spec_violations(kind, &parse(text.as_bytes())?);
        if violations.is_empty() {
            Self::from_json(kind, text)
        } else {
            let violations = violations.into_iter().map(within_spec);
            Err(SubmissionError::Invalid(violations.collect()))
        }
    }
}

/// Everything in a submission, its spec aside, that the envelope's schema refuses.
fn envelope_violations(body: &Value) -> Vec<Violation> {
    static CHECKER: OnceLock<Checker> = OnceLock::new();
    CHECKER
        .get_or_init(Checker::of::<Envelope>)
        .violations(body)
}

fn within_spec(mut violation: Violation) -> Violation {
    violation.pointer.insert_str(0, "/spec");
    violation
}
