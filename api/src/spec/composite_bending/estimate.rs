//! What a test of a section takes: counted solutions and steps over measured speed.
//!
//! Work is counted in evaluations of one bond of the calibrating fabric. The factors follow runs
//! of 400 to a million cells at rest by each solver, on rollers and in time; `tests/composite/estimates`
//! holds them against random jobs. How many steps `verlet` takes to come to rest follows from how slowly the
//! section swings ([`lowest_per_s`]).
use super::lines::Laid;
use super::lowest::lowest_per_s;
use super::{CompositeBending, Geometry, MOTION_RESIDUAL, Material, Ply, Solver, Way};
use crate::section::settling::steps_to_rest;
use crate::section::solving::is_factored;
use crate::{Calibration, Estimate, Sharing};

/// One particle in a solution of the equations of 10 000 particles, and the power of the number of
/// particles with which that grows.
const SOLUTION: f64 = 1150.0;
const SOLUTION_POWER: f64 = 0.2;
/// One particle on its way to rest by `pbd` and `xpbd`, for each of the smallest cells along the longer side and
/// each sweep of a time step.
const REST_PBD: f64 = 800.0;
const REST_XPBD: f64 = 75.0;
/// One particle in a time step on the way to rest, and of a motion that is watched.
const STEP: f64 = 2.5;
const STEP_OF_HISTORY: f64 = 5.2;
/// Particles from which threads share the motion, and the share of the time that they divide (the guide's
/// table `threads`).
const SHARED_FROM: f64 = 20_000.0;
const SHARED: f64 = 0.7;
/// The automatic time step over the time a wave takes through a cell.
const STEP_OVER_CROSSING: f64 = 0.5;
/// Rounds of contact in a step of the load, and where a first answer tells how wide contacts are.
const CONTACT_ROUNDS: f64 = 3.0;
const CONTACT_ROUNDS_GRADED: f64 = 5.0;
/// Rounds of Newton's method at the first step of the load, more than at others, and at every step: between those of
/// small loads and those of sections that turn by a right angle.
const FIRST_ROUNDS: f64 = 2.4;
const NEWTON_ROUNDS: f64 = 1.5;
/// Solutions for each stride of rollers in large displacements, a quarter of their radius long, and strides
/// where only a force is given.
const ROLLING_ROUNDS: f64 = 20.0;
const STRIDES: f64 = 20.0;
/// One particle in an event of a test that breaks, with its coarser grids; where rollers press on many small
/// cells, whose contacts are found with it.
const EVENT: f64 = 160.0;
const EVENT_AT_ROLLERS: f64 = 850.0;
/// Events over the square root of the particles, for each step in which a crack opens: of a section that
/// cracks here and there, of plies that come apart along their whole length, and of plies that are pulled
/// and crack everywhere.
const EVENTS: f64 = 0.65;
const EVENTS_BETWEEN_PLIES: f64 = 1.0;
const EVENTS_OF_PULLED_PLIES: f64 = 7.0;
/// Memory of the process itself and of a particle [MB], by a factor and without one.
const PROCESS_MB: f64 = 20.0;
const FACTORED_MB: f64 = 2.8e-3;
const ITERATED_MB: f64 = 0.9e-3;
/// The picture and the faces, per particle [MB].
const DISK_MB: f64 = 180e-6;
/// Reading the spec and writing the files [s].
const START_S: f64 = 0.01;

