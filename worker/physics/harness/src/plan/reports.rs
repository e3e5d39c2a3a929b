//! What the reports of several tests say together.
use indexmap::IndexMap;
use loadframe_api::{QualityCheck, Quantity, Report, Warning};
use serde::{Deserialize, Serialize};

use crate::{
    checkpoint::{self, CheckpointError},
    statistics::Sample,
};

/// A report within a checkpoint: as JSON, because a report leaves out what is empty and the form of
/// checkpoints cannot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SavedReport(String);

impl SavedReport {
    /// # Errors
    /// [`CheckpointError::Form`] when the report does not serialize.
    pub fn of(report: &Report) -> Result<Self, CheckpointError> {
        serde_json::to_string(report)
            .map(Self)
            .map_err(checkpoint::form)
    }

    /// # Errors
    /// [`CheckpointError::Form`] when this is no report.
    pub fn read(&self) -> Result<Report, CheckpointError> {
        serde_json::from_str(&self.0).map_err(checkpoint::form)
    }
}

/// The worst value of each check, whose bound is that of the first report.
pub fn worst_quality(reports: &[Report], words: &str) -> IndexMap<String, QualityCheck> {
    let mut quality = reports
        .first()
        .map_or_else(IndexMap::new, |r| r.quality.clone());
    for (name, check) in &mut quality {
        let found = reports.iter().filter_map(|report| report.quality.get(name));
        let worst = found.map(|check| check.value).fold(0.0, f64::max);
        let description = format!("{} {words}", check.description);
        *check = QualityCheck::at_most(worst, check.bound, &check.unit, &description);
    }
    quality
}

/// The sum of each work counter.
pub fn total_work(reports: &[Report]) -> IndexMap<String, u64> {
    let mut work = IndexMap::new();
    for (name, count) in reports.iter().flat_map(|report| &report.work) {
        *work.entry(name.clone()).or_default() += count;
    }
    work
}

/// The known values of a result, in the order of the repeats.
pub fn values(reports: &[Report], name: &str) -> Vec<f64> {
    let found = reports.iter().filter_map(|report| report.summary.get(name));
    found.filter_map(|quantity| quantity.value).collect()
}

/// The mean of a result's values with their scatter.
pub fn mean(quantity: &Quantity, values: &[f64]) -> Quantity {
    let sample = Sample::of(values);
    Quantity {
        value: sample.map(|sample| sample.mean),
        deviation: sample.and_then(|sample| sample.deviation),
        interval: sample.and_then(|sample| sample.interval),
        n: Some(sample.map_or(0, |sample| sample.count)),
        ..quantity.clone()
    }
}

/// Each sort of warning once, in the words of the first of the `tests` that has it; their seeds count
/// on from the first.
pub fn joint_warnings(first_seed: u64, tests: &str, reports: &[Report]) -> Vec<Warning> {
    let mut sorts = IndexMap::<&str, (u64, &str, usize)>::new();
    for (seed, report) in (first_seed..).zip(reports) {
        for warning in &report.warnings {
            let first = (seed, warning.detail.as_str(), 0);
            sorts.entry(&warning.code).or_insert(first).2 += 1;
        }
    }
    let total = reports.len();
    let sorts = sorts.into_iter();
    sorts
        .map(|(code, (seed, detail, count))| Warning {
            code: code.to_owned(),
            detail: format!("in {count} of {total} {tests}, first with seed {seed}: {detail}"),
        })
        .collect()
}
