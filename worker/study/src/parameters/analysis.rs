//! What the tests of each case say together.
use indexmap::{IndexMap, IndexSet};
use loadframe_api::JobKind;
use loadframe_physics::Sample;
use serde::Serialize;
use serde_json::Value;

use super::design::{Design, DesignCase};
use super::finding::Finding;
use crate::study::runs_file::{mean_time, unit};
use crate::study::{Design as _, Finished};
use crate::{ENGINE_COMMIT, ENGINE_VERSION};

/// The result of a study: `parameters.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Study {
    pub title: String,
    pub source: String,
    pub statement: String,
    pub kind: JobKind,
    pub engine_version: String,
    pub engine_commit: String,
    pub seeds: Vec<u64>,
    /// Processor time of all tests of the study [s].
    pub total_cpu_s: f64,
    pub cases: Vec<CaseRow>,
    /// What the numbers say, by result, of those that tables show and in their order.
    pub findings: IndexMap<String, Finding>,
    /// Results that were asked for and that no test told.
    pub unknown_results: Vec<String>,
}

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

impl Study {
    /// `finished`: the tests at each setting of the design, in the order of its seeds.
    pub(super) fn of(design: &Design, finished: &[Vec<Finished>]) -> Self {
        let tests = || design.cases.iter().flat_map(|case| &finished[case.setting]);
        let known: IndexSet<&String> = tests().flat_map(|test| test.results.keys()).collect();
        let units: IndexMap<&str, String> = known
            .iter()
            .map(|name| {
                let mut units = design
                    .cases
                    .iter()
                    .map(|case| unit(&finished[case.setting], name));
                (
                    name.as_str(),
                    units.find(|unit| !unit.is_empty()).unwrap_or_default(),
                )
            })
            .collect();
        let (asked, unknown_results): (Vec<String>, Vec<String>) = match design.results.as_slice() {
            [] => {
                let (_, spec) = design.settings().get(0);
                let compared = known.iter().filter(|name| spec.compares(name));
                (compared.map(|name| (*name).clone()).collect(), Vec::new())
            }
            asked => asked.iter().cloned().partition(|name| known.contains(name)),
        };
        let cases = design.cases.iter();
        let cases: Vec<CaseRow> = cases
            .map(|case| row(design, case, &finished[case.setting], &units))
            .collect();
        let findings = asked.into_iter().map(|name| {
            let finding = Finding::of(&name, &cases);
            (name, finding)
        });
        let findings = findings.collect();
        Self {
            title: design.title.clone(),
            source: design.source.clone(),
            statement: design.statement.clone(),
            kind: design.kind,
            engine_version: ENGINE_VERSION.to_owned(),
            engine_commit: ENGINE_COMMIT.to_owned(),
            seeds: design.settings().seeds().to_vec(),
            total_cpu_s: finished.iter().flatten().map(|test| test.cpu_s).sum(),
            cases,
            findings,
            unknown_results,
        }
    }
}

fn row(
    design: &Design,
    case: &DesignCase,
    finished: &[Finished],
    units: &IndexMap<&str, String>,
) -> CaseRow {
    let results = units.iter().map(|(name, unit)| {
        let known: Vec<f64> = finished
            .iter()
            .filter_map(|test| test.value(name))
            .collect();
        let sample = Sample::of(&known);
        let result = CaseResult {
            unit: unit.clone(),
            mean: sample.map(|sample| sample.mean),
            deviation: sample.and_then(|sample| sample.deviation),
            interval: sample.and_then(|sample| sample.interval),
            n: sample.map_or(0, |sample| sample.count),
        };
        ((*name).to_owned(), result)
    });
    let mut warnings = IndexMap::new();
    for code in finished.iter().flat_map(|test| &test.warnings) {
        *warnings.entry(code.clone()).or_insert(0) += 1;
    }
    let seeds = design.settings().seeds().iter();
    let tests = seeds.zip(finished).map(|(seed, test)| Test {
        seed: *seed,
        cpu_s: test.cpu_s,
        warnings: test.warnings.clone(),
        values: units.keys().map(|name| test.value(name)).collect(),
    });
    CaseRow {
        label: case.label.clone(),
        set: case.set.clone(),
        spec_sha256: design.settings().get(case.setting).0.to_owned(),
        cpu_s: mean_time(finished),
        doubtful: finished
            .iter()
            .filter(|test| !test.warnings.is_empty())
            .count(),
        warnings,
        results: results.collect(),
        tests: tests.collect(),
    }
}

impl CaseResult {
    /// What it says of its population, where a test got that far.
    pub(super) fn sample(&self) -> Option<Sample> {
        Some(Sample {
            count: self.n,
            mean: self.mean?,
            deviation: self.deviation,
            interval: self.interval,
        })
    }
}
