//! The report of the test of a sheet: why it ended, its results, and whether to believe them.
use loadframe_api::Report;
use loadframe_api::spec::paper_tensile::PaperTensile;
use loadframe_harness::ReportBuilder;

use super::course::Course;
use super::results;
use super::specimen::Specimen;
use super::warnings::warn;
use crate::frame::{MotionReport, PullEnd, PullMeasures, Pulling};

/// Largest difference between the jaw forces, relative to the maximum force, that goes without
/// warning: the force error ISO 7500-1 allows a testing machine of class 1.
const LARGEST_IMBALANCE: f64 = 0.01;
/// Work that is neither stored nor set free, over the work.
const LARGEST_ENERGY_ERROR: f64 = 1e-6;
/// The same of masses in motion, whose steps are finite.
const LARGEST_ENERGY_ERROR_IN_MOTION: f64 = 0.01;

/// The report of a finished test.
pub(super) fn report(
    spec: &PaperTensile,
    specimen: &Specimen,
    course: &Course<'_>,
    end: PullEnd,
    residual_strain: Option<f64>,
) -> Report {
    let measures = course.pull.state().measures;
    let cost = course.pull.cost();
    let mut report = ReportBuilder::new(match end {
        PullEnd::MaxStrain => "max_strain",
        PullEnd::ForceFraction => "force_dropped",
        PullEnd::Parted => "parted",
        PullEnd::NoPath => "no_load_path",
    });
    let records = &course.kept.records;
    results::add(
        &mut report,
        spec,
        specimen,
        &measures,
        records,
        residual_strain,
    );
    match course.pull.motion_report() {
        None => checks(&mut report, &measures, &*course.pull),
        Some(motion) => checks_of_motion(&mut report, &measures, &motion),
    }
    if let Some(tubes) = &specimen.tubes {
        tubes.report(&mut report);
        tubes.warn(&mut report, spec);
    }
    warn(&mut report, spec, specimen, course, end);
    for (name, count) in [
        ("factorings", cost.factors),
        ("solutions", cost.solutions),
        ("iterations", cost.iterations),
        ("unknowns", cost.unknowns),
        ("factor_entries", cost.stored),
    ] {
        report.work(name, count as u64);
    }
    report.finish()
}

fn checks(report: &mut ReportBuilder, measures: &PullMeasures, pull: &dyn Pulling) {
    report.check(
        "frame_residual",
        measures.largest_residual,
        pull.residual_limit(),
        "1",
        "Largest unbalanced force on a node over the largest force of a beam or bond, at any rest.",
    );
    report.check(
        "jaw_force_imbalance",
        measures.largest_jaw_imbalance,
        LARGEST_IMBALANCE,
        "1",
        "Largest difference between the forces on the two jaws, over the maximum force.",
    );
    report.check(
        "energy_balance_error",
        measures.energy_error(),
        pull.index_limit().max(LARGEST_ENERGY_ERROR),
        "1",
        "Work of the jaw that is neither stored nor set free by breaks nor lost by yielding, over the work.",
    );
    if let Some(error) = measures.largest_index_error {
        report.check(
            "failure_index_error",
            error,
            pull.index_limit(),
            "1",
            "Estimated error of the failure indices of what broke next, root mean square (one by one: the \
             largest), at any rest: equilibrium was found by iterations.",
        );
    }
}

fn checks_of_motion(report: &mut ReportBuilder, measures: &PullMeasures, motion: &MotionReport) {
    let step_ns = 1e3 * motion.step_us;
    report.result(
        "time_step",
        step_ns,
        "ns",
        "Step of time, nine tenths of the longest stable one at most.",
    );
    let about =
        "Mass that was added to the lightest nodes for the sake of longer steps, over all mass.";
    report.result("added_mass", motion.added_mass, "1", about);
    report.check(
        "kinetic_share",
        motion.kinetic_share,
        MotionReport::LARGEST_KINETIC_SHARE,
        "1",
        "Largest kinetic energy over elastic energy, from a tenth of the largest force up to it: below a \
         hundredth the speed of the jaw does not matter.",
    );
    report.check(
        "jaw_force_imbalance",
        measures.largest_jaw_imbalance,
        LARGEST_IMBALANCE,
        "1",
        "Largest difference between the mean forces on the two jaws up to the maximum force, over it.",
    );
    report.check(
        "energy_balance_error",
        measures.energy_error(),
        LARGEST_ENERGY_ERROR_IN_MOTION,
        "1",
        "Work of the jaw that is neither elastic nor kinetic energy, nor set free by breaks, nor taken by drag, \
         over the work.",
    );
    report.work("time_steps", motion.steps);
}
