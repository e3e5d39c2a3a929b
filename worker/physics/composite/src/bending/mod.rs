//! A test of a section as a job.
//!
//! In the order in which a run calls them: [`model`] builds the lattice, its supports and its load from
//! the spec, for any grid; [`rest`] finds its rest by the solver asked for, [`rollers`] bends it,
//! [`history`] moves it in time, [`cracks`] lets it break, [`split`] evaluates arms that peel apart;
//! [`results`] reads values off, [`errors`] says how wrong they may be from the same test on coarser grids;
//! [`files`], [`pictures`] and [`report`] write. Between them pass what a test comes to ([`tested`]), how far it is
//! ([`progress`]) and what is read off it ([`measured`]); [`watch`] is who listens. This file holds the course
//! of it.
mod arms;
mod beam_line;
mod bent;
mod comparison;
mod cracks;
mod errors;
mod failure;
mod files;
mod history;
mod measured;
mod model;
mod pictures;
mod progress;
mod report;
mod rest;
mod results;
mod rollers;
mod split;
mod swing;
mod tested;
#[cfg(test)]
mod tests;
mod watch;

use loadframe_api::Report;
use loadframe_api::section::contact::CONTACT_CELLS;
use loadframe_api::spec::composite_bending::{Accuracy, CompositeBending, Knobs, Lattice, Solver};
use loadframe_harness::checkpoint::{self, Fingerprint};
use loadframe_harness::{Ending, Interrupt, Recorder, RunContext, SimulationError};

use crate::section::Bounds;
use comparison::Fineness;
use errors::{Finding, Values};
use model::Model;
use progress::Progress;
use tested::Tested;
use watch::{Checkpoint, Halt, Recorded, Unwatched, Watch};

/// Cells that are drawn before a test: some seconds of a core. How many there are is not known before lines
/// are laid through the faces of many fibres.
const MOST_DRAWN: usize = 400_000;

