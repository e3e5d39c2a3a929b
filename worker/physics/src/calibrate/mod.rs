//! Calibration: parameters of another job are fitted to what was measured.
//!
//! In the order in which a run calls them: [`coordinates`] says where the search walks, [`misfit`]
//! what it descends; [`search`] asks [`trials`] for residuals, which remembers all of them and has
//! new ones tested in a [`batch`] over all specimens, side by side; [`confidence`] tells from
//! trials around the best one how well parameters are known; [`tables`] and [`report`] turn that
//! into files and results. Nothing here knows what the inner job is: whoever calls brings what simulates and
//! draws jobs of any kind.
mod batch;
mod confidence;
mod coordinates;
mod misfit;
mod report;
mod search;
mod setting;
mod tables;
mod trials;

use loadframe_api::JobSpec;
use loadframe_api::spec::calibrate::{Calibrate, Template};
use loadframe_harness::{Ending, Preview, Recorder, Run, RunContext, SimulationError};

use coordinates::Coordinate;
use misfit::Targets;
use setting::{Setting, in_words};
use trials::{Halt, Trials};

/// Draws the specimen of the job whose parameters `spec` seeks; returns what is shown.
///
/// # Errors
/// When there is no such specimen, or the recorder fails.
pub(crate) fn preview(
    spec: &Calibrate,
    preview: Preview<JobSpec>,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<String, loadframe_harness::Halt> {
    let inner = spec.job.read();
    let inner = inner.map_err(|found| SimulationError::Unbuildable(in_words(&found)))?;
    let words = preview(&inner, context, recorder)?;
    Ok(format!(
        "Of the job whose parameters are sought, with the values that it has now. {words}"
    ))
}

/// Runs the calibration of `spec`.
///
/// # Errors
/// What made a result impossible, see [`SimulationError`].
pub(crate) fn run(
    spec: &Calibrate,
    simulate: Run<JobSpec>,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Ending, SimulationError> {
    let template = Template::new(&spec.job);
    let template = template.map_err(|found| SimulationError::Unbuildable(in_words(&found)))?;
    let coordinates: Vec<Coordinate> = spec.free.iter().map(Coordinate::new).collect();
    let targets = Targets::new(&spec.measured);
    let setting = Setting {
        spec,
        template: &template,
        targets: &targets,
        coordinates: &coordinates,
        simulate,
    };
    if context.checkpoint.is_none() {
        recorder.log(&format!(
            "{} free parameters, {} measured quantities, {} specimens a trial, at most {} trials",
            spec.free.len(),
            targets.quantities(),
            spec.realisations,
            spec.max_trials
        ));
        for words in spec.measured.curve.iter().flat_map(|curve| &curve.read_as) {
            recorder.log(&format!("measured curve: {words}"));
        }
    }
    let mut trials = Trials::new(setting, context, recorder)?;
    match carry_out(&mut trials) {
        Ok(report) => Ok(Ending::Finished(report)),
        Err(Halt::Interrupted(interrupt)) => Ok(interrupt.into()),
        Err(Halt::Failed(error)) => Err(error),
        Err(Halt::Reached | Halt::UsedUp) => Err(SimulationError::Calibration(
            "the search ended before it began".to_owned(),
        )),
    }
}

fn carry_out(trials: &mut Trials<'_>) -> Result<loadframe_api::Report, Halt> {
    let free = trials
        .setting
        .spec
        .free
        .iter()
        .zip(trials.setting.coordinates);
    let start = free.map(|(free, coordinate)| {
        let own = trials.setting.template.number(&free.parameter);
        coordinate.of(free.start.or(own).unwrap_or(free.min))
    });
    let start: Vec<f64> = start.collect();
    let stop_reason = search::search(trials, start)?;
    trials.end_search();
    let Some(best) = trials.best().cloned() else {
        return Err(Halt::UsedUp);
    };
    let confidence = confidence::confidence(trials, best.trial)?;
    tables::write(trials, &best)?;
    let words = trials.setting.targets.words(best.misfit);
    let line = format!(
        "{} after {} trials, misfit {words}",
        stop_reason.name().replace('_', " "),
        trials.all().len()
    );
    trials.recorder().log(&line);
    trials.recorder().progress(1.0, "finished");
    Ok(report::report(trials, &best, &confidence, stop_reason)?)
}
