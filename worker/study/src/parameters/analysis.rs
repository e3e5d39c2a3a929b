//! What the tests of each case say together.
use indexmap::{IndexMap, IndexSet};
use loadframe_api::JobKind;
use loadframe_physics::Sample;
use loadframe_run::Engine;
use serde::Serialize;

use super::case::{CaseResult, CaseRow, Test};
use super::design::{Design, DesignCase};
use super::finding::Finding;
use crate::runs_file::{Finished, mean_time, unit};
use crate::settings::Settings;

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

impl crate::design::Design for Design {
    type Findings = Study;

    fn settings(&self) -> &Settings {
        &self.settings
    }

    fn describe(&self, setting: usize) -> String {
        let named = self.cases.iter().find(|case| case.setting == setting);
        named.map_or_else(String::new, |case| format!("case {:?}", case.label))
    }

    fn findings(&self, engine: Engine, finished: &[Vec<Finished>]) -> Study {
        Study::of(engine, self, finished)
    }
}

impl Study {
    /// `finished`: the tests at each setting of the design, in the order of its seeds.
    fn of(engine: Engine, design: &Design, finished: &[Vec<Finished>]) -> Self {
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
                let (_, spec) = design.settings.get(0);
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
            engine_version: engine.version.to_owned(),
            engine_commit: engine.commit.to_owned(),
            seeds: design.settings.seeds().to_vec(),
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
    let seeds = design.settings.seeds().iter();
    let tests = seeds.zip(finished).map(|(seed, test)| Test {
        seed: *seed,
        cpu_s: test.cpu_s,
        warnings: test.warnings.clone(),
        values: units.keys().map(|name| test.value(name)).collect(),
    });
    CaseRow {
        label: case.label.clone(),
        set: case.set.clone(),
        spec_sha256: design.settings.get(case.setting).0.to_owned(),
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
