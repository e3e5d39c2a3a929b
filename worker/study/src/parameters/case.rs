//! A case of a study as its tests tell it.
use indexmap::IndexMap;
use serde::Serialize;
use serde_json::Value;

/// A case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CaseRow {
    pub label: String,
    /// What is different in it, by JSON pointer into the spec.
    pub set: IndexMap<String, Value>,
    /// Of the spec with the study's first seed.
    pub spec_sha256: String,
    /// Processor time of one test [s], the mean over seeds.
    pub cpu_s: f64,
    /// Tests with a warning.
    pub doubtful: usize,
    /// Warnings by their code, and how many tests had them.
    pub warnings: IndexMap<String, usize>,
    /// Every result over the seeds.
    pub results: IndexMap<String, CaseResult>,
    /// In the order of the seeds.
    pub tests: Vec<Test>,
}

/// A result of a case over the seeds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CaseResult {
    pub unit: String,
    /// `null` where no test got that far.
    pub mean: Option<f64>,
    /// Standard deviation, from two seeds on.
    pub deviation: Option<f64>,
    /// 95 % confidence interval of the mean, by Student's t, from two seeds on.
    pub interval: Option<[f64; 2]>,
    /// Seeds that know it.
    pub n: u32,
}

/// A test of a case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Test {
    pub seed: u64,
    /// Processor time [s].
    pub cpu_s: f64,
    /// Codes of its warnings.
    pub warnings: Vec<String>,
    /// Every result, in the order of the case's.
    pub values: Vec<Option<f64>>,
}
