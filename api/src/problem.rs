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
    pub fn value(self, value: impl Into<Value>) -> Self {
        self.given(&value.into())
    }

    /// With the value given, of which only what is shown is copied.
    pub fn given(mut self, value: &Value) -> Self {
        let mut beginning = Beginning(Vec::new());
        self.value = Some(match serde_json::to_writer(&mut beginning, value) {
            Ok(()) => value.clone(),
            Err(_) => Value::String(beginning.text() + "…"),
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

/// The first bytes written to it; refuses to take more.
struct Beginning(Vec<u8>);

impl Beginning {
    /// Most bytes taken.
    const LONGEST: usize = 120;

    /// What was taken, without a character that was cut.
    fn text(&self) -> String {
        let whole = match std::str::from_utf8(&self.0) {
            Ok(_) => self.0.len(),
            Err(cut) => cut.valid_up_to(),
        };
        String::from_utf8_lossy(&self.0[..whole]).into_owned()
    }
}

impl std::io::Write for Beginning {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let room = Self::LONGEST - self.0.len();
        self.0.extend(bytes.iter().take(room));
        if bytes.len() > room {
            return Err(std::io::ErrorKind::FileTooLarge.into());
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
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

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn long_values_are_cut_between_characters() {
        let shown = |value: Value| Violation::new("", "", "").given(&value).value;
        assert_eq!(shown(json!([1, "a"])), Some(json!([1, "a"])));
        let long = "é".repeat(100);
        // the quote and 59 characters of two bytes fit
        let cut = format!("\"{}…", "é".repeat(59));
        assert_eq!(shown(json!(long)), Some(json!(cut)));
        let many = shown(json!(vec![1; 1000])).expect("a value");
        assert_eq!(many.as_str().map(str::len), Some(120 + "…".len()));
    }
}
