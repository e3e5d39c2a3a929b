//! The tensile test of a sheet of paper.
//!
//! In the order in which a run calls them: [`specimen`] makes a network of beams or bars of a sheet that
//! is given or laid, and [`laid`] measures the latter; [`course`] pulls it from break to break and keeps
//! all that counts; [`tables`], [`pictures`] and [`report`] turn that into files and results. This file
//! holds the loop, which alone talks to the recorder. A job of repeats is several such tests side by side
//! ([`loadframe_harness::plan`]), their results joined.
//!
//! An interrupt is seen between breaks.
mod course;
mod laid;
mod pictures;
mod report;
mod specimen;
mod tables;

#[cfg(test)]
mod tests;

use loadframe_api::Report;
use loadframe_api::spec::paper_tensile::PaperTensile;
use loadframe_harness::checkpoint::{self, Fingerprint};
use loadframe_harness::plan::{
    Conclusion, Curve, CurveKeeper, Plan, SavedReport, Share, Tests, join_repeats, write_repeats,
};
use loadframe_harness::{Ending, Interrupt, Recorder, RunContext, SimulationError};
use loadframe_numerics::Team;
use serde::{Deserialize, Serialize};

use crate::frame::{FrameError, PullTest};
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
    if spec.specimens() <= 1 {
        return run_one(spec, context, recorder);
    }
    let fingerprint = Fingerprint::of(spec)?;
    let count = spec.specimens();
    let plan = match context.checkpoint {
        Some(bytes) => Plan::resume(fingerprint, bytes, recorder)?,
        None => {
            let last = spec.seed + u64::from(count - 1);
            recorder.log(&format!("{count} sheets, seeds {} to {last}", spec.seed));
            Plan::new(fingerprint, count as usize)
        }
    };
    let finished = match plan.carry_out(&Repeats(spec), context, recorder)? {
        Conclusion::Finished(finished) => finished,
        Conclusion::Interrupted(Interrupt::Cancel) => return Ok(Ending::Cancelled),
        Conclusion::Interrupted(Interrupt::Suspend) => return Ok(Ending::Suspended),
    };
    let reports = finished.iter().map(|test| test.report.read());
    let reports: Vec<Report> = reports.collect::<Result<_, _>>()?;
    write_repeats(spec.seed, &reports, recorder)?;
    tables::write_curves(finished.iter().map(|test| &test.curve), recorder)?;
    recorder.progress(1.0, "finished");
    Ok(Ending::Finished(join_repeats(spec.seed, &reports)))
}

/// Runs a single test of `spec`, whatever repeats it asks for.
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
    let specimen = Specimen::new(spec, &Team::new(context.threads)?)?;
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
    };
    let mut course = Course::new(&specimen, test, kept)?;
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

/// The sheets of a spec, one for each seed.
struct Repeats<'a>(&'a PaperTensile);

impl Tests for Repeats<'_> {
    type Result = Finished;

    fn share(&self, test: usize) -> Share {
        if test == 0 {
            Share::All
        } else {
            Share::Nothing
        }
    }

    fn run(
        &self,
        test: usize,
        context: RunContext<'_>,
        recorder: &mut dyn Recorder,
    ) -> Result<Conclusion<Finished>, SimulationError> {
        let mut own = self.0.clone();
        own.test.repeats = Some(1);
        own.seed += test as u64;
        if test > 0 {
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
