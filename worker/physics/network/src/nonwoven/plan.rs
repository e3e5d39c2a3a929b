//! The tests of a job: repeats of a specimen, each in one or two directions.
//!
//! A job of one test goes straight to [`super::run_one`]; otherwise its tests are those of a
//! [`Plan`], and their results are joined here.
use loadframe_api::{
    Report,
    spec::nonwoven_tensile::{Direction, NonwovenTensile},
};
use loadframe_harness::{
    Ending, Interrupt, Recorder, RunContext, SimulationError,
    checkpoint::Fingerprint,
    plan::{
        Conclusion, Curve, CurveKeeper, Plan, SavedReport, Share, Tests, join_repeats,
        write_repeats,
    },
};
use serde::{Deserialize, Serialize};

use super::{directions, repeats};

/// Leading columns of the curve that are kept of every test: nominal strain and force.
const KEPT_COLUMNS: usize = 2;

/// What is kept of a finished test.
#[derive(Debug, Serialize, Deserialize)]
struct Finished {
    report: SavedReport,
    curve: Curve,
}

/// Runs everything `spec` asks for.
///
/// # Errors
/// What made a result impossible, see [`SimulationError`].
pub fn run(
    spec: &NonwovenTensile,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Ending, SimulationError> {
    if tests(spec) <= 1 {
        return super::run_one(spec, context, recorder);
    }
    let fingerprint = Fingerprint::of(spec)?;
    let plan = match context.checkpoint {
        Some(bytes) => Plan::resume(fingerprint, bytes, recorder)?,
        None => {
            recorder.log(&overview(spec));
            Plan::new(fingerprint, tests(spec))
        }
    };
    let finished = match plan.carry_out(&Repeats(spec), context, recorder)? {
        Conclusion::Finished(finished) => finished,
        Conclusion::Interrupted(Interrupt::Cancel) => return Ok(Ending::Cancelled),
        Conclusion::Interrupted(Interrupt::Suspend) => return Ok(Ending::Suspended),
    };
    let reports = finished.iter().map(|test| test.report.read());
    let reports: Vec<Report> = reports.collect::<Result<_, _>>()?;
    for (index, report) in reports.iter().enumerate() {
        recorder.log(&line(spec, index, report));
    }
    let per_repeat = reports.chunks(tests_per_repeat(spec));
    let reports: Vec<Report> = per_repeat
        .map(|reports| directions::join(&spec.test.directions, reports))
        .collect();
    let report = match reports.as_slice() {
        [report] => report.clone(),
        reports => {
            write_repeats(spec.seed, reports, recorder)?;
            for direction in 0..tests_per_repeat(spec) {
                let name = share(spec, direction).name("repeats_curves.csv");
                let tests = finished.iter().skip(direction);
                let tests = tests.step_by(tests_per_repeat(spec));
                let curves = tests.map(|test| &test.curve);
                repeats::write_curves(&name, curves, recorder)?;
            }
            join_repeats(spec.seed, reports)
        }
    };
    recorder.progress(1.0, "finished");
    Ok(Ending::Finished(report))
}

/// Tests in each repeat.
fn tests_per_repeat(spec: &NonwovenTensile) -> usize {
    spec.test.directions.len().max(1)
}

/// Tests of the job: the directions of each repeat after one another.
fn tests(spec: &NonwovenTensile) -> usize {
    spec.test.repeats as usize * tests_per_repeat(spec)
}

/// Number of the repeat and direction of test number `index`.
fn place(spec: &NonwovenTensile, index: usize) -> (u64, Option<Direction>) {
    let count = tests_per_repeat(spec);
    let direction = spec.test.directions.get(index % count);
    ((index / count) as u64, direction.copied())
}

/// The spec of test number `index`, on its own.
fn spec_of(spec: &NonwovenTensile, index: usize) -> NonwovenTensile {
    let (repeat, direction) = place(spec, index);
    let mut own = spec.clone();
    own.test.repeats = 1;
    own.test.directions = direction.into_iter().collect();
    own.seed += repeat;
    if repeat > 0 {
        // nobody would see them
        own.output.snapshot_every_steps = 0;
        own.output.force_distribution_strains.clear();
    }
    own
}

/// What the job shows of test number `index`: the first repeat, its first direction as its own.
fn share(spec: &NonwovenTensile, index: usize) -> Share {
    match place(spec, index) {
        _ if index == 0 => Share::All,
        (0, Some(direction)) => Share::Folder(directions::suffix(direction)),
        _ => Share::Nothing,
    }
}

/// A log line on a finished test.
fn line(spec: &NonwovenTensile, index: usize, report: &Report) -> String {
    let (repeat, direction) = place(spec, index);
    let along = match direction {
        Some(direction) if tests_per_repeat(spec) > 1 => format!(" along {}", direction.name()),
        _ => String::new(),
    };
    let value = |name: &str| report.summary.get(name).and_then(|quantity| quantity.value);
    format!(
        "seed {}{along}: {}, maximum force {} N, {} bonds broken",
        spec.seed + repeat,
        report.stop_reason.replace('_', " "),
        value("max_force").unwrap_or(f64::NAN),
        value("broken_bonds").unwrap_or(f64::NAN),
    )
}

/// What is going to be done.
fn overview(spec: &NonwovenTensile) -> String {
    let repeats = spec.test.repeats;
    let last = spec.seed + u64::from(repeats.saturating_sub(1));
    let specimens = match repeats {
        1 => "one specimen".to_owned(),
        _ => format!("{repeats} repeats, seeds {} to {last}", spec.seed),
    };
    match spec.test.directions.as_slice() {
        [first, second] => {
            let (first, second) = (first.name(), second.name());
            format!("{specimens}, along {first} and along {second}")
        }
        _ => specimens,
    }
}

/// The tests of a spec.
struct Repeats<'a>(&'a NonwovenTensile);

impl Tests for Repeats<'_> {
    type Result = Finished;

    fn share(&self, test: usize) -> Share {
        share(self.0, test)
    }

    fn run(
        &self,
        test: usize,
        context: RunContext<'_>,
        recorder: &mut dyn Recorder,
    ) -> Result<Conclusion<Finished>, SimulationError> {
        let mut keeper = CurveKeeper::new(recorder, KEPT_COLUMNS);
        let ending = super::run_one(&spec_of(self.0, test), context, &mut keeper)?;
        Ok(match ending {
            Ending::Finished(report) => Conclusion::Finished(Finished {
                report: SavedReport::of(&report)?,
                curve: keeper.into_curve(),
            }),
            Ending::Cancelled => Conclusion::Interrupted(Interrupt::Cancel),
            Ending::Suspended => Conclusion::Interrupted(Interrupt::Suspend),
        })
    }
}
