//! The job whose parameters are sought, and how parameters are put into it.
use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value;
use serde_json::value::RawValue;

use crate::{JobKind, JobSpec, SubmissionError, Violation, kind_schema, schema::unit_at};

/// A job of another kind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InnerJob {
    pub kind: JobKind,
    /// The kind's spec, see `/v1/kinds/{kind}/schema`. Of repeats only one is run for each
    /// realisation, and no snapshots are written.
    pub spec: SpecText,
}

/// A JSON object as it was written, so that its own kind reads it.
#[derive(Clone, Debug, PartialEq)]
pub struct SpecText(String);

impl SpecText {
    /// The text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl Serialize for SpecText {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let raw = RawValue::from_string(self.0.clone()).map_err(serde::ser::Error::custom)?;
        raw.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for SpecText {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let raw = Box::<RawValue>::deserialize(deserializer)?;
        Ok(Self(raw.get().to_owned()))
    }
}

impl JsonSchema for SpecText {
    fn schema_name() -> Cow<'static, str> {
        "InnerSpec".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        serde_json::Map::<String, Value>::json_schema(generator)
    }
}

impl InnerJob {
    /// Reads the spec as its own kind does.
    ///
    /// # Errors
    /// Everything that is wrong with it, with pointers into the inner job.
    pub fn read(&self) -> Result<JobSpec, Vec<Violation>> {
        read(self.kind, self.spec.as_str())
    }
}

fn read(kind: JobKind, text: &str) -> Result<JobSpec, Vec<Violation>> {
    JobSpec::from_text(kind, text).map_err(SubmissionError::violations)
}

/// A checked inner job, all defaults written out, with places for parameters.
#[derive(Clone, Debug)]
pub struct Template {
    kind: JobKind,
    spec: Value,
}

impl Template {
    /// # Errors
    /// As [`InnerJob::read`].
    pub fn new(job: &InnerJob) -> Result<Self, Vec<Violation>> {
        let text = job.read()?.to_json();
        let spec = serde_json::from_str(&text).unwrap_or_default();
        let kind = job.kind;
        Ok(Self { kind, spec })
    }

    /// The number at `pointer`; whole numbers (counts, seeds) are none, because nothing lies between
    /// them.
    pub fn number(&self, pointer: &str) -> Option<f64> {
        real(self.spec.pointer(pointer)?)
    }

    /// The unit of the number at `pointer`, where the kind's schema says it.
    pub fn unit(&self, pointer: &str) -> Option<&'static str> {
        unit_at(kind_schema(self.kind), pointer)
    }

    /// The spec with these numbers, as JSON.
    pub fn with(&self, numbers: &[(&str, f64)]) -> Value {
        let mut spec = self.spec.clone();
        for (pointer, number) in numbers {
            if let Some(place) = spec.pointer_mut(pointer) {
                *place = Value::from(*number);
            }
        }
        spec
    }

    /// The job with these numbers.
    ///
    /// # Errors
    /// As [`InnerJob::read`].
    pub fn job(&self, numbers: &[(&str, f64)]) -> Result<JobSpec, Vec<Violation>> {
        read(self.kind, &self.with(numbers).to_string())
    }

    /// Pointers to numbers, in the order of the spec, at most so many; of a list only those of the
    /// first entries.
    pub(super) fn numbers(&self, most: usize) -> Vec<String> {
        let mut found = Vec::new();
        collect(&self.spec, String::new(), most, &mut found);
        found
    }

    pub(super) fn text(&self) -> SpecText {
        SpecText(self.spec.to_string())
    }
}

/// A number of a field that takes fractions, which are written with a point even where they are whole.
fn real(value: &Value) -> Option<f64> {
    value.as_f64().filter(|_| value.is_f64())
}

fn collect(value: &Value, pointer: String, most: usize, found: &mut Vec<String>) {
    /// Entries of a list that are shown.
    const SHOWN: usize = 3;
    match value {
        _ if found.len() >= most => {}
        value if real(value).is_some() => found.push(pointer),
        Value::Array(items) => {
            for (index, item) in items.iter().take(SHOWN).enumerate() {
                collect(item, format!("{pointer}/{index}"), most, found);
            }
        }
        Value::Object(fields) => {
            for (name, field) in fields {
                let name = crate::schema::escape(name);
                collect(field, format!("{pointer}/{name}"), most, found);
            }
        }
        _ => {}
    }
}
