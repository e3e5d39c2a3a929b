//! A tensile test of paper as a job; its specimen is one fibre.
//!
//! In the order in which a run calls them: [`fibre`] divides the fibre and measures its constants, and
//! does to it what the spec says; [`files`] and [`report`] write. This file holds the course of it,
//! which alone talks to the recorder. A run is over within seconds: it keeps no checkpoint, and one
//! that was suspended begins again.
mod fibre;
mod files;
mod report;

#[cfg(test)]
mod tests;

use loadframe_api::spec::paper_tensile::{PaperTensile, Specimen};
use loadframe_harness::{Ending, Interrupt, Recorder, RunContext, SimulationError};

use crate::fibre::TubeError;
use fibre::{Loaded, Picture};

impl From<TubeError> for Halt {
    fn from(error: TubeError) -> Self {
        Self::Failed(SimulationError::Paper(error.to_string()))
    }
}

/// Why a test ended before its end.
enum Halt {
    Interrupted(Interrupt),
    Failed(SimulationError),
}

impl From<std::io::Error> for Halt {
    fn from(error: std::io::Error) -> Self {
        Self::Failed(error.into())
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
    match test(spec, context, recorder) {
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

fn test(
    spec: &PaperTensile,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Ending, Halt> {
    let Specimen::SingleFibre(single) = &spec.specimen;
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
            Some(interrupt) => Err(Halt::Interrupted(interrupt)),
            None => Ok(()),
        }
    })?;
    files::write(&specimen, &curve, &pictures, recorder)?;
    recorder.progress(1.0, "finished");
    Ok(Ending::Finished(report::report(
        &specimen, &constants, &loaded,
    )))
}
