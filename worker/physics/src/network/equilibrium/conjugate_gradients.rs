//! Preconditioned conjugate gradients for the Newton step H d = F.
use super::{block_jacobi::BlockJacobi, work::Meter};
use crate::{
    Interrupt,
    network::{Vector, assembly::Assembly, configuration::Configuration},
    parallel::{Team, ordered_sum},
};

/// A Newton step.
#[derive(Debug)]
pub(super) struct Step {
    /// d of every node [mm], zero at held ones.
    pub(super) direction: Vec<Vector>,
    /// The Hessian was found to curve downwards; `direction` then is what was found before.
    pub(super) curves_down: bool,
}

/// When the iterations end, in terms of the squared preconditioned norm of the residual.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stop {
    /// Relative to the start.
    pub(super) relative: f64,
    pub(super) absolute: f64,
    pub(super) iterations: usize,
}

/// What one free node keeps between iterations, side by side because it is used together.
struct Row {
    solution: Vector,
    residual: Vector,
    preconditioned: Vector,
}

/// Solves for the Newton step with every transverse bond stiffness raised to `least_transverse`.
///
/// # Errors
/// The interrupt that ended it early.
pub(super) fn newton_step(
    assembly: &Assembly,
    configuration: &Configuration,
    preconditioner: &BlockJacobi,
    least_transverse: f64,
    stop: Stop,
    team: &Team,
    meter: &mut Meter<'_>,
) -> Result<Step, Interrupt> {
    let free = assembly.free();
    let force = &configuration.resultants[..free];
    let start = |(node, force): (usize, &Vector)| Row {
        solution: Vector::zeros(),
        residual: *force,
        preconditioned: preconditioner.apply(node, force),
    };
    let mut rows: Vec<Row> = force.iter().enumerate().map(start).collect();
    let start_norm = preconditioner.norm(force);
    let mut search = vec![Vector::zeros(); assembly.nodes()];
    for (search, row) in search.iter_mut().zip(&rows) {
        *search = row.preconditioned;
    }
    let mut product = vec![Vector::zeros(); assembly.nodes()];
    let enough = (stop.relative * start_norm).max(stop.absolute);
    let mut norm = start_norm;
    let mut curves_down = false;
    for _ in 0..stop.iterations {
        if norm <= enough {
            break;
        }
        meter.spend(assembly.bonds.len())?;
        meter.work.conjugate_gradient_iterations += 1;
        configuration.multiply(assembly, team, least_transverse, &search, &mut product);
        let curvature = ordered_sum(free, |node| search[node].dot(&product[node]));
        if curvature.is_nan() || curvature <= 0.0 {
            curves_down = true;
            break;
        }
        let length = norm / curvature;
        let next_norm = team.fill(&mut rows, |start, rows| {
            let mut norm = 0.0;
            for (offset, row) in rows.iter_mut().enumerate() {
                let node = start + offset;
                row.solution += search[node] * length;
                row.residual -= product[node] * length;
                row.preconditioned = preconditioner.apply(node, &row.residual);
                norm += row.residual.dot(&row.preconditioned);
            }
            norm
        });
        let turn = next_norm / norm;
        norm = next_norm;
        team.fill(&mut search[..free], |start, search| {
            for (offset, search) in search.iter_mut().enumerate() {
                *search = rows[start + offset].preconditioned + *search * turn;
            }
            0.0
        });
    }
    let mut direction = search;
    for (direction, row) in direction.iter_mut().zip(&rows) {
        *direction = row.solution;
    }
    Ok(Step {
        direction,
        curves_down,
    })
}
