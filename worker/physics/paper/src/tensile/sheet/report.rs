//! The report of the test of a sheet: why it ended, its results, and whether to believe them.
use indexmap::IndexMap;
use loadframe_api::spec::paper_tensile::PaperTensile;
use loadframe_api::{QualityCheck, Report};

use super::course::Course;
use super::results::Rows;
use super::specimen::Specimen;
use super::warnings::warnings;
use crate::frame::{PullEnd, PullMeasures, UNBALANCED};

/// Largest difference between the jaw forces, relative to the maximum force, that goes without
/// warning: the force error ISO 7500-1 allows a testing machine of class 1.
const LARGEST_IMBALANCE: f64 = 0.01;
/// Work that is neither stored nor set free, over the work.
const LARGEST_ENERGY_ERROR: f64 = 1e-6;

/// The report of a finished test.
pub(super) fn report(
    spec: &PaperTensile,
    specimen: &Specimen,
    course: &Course<'_>,
    end: PullEnd,
) -> Report {
    let measures = course.pull.state().measures;
    let cost = course.pull.cost();
    let rows = Rows::of(spec, specimen, &measures, &course.kept.records);
    Report {
        stop_reason: match end {
            PullEnd::MaxStrain => "max_strain",
            PullEnd::ForceFraction => "force_dropped",
            PullEnd::Parted => "parted",
            PullEnd::NoPath => "no_load_path",
        }
        .to_owned(),
        warnings: warnings(
            spec,
            specimen,
            course,
            end,
            rows.value("tensile_stiffness_index"),
        ),
        summary: rows.into_summary(),
        quality: quality(&measures),
        bodies: Vec::new(),
        work: IndexMap::from([
            ("factorings".to_owned(), cost.factors as u64),
            ("solutions".to_owned(), cost.solutions as u64),
            ("unknowns".to_owned(), cost.unknowns as u64),
            ("factor_entries".to_owned(), cost.stored as u64),
        ]),
    }
}

fn quality(measures: &PullMeasures) -> IndexMap<String, QualityCheck> {
    IndexMap::from([
        (
            "frame_residual".to_owned(),
            QualityCheck::at_most(
                measures.largest_residual,
                UNBALANCED,
                "1",
                "Largest unbalanced force on a node over the largest force of a beam or bond, at any rest.",
            ),
        ),
        (
            "jaw_force_imbalance".to_owned(),
            QualityCheck::at_most(
                measures.largest_jaw_imbalance,
                LARGEST_IMBALANCE,
                "1",
                "Largest difference between the forces on the two jaws, over the maximum force.",
            ),
        ),
        (
            "energy_balance_error".to_owned(),
            QualityCheck::at_most(
                measures.energy_error(),
                LARGEST_ENERGY_ERROR,
                "1",
                "Work of the jaw that is neither stored nor set free by breaks, over the work.",
            ),
        ),
    ])
}
