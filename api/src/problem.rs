//! Errors on the wire: `application/problem+json` (RFC 9457) with violations.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// An error answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Problem {
    /// Stable name of the kind of problem: `/problems/invalid-spec`, ...
    #[serde(rename = "type")]
    pub kind: String,
    pub title: String,
    pub status: u16,
    /// What is wrong this time, and what to do.
    pub detail: String,
    /// Each thing wrong with the request, all at once.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub violations: Vec<Violation>,
}

/// One thing wrong with a request.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Violation {
    /// JSON pointer (RFC 6901) into the request's body; empty for the body itself.
    pub pointer: String,
    /// Word for programs: `unknown_field`, `out_of_range`, ...
    pub code: String,
    pub detail: String,
    /// The value given, shortened when long.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<Value>,
    /// What would be accepted: `> 0`, `1 … 100`, `one of: a, b`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub allowed: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
}

impl Problem {
    /// A problem of the kind `/problems/{slug}`.
    pub fn new(status: u16, slug: &str, title: &str, detail: impl Into<String>) -> Self {
        Self {
            kind: format!("/problems/{slug}"),
            title: title.to_owned(),
            status,
            detail: detail.into(),
            violations: Vec::new(),
        }
    }
}

impl Violation {
    /// A violation at `pointer`.
    pub fn new(pointer: impl Into<String>, code: &str, detail: impl Into<String>) -> Self {
        Self {
            pointer: pointer.into(),
            code: code.to_owned(),
            detail: detail.into(),
            value: None,
            allowed: None,
            unit: None,
        }
    }

    /// With the value given; long ones are shortened, so that an error is never larger than its cause.
    pub fn value(mut self, value: impl Into<Value>) -> Self {
        const LONGEST: usize = 120;
        let value = value.into();
        let text = value.to_string();
        self.value = Some(if text.len() <= LONGEST {
            value
        } else {
            let cut: String = text.chars().take(LONGEST).collect();
            Value::String(format!("{cut}…"))
        });
        self
    }

    /// With what would be accepted.
    pub fn allowed(mut self, allowed: impl Into<String>) -> Self {
        self.allowed = Some(allowed.into());
        self
    }

    /// With the unit of value and range.
    pub fn unit(mut self, unit: &str) -> Self {
        self.unit = Some(unit.to_owned());
        self
    }
}

impl std::fmt::Display for Violation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let place = if self.pointer.is_empty() {
            "/"
        } else {
            &self.pointer
        };
        write!(f, "{place}: {}", self.detail)?;
        if let Some(value) = &self.value {
            write!(f, " (given {value})")?;
        }
        if let Some(allowed) = &self.allowed {
            write!(f, "; allowed: {allowed}")?;
            if let Some(unit) = self.unit.as_deref().filter(|unit| *unit != "1") {
                write!(f, " {unit}")?;
            }
        }
        Ok(())
    }
}

impl std::fmt::Display for Problem {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", self.title, self.detail)?;
        self.violations
            .iter()
            .try_for_each(|violation| write!(f, "\n  {violation}"))
    }
}

impl std::error::Error for Problem {}
