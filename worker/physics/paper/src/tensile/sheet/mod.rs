//! The tensile test of a sheet of paper.
//!
//! In the order in which a run calls them: [`specimen`] makes a network of beams, bars or [`tubes`] of a sheet that
//! is given or laid, with [`bonds`] by their area; [`laid`] measures the latter, and [`theory`] tells what
//! it could bear; [`course`] pulls it from break to break and keeps all that counts; [`tables`],
//! [`pictures`], [`results`], [`report`] and [`warnings`] turn that into files and results, and
//! [`straight_parts`], [`bonds_inside`] and [`bonds_between_rings`] say how wrong stiffness is, and [`together`] strength. This file
//! holds the loop, which alone talks to the recorder. A job of repeats or of both directions is several such tests side by side
//! ([`loadframe_harness::plan`]),
//! their results joined.
//!
//! An interrupt is seen between breaks.
mod bonds;
mod bonds_between_rings;
mod bonds_inside;
mod course;
mod laid;
mod pictures;
mod report;
mod results;
mod specimen;
mod straight_parts;
mod tables;
mod theory;
mod together;
mod tubes;
mod warnings;

#[cfg(test)]
mod tests;

use std::sync::Arc;

use loadframe_api::spec::paper_tensile::{Dynamics, PaperTensile, SHEET_CURVE, Specimen as Kind};
use loadframe_harness::checkpoint::{self, Fingerprint};
use loadframe_harness::plan::{Compared, Place, Specimens, test_specimens};
use loadframe_harness::{Ending, Halt, Interrupt, Recorder, RunContext, SimulationError};
use loadframe_numerics::Team;
use serde::{Deserialize, Serialize};

use crate::frame::{FrameError, Means, MotionTest, PullTest, Solver};
use course::{Course, Kept};
use specimen::Specimen;

/// 1/s in 1/µs.
const PER_US: f64 = 1e-6;
/// Leading columns of the curve that are kept of every repeat: nominal strain and force.
const KEPT_COLUMNS: usize = 2;
/// Results compared between directions.
const COMPARED: [Compared; 6] = [
    ("tensile_index", "`tensile_index`"),
    ("zero_span_index", "`zero_span_index`"),
    ("stretch", "`stretch`"),
    ("energy_absorption_index", "`energy_absorption_index`"),
    ("tensile_stiffness_index", "`tensile_stiffness_index`"),
    ("cox_stiffness_index", "`cox_stiffness_index`"),
];

/// A state and the spec it belongs to.
#[derive(Serialize, Deserialize)]
struct Checkpoint {
    spec: Fingerprint,
    kept: Kept,
}

impl From<FrameError> for SimulationError {
    fn from(error: FrameError) -> Self {
        Self::of_paper(error)
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
    if spec.specimens() as usize * spec.test.pulled().each().len() <= 1 {
        return run_one(spec, context, recorder);
    }
    test_specimens(&Repeats(spec), Fingerprint::of(spec)?, context, recorder)
}

/// Draws the first sheet of `spec`, for the first of its directions; returns what is shown.
///
/// # Errors
/// When there is no such sheet, or the recorder fails.
pub(super) fn preview(
    spec: &PaperTensile,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<&'static str, Halt> {
    let team = Team::new(context.threads)?;
    let specimen = Specimen::new(spec, &team, context.interrupt)?;
    context.interrupt.heed()?;
    pictures::unheld(&specimen, recorder)?;
    Ok(match &spec.specimen {
        Kind::Explicit(_) => "The sheet as it is given, before it is pulled.",
        _ if spec.test.is_zero_span() => {
            "The pieces of fibres between the jaws, before they are pulled."
        }
        _ => "The sheet between its jaws, before it is pulled.",
    })
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
    let specimen = match Specimen::new(spec, &team, context.interrupt) {
        Ok(specimen) => specimen,
        // nothing of it is done yet
        Err(Halt::Interrupted(interrupt)) => return Ok(interrupt.into()),
        Err(Halt::Failed(error)) => return Err(error),
    };
    let network = &specimen.network;
    if is_new {
        recorder.log(&format!(
            "{} fibres in {} segments, {} bonds, {} mm between the jaws",
            network.fibres(),
            network.segments(),
            network.bonds(),
            specimen.length_mm
        ));
        if let Some(tubes) = &specimen.tubes {
            recorder.log(&tubes.described());
        }
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
        motion: spec.test.dynamics.map(moving),
    };
    let mut course = Course::new((&specimen, spec.level()), test, means, kept)?;
    recorder.columns(&SHEET_CURVE)?;
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
    let peak = if takes_pictures || network.yields() {
        course.at_peak()?
    } else {
        None
    };
    if takes_pictures {
        pictures::rest(&course, peak.as_deref(), &specimen, recorder)?;
    }
    let residual_um = peak.map(|peak| peak.residual_elongation_um()).transpose()?;
    let residual_strain = residual_um.map(|residual| residual / network.model().length_um);
    recorder.progress(1.0, "finished");
    Ok(Ending::Finished(report::report(
        spec,
        &specimen,
        &course,
        end,
        residual_strain,
    )))
}

/// How masses move.
fn moving(dynamics: Dynamics) -> MotionTest {
    MotionTest {
        strain_rate_per_us: PER_US * dynamics.strain_rate_per_s,
        damping: dynamics.damping,
        added_mass: dynamics.added_mass,
        points: dynamics.points,
    }
}

/// The sheets of a spec, one for each seed and direction.
struct Repeats<'a>(&'a PaperTensile);

impl Specimens for Repeats<'_> {
    fn count(&self) -> usize {
        self.0.specimens() as usize
    }

    fn first_seed(&self) -> u64 {
        self.0.seed
    }

    fn directions(&self) -> Vec<&'static str> {
        let directions = self.0.test.pulled().each().iter();
        directions.map(|direction| direction.name()).collect()
    }

    fn compared(&self) -> &'static [Compared] {
        &COMPARED
    }

    fn has_sampling_errors(&self) -> bool {
        true
    }

    fn kept_columns(&self) -> usize {
        KEPT_COLUMNS
    }

    fn overview(&self) -> String {
        let directions = self.directions();
        let (seed, specimens) = (self.0.seed, self.0.specimens());
        format!(
            "{} sheets, seeds {seed} to {}, along {}",
            specimens as usize * directions.len(),
            seed + u64::from(specimens - 1),
            directions.join(" and ")
        )
    }

    fn test(
        &self,
        place: Place,
        context: RunContext<'_>,
        recorder: &mut dyn Recorder,
    ) -> Result<Ending, SimulationError> {
        let mut own = self.0.clone();
        own.test.repeats = Some(1);
        own.test.direction = Some(self.0.test.pulled().each()[place.direction]);
        own.seed += place.specimen as u64;
        if place.specimen > 0 {
            // nobody would see them
            own.output.snapshot_every_steps = 0;
        }
        run_one(&own, context, recorder)
    }
}
