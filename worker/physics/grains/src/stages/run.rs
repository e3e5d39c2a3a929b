//! A run: steps, what is observed on the way, until the end of the last of its stages.
use loadframe_api::spec::granular_scene::{GranularScene, Stage};
use loadframe_harness::{Ending, Halt, Interrupt, Recorder, RunContext, SimulationError};
use loadframe_numerics::Team;

use super::runner::Runner;
use crate::output::{
    errors, fragments, journal::Journal, report, snapshot, tables, voids, warnings::Fields,
};

/// Draws the scene of `spec` before its first step.
pub(crate) fn preview(
    spec: &GranularScene,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<(), Halt> {
    let mut runner = Runner::new(spec, Team::new(context.threads)?, context.interrupt)?;
    runner.engine.push_still();
    let mut survey = runner.engine.survey(true);
    runner.picture(recorder, &mut survey)?;
    Ok(())
}

/// Runs the scene of `spec`, which is made of what has these `fields`; returns its journal as well, for
/// tests in terms of their own.
pub(crate) fn run(
    spec: &GranularScene,
    fields: Fields,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<(Ending, Journal), SimulationError> {
    let mut runner = match Runner::new(spec, Team::new(context.threads)?, context.interrupt) {
        Ok(runner) => runner,
        Err(Halt::Failed(error)) => return Err(error),
        // nothing of it is done yet
        Err(Halt::Interrupted(interrupt)) => return Ok((interrupt.into(), Journal::default())),
    };
    if let Some(bytes) = context.checkpoint {
        runner.resume(bytes)?;
    }
    let columns = spec.curve_columns();
    let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
    recorder.columns(&columns)?;
    for row in runner.journal.curve.chunks_exact(columns.len()) {
        recorder.point(row)?;
    }
    if context.checkpoint.is_none() {
        runner.begin(recorder)?;
    }
    let mut work = 0;
    while let Some(stage) = spec.stages.get(runner.journal.stage) {
        runner.begin_drives(stage);
        runner.rub(stage);
        runner.raise_cohesion();
        runner.begin_step();
        if let Stage::Cut(cut) = stage {
            runner.cut(cut, recorder)?;
        }
        if let Stage::Place(place) = stage {
            runner.place(place, recorder)?;
        }
        if let Stage::Replace(replace) = stage {
            runner.replace(replace, recorder)?;
        }
        while !runner.is_stage_done(stage) {
            work += runner.steps_unseen(stage, work)?;
            if runner.is_stage_done(stage) {
                break;
            }
            work += runner.work_of_step();
            if work > runner.work_uninterrupted() {
                work = 0;
                match context.interrupt.interrupt() {
                    Some(Interrupt::Cancel) => return Ok((Ending::Cancelled, runner.journal)),
                    Some(Interrupt::Suspend) => {
                        runner.keep(recorder)?;
                        return Ok((Ending::Suspended, runner.journal));
                    }
                    None => {}
                }
                runner.tell_progress(recorder);
                if recorder.checkpoint_due() {
                    runner.keep(recorder)?;
                }
            }
            runner.prepare_step(stage)?;
            runner.supply(stage, recorder);
            runner.step(stage, recorder)?;
        }
        runner.tell_end(stage, recorder)?;
        let waits = matches!(stage, Stage::Settle(_) | Stage::Relax(_));
        if waits && !runner.journal.is_settled {
            runner.journal.unsettled_stages.push(runner.journal.stage);
        }
        runner.note_worst();
        runner.end_supply(stage);
        runner.end_stiffening(stage);
        runner.note_servos();
        voids::look(spec, &runner.engine, &mut runner.journal);
        runner.journal.is_settled = false;
        runner.journal.stage += 1;
        runner.journal.stage_steps = 0;
        runner.journal.stage_start = runner.engine.state.time;
    }
    tables::write(spec, &runner.journal, recorder)?;
    if !runner.engine.model.grains.is_empty() {
        fragments::write_sizes(&runner.engine, &runner.journal.bonds, recorder)?;
    }
    voids::write(spec, &runner.journal, recorder)?;
    let has_walls = runner.engine.wall_count() > 0;
    snapshot::write_series(&runner.journal, has_walls, recorder)?;
    recorder.progress(1.0, "finished");
    let mut report = report::report(spec, &runner.engine, &runner.journal, fields);
    if let Some(words) = errors::add(&mut report, spec, &runner.engine, &runner.journal) {
        recorder.log(&words);
    }
    Ok((Ending::Finished(report), runner.journal))
}
