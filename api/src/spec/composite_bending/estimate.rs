//! What a test of a section takes: counted solutions and steps over measured speed.
//!
//! Work is counted in evaluations of one bond of the calibrating fabric. The factors follow some twenty
//! runs of 400 to a million cells at rest by each solver, on rollers and in time, all within a factor of
//! two.
use super::{CompositeBending, Geometry, Lattice, Material, Solver, Way};
use crate::{Calibration, Estimate};

/// One particle in a solution of the equations of 10 000 particles, and the power of the number of
/// particles with which that grows.
const SOLUTION: f64 = 920.0;
const SOLUTION_POWER: f64 = 0.2;
/// One particle on its way to rest, for each cell along the longer side; of `pbd` and `xpbd` for each
/// sweep of a time step.
const REST_VERLET: f64 = 1_000.0;
const REST_PBD: f64 = 3_600.0;
const REST_XPBD: f64 = 600.0;
/// One particle in a time step.
const STEP: f64 = 6.0;
/// The automatic time step over the time a wave takes through a cell.
const STEP_OVER_CROSSING: f64 = 0.5;
/// The same test on half the cells, in that on all of them.
const HALF_IN_TIME: f64 = 1.125;
/// Rounds of contact and of Newton's method in a step of the load.
const CONTACT_ROUNDS: f64 = 6.0;
const NEWTON_ROUNDS: f64 = 4.0;
/// Solutions for each stride of rollers in large displacements, a quarter of their radius long, and strides
/// where only a force is given.
const ROLLING_ROUNDS: f64 = 20.0;
const STRIDES: f64 = 20.0;
/// One particle in an event of a test that breaks, with its coarser grids; events over the square root
/// of the particles, for each step in which a crack opens. Of a section that cracks here and there; one
/// that cracks everywhere has more.
const EVENT: f64 = 80.0;
const EVENTS: f64 = 0.9;
/// Particles of a graded grid with rollers over those of its even cells.
const AT_ROLLERS: f64 = 2.4;
/// Memory of the process itself and of a particle [MB], by a factor and without one.
const PROCESS_MB: f64 = 20.0;
const FACTORED_MB: f64 = 2.8e-3;
const ITERATED_MB: f64 = 0.9e-3;
/// More particles than this are solved without a factor.
const MOST_FACTORED: f64 = 300_000.0;
/// The picture and the faces, per particle [MB].
const DISK_MB: f64 = 180e-6;
/// Reading the spec and writing the files [s].
const START_S: f64 = 0.02;

pub(super) fn estimate(spec: &CompositeBending, calibration: &Calibration) -> Estimate {
    let knobs = spec.accuracy.knobs();
    let grid = spec.grid();
    let is_bent = spec.test.way().is_some_and(|way| way.flexure().is_some());
    let is_refined = is_bent && grid.graded_cells_per_fibre.is_some();
    let particles = spec.particles() as f64 * if is_refined { AT_ROLLERS } else { 1.0 };
    let steps = f64::from(knobs.load_steps);
    let rounds = match spec.test.way() {
        Some(Way::ThreePoint(test) | Way::FourPoint(test) | Way::ShortBeam(test)) => {
            if knobs.geometry == Geometry::Large {
                let radius = test.loading_radius_mm.min(test.support_radius_mm);
                let strides = test.displacement_mm.map(|way| 4.0 * way / radius);
                ROLLING_ROUNDS * strides.unwrap_or(STRIDES).max(steps)
            } else {
                CONTACT_ROUNDS * steps
            }
        }
        _ if knobs.geometry == Geometry::Large => NEWTON_ROUNDS * steps,
        _ => 1.0,
    };
    let lattices = match spec.lattice {
        Lattice::Exact(_) => 1.0,
        Lattice::Paper(_) => 2.0,
    };
    let one = particles * SOLUTION * (particles / 1e4).powf(SOLUTION_POWER);
    let longest = f64::from(grid.cells.into_iter().max().unwrap_or(1));
    let sweeps = f64::from(knobs.iterations);
    let moved = match (&spec.test.history, knobs.solver) {
        (Some(history), _) => STEP * HALF_IN_TIME * time_steps(spec, history.duration_s),
        (None, Solver::Static) => 0.0,
        (None, Solver::Verlet) => REST_VERLET * longest,
        (None, Solver::Pbd) => REST_PBD * sweeps * longest,
        (None, Solver::Xpbd) => REST_XPBD * sweeps * longest,
    };
    let events = spec.test.breaking.as_ref().map_or(0.0, |breaking| {
        let expected = EVENTS * f64::from(breaking.teeth) * particles.sqrt();
        expected.min(breaking.max_events as f64)
    });
    let work = lattices * rounds * one + particles * (moved + EVENT * events);
    let of_particle = if particles > MOST_FACTORED {
        ITERATED_MB
    } else {
        FACTORED_MB
    };
    Estimate {
        wall_s: START_S + work / calibration.bond_evaluations_per_s,
        memory_mb: PROCESS_MB + particles * of_particle,
        disk_mb: if spec.output.picture {
            particles * DISK_MB
        } else {
            0.0
        },
        calibrated: false,
    }
}

/// Time steps in a time, as many as the stiffest and the lightest material and the smallest cells ask for.
fn time_steps(spec: &CompositeBending, duration_s: f64) -> f64 {
    if let Some(step_s) = spec.accuracy.knobs().time_step_s {
        return duration_s / step_s;
    }
    let modulus = |material: &Material| {
        let isotropic = material
            .isotropic
            .map(|constants| constants.youngs_modulus_mpa);
        let orthotropic = material
            .orthotropic
            .map(|constants| constants.modulus_1_mpa.max(constants.modulus_2_mpa));
        isotropic.or(orthotropic).unwrap_or(1.0)
    };
    let materials = || spec.materials.values();
    let stiffest = materials().map(modulus).fold(0.0, f64::max);
    let lightest = materials()
        .filter_map(|material| material.density_kg_per_m3)
        .fold(f64::INFINITY, f64::min);
    let sides = [spec.section.length_mm, spec.section.height_mm];
    let cells = spec.grid().cells.map(f64::from);
    let smallest = (sides[0] / cells[0]).min(sides[1] / cells[1]);
    // MPa over kg/m3 gives (km/s)²; a km/s is 1e6 mm/s
    let wave_mm_per_s = 1e6 * (stiffest / lightest).sqrt();
    duration_s * wave_mm_per_s / (STEP_OVER_CROSSING * smallest)
}
