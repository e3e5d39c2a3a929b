//! The report of a cell: constants with their errors, what tells whether to believe them, warnings.
use indexmap::IndexMap;
use loadframe_api::spec::composite_cell::CompositeCell;
use loadframe_api::{ErrorBasis, ErrorPart, QualityCheck, Quantity, Report, Warning};

use super::conduct::Tested;
use super::results::CONSTANTS;
use crate::error::CompositeError;
use crate::homogenise::Phase;

/// Unbalanced force over the load, at most.
const LARGEST_RESIDUAL: f64 = 1e-6;
/// Error for the grid over the value of the worst modulus, at most.
const LARGEST_GRID_ERROR: f64 = 0.02;

pub(super) fn report(spec: &CompositeCell, tested: &Tested) -> Result<Report, CompositeError> {
    let effective = &tested.effective;
    let mut summary = IndexMap::new();
    let values = effective.constants.values();
    let mut worst = f64::NAN;
    for (place, (kind, value)) in CONSTANTS.iter().zip(values).enumerate() {
        let error = grid_error(tested, place);
        if kind.unit == "MPa" {
            // max takes the number of a number and what is none
            worst = worst.max(error / value);
        }
        let part = ErrorPart {
            source: "grid".to_owned(),
            value: error,
            basis: ErrorBasis::TwoGrids,
        };
        let quantity = Quantity::new(value, kind.unit, kind.description).with_error(vec![part]);
        summary.insert(kind.name.to_owned(), quantity);
    }
    let [columns, rows] = effective.grid();
    for (name, value, about) in [
        (
            "fibre_fraction",
            effective.fraction,
            "Volume of fibres over that of the cell.",
        ),
        ("fibres", tested.cell.fibres.len() as f64, "Fibres in the cell."),
        ("cells", (columns * rows) as f64, "Cells of the grid."),
    ] {
        summary.insert(name.to_owned(), Quantity::new(value, "1", about));
    }
    let quality = quality(tested, worst);
    let warnings = warnings(spec, tested, &quality);
    Ok(Report {
        stop_reason: "solved".to_owned(),
        summary,
        quality,
        warnings,
        bodies: Vec::new(),
        work: IndexMap::from([("iterations".to_owned(), effective.iterations)]),
    })
}

/// How far a constant is from that of ever finer grids: cells cut by the round faces of fibres leave
/// an error of the first order, whose rest is as large as what the last halving changed; grids cut them
/// each in another way, so that the change before counts, too, by half.
fn grid_error(tested: &Tested, place: usize) -> f64 {
    let values: Vec<f64> = tested.grids.iter().map(|grid| grid.constants[place]).collect();
    match values.as_slice() {
        [.., coarsest, coarse, fine] => {
            (fine - coarse).abs().max(0.5 * (coarse - coarsest).abs())
        }
        [coarse, fine] => (fine - coarse).abs(),
        _ => f64::NAN,
    }
}

fn quality(tested: &Tested, worst: f64) -> IndexMap<String, QualityCheck> {
    let mut quality = IndexMap::from([(
        "residual".to_owned(),
        QualityCheck::at_most(
            tested.effective.residual,
            LARGEST_RESIDUAL,
            "1",
            "Largest unbalanced force over the load, of all load cases.",
        ),
    )]);
    if worst.is_finite() {
        quality.insert(
            "estimated_discretisation_error".to_owned(),
            QualityCheck::at_most(
                worst,
                LARGEST_GRID_ERROR,
                "1",
                "Error for the grid over the value, of the modulus that has the largest, from coarser \
                 grids.",
            ),
        );
    }
    quality
}

fn warnings(
    spec: &CompositeCell,
    tested: &Tested,
    quality: &IndexMap<String, QualityCheck>,
) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let mut warn = |code: &str, detail: String| {
        warnings.push(Warning {
            code: code.to_owned(),
            detail,
        });
    };
    for (phase, note) in &tested.effective.notes {
        let name = match phase {
            Phase::Matrix => &spec.matrix,
            Phase::Fibre => &spec.fibre,
        };
        warn("assumed_constant", format!("material {name:?}: {note}"));
    }
    match quality.get("estimated_discretisation_error") {
        Some(check) if !check.ok => warn(
            "coarse_grid",
            format!(
                "the grid adds an error of about {:.1} %; twice the cells_per_fibre halve it, or more, for \
                 about five times the time",
                100.0 * check.value
            ),
        ),
        Some(_) => {}
        None => warn(
            "unknown_discretisation_error",
            "no coarser grid could be tried, so that the grid's error is not known".to_owned(),
        ),
    }
    if let Some(check) = quality.get("residual").filter(|check| !check.ok) {
        warn(
            "residual",
            format!(
                "forces are not balanced as well as they should be: materials differ too much in \
                 stiffness ({:e})",
                check.value
            ),
        );
    }
    warnings
}
