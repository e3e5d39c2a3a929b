//! What a test of a section takes: counted solutions and steps over measured speed.
use super::{CompositeBending, Geometry, Solver, Way};
use crate::{Calibration, Estimate};

/// Evaluations of a bond, in time, that one particle costs in a solution of the equations of 10 000
/// particles, and the power of the number of particles with which that grows.
const SOLUTION: f64 = 1_500.0;
const SOLUTION_POWER: f64 = 0.35;
/// The same of one particle in a time step, and in a sweep of one.
const STEP: f64 = 60.0;
const SWEEP: f64 = 60.0;
/// Time steps to rest per particle along the longer side.
const STEPS_TO_REST: f64 = 40.0;
/// Rounds of contact and of Newton's method in a step of the load.
const CONTACT_ROUNDS: f64 = 6.0;
const NEWTON_ROUNDS: f64 = 6.0;
/// Solutions on the coarser grids, in those of the finest.
const COARSER: f64 = 1.4;
/// Memory of the process itself, per particle [MB], and what of it grows faster, at 1e6 particles.
const MEMORY_MB: [f64; 3] = [14.0, 1.2e-3, 0.3e-3];
/// The picture and the faces, per particle [MB].
const DISK_MB: f64 = 180e-6;
/// Reading the spec and writing the files [s].
const START_S: f64 = 0.02;

pub(super) fn estimate(spec: &CompositeBending, calibration: &Calibration) -> Estimate {
    let particles = spec.particles() as f64;
    let knobs = spec.accuracy.knobs();
    let steps = f64::from(knobs.load_steps);
    let one = particles * SOLUTION * (particles / 1e4).powf(SOLUTION_POWER).max(0.3);
    let rounds = match spec.test.way() {
        Some(Way::ThreePoint(_) | Way::FourPoint(_) | Way::ShortBeam(_)) => CONTACT_ROUNDS * steps,
        _ if knobs.geometry == Geometry::Large => NEWTON_ROUNDS * steps,
        _ => 1.0,
    };
    let solutions = one * rounds * COARSER;
    let longest = f64::from(spec.grid().cells.into_iter().max().unwrap_or(1));
    let motion = match knobs.solver {
        Solver::Static => 0.0,
        Solver::Verlet => STEP,
        Solver::Pbd | Solver::Xpbd => STEP + SWEEP * f64::from(knobs.iterations),
    };
    let moved = particles * motion * STEPS_TO_REST * longest;
    Estimate {
        wall_s: START_S + (solutions + moved) / calibration.bond_evaluations_per_s,
        memory_mb: MEMORY_MB[0]
            + particles * (MEMORY_MB[1] + MEMORY_MB[2] * (particles / 1e6).sqrt()),
        disk_mb: if spec.output.picture {
            particles * DISK_MB
        } else {
            0.0
        },
        calibrated: false,
    }
}
