//! What a finished job says: `outcome.json`.
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::JobKind;

/// `outcome.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Outcome {
    pub kind: JobKind,
    pub status: OutcomeStatus,
    /// Why the test ended, as a word for programs: `max_strain`, `force_dropped`, ...
    pub stop_reason: String,
    /// Results by name.
    pub summary: IndexMap<String, Quantity>,
    /// What tells whether to believe the results.
    pub quality: IndexMap<String, QualityCheck>,
    pub cost: Cost,
    pub provenance: Provenance,
    pub warnings: Vec<Warning>,
    /// Every body of a granular scene of fewer than 1000.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bodies: Vec<BodyProperties>,
    /// Every other file of the result.
    pub files: Vec<FileEntry>,
}

/// Whether the simulation ran to its own end. A failed simulation has no outcome file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum OutcomeStatus {
    Succeeded,
}

/// The part of an outcome that follows from the spec alone: the same on every machine.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Report {
    pub stop_reason: String,
    pub summary: IndexMap<String, Quantity>,
    pub quality: IndexMap<String, QualityCheck>,
    pub warnings: Vec<Warning>,
    /// Bodies described one by one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bodies: Vec<BodyProperties>,
    /// Work done, by name: `newton_iterations`, `bond_evaluations`, ...
    pub work: IndexMap<String, u64>,
}

/// A value with its unit; `"1"` marks a dimensionless one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Quantity {
    /// `null` where the test did not get far enough to know it.
    pub value: Option<f64>,
    /// Why it is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    pub unit: String,
    /// Standard deviation over the repeats of a test, in the unit of the value, which is their mean.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deviation: Option<f64>,
    /// Lower and upper end of the 95 % confidence interval of the mean over repeats, by Student's
    /// t, in the unit of the value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interval: Option<[f64; 2]>,
    /// Repeats that know the value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub n: Option<u32>,
    /// How wrong the value may be. Absent where that is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<ErrorEstimate>,
    /// A sentence on what it is, for people.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub description: String,
}

/// How wrong a value may be, in its unit: one standard error.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ErrorEstimate {
    /// All parts together: the root of the sum of their squares.
    pub value: f64,
    pub parts: Vec<ErrorPart>,
}

/// What one source adds to an error.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ErrorPart {
    /// `grid`, `solver`, `time_step`, `specimens`, ...
    pub source: String,
    pub value: f64,
    pub basis: ErrorBasis,
    /// What would make it a tenth, where that is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tenth: Option<Tenth>,
}

/// What buys a digit: a change of the spec that makes a part of an error a tenth of what it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Tenth {
    /// What to change, in words.
    pub change: String,
    /// Time that the job would then take over what it takes now, about.
    pub time_factor: f64,
}

impl ErrorPart {
    /// Of which is not known what would make it less.
    pub fn new(source: &str, value: f64, basis: ErrorBasis) -> Self {
        Self {
            source: source.to_owned(),
            value,
            basis,
            tenth: None,
        }
    }

    /// With what would make it a tenth.
    #[must_use]
    pub fn with_tenth(self, tenth: Option<Tenth>) -> Self {
        Self { tenth, ..self }
    }
}

/// Where an error's size is known from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ErrorBasis {
    /// A table measured before, for specs like this one.
    MeasuredTable,
    /// The same job on coarser grids.
    TwoGrids,
    /// The same job by another solver.
    TwoSolvers,
    /// The scatter of the job's repeats.
    Repeats,
    /// What another result, by which this one is read, is off: what this one would be beside it.
    Propagated,
}

/// A body at the end of a test.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BodyProperties {
    /// Its number in the spec.
    pub body: u32,
    pub mass_kg: f64,
    /// Centre of mass.
    pub centre_m: [f64; 3],
    /// About the centre of mass, rows of the tensor in the global frame.
    pub inertia_kg_m2: [[f64; 3]; 3],
}

/// A measure of quality, and the bound beyond which a warning is attached.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct QualityCheck {
    pub value: f64,
    pub unit: String,
    /// The value should not exceed this.
    pub bound: f64,
    pub ok: bool,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub description: String,
}

/// Something a reader of the result should know.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Warning {
    pub code: String,
    pub detail: String,
}

/// What the run took.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Cost {
    /// Wall time [s] over all attempts that contributed.
    pub wall_s: f64,
    /// Processor time [s].
    pub cpu_s: f64,
    pub threads: u32,
    /// Largest resident memory of the process that finished the job [MB].
    pub peak_memory_mb: f64,
    /// Work counters by name.
    pub work: IndexMap<String, u64>,
}

/// Where the result comes from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Provenance {
    /// SHA-256 of the normalised spec, all defaults written out.
    pub spec_sha256: String,
    pub engine_version: String,
    pub engine_commit: String,
    pub seed: u64,
    pub threads: u32,
    /// RFC 3339.
    pub started_at: String,
    pub host: String,
}

/// A file of the result.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct FileEntry {
    /// Relative path with `/`, such as `snapshots/step_00010.vtp`.
    pub name: String,
    pub bytes: u64,
    pub sha256: String,
}

impl Quantity {
    /// A known value.
    pub fn new(value: f64, unit: &str, description: &str) -> Self {
        Self {
            value: value.is_finite().then_some(value),
            reason: None,
            unit: unit.to_owned(),
            deviation: None,
            interval: None,
            n: None,
            error: None,
            description: description.to_owned(),
        }
    }

    /// With why it is not known, where it is not.
    #[must_use]
    pub fn or_because(mut self, reason: &str) -> Self {
        self.reason = self.value.is_none().then(|| reason.to_owned());
        self
    }

    /// With how wrong it may be; parts that are not numbers are left out.
    #[must_use]
    pub fn with_error(mut self, parts: Vec<ErrorPart>) -> Self {
        let parts: Vec<ErrorPart> = parts
            .into_iter()
            .filter(|part| part.value.is_finite())
            .collect();
        if !parts.is_empty() {
            let squares: f64 = parts.iter().map(|part| part.value * part.value).sum();
            self.error = Some(ErrorEstimate {
                value: squares.sqrt(),
                parts,
            });
        }
        self
    }
}

impl QualityCheck {
    /// A check that is good up to and including `bound`. A value that is not a number is bad.
    pub fn at_most(value: f64, bound: f64, unit: &str, description: &str) -> Self {
        Self {
            value: if value.is_finite() { value } else { f64::MAX },
            unit: unit.to_owned(),
            bound,
            ok: value <= bound,
            description: description.to_owned(),
        }
    }
}
