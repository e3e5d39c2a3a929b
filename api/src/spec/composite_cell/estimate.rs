//! What a unit cell takes: cells of its grid, iterations, and repeats over measured speed.
use super::CompositeCell;
use crate::{Calibration, Estimate, Sharing};

/// Work of a cell of the grid in all load cases, in evaluations of one bond of the calibrating
/// fabric, with the contrast of carbon in epoxy.
const CELL: f64 = 30_000.0;
/// The half and the quarter of the cells along both sides, beside all of them.
const OTHERS: f64 = 1.3125;
/// Memory of the process itself and of a cell [MB].
const PROCESS_MB: f64 = 20.0;
const CELL_MB: f64 = 0.8e-3;
/// The picture, per cell [MB].
const DISK_MB: f64 = 150e-6;
/// Reading the spec and writing the files [s].
const START_S: f64 = 0.02;

pub(super) fn estimate(spec: &CompositeCell, calibration: &Calibration) -> Estimate {
    let [columns, rows] = spec.cells().map(f64::from);
    let cells = columns * rows;
    let work = f64::from(spec.repeats) * OTHERS * cells * CELL;
    Estimate {
        wall_s: START_S + work / calibration.bond_evaluations_per_s,
        memory_mb: PROCESS_MB + CELL_MB * cells,
        disk_mb: if spec.output.picture {
            cells * DISK_MB
        } else {
            0.0
        },
        calibrated: false,
        threads_wall_s: None,
        sharing: Sharing {
            tests: f64::from(spec.repeats),
            within: 0.0,
        },
    }
}
