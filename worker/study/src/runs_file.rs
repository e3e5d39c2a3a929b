//! Finished tests of a study, a line of JSON each, so that an interrupted study goes on.
use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::Path;

use indexmap::IndexMap;
use loadframe_api::Report;
use loadframe_physics::SimulationError;
use loadframe_run::Engine;
use serde::{Deserialize, Serialize};

const RUNS_FILE: &str = "runs.jsonl";

/// A finished test.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finished {
    pub(super) spec_sha256: String,
    pub(super) engine_commit: String,
    /// Processor time [s].
    pub(super) cpu_s: f64,
    /// Whether all measures of quality were within their bounds.
    pub(super) is_good: bool,
    /// Codes of the warnings, each once.
    pub(super) warnings: Vec<String>,
    /// All results with their units; `null` where the test did not get that far.
    pub(super) results: IndexMap<String, (Option<f64>, String)>,
    /// Why there are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) failure: Option<String>,
}

/// What a test without result warns of.
const NO_RESULT: &str = "no_result";

impl Finished {
    pub(super) fn new(engine: Engine, spec_sha256: &str, cpu_s: f64, report: Report) -> Self {
        let mut warnings = Vec::new();
        for warning in report.warnings {
            if !warnings.contains(&warning.code) {
                warnings.push(warning.code);
            }
        }
        let results = report.summary.into_iter();
        Self {
            spec_sha256: spec_sha256.to_owned(),
            engine_commit: engine.commit.to_owned(),
            cpu_s,
            is_good: report.quality.values().all(|check| check.ok),
            warnings,
            results: results
                .map(|(name, quantity)| (name, (quantity.value, quantity.unit)))
                .collect(),
            failure: None,
        }
    }

    /// A test that its own spec made impossible: also a finding.
    pub(super) fn without_result(
        engine: Engine,
        spec_sha256: &str,
        cpu_s: f64,
        error: &SimulationError,
    ) -> Self {
        Self {
            spec_sha256: spec_sha256.to_owned(),
            engine_commit: engine.commit.to_owned(),
            cpu_s,
            is_good: false,
            warnings: vec![NO_RESULT.to_owned()],
            results: IndexMap::new(),
            failure: Some(error.to_string()),
        }
    }

    /// A result, where the test got that far.
    pub(super) fn value(&self, name: &str) -> Option<f64> {
        self.results.get(name).and_then(|(value, _)| *value)
    }
}

/// The unit of a result, as the first of `tests` that has it tells.
pub(super) fn unit(tests: &[Finished], name: &str) -> String {
    let mut units = tests.iter().filter_map(|test| test.results.get(name));
    units
        .next()
        .map_or_else(String::new, |(_, unit)| unit.clone())
}

/// Processor time of a test [s], the mean over `tests`.
pub(super) fn mean_time(tests: &[Finished]) -> f64 {
    tests.iter().map(|test| test.cpu_s).sum::<f64>() / tests.len() as f64
}

/// The file, open for more.
#[derive(Debug)]
pub(super) struct RunsFile(File);

impl RunsFile {
    /// Opens the file in `folder`, with the tests of this engine found there, by their spec.
    pub(super) fn open(
        folder: &Path,
        engine: Engine,
    ) -> io::Result<(Self, HashMap<String, Finished>)> {
        std::fs::create_dir_all(folder)?;
        let path = folder.join(RUNS_FILE);
        let text = match std::fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => String::new(),
            Err(error) => return Err(error),
        };
        // a line that a crash cut short is not a test
        let tests = text
            .lines()
            .filter_map(|line| serde_json::from_str(line).ok());
        let tests = tests.filter(|test: &Finished| test.engine_commit == engine.commit);
        let known = tests.map(|test| (test.spec_sha256.clone(), test)).collect();
        let mut file = OpenOptions::new().create(true).append(true).open(path)?;
        if !text.is_empty() && !text.ends_with('\n') {
            writeln!(file)?;
        }
        Ok((Self(file), known))
    }

    pub(super) fn add(&mut self, test: &Finished) -> io::Result<()> {
        let line = serde_json::to_string(test)?;
        writeln!(self.0, "{line}")
    }
}