/// Runs the simulation of `spec`.
///
/// # Errors
/// What made a result impossible, see [`SimulationError`].
pub fn run(
    spec: &CompositeBending,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Ending, SimulationError> {
    let fingerprint = Fingerprint::of(spec)?;
    let (points, progress) = match context.checkpoint {
        Some(bytes) => {
            let checkpoint: Checkpoint = checkpoint::unpack(bytes)?;
            fingerprint.check(checkpoint.spec)?;
            (checkpoint.points, checkpoint.progress)
        }
        None => (Vec::new(), None),
    };
    let mut recorded = Recorded {
        context,
        recorder,
        fingerprint,
        points,
        part: 0.75,
    };
    match test(spec, progress, &mut recorded) {
        Ok(report) => Ok(Ending::Finished(report)),
        Err(Halt::Failed(error)) => Err(error),
        Err(Halt::TooCoarse(error)) => Err(error.into()),
        Err(Halt::Interrupted(interrupt)) => Ok(interrupt.into()),
    }
}

/// Draws the section of `spec` before its load; returns what is shown.
///
/// # Errors
/// When there is no such section, it has very many cells, or the recorder fails; a cancel.
pub fn preview(
    spec: &CompositeBending,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<String, loadframe_harness::Halt> {
    let bounds = Bounds {
        most_cells: MOST_DRAWN,
        interrupt: context.interrupt,
    };
    let layout = model::before_rollers(spec, finest(spec), bounds)?;
    pictures::write_first(&layout, recorder)?;
    let words = "The section on its grid, before its load.";
    let is_bent = spec.test.way().is_some_and(|way| way.flexure().is_some());
    Ok(match is_bent {
        true => format!(
            "{words} Where rollers touch it, the grid becomes finer once their force is known."
        ),
        false => words.to_owned(),
    })
}

/// The grid that is asked for.
fn finest(spec: &CompositeBending) -> Fineness {
    Fineness {
        grid: spec.grid(),
        contact_cells: CONTACT_CELLS,
        shrinks_to_corners: spec.shrinks_to_corners(),
    }
}

fn test(
    spec: &CompositeBending,
    progress: Option<Progress>,
    recorded: &mut Recorded<'_, '_>,
) -> Result<Report, Halt> {
    let model = Model::new(spec, finest(spec))?;
    if recorded.context.checkpoint.is_none() {
        recorded.recorder.log(&model.described());
    }
    let finding = match &progress {
        Some(Progress::Done(done)) => done.1.clone(),
        _ => Finding::default(),
    };
    let tested = conduct(&model, progress, recorded.context, recorded)?;
    let measured = results::measure(&model, &tested);
    let finding = match tested.unstable {
        // other grids would agree on a saddle, too
        Some(_) => finding,
        None => compare(&model, recorded, &tested, finding)?,
    };
    files::write(&model, &tested, &measured, &finding, recorded).map_err(Halt::Failed)?;
    recorded.recorder.progress(1.0, "finished");
    Ok(report::report(&model, &tested, &measured, &finding))
}

/// Does what the spec says to the model.
fn conduct(
    model: &Model<'_>,
    progress: Option<Progress>,
    context: RunContext<'_>,
    watch: &mut dyn Watch,
) -> Result<Tested, Halt> {
    if let Some(Progress::Done(done)) = progress {
        watch.columns(model.spec.columns())?;
        return Ok(done.0);
    }
    if let Some(given) = &model.spec.test.breaking {
        return cracks::conduct(model, given, progress, watch);
    }
    if let Some((flexure, given)) = model.flexure() {
        return rollers::conduct(model, flexure, given, progress, watch);
    }
    match &model.spec.test.history {
        Some(history) => history::conduct(model, history, progress, context, watch),
        None => rest::conduct(model, progress, context, watch),
    }
}

/// The same test on coarser grids, by the equations of equilibrium, and on the exact lattice, beyond
/// what is known of them.
fn compare(
    model: &Model<'_>,
    recorded: &mut Recorded<'_, '_>,
    tested: &Tested,
    mut finding: Finding,
) -> Result<Finding, Halt> {
    let (spec, finest) = (model.spec, model.fineness);
    let knobs = spec.accuracy.knobs();
    let by_static = knobs.solver != Solver::Static && spec.test.history.is_none();
    let mut plain = spec.clone();
    if by_static {
        plain.accuracy = Accuracy::Knobs(Knobs {
            solver: Solver::Static,
            residual: None,
            ..knobs
        });
    }
    let context = recorded.context;
    let other = |spec: &CompositeBending, fineness: Fineness| -> Result<Values, Halt> {
        let model = Model::new(spec, fineness)?;
        let tested = conduct(&model, None, context, &mut Unwatched(context))?;
        let measured = results::measure(&model, &tested);
        let named = measured
            .into_iter()
            .map(|one| (one.name.to_owned(), one.value));
        Ok(named.collect())
    };
    let all = model.comparison().grids(finest);
    loop {
        let next = if by_static && finding.by_static.is_none() {
            other(&plain, finest).map(|values| finding.by_static = Some(values))
        } else if let Some(fineness) = all.get(finding.others.len()) {
            match other(&plain, *fineness) {
                // on so few cells nothing is known
                Err(Halt::TooCoarse(_)) => {
                    finding.others.push(Values::new());
                    Ok(())
                }
                found => found.map(|values| finding.others.push(values)),
            }
        } else if matches!(spec.lattice, Lattice::Paper(_)) && finding.exact.is_none() {
            let exact = CompositeBending {
                lattice: Lattice::default(),
                ..plain.clone()
            };
            other(&exact, finest).map(|values| finding.exact = Some(values))
        } else {
            return Ok(finding);
        };
        let keep = |recorded: &mut Recorded<'_, '_>| {
            let done = Progress::Done(Box::new((tested.clone(), finding.clone())));
            recorded.keep(Some(done)).map_err(Halt::Failed)
        };
        match next {
            Ok(()) => {
                recorded.recorder.progress(recorded.part, "other grids");
                if recorded.recorder.checkpoint_due() {
                    keep(recorded)?;
                }
            }
            Err(Halt::Interrupted(Interrupt::Suspend)) => {
                keep(recorded)?;
                return Err(Halt::Interrupted(Interrupt::Suspend));
            }
            Err(halt) => return Err(halt),
        }
    }
}
