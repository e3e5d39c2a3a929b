//! The tensile test of a sheet of paper.
//!
//! In the order in which a run calls them: [`specimen`] makes a network of beams or bars of a sheet that
//! is given or laid, with [`bonds`] by their area, and [`laid`] measures the latter; [`course`] pulls it
//! from break to break and keeps all that counts; [`tables`], [`pictures`], [`report`] and [`warnings`]
//! turn that into files and results. This file holds the loop, which alone talks to the recorder. A job of
//! repeats or of both [`directions`] is several such tests side by side ([`loadframe_harness::plan`]),
//! their results joined.
//!
//! An interrupt is seen between breaks.
mod bonds;
mod course;
mod directions;
mod laid;
mod pictures;
mod report;
mod specimen;
mod tables;
mod warnings;

#[cfg(test)]
mod tests;

use std::sync::Arc;

use loadframe_api::Report;
use loadframe_api::spec::paper_tensile::{Direction, PaperTensile};
use loadframe_harness::checkpoint::{self, Fingerprint};
use loadframe_harness::plan::{
    Conclusion, Curve, CurveKeeper, Plan, SavedReport, Share, Tests, join_repeats, write_repeats,
};
use loadframe_harness::{Ending, Interrupt, Recorder, RunContext, SimulationError};
use loadframe_numerics::Team;
use serde::{Deserialize, Serialize};

use crate::frame::{FrameError, Means, PullTest, Solver};
use course::{COLUMNS, Course, Kept};
use specimen::Specimen;

/// Leading columns of the curve that are kept of every repeat: nominal strain and force.
const KEPT_COLUMNS: usize = 2;

/// What is kept of a finished repeat.
#[derive(Debug, Serialize, Deserialize)]
struct Finished {
    report: SavedReport,
    curve: Curve,
}

/// A state and the spec it belongs to.
#[derive(Serialize, Deserialize)]
struct Checkpoint {
    spec: Fingerprint,
    kept: Kept,
}

impl From<FrameError> for SimulationError {
    fn from(error: FrameError) -> Self {
        Self::Paper(error.to_string())
    }
}

