//! A tensile test of paper as a job.
//!
//! Sheets have a folder of their own, [`sheet`]; the rest is about one fibre. In the order in which a run
//! calls them: [`fibre`] divides the fibre and measures its constants, and
//! does to it what the spec says; [`files`] and [`report`] write. This file holds the course of it,
//! which alone talks to the recorder. A run is over within seconds: it keeps no checkpoint, and one
//! that was suspended begins again.
mod contradictions;
mod fibre;
mod files;
mod report;
mod sheet;

#[cfg(test)]
mod tests;

use loadframe_api::spec::paper_tensile::{PaperTensile, SingleFibre, Specimen};
use loadframe_harness::{
    Ending, Halt, Interrupt, Recorder, RunContext, SimulationError, plan::first_of,
};

use crate::fibre::TubeError;
use fibre::{Loaded, Picture};

impl From<TubeError> for SimulationError {
    fn from(error: TubeError) -> Self {
        Self::of_paper(error)
    }
}

/// Runs the simulation of `spec`.
///
/// # Errors
/// What made a result impossible, see [`SimulationError`].
pub fn run(
    spec: &PaperTensile,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Ending, SimulationError> {
    let Specimen::SingleFibre(single) = &spec.specimen else {
        return sheet::run(spec, context, recorder);
    };
    match test(spec, single, context, recorder) {
        Ok(ending) => Ok(ending),
        Err(Halt::Failed(error)) => Err(error),
        Err(Halt::Interrupted(Interrupt::Cancel)) => Ok(Ending::Cancelled),
        Err(Halt::Interrupted(Interrupt::Suspend)) => {
            // what there is to go on from is the spec
            recorder.checkpoint(&[])?;
            Ok(Ending::Suspended)
        }
    }
}

/// Draws the first specimen of `spec` before its test; returns what is shown.
///
/// # Errors
/// When there is no such specimen, or the recorder fails.
pub fn preview(
    spec: &PaperTensile,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<String, Halt> {
    let words = match &spec.specimen {
        Specimen::SingleFibre(single) => {
            let specimen = fibre::Specimen::new(spec, single)?;
            context.interrupt.heed()?;
            files::write_pictures(&specimen, &[specimen.unloaded()], recorder)?;
            "The fibre as a tube of springs, before its load."
        }
        _ => sheet::preview(spec, context, recorder)?,
    };
    Ok(first_of(words, spec.specimens()))
}

fn test(
    spec: &PaperTensile,
    single: &SingleFibre,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Ending, Halt> {
    let specimen = fibre::Specimen::new(spec, single)?;
    recorder.log(&specimen.described());
    recorder.progress(0.0, "constants");
    let constants = specimen.constants()?;
    recorder.columns(specimen.columns())?;
    let mut curve: Vec<Vec<f64>> = Vec::new();
    let mut pictures: Vec<Picture> = Vec::new();
    let loaded: Loaded = specimen.load(&constants, &mut |fraction, point, picture| {
        recorder.point(&point)?;
        recorder.progress(fraction, "test");
        curve.push(point);
        pictures.extend(picture);
        match context.interrupt.interrupt() {
            Some(interrupt) => Err(interrupt.into()),
            None => Ok(()),
        }
    })?;
    files::write(&specimen, &curve, &pictures, recorder)?;
    recorder.progress(1.0, "finished");
    Ok(Ending::Finished(report::report(
        &specimen, &constants, &loaded,
    )))
}
