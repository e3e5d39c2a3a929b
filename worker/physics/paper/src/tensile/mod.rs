//! A tensile test of paper as a job.
//!
//! Sheets have a folder of their own, [`sheet`]; the rest is about one fibre. In the order in which a run
//! calls them: [`fibre`] divides the fibre and measures its constants, and
//! does to it what the spec says; [`files`] and [`report`] write. This file holds the course of it,
//! which alone talks to the recorder. A run is over within seconds: it keeps no checkpoint, and one
//! that was suspended begins again.
mod fibre;
mod files;
mod report;
mod sheet;

#[cfg(test)]
mod tests;

use loadframe_api::spec::paper_tensile::{PaperTensile, SingleFibre, Specimen};
use loadframe_harness::{
    Ending, Halt, Interrupt, Recorder, ReportBuilder, RunContext, SimulationError,
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

/// Draws the first specimen of `spec` before its test.
///
/// # Errors
/// When there is no such specimen, or the recorder fails.
pub fn preview(
    spec: &PaperTensile,
    threads: usize,
    recorder: &mut dyn Recorder,
) -> Result<(), SimulationError> {
    let Specimen::SingleFibre(single) = &spec.specimen else {
        return sheet::preview(spec, threads, recorder);
    };
    let specimen = fibre::Specimen::new(spec, single)?;
    files::write_pictures(&specimen, &[specimen.unloaded()], recorder)?;
    Ok(())
}

/// Warns of pulps whose coarseness and wall contradict one another.
fn warn_of_contradictions(report: &mut ReportBuilder, spec: &PaperTensile) {
    let contradicted = spec.pulp.iter().filter_map(|pulp| {
        let (section, coarseness) = pulp.section().ok().zip(pulp.coarseness_mg_per_m)?;
        Some((&pulp.name, section.contradiction(coarseness)?))
    });
    for (name, contradiction) in contradicted {
        let detail = format!("pulp {name:?}: {contradiction}");
        report.warn("contradicting_coarseness", detail);
    }
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
