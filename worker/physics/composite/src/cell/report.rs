//! The report of a cell: constants with their errors, what tells whether to believe them, warnings.
use indexmap::IndexMap;
use loadframe_api::spec::composite_cell::CompositeCell;
use loadframe_api::{ErrorBasis, ErrorPart, QualityCheck, Quantity, Report, Warning};

use super::conduct::Tested;
use super::results::{CONSTANTS, Strength};
use crate::error::CompositeError;
use crate::homogenise::bounds::{Beyond, beyond};
use crate::homogenise::{Part, Phase};

/// Unbalanced force over the load, at most.
const LARGEST_RESIDUAL: f64 = 1e-6;
/// Error for the grid over the value of the worst modulus, at most.
const LARGEST_GRID_ERROR: f64 = 0.02;

pub(super) fn report(spec: &CompositeCell, tested: &Tested) -> Result<Report, CompositeError> {
    let effective = &tested.effective;
    let mut summary = IndexMap::new();
    let values = effective.constants.values();
    let errors = tested.errors.constants.values();
    let mut worst = 0.0_f64;
    for ((kind, value), error) in CONSTANTS.iter().zip(values).zip(errors) {
        if kind.unit == "MPa" {
            worst = worst.max(error / value);
        }
        let quantity = Quantity::new(value, kind.unit, kind.description);
        summary.insert(
            kind.name.to_owned(),
            quantity.with_error(vec![of_grid(error)]),
        );
    }
    for Strength {
        kind,
        mpa,
        error_mpa,
        part,
    } in &tested.strengths
    {
        let part = match part {
            Part::Matrix => "in the matrix",
            Part::Fibre => "in a fibre",
            Part::Interface => "on the face of a fibre",
        };
        let about = format!(
            "{}, here {part}: not where the ply fails.",
            kind.description
        );
        let quantity = Quantity::new(*mpa, kind.unit, &about);
        summary.insert(
            kind.name.to_owned(),
            quantity.with_error(vec![of_grid(*error_mpa)]),
        );
    }
    let [columns, rows] = effective.grid();
    for (name, value, about) in [
        (
            "fibre_fraction",
            effective.fraction,
            "Volume of fibres over that of the cell.",
        ),
        (
            "fibres",
            tested.cell.fibres.len() as f64,
            "Fibres in the cell.",
        ),
        ("cells", (columns * rows) as f64, "Cells of the grid."),
    ] {
        summary.insert(name.to_owned(), Quantity::new(value, "1", about));
    }
    let quality = quality(tested, worst);
    let cell = &tested.cell;
    let beyond = beyond(
        effective,
        Some(&tested.errors.constants),
        &cell.fibre,
        &cell.matrix,
    )?;
    let warnings = warnings(spec, tested, &quality, &beyond);
    Ok(Report {
        stop_reason: "solved".to_owned(),
        summary,
        quality,
        warnings,
        bodies: Vec::new(),
        work: IndexMap::from([("iterations".to_owned(), effective.iterations)]),
    })
}

fn of_grid(value: f64) -> ErrorPart {
    ErrorPart {
        source: "grid".to_owned(),
        value,
        basis: ErrorBasis::TwoGrids,
    }
}

fn quality(tested: &Tested, worst: f64) -> IndexMap<String, QualityCheck> {
    IndexMap::from([
        (
            "residual".to_owned(),
            QualityCheck::at_most(
                tested.effective.residual,
                LARGEST_RESIDUAL,
                "1",
                "Largest unbalanced force over the load, of all load cases.",
            ),
        ),
        (
            "estimated_discretisation_error".to_owned(),
            QualityCheck::at_most(
                worst,
                LARGEST_GRID_ERROR,
                "1",
                "Error for the grid over the value, of the modulus that has the largest, from coarser \
                 grids.",
            ),
        ),
    ])
}

fn warnings(
    spec: &CompositeCell,
    tested: &Tested,
    quality: &IndexMap<String, QualityCheck>,
    beyond: &[Beyond],
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
    for beyond in beyond {
        warn("beyond_bounds", beyond.to_string());
    }
    let grid_error = quality.get("estimated_discretisation_error");
    if let Some(check) = grid_error.filter(|check| !check.ok) {
        warn(
            "coarse_grid",
            format!(
                "the grid adds an error of about {:.1} %; twice the cells_per_fibre halve it, or more, for \
                 about five times the time",
                100.0 * check.value
            ),
        );
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