pub(super) fn estimate(spec: &CompositeBending, calibration: &Calibration) -> Estimate {
    let knobs = spec.accuracy.knobs();
    let is_bent = spec.test.way().is_some_and(|way| way.flexure().is_some());
    let laid = spec.laid();
    let steps = f64::from(knobs.load_steps);
    let rounds = match spec.test.way() {
        Some(Way::ThreePoint(test) | Way::FourPoint(test) | Way::ShortBeam(test)) => {
            if knobs.geometry == Geometry::Large {
                let radius = test.loading_radius_mm.min(test.support_radius_mm);
                let strides = test.displacement_mm.map(|way| 4.0 * way / radius);
                ROLLING_ROUNDS * strides.unwrap_or(STRIDES).max(steps)
            } else if laid.first().is_some_and(|laid| laid.is_graded) {
                CONTACT_ROUNDS_GRADED * steps
            } else {
                CONTACT_ROUNDS * steps
            }
        }
        _ if knobs.geometry == Geometry::Large => FIRST_ROUNDS + NEWTON_ROUNDS * steps,
        _ => 1.0,
    };
    let on_grids: f64 = laid
        .iter()
        .map(|laid| {
            let particles = laid.particles as f64;
            let one = SOLUTION * (particles / 1e4).powf(SOLUTION_POWER);
            let moved = spec.test.history.as_ref().map_or(0.0, |history| {
                STEP_OF_HISTORY * history.duration_s / time_step_s(spec, laid)
            });
            particles * (rounds * one + moved)
        })
        .sum();
    let particles = laid.first().map_or(0.0, |laid| laid.particles as f64);
    // a wave runs through the smallest cells no faster than through others
    let longer = spec.section.length_mm.max(spec.section.height_mm);
    let longest = laid.first().map_or(1.0, |laid| longer / laid.smallest_mm);
    let sweeps = f64::from(knobs.iterations);
    let to_rest = match knobs.solver {
        Solver::Static => 0.0,
        Solver::Verlet if spec.test.history.is_some() => 0.0,
        Solver::Verlet => laid
            .first()
            .map_or(0.0, |laid| STEP * steps_of_verlet(spec, laid)),
        Solver::Pbd => REST_PBD * sweeps * longest,
        Solver::Xpbd => REST_XPBD * sweeps * longest,
    };
    let events = spec.test.breaking.as_ref().map_or(0.0, |breaking| {
        let each = if spec.ply_interface.is_some() {
            EVENTS_BETWEEN_PLIES
        } else if spec.test.tension.is_some() && spec.plies.len() > 1 {
            EVENTS_OF_PULLED_PLIES
        } else {
            EVENTS
        };
        let expected = each * f64::from(breaking.teeth) * particles.sqrt();
        expected.min(breaking.max_events as f64)
    });
    let is_pressed = is_bent && laid.first().is_some_and(|laid| laid.is_graded);
    let event = if is_pressed { EVENT_AT_ROLLERS } else { EVENT };
    let work = on_grids + particles * (to_rest + event * events);
    let memory_of = |laid: &Laid| {
        let particles = laid.particles as f64;
        let is_stretched = is_bent && laid.is_graded;
        let stretch = if is_stretched {
            f64::INFINITY
        } else {
            laid.stretch
        };
        let of_particle = if is_factored(particles as u64, stretch) {
            FACTORED_MB
        } else {
            ITERATED_MB
        };
        particles * of_particle
    };
    let most_mb = laid.iter().map(memory_of).fold(0.0, f64::max);
    Estimate {
        wall_s: START_S + work / calibration.bond_evaluations_per_s,
        memory_mb: PROCESS_MB + most_mb,
        disk_mb: if spec.output.picture {
            particles * DISK_MB
        } else {
            0.0
        },
        calibrated: false,
        threads_wall_s: None,
        sharing: Sharing {
            tests: 1.0,
            within: match knobs.solver {
                Solver::Verlet if particles >= SHARED_FROM => SHARED,
                _ => 0.0,
            },
        },
    }
}

/// Time steps of `verlet` to rest.
fn steps_of_verlet(spec: &CompositeBending, laid: &Laid) -> f64 {
    let knobs = spec.accuracy.knobs();
    let most = knobs.step_limit as f64;
    let residual = knobs.residual.unwrap_or(MOTION_RESIDUAL);
    let lowest = lowest_per_s(spec, ANY_DENSITY);
    lowest.map_or(most, |lowest| {
        steps_to_rest(
            lowest,
            knobs.damping_per_s,
            time_step_s(spec, laid),
            residual,
        )
        .min(most)
    })
}

/// Density of what is only brought to rest, where none is given [kg/m³].
const ANY_DENSITY: f64 = 1_000.0;

/// Time step on a grid [s].
fn time_step_s(spec: &CompositeBending, laid: &Laid) -> f64 {
    let given = spec.accuracy.knobs().time_step_s;
    given.unwrap_or_else(|| automatic_step_s(spec, laid.smallest_mm))
}

/// The automatic time step of a grid whose smallest side of a cell is `smallest_mm`, about [s].
pub(super) fn automatic_step_s(spec: &CompositeBending, smallest_mm: f64) -> f64 {
    let modulus = |material: &Material| {
        let isotropic = material
            .isotropic
            .map(|constants| constants.youngs_modulus_mpa);
        let orthotropic = material
            .orthotropic
            .map(|constants| constants.modulus_1_mpa.max(constants.modulus_2_mpa));
        isotropic.or(orthotropic).unwrap_or(1.0)
    };
    // plies whose fibres run out of the plane show their other modulus
    let across = |ply: &Ply| {
        let material = spec.materials.get(&ply.material)?;
        let is_across = (ply.angle_deg / 90.0).rem_euclid(2.0) - 1.0;
        let constants = material.orthotropic.filter(|_| is_across.abs() < 1e-9);
        Some(constants.map_or_else(|| modulus(material), |found| found.modulus_2_mpa))
    };
    let others = spec.fibres.iter().map(|fibre| &fibre.material);
    let others = others.chain(&spec.matrix);
    let others = others.filter_map(|name| spec.materials.get(name).map(modulus));
    let moduli = others.chain(spec.plies.iter().filter_map(across));
    let stiffest = moduli.fold(0.0, f64::max);
    let materials = || spec.materials.values();
    let lightest = materials()
        .map(|material| material.density_kg_per_m3.unwrap_or(ANY_DENSITY))
        .fold(f64::INFINITY, f64::min);
    // MPa over kg/m3 gives (km/s)²; a km/s is 1e6 mm/s
    let wave_mm_per_s = 1e6 * (stiffest / lightest).sqrt();
    STEP_OVER_CROSSING * smallest_mm / wave_mm_per_s
}
