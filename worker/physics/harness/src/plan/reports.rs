//! What the reports of several tests say together.
use std::io;

use indexmap::IndexMap;
use loadframe_api::{ErrorBasis, ErrorPart, QualityCheck, Quantity, Report, Tenth, Warning};
use serde::{Deserialize, Serialize};

use crate::{
    Recorder,
    checkpoint::{self, CheckpointError},
    csv,
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
pub(super) fn total_work(reports: &[Report]) -> IndexMap<String, u64> {
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
        // where one knows it, it is known
        reason: quantity.reason.clone().filter(|_| sample.is_none()),
        ..quantity.clone()
    }
}

/// The joint report of repeats, whose seeds count on from the first: means with their scatter, the worst
/// quality, all warnings. The first gives the words.
pub(super) fn join_repeats(first_seed: u64, reports: &[Report]) -> Report {
    let mut joint = reports.first().cloned().unwrap_or_default();
    for (name, quantity) in &mut joint.summary {
        *quantity = mean(quantity, &values(reports, name)).with_error(errors(reports, name));
    }
    joint.quality = worst_quality(reports, "The worst of all repeats.");
    joint.warnings = joint_warnings(first_seed, "repeats", reports);
    let mut others = reports.iter().skip(1);
    if reports.len() > 1 && others.all(|report| report.summary == reports[0].summary) {
        joint.warnings.push(Warning {
            code: "repeats_alike".to_owned(),
            detail: "all repeats gave the same: nothing that counts in this test is drawn at \
                     random, and one repeat says as much"
                .to_owned(),
        });
    }
    joint.work = total_work(reports);
    joint
}

/// The part of an error that other specimens make.
const SPECIMENS: &str = "specimens";

/// How wrong the mean of a result is: what each repeat says of itself, which grids and solvers do to
/// all of them alike, and what the scatter leaves open. What a repeat says of another specimen is not among
/// it: the scatter tells. Nothing where repeats say nothing.
fn errors(reports: &[Report], name: &str) -> Vec<ErrorPart> {
    let told = reports
        .iter()
        .filter_map(|report| report.summary.get(name)?.error.as_ref());
    let told: Vec<_> = told.collect();
    let Some(first) = told.first() else {
        return Vec::new();
    };
    let mean_of = |one: &ErrorPart| {
        let parts = told.iter().flat_map(|error| &error.parts);
        // a source may have two parts, each known from elsewhere
        let values = parts.filter(|part| (&part.source, part.basis) == (&one.source, one.basis));
        values.map(|part| part.value).sum::<f64>() / told.len() as f64
    };
    let mut parts: Vec<ErrorPart> = first
        .parts
        .iter()
        .filter(|part| part.source != SPECIMENS)
        .map(|part| ErrorPart {
            value: mean_of(part),
            ..part.clone()
        })
        .collect();
    let sample = Sample::of(&values(reports, name));
    parts.extend(sample.and_then(|sample| sampling(sample.deviation?, sample.count)));
    parts
}

/// What the scatter of repeats leaves open of their mean: its standard error.
fn sampling(deviation: f64, count: u32) -> Option<ErrorPart> {
    // the standard error falls with the root of their number
    let tenth = Tenth {
        change: format!("100 times as many repeats ({})", 100 * u64::from(count)),
        time_factor: 100.0,
    };
    (count > 1).then(|| {
        let open = deviation / f64::from(count).sqrt();
        ErrorPart::new(SPECIMENS, open, ErrorBasis::Repeats).with_tenth(Some(tenth))
    })
}

/// Gives means over repeats that know nothing else of their error the part that their scatter leaves
/// open; for kinds whose guide says what else was not looked at.
pub(super) fn add_sampling_errors(joint: &mut Report) {
    for quantity in joint.summary.values_mut() {
        let scatter = quantity.deviation.zip(quantity.n);
        if let (None, Some((deviation, count))) = (&quantity.error, scatter) {
            let part = sampling(deviation, count);
            *quantity = quantity.clone().with_error(part.into_iter().collect());
        }
    }
}

/// `repeats.csv`: seed and results of every repeat.
///
/// # Errors
/// Of the recorder.
pub(super) fn write_repeats(
    first_seed: u64,
    reports: &[Report],
    recorder: &mut dyn Recorder,
) -> io::Result<()> {
    recorder.file("repeats.csv", &mut |out| {
        let Some(first) = reports.first() else {
            return Ok(());
        };
        let results = first.summary.iter();
        let results = results.map(|(name, quantity)| csv::column(name, &quantity.unit));
        let names: Vec<String> = ["repeat".to_owned(), "seed".to_owned()]
            .into_iter()
            .chain(results)
            .collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        csv::header(out, &names)?;
        for (index, report) in reports.iter().enumerate() {
            let mut row = vec![(index + 1) as f64, (first_seed + index as u64) as f64];
            let results = first.summary.keys().map(|name| report.summary.get(name));
            row.extend(results.map(|found| found.and_then(|q| q.value).unwrap_or(f64::NAN)));
            csv::row(out, &row)?;
        }
        Ok(())
    })
}

/// Each sort of warning once, in the words of the first of the `tests` that has it; their seeds count
/// on from the first.
pub fn joint_warnings(first_seed: u64, tests: &str, reports: &[Report]) -> Vec<Warning> {
    let mut sorts = IndexMap::<&str, (u64, &str, usize)>::new();
    for (seed, report) in (first_seed..).zip(reports) {
        for (place, warning) in report.warnings.iter().enumerate() {
            let first = (seed, warning.detail.as_str(), 0);
            let sort = sorts.entry(&warning.code).or_insert(first);
            // a test may have several of a sort, and counts once
            let before = &report.warnings[..place];
            if before.iter().all(|other| other.code != warning.code) {
                sort.2 += 1;
            }
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
