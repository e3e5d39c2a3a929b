//! A study file: a job, and the cases in which it is run.
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::Value;

use crate::Envelope;

/// What parameters of a job do to its results, read from a file with
/// [`Message::from_slice`](crate::Message::from_slice).
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ParameterStudy {
    /// What is studied, in a line.
    #[schemars(length(min = 1, max = 200))]
    pub title: String,
    /// Where the question comes from: `thesis, table 4.3`.
    #[serde(default)]
    #[schemars(length(max = 1000))]
    pub source: String,
    /// What the source says, in a sentence.
    #[serde(default)]
    #[schemars(length(max = 10_000))]
    pub statement: String,
    /// Specimens tested in each case, with the same seeds everywhere: the job's own, the next one
    /// and so on.
    #[serde(default = "five")]
    #[schemars(range(min = 1, max = 1000))]
    pub seeds: u32,
    /// The job as it would be posted. Either this or `example`.
    pub job: Option<Envelope>,
    /// Name of an example, which is the job.
    pub example: Option<String>,
    /// Cases with names of their own.
    #[serde(default)]
    #[schemars(length(max = 1000))]
    pub cases: Vec<WrittenCase>,
    /// Cases in short, after the others: JSON pointers into the job's spec, each with its values.
    /// There is a case for each value, or for each combination of several pointers' values, the
    /// last pointer's changing fastest.
    #[serde(default)]
    pub vary: IndexMap<String, Vec<Value>>,
    /// Results that tables and plot show, by their names in the summary of an outcome; left out,
    /// those that an accuracy study of the kind compares.
    #[serde(default)]
    #[schemars(length(max = 100), inner(length(min = 1, max = 200)), extend("uniqueItems" = true))]
    pub results: Vec<String>,
}

/// A case and what is different in it.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WrittenCase {
    /// Its name in tables.
    #[schemars(length(min = 1, max = 100))]
    pub label: String,
    /// JSON pointers (RFC 6901) into the job's spec as it is written, before defaults, with the
    /// values that take their places. Objects that are not there are made.
    #[serde(default)]
    pub set: IndexMap<String, Value>,
}

fn five() -> u32 {
    5
}
