//! The specimen of a job before its test, as its generator makes it and its snapshots draw it.
use loadframe_api::JobSpec;
use loadframe_api::spec::calibrate::Calibrate;
use loadframe_api::spec::granular_scene::{GranularScene, Stage};
use loadframe_api::spec::paper_tensile::{PaperTensile, Specimen};
use loadframe_composite::{bending, cell};
use loadframe_grains as grains;
use loadframe_harness::{Recorder, SimulationError};
use loadframe_network::nonwoven;
use loadframe_paper::tensile;

/// Gives the recorder pictures of the specimen of `spec`; of several, of the first. Returns what they show.
/// How much there is to draw tells [`JobSpec::extent`] beforehand.
///
/// # Errors
/// When there is no such specimen, or the recorder fails.
pub fn preview(
    spec: &JobSpec,
    threads: usize,
    recorder: &mut dyn Recorder,
) -> Result<String, SimulationError> {
    let draw = |scene: &GranularScene, recorder: &mut dyn Recorder| {
        grains::preview(scene, threads, recorder)
    };
    Ok(match spec {
        JobSpec::NonwovenTensile(spec) => {
            nonwoven::preview(spec, recorder)?;
            first_of(
                "The fabric between its jaws, not strained yet.",
                spec.test.repeats,
            )
        }
        JobSpec::GranularScene(spec) => {
            draw(spec, recorder)?;
            of_scene(spec)
        }
        JobSpec::Triaxial(spec) => {
            draw(&spec.script().scene, recorder)?;
            OF_SOIL.to_owned()
        }
        JobSpec::DirectShear(spec) => {
            draw(&spec.script().scene, recorder)?;
            OF_SOIL.to_owned()
        }
        JobSpec::BallastOedometer(spec) => {
            draw(&spec.script().scene, recorder)?;
            OF_BALLAST.to_owned()
        }
        JobSpec::BallastBox(spec) => {
            draw(&spec.script().scene, recorder)?;
            OF_BALLAST.to_owned()
        }
        JobSpec::BallastRailbed(spec) => {
            draw(&spec.script().scene, recorder)?;
            OF_BALLAST.to_owned()
        }
        JobSpec::CompositeBending(spec) => {
            bending::preview(spec, recorder)?;
            let is_bent = spec.test.way().is_some_and(|way| way.flexure().is_some());
            let words = "The section on its grid, before its load.";
            match is_bent {
                true => format!(
                    "{words} Where rollers touch it, the grid becomes finer once their force is known."
                ),
                false => words.to_owned(),
            }
        }
        JobSpec::CompositeCell(spec) => {
            cell::preview(spec, recorder)?;
            first_of(
                "The unit cell on its grid, seen along the fibres.",
                spec.repeats,
            )
        }
        JobSpec::PaperTensile(spec) => {
            tensile::preview(spec, threads, recorder)?;
            first_of(of_paper(spec), spec.specimens())
        }
        JobSpec::Calibrate(spec) => {
            let words = preview(&inner(spec)?, threads, recorder)?;
            format!(
                "Of the job whose parameters are sought, with the values that it has now. {words}"
            )
        }
    })
}

/// A bed is the result of its preparation, which is part of the simulation.
const OF_BALLAST: &str = "What there is before the first grain falls: walls, and the grains of the first layer \
     where they are let go. Pouring and compacting the bed takes simulated time and comes with the job.";
const OF_SOIL: &str = "Grains as they are placed, apart from one another. Pressing them together to the specimen \
     takes simulated time and comes with the job.";

fn of_scene(spec: &GranularScene) -> String {
    let words = "The scene before its first step.";
    let comes = |stage: &Stage| matches!(stage, Stage::Insert(_) | Stage::Place(_));
    match spec.stages.iter().any(comes) {
        true => format!("{words} What its stages put in later is not in it yet."),
        false => words.to_owned(),
    }
}

fn of_paper(spec: &PaperTensile) -> &'static str {
    match spec.specimen {
        Specimen::SingleFibre(_) => "The fibre as a tube of springs, before its load.",
        Specimen::Explicit(_) => "The sheet as it is given, before it is pulled.",
        Specimen::Sheet(_) if spec.test.is_zero_span() => {
            "The pieces of fibres between the jaws, before they are pulled."
        }
        Specimen::Sheet(_) => "The sheet between its jaws, before it is pulled.",
    }
}

fn first_of(words: &str, specimens: u32) -> String {
    match specimens {
        0 | 1 => words.to_owned(),
        _ => format!("{words} It is the first of {specimens} specimens."),
    }
}

fn inner(spec: &Calibrate) -> Result<JobSpec, SimulationError> {
    spec.job.read().map_err(|violations| {
        let violations: Vec<String> = violations.iter().map(ToString::to_string).collect();
        SimulationError::Unbuildable(violations.join("; "))
    })
}