/// Runs everything `spec` asks for.
///
/// # Errors
/// What made a result impossible, see [`SimulationError`].
pub(super) fn run(
    spec: &PaperTensile,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Ending, SimulationError> {
    let directions = spec.test.pulled().each();
    let count = spec.specimens() as usize * directions.len();
    if count <= 1 {
        return run_one(spec, context, recorder);
    }
    let fingerprint = Fingerprint::of(spec)?;
    let plan = match context.checkpoint {
        Some(bytes) => Plan::resume(fingerprint, bytes, recorder)?,
        None => {
            let last = spec.seed + u64::from(spec.specimens() - 1);
            let along: Vec<&str> = directions
                .iter()
                .map(|direction| direction.name())
                .collect();
            let along = along.join(" and ");
            recorder.log(&format!(
                "{count} sheets, seeds {} to {last}, along {along}",
                spec.seed
            ));
            Plan::new(fingerprint, count)
        }
    };
    let finished = match plan.carry_out(&Repeats(spec), context, recorder)? {
        Conclusion::Finished(finished) => finished,
        Conclusion::Interrupted(Interrupt::Cancel) => return Ok(Ending::Cancelled),
        Conclusion::Interrupted(Interrupt::Suspend) => return Ok(Ending::Suspended),
    };
    let reports = finished.iter().map(|test| test.report.read());
    let reports: Vec<Report> = reports.collect::<Result<_, _>>()?;
    let per_seed = reports.chunks(directions.len());
    let joint: Vec<Report> = per_seed
        .map(|both| directions::join(directions, both))
        .collect();
    recorder.progress(1.0, "finished");
    let [report] = joint.as_slice() else {
        write_repeats(spec.seed, &joint, recorder)?;
        for first in 0..directions.len() {
            let name = share(spec, first).name("repeats_curves.csv");
            let tests = finished.iter().skip(first).step_by(directions.len());
            tables::write_curves(&name, tests.map(|test| &test.curve), recorder)?;
        }
        return Ok(Ending::Finished(join_repeats(spec.seed, &joint)));
    };
    Ok(Ending::Finished(report.clone()))
}

/// Number of the repeat and direction of test number `index`: directions of a seed follow one another.
fn place(spec: &PaperTensile, index: usize) -> (usize, Direction) {
    let directions = spec.test.pulled().each();
    (
        index / directions.len(),
        directions[index % directions.len()],
    )
}

/// What the job shows of test number `index`: the first seed, its first direction as its own.
fn share(spec: &PaperTensile, index: usize) -> Share {
    match place(spec, index) {
        _ if index == 0 => Share::All,
        (0, direction) => Share::Folder(directions::suffix(direction)),
        _ => Share::Nothing,
    }
}

/// Runs a single test of `spec`, whatever repeats it asks for; of both directions the first.
fn run_one(
    spec: &PaperTensile,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Ending, SimulationError> {
    let fingerprint = Fingerprint::of(spec)?;
    let kept = match context.checkpoint {
        Some(bytes) => {
            let checkpoint: Checkpoint = checkpoint::unpack(bytes)?;
            fingerprint.check(checkpoint.spec)?;
            Some(checkpoint.kept)
        }
        None => None,
    };
    let is_new = kept.is_none();
    recorder.progress(0.0, "fibres and bonds");
    let team = Arc::new(Team::new(context.threads)?);
    let specimen = Specimen::new(spec, &team)?;
    let network = &specimen.network;
    if is_new {
        recorder.log(&format!(
            "{} fibres in {} segments, {} bonds, {} mm between the jaws",
            network.fibres(),
            network.segments(),
            network.bonds(),
            specimen.length_mm
        ));
        recorder.progress(0.0, "first equilibrium");
    }
    let test = PullTest {
        max_strain: spec.test.max_strain,
        stop_force_fraction: spec.test.stop_fraction(),
        break_precision: spec.accuracy.knobs().break_precision,
    };
    let means = Means {
        solver: Solver::ByCost,
        team,
    };
    let mut course = Course::new(&specimen, test, means, kept)?;
    recorder.columns(&COLUMNS)?;
    let mut told = 0;
    let mut tell = |course: &Course<'_>, recorder: &mut dyn Recorder| {
        let mut points = course.kept.points.iter().skip(told);
        points.try_for_each(|point| recorder.point(point))?;
        told = course.kept.points.len();
        Ok::<(), SimulationError>(())
    };
    tell(&course, recorder)?;
    let takes_pictures = spec.output.snapshot_every_steps > 0;
    if is_new && takes_pictures {
        pictures::start(&course, &specimen, recorder)?;
    }
    let keep = |course: &Course<'_>, recorder: &mut dyn Recorder| {
        let checkpoint = Checkpoint {
            spec: fingerprint,
            kept: course.keep(),
        };
        recorder.checkpoint(&checkpoint::pack(&checkpoint)?)?;
        Ok::<(), SimulationError>(())
    };
    let end = loop {
        match context.interrupt.interrupt() {
            Some(Interrupt::Cancel) => return Ok(Ending::Cancelled),
            Some(Interrupt::Suspend) => {
                keep(&course, recorder)?;
                return Ok(Ending::Suspended);
            }
            None => {}
        }
        let end = course.advance()?;
        tell(&course, recorder)?;
        if let Some(end) = end {
            break end;
        }
        let broken = course.pull.state().measures.broken();
        recorder.progress(course.progress(), &format!("{broken} broken"));
        if recorder.checkpoint_due() {
            keep(&course, recorder)?;
        }
    };
    recorder.log(&format!(
        "{}, at {:.4} % strain, {} broken",
        end.sentence(),
        100.0 * course.pull.elongation_um() / network.model().length_um,
        course.kept.records.len()
    ));
    tables::write(&specimen, &course.kept, recorder)?;
    if takes_pictures {
        let peak = course.at_peak()?;
        pictures::rest(&course, peak.as_ref(), &specimen, recorder)?;
    }
    recorder.progress(1.0, "finished");
    Ok(Ending::Finished(report::report(
        spec, &specimen, &course, end,
    )))
}

/// The sheets of a spec, one for each seed and direction.
struct Repeats<'a>(&'a PaperTensile);

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
        let mut own = self.0.clone();
        let (repeat, direction) = place(self.0, test);
        own.test.repeats = Some(1);
        own.test.direction = Some(direction);
        own.seed += repeat as u64;
        if repeat > 0 {
            // nobody would see them
            own.output.snapshot_every_steps = 0;
        }
        let mut keeper = CurveKeeper::new(recorder, KEPT_COLUMNS);
        let ending = run_one(&own, context, &mut keeper)?;
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
