//! What the tests of a study say: errors against the finest setting, scatter, time.
use indexmap::IndexMap;
use loadframe_api::JobKind;
use loadframe_physics::Sample;
use loadframe_run::Engine;
use serde::Serialize;

use super::design::{Design, Line};
use crate::runs_file::{Finished, mean_time, unit};
use crate::settings::Settings;

/// Numbers of repeats whose mean is told.
const REPEATS: [u32; 6] = [1, 3, 5, 10, 30, 100];

/// The result of a study: `accuracy.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Study {
    pub kind: JobKind,
    /// Of the spec with the study's first seed, at its own setting.
    pub spec_sha256: String,
    pub engine_version: String,
    pub engine_commit: String,
    pub seeds: Vec<u64>,
    /// Processor time of one test at the spec's own setting [s], the mean over seeds.
    pub cpu_s: f64,
    /// Processor time of all tests of the study [s].
    pub total_cpu_s: f64,
    /// How specimens differ at the spec's own setting, by result.
    pub scatter: IndexMap<String, Scatter>,
    pub knobs: Vec<KnobStudy>,
    /// What the mean of several tests would be known to, by the scatter.
    pub repeats: Vec<RepeatsRow>,
}

/// A result over the seeds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scatter {
    pub unit: String,
    /// `null` where no test knows the value.
    pub mean: Option<f64>,
    /// Standard deviation over |mean| [-], from two seeds on.
    pub relative_deviation: Option<f64>,
}

/// One knob over its values, the others as the spec has them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KnobStudy {
    pub knob: &'static str,
    pub description: &'static str,
    /// Whether tests are compared one by one, or only their means.
    pub keeps_specimen: bool,
    /// The reference last.
    pub rows: Vec<Row>,
}

/// A setting.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    pub value: String,
    /// Whether it is the spec's own.
    pub is_present: bool,
    pub is_reference: bool,
    /// Processor time of one test [s], the mean over seeds.
    pub cpu_s: f64,
    /// In that of the spec's own setting.
    pub time: f64,
    /// Tests whose quality was out of bounds.
    pub doubtful: usize,
    /// By result; `null` where it cannot be known.
    pub errors: IndexMap<String, Option<Error>>,
}

/// Relative error of a result [-]: its difference from that at the reference over |that|.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Error {
    /// Mean over seeds, with its sign; or the difference of the means.
    pub mean: f64,
    /// Standard error of that mean, from two seeds on.
    pub standard_error: Option<f64>,
    /// Root mean square over seeds, where tests are compared one by one.
    pub rms: Option<f64>,
    /// The largest over seeds, likewise.
    pub worst: Option<f64>,
    /// Seeds that know it.
    pub n: u32,
}

/// The mean of so many tests.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RepeatsRow {
    pub repeats: u32,
    /// Standard error of the mean over |mean| [-] by result: relative deviation over √n.
    pub errors: IndexMap<String, Option<f64>>,
}

impl Error {
    /// What one test is typically off; the difference of the means where only these compare.
    pub fn size(&self) -> f64 {
        self.rms.unwrap_or(self.mean.abs())
    }
}

impl crate::design::Design for Design {
    type Findings = Study;

    fn settings(&self) -> &Settings {
        &self.settings
    }

    fn describe(&self, setting: usize) -> String {
        let named = self.lines.iter().find_map(|line| {
            let point = line.points.iter().find(|point| point.setting == setting)?;
            Some(format!("{}={}", line.knob.name, point.label))
        });
        named.unwrap_or_else(|| "the spec's own setting".to_owned())
    }

    fn findings(&self, engine: Engine, finished: &[Vec<Finished>]) -> Study {
        Study::of(engine, self, finished)
    }
}

impl Study {
    /// `finished`: the tests at each setting of the design, in the order of its seeds.
    fn of(engine: Engine, design: &Design, finished: &[Vec<Finished>]) -> Self {
        let present = &finished[design.present];
        let (sha256, spec) = design.settings.get(design.present);
        // a test that had no result names none
        let first = present.iter().find(|test| !test.results.is_empty());
        let results = first.into_iter().flat_map(|test| test.results.keys());
        let names: Vec<&String> = results.filter(|name| spec.compares(name)).collect();
        let cpu_s = mean_time(present);
        let scatter: IndexMap<String, Scatter> = names
            .iter()
            .map(|name| ((*name).clone(), scatter(present, name)))
            .collect();
        let repeats = REPEATS.iter().map(|repeats| RepeatsRow {
            repeats: *repeats,
            errors: scatter
                .iter()
                .map(|(name, scatter)| {
                    let one = scatter.relative_deviation;
                    (
                        name.clone(),
                        one.map(|one| one / f64::from(*repeats).sqrt()),
                    )
                })
                .collect(),
        });
        Self {
            kind: spec.kind(),
            spec_sha256: sha256.to_owned(),
            engine_version: engine.version.to_owned(),
            engine_commit: engine.commit.to_owned(),
            seeds: design.settings.seeds().to_vec(),
            cpu_s,
            total_cpu_s: finished.iter().flatten().map(|test| test.cpu_s).sum(),
            knobs: design
                .lines
                .iter()
                .map(|line| knob(line, design.present, finished, &names, cpu_s))
                .collect(),
            repeats: repeats.collect(),
            scatter,
        }
    }
}

