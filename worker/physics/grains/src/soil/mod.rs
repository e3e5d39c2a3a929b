//! Tests of soil: a scene, read in the terms of its test.
//!
//! The spec's [`Script`](loadframe_api::spec::soil::Script) is a scene with stages; the engine runs it like any other. Between the engine and
//! the job's recorder sits a [`Tester`], which makes the test's own curve of the walls' places and forces,
//! row by row; when the engine is done, the test reads its results off that curve. What a test is to be
//! read as is [`Measured`], of the [`Rows`](measured::Rows) that were heard: [`triaxial`] and [`direct_shear`], one file each. Angles that both have are of
//! [`angles`]. What is known of how far results are off, [`errors`] adds. A resumed run hears the whole curve again, so that nothing here is kept in a checkpoint.
mod angles;
mod direct_shear;
mod errors;
mod measured;
mod tester;
mod triaxial;

use loadframe_api::{Report, spec::soil::Soil};
use loadframe_harness::{Ending, Halt, Recorder, ReportBuilder, RunContext, SimulationError};

use crate::stages;
use tester::Tester;

pub use errors::Tabled;
pub use measured::{Measured, Reading};

/// Part of the force on one wall that another does not carry, beyond which forces are those of motion.
const LARGEST_IMBALANCE: f64 = 0.05;

/// Shown of the specimen: grains have yet to be pressed together, which is part of the simulation.
const SHOWN: &str = "Grains as they are placed, apart from one another. Pressing them together to the specimen \
     takes simulated time and comes with the job.";

/// Draws the scene of `spec` as it is before its first step; returns what is shown.
///
/// # Errors
/// When there is no such scene, or the recorder fails.
pub fn preview<T: Measured>(
    spec: &Soil<T>,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<String, Halt> {
    stages::run::preview(&spec.script().scene, context, recorder)?;
    Ok(SHOWN.to_owned())
}

/// Runs the test of `spec`.
///
/// # Errors
/// What made a result impossible, see [`SimulationError`].
pub fn run<T: Measured>(
    spec: &Soil<T>,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Ending, SimulationError> {
    let script = spec.script();
    let mut tester = Tester::new(&spec.test, &script, recorder);
    let (ending, _) = stages::run::run(&script.scene, context, &mut tester)?;
    Ok(match ending {
        Ending::Finished(scene) => {
            let mut report = conclude(&spec.test, scene, &mut tester)?;
            if let Some(words) = errors::add(&mut report, spec) {
                tester.log(&words);
            }
            Ending::Finished(report)
        }
        ending => ending,
    })
}

/// Files and the report of the test, given the scene's.
fn conclude<T: Measured>(
    test: &T,
    scene: Report,
    tester: &mut Tester<'_, T>,
) -> std::io::Result<Report> {
    tester.write()?;
    let mut report = ReportBuilder::new("sheared");
    test.results(&mut report, tester.script, &tester.rows);
    report.check(
        "wall_force_imbalance",
        tester.rows.imbalance(),
        LARGEST_IMBALANCE,
        "1",
        "What the force on one wall and that on the wall across differ by, over the force: mean over the rows of the test. In a test without inertia nothing is left.",
    );
    if let Some(check) = report.failed("wall_force_imbalance").cloned() {
        let detail = format!(
            "walls across differ by {:.3e} of their force, beyond {}: shear more slowly by a smaller \
             /accuracy/inertial_number, or a smaller rate of the test",
            check.value, check.bound
        );
        report.warn("wall_force_imbalance", detail);
    }
    let Report {
        stop_reason,
        mut summary,
        quality,
        mut warnings,
        ..
    } = report.finish();
    for (name, quantity) in scene.summary {
        summary.entry(name).or_insert(quantity);
    }
    let mut all = scene.quality;
    all.extend(quality);
    warnings.extend(scene.warnings);
    Ok(Report {
        stop_reason,
        summary,
        quality: all,
        warnings,
        bodies: Vec::new(),
        ..scene
    })
}
