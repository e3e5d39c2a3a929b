//! The report of a cell: constants with their errors, what tells whether to believe them, warnings.
use loadframe_api::spec::composite_cell::{Accuracy, CompositeCell, Knobs};
use loadframe_api::{ErrorBasis, ErrorPart, Report, Spec as _};
use loadframe_harness::ReportBuilder;

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
    let mut report = ReportBuilder::new("solved");
    let values = effective.constants.values();
    let errors = tested.errors.constants.values();
    let mut worst = 0.0_f64;
    for ((kind, value), error) in CONSTANTS.iter().zip(values).zip(errors) {
        if kind.unit == "MPa" {
            worst = worst.max(error / value);
        }
        let parts = vec![of_grid(spec, error)];
        report.result_with_error(kind.name, value, kind.unit, kind.description, parts);
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
        let parts = vec![of_grid(spec, *error_mpa)];
        report.result_with_error(kind.name, *mpa, kind.unit, &about, parts);
    }
    let [columns, rows] = effective.grid();
    let cell = &tested.cell;
    let about = "Volume of fibres over that of the cell.";
    report.result("fibre_fraction", effective.fraction, "1", about);
    report.count("fibres", cell.fibres.len(), "Fibres in the cell.");
    report.count("cells", columns * rows, "Cells of the grid.");
    checks(&mut report, tested, worst);
    let beyond = beyond(
        effective,
        Some(&tested.errors.constants),
        &cell.fibre,
        &cell.matrix,
    )?;
    warn(&mut report, spec, tested, &beyond);
    report.work("iterations", effective.iterations);
    Ok(report.finish())
}

/// Cells through the thinnest fibre that a spec may ask for at most.
const MOST_CELLS: u32 = 512;

/// With what makes it a tenth: errors are counted as of the first order.
fn of_grid(spec: &CompositeCell, value: f64) -> ErrorPart {
    let mut changed = spec.clone();
    let cells = 10 * spec.chosen_knobs().cells_per_fibre;
    changed.accuracy = Accuracy::Knobs(Knobs {
        cells_per_fibre: cells,
    });
    let tenth = (cells <= MOST_CELLS)
        .then(|| spec.tenth(format!("accuracy.cells_per_fibre {cells}"), &changed));
    ErrorPart::new("grid", value, ErrorBasis::TwoGrids).with_tenth(tenth.flatten())
}

fn checks(report: &mut ReportBuilder, tested: &Tested, worst: f64) {
    report.check(
        "residual",
        tested.effective.residual,
        LARGEST_RESIDUAL,
        "1",
        "Largest unbalanced force over the load, of all load cases.",
    );
    report.check(
        "estimated_discretisation_error",
        worst,
        LARGEST_GRID_ERROR,
        "1",
        "Error for the grid over the value, of the modulus that has the largest, from coarser \
                 grids.",
    );
}

fn warn(report: &mut ReportBuilder, spec: &CompositeCell, tested: &Tested, beyond: &[Beyond]) {
    for (phase, note) in &tested.effective.notes {
        let name = match phase {
            Phase::Matrix => &spec.matrix,
            Phase::Fibre => &spec.fibre,
        };
        report.warn("assumed_constant", format!("material {name:?}: {note}"));
    }
    for beyond in beyond {
        report.warn("beyond_bounds", beyond.to_string());
    }
    let grid_error = report.failed("estimated_discretisation_error");
    if let Some(error) = grid_error.map(|check| check.value) {
        report.warn(
            "coarse_grid",
            format!(
                "the grid adds an error of about {:.1} %; twice the cells_per_fibre halve it, or more, for \
                 about five times the time",
                100.0 * error
            ),
        );
    }
    if let Some(residual) = report.failed("residual").map(|check| check.value) {
        report.warn(
            "residual",
            format!(
                "forces are not balanced as well as they should be: materials differ too much in \
                 stiffness ({residual:e})"
            ),
        );
    }
}
