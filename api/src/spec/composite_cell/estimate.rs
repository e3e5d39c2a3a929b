//! What a unit cell takes: cells of its grid, iterations, and repeats over measured speed.
use super::CompositeCell;
use crate::{Calibration, Estimate, Sharing};

/// Work of a cell of the grid in an iteration, in evaluations of one bond of the calibrating fabric.
const CELL: f64 = 11.5;
/// Iterations of all load cases over the root of the contrast of the phases: 38 at a contrast of 10, 27 at one
/// of 3000.
const ITERATIONS: f64 = 34.0;
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
    let work = f64::from(spec.repeats) * OTHERS * cells * CELL * iterations(spec);
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

/// Iterations that both phases take: conjugate gradients go with the root of the contrast.
fn iterations(spec: &CompositeCell) -> f64 {
    let moduli = |name: &str| {
        let material = spec.materials.get(name)?;
        let (stiffness, _) = material.elastic()?.stiffness_of_space().ok()?;
        // along 2, and in shear along the fibres
        Some([stiffness[(1, 1)], stiffness[(5, 5)]])
    };
    let contrast = moduli(&spec.matrix).zip(moduli(&spec.fibre));
    let contrast = contrast.map_or(1.0, |(matrix, fibre)| {
        let ratios = matrix.into_iter().zip(fibre);
        let either = ratios.map(|(matrix, fibre)| (fibre / matrix).max(matrix / fibre));
        either.fold(1.0, f64::max)
    });
    ITERATIONS * contrast.sqrt()
}