fn knob(
    line: &Line,
    present: usize,
    finished: &[Vec<Finished>],
    names: &[&String],
    present_cpu_s: f64,
) -> KnobStudy {
    let last = line.points.len() - 1;
    let reference = &finished[line.points[last].setting];
    let compare = if line.knob.keeps_specimen {
        one_by_one
    } else {
        by_mean
    };
    let rows = line.points.iter().enumerate().map(|(index, point)| {
        let tests = &finished[point.setting];
        let cpu_s = mean_time(tests);
        let errors = names.iter().map(|name| {
            let error = compare(&values(tests, name), &values(reference, name));
            ((*name).clone(), error)
        });
        Row {
            value: point.label.clone(),
            is_present: point.setting == present,
            is_reference: index == last,
            cpu_s,
            time: cpu_s / present_cpu_s,
            doubtful: tests.iter().filter(|test| !test.is_good).count(),
            errors: errors.collect(),
        }
    });
    KnobStudy {
        knob: line.knob.name,
        description: line.knob.description,
        keeps_specimen: line.knob.keeps_specimen,
        rows: rows.collect(),
    }
}

/// A result by seed.
fn values(tests: &[Finished], name: &str) -> Vec<Option<f64>> {
    tests.iter().map(|test| test.value(name)).collect()
}

fn scatter(tests: &[Finished], name: &str) -> Scatter {
    let known: Vec<f64> = values(tests, name).into_iter().flatten().collect();
    let sample = Sample::of(&known);
    Scatter {
        unit: unit(tests, name),
        mean: sample.map(|sample| sample.mean),
        relative_deviation: sample
            .and_then(|s| Some(s.deviation? / s.mean.abs()))
            .filter(finite),
    }
}

/// Errors of the tests of each seed.
fn one_by_one(found: &[Option<f64>], reference: &[Option<f64>]) -> Option<Error> {
    let pairs = found.iter().zip(reference);
    let errors = pairs.filter_map(|(found, reference)| relative((*found)?, (*reference)?));
    let errors: Vec<f64> = errors.collect();
    let sample = Sample::of(&errors)?;
    let squares: f64 = errors.iter().map(|error| error * error).sum();
    let worst = errors
        .iter()
        .fold(0.0, |worst: f64, error| worst.max(error.abs()));
    let count = f64::from(sample.count);
    Some(Error {
        mean: sample.mean,
        standard_error: sample.deviation.map(|deviation| deviation / count.sqrt()),
        rms: Some((squares / count).sqrt()),
        worst: Some(worst),
        n: sample.count,
    })
}

/// Difference of the means, whose errors add in squares: the specimens differ.
fn by_mean(found: &[Option<f64>], reference: &[Option<f64>]) -> Option<Error> {
    if found == reference {
        return one_by_one(found, reference);
    }
    let sample = |values: &[Option<f64>]| {
        let known: Vec<f64> = values.iter().copied().flatten().collect();
        Sample::of(&known)
    };
    let (found, reference) = (sample(found)?, sample(reference)?);
    let variance = |sample: Sample| Some(sample.deviation?.powi(2) / f64::from(sample.count));
    let standard_error = variance(found)
        .zip(variance(reference))
        .map(|(a, b)| (a + b).sqrt());
    Some(Error {
        mean: relative(found.mean, reference.mean)?,
        standard_error: standard_error.map(|error| error / reference.mean.abs()),
        rms: None,
        worst: None,
        n: found.count.min(reference.count),
    })
}

/// (found − reference)/|reference|; 0 for equal values, `None` where the reference is zero.
#[allow(
    clippy::float_cmp,
    reason = "the same number twice has no error, whatever it is"
)]
fn relative(found: f64, reference: f64) -> Option<f64> {
    if found == reference {
        return Some(0.0);
    }
    Some((found - reference) / reference.abs()).filter(finite)
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "a predicate of filter")]
fn finite(value: &f64) -> bool {
    value.is_finite()
}
