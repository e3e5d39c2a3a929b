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
use loadframe_harness::{
    Ending, Halt, Recorder, ReportBuilder, RunContext, SimulationError, plan::first_of,
};
use serde::Serialize;

use crate::output::warnings::Fields;
use crate::repeats::{self, Repeated};
use crate::stages;
use tester::Tester;

pub use errors::Tabled;
pub use measured::{Measured, Reading};

/// Part of the force on one wall that another does not carry, beyond which forces are those of motion.
const LARGEST_IMBALANCE: f64 = 0.05;

/// Part of the rows of a test in which the walls do not keep their stress, at most.
const LARGEST_NOT_KEPT: f64 = 0.02;

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
    Ok(first_of(SHOWN, spec.repeats))
}

/// Said where that is so.
const NOT_KEPT: &str =
    "results have no error: it was measured for tests whose walls kept their stress";

/// Runs the test of `spec`, of as many specimens as it asks for.
///
/// # Errors
/// What made a result impossible, see [`SimulationError`].
pub fn run<T: Measured + Clone + Serialize + Sync>(
    spec: &Soil<T>,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Ending, SimulationError> {
    repeats::run(spec, context, recorder)
}

impl<T: Measured + Clone + Serialize + Sync> Repeated for Soil<T> {
    const SEVERAL: &'static str = "specimens";
    // time and what both tests are read by: strain or way, volume or height, stress
    const KEPT_COLUMNS: usize = 4;
    const TOLD: &'static str = "peak_friction_angle";

    fn repeats(&self) -> u32 {
        self.repeats
    }

    fn seed(&self) -> u64 {
        self.seed
    }

    fn first_alone(&mut self) {
        self.repeats = 1;
    }

    fn run_one(
        &self,
        context: RunContext<'_>,
        recorder: &mut dyn Recorder,
    ) -> Result<Ending, SimulationError> {
        run_one(self, context, recorder)
    }
}

fn run_one<T: Measured>(
    spec: &Soil<T>,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Ending, SimulationError> {
    let script = spec.script();
    let mut tester = Tester::new(&spec.test, &script, recorder);
    let (ending, _) = stages::run::run(&script.scene, Fields::Soil, context, &mut tester)?;
    Ok(match ending {
        Ending::Finished(scene) => {
            let mut report = conclude(&spec.test, scene, &mut tester)?;
            let words = match report.quality.get("stress_not_kept") {
                Some(check) if !check.ok => Some(NOT_KEPT.to_owned()),
                _ => {
                    let words = errors::add(&mut report, spec);
                    spec.test.propagate(&mut report, &tester.rows);
                    words
                }
            };
            if let Some(words) = words {
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
    report.check(
        "stress_not_kept",
        tester.rows.not_kept(test.kept_stress()),
        LARGEST_NOT_KEPT,
        "1",
        "Part of the rows of the test in which the stress that walls keep was more than a tenth off. Strengths and angles are read in the others.",
    );
    if let Some(check) = report.failed("stress_not_kept").cloned() {
        let detail = format!(
            "in {:.1} % of the rows of the test grains gave way faster than the walls could follow, and the \
             stress that these keep was more than a tenth off: so few grains carry it that a chain of them is \
             the specimen. Take smaller grains (/grains/sizes)",
            100.0 * check.value
        );
        report.warn("stress_not_kept", detail);
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
