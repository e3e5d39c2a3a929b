//! What a nonwoven tensile test takes: counted work over measured speed.
//!
//! The work is counted in evaluations of one bond (`bond_evaluations` in an outcome's cost). How it
//! grows with the spec was fitted to 30 runs from 3 000 to 250 000 bonds, A_cc 10 to 1e8, strain
//! steps 0.5 % to 5 %, with and without breaking, by all three solvers; the fit was within a factor
//! of 1.7 on all of them. Newton's method became faster since; its factors follow eight runs of the
//! present one, up to 2.7 million bonds and 20 layers. There is no theory behind this beyond the
//! powers that one expects: longer waves in larger networks, more digits for a tighter limit.
use super::{Breaking, DescentGradient, Fabric, Jaws, Lattice, NonwovenTensile, Solver, Target};
use crate::{Calibration, Estimate, Sharing};

/// Relaxations take longer per evaluation than the solver that calibrates: they visit bonds node
/// by node, in double precision and one at a time.
const RELAXATION_SLOWDOWN: f64 = 9.0;
/// One after the other instead of all at once means more breaking rounds.
const WEAKEST_FIRST: f64 = 1.6;
/// Sweeps of a descent where the spec does not say, and moves of a node in each at most: nearly all are
/// made, because nearly no step comes to balance.
const DESCENT_SWEEPS: f64 = 1_000.0;
const DESCENT_MOVES: f64 = 50.0;
/// A flat fabric that starts as an even lattice hardly bends.
const FLAT: f64 = 0.35;
/// Beyond this A_cc Newton's method converges quadratically and digits come cheaper.
const QUADRATIC_FROM: f64 = 1e4;
/// Memory of the process itself and per bond [MB], disk per bond and snapshot, per step [MB].
const MEMORY_MB: [f64; 2] = [14.0, 550e-6];
const SNAPSHOT_MB_PER_BOND: f64 = 40e-6;
/// Reading the spec, building the network, writing the files [s].
const START_S: f64 = 0.04;
/// What beginning a run of bonds costs, in bonds of the vectorised kernels.
const RUN_START: f64 = 15.0;
/// Points per row of the calibrating fabric.
const CALIBRATED_ROW: f64 = 49.0;
/// Bonds in a row of a network that is given, at most: they are gathered.
const GATHERED_ROW: f64 = 8.0;
const STEP_MB: f64 = 250e-6;
/// Nodes from which threads gain anything by sharing one specimen, and the share of the time that they divide:
/// of 300 000 nodes (the guide's table `threads`).
const SHARED_FROM: f64 = 1e5;
const SHARED: f64 = 0.6;
/// What a step on a way that was gone before takes, over a step of the first pull.
const LATER_STEP: f64 = 0.5;
/// Strain and force of a step, and the results of one test, where there are repeats [MB].
const POINT_MB: f64 = 45e-6;
const RESULTS_MB: f64 = 500e-6;
const EVENT_MB: f64 = 65e-6;

impl Lattice {
    /// Lattice points, jaw points not counted: rows alternate between n_x and n_x + 1.
    pub fn nodes(&self) -> u64 {
        let (columns, rows, layers) = self.sizes();
        (rows * columns + rows / 2) * layers
    }

    /// Bonds, those between two held nodes left out.
    pub fn bonds(&self) -> u64 {
        let (columns, rows, layers) = self.sizes();
        let in_rows = rows * columns - rows.div_ceil(2);
        let diagonals = 2 * columns * rows.saturating_sub(1);
        let upright = (rows * columns + rows / 2) * (layers - 1);
        let all = (in_rows + diagonals) * layers + upright;
        match self.jaws {
            Jaws::HalfBond => all + 4 * columns * layers,
            Jaws::ClampedRows => all - 2 * ((columns - 1) * layers + columns * (layers - 1)),
        }
    }

    /// Points in the half-bond jaws.
    fn jaw_points(&self) -> u64 {
        match self.jaws {
            Jaws::HalfBond => 4 * u64::from(self.points_per_row),
            Jaws::ClampedRows => 0,
        }
    }

    fn sizes(&self) -> (u64, u64, u64) {
        (
            self.points_per_row.into(),
            self.rows.into(),
            self.layers.into(),
        )
    }
}

impl Fabric {
    /// Free and held nodes of the lattice or network.
    pub fn nodes(&self) -> u64 {
        match self {
            Self::Lattice(lattice) => lattice.nodes() + lattice.jaw_points(),
            Self::Network(network) => network.nodes_mm.len() as u64,
        }
    }

    /// Bonds of the lattice or network.
    pub fn bonds(&self) -> u64 {
        match self {
            Self::Lattice(lattice) => lattice.bonds(),
            Self::Network(network) => network.bonds.len() as u64,
        }
    }

    /// Rows along the pulling direction; for a network of as many nodes in a square.
    fn rows(&self) -> f64 {
        match self {
            Self::Lattice(lattice) => f64::from(lattice.rows),
            Self::Network(network) => (network.nodes_mm.len() as f64).sqrt(),
        }
    }

    /// Layers, of which thick fabrics have many compressed bonds between; 1 for a network, of which
    /// nothing is known.
    fn layers(&self) -> f64 {
        match self {
            Self::Lattice(lattice) => f64::from(lattice.layers),
            Self::Network(_) => 1.0,
        }
    }

    /// How much longer a bond takes than one of the calibrating fabric, whose runs are longer.
    fn short_runs(&self) -> f64 {
        let row = match self {
            Self::Lattice(lattice) => f64::from(lattice.points_per_row),
            Self::Network(_) => GATHERED_ROW,
        };
        ((1.0 + RUN_START / row) / (1.0 + RUN_START / CALIBRATED_ROW)).max(1.0)
    }

    /// Whether it lies in a plane and stays there.
    fn is_flat(&self) -> bool {
        match self {
            Self::Lattice(lattice) => lattice.layers == 1 && lattice.irregularity[2] == 0.0,
            Self::Network(network) => network.nodes_mm.iter().all(|node| node[2] == 0.0),
        }
    }
}

pub(super) fn estimate(spec: &NonwovenTensile, calibration: &Calibration) -> Estimate {
    let bonds = spec.fabric.bonds() as f64;
    let [first, later] = steps_of_way(spec);
    let steps = first + later;
    let slowdown = match spec.accuracy.knobs().solver {
        Solver::NewtonCg => spec.fabric.short_runs(),
        _ => RELAXATION_SLOWDOWN,
    };
    let evaluations = bonds * evaluations_per_bond(spec) * (1.0 + LATER_STEP * later / first);
    let every = f64::from(spec.output.snapshot_every_steps);
    let snapshots = if every > 0.0 {
        (steps / every).ceil() + 1.0
    } else {
        0.0
    };
    // as many tests are in memory at once as there are threads, which the spec does not know;
    // the estimate is for one core
    let directions = spec.test.directions.len() as f64;
    let tests = f64::from(spec.test.repeats) * directions;
    let one = START_S + slowdown * evaluations / calibration.bond_evaluations_per_s;
    let curves = if tests > 1.0 {
        tests * (RESULTS_MB + steps * POINT_MB)
    } else {
        0.0
    };
    Estimate {
        wall_s: tests * one,
        memory_mb: MEMORY_MB[0] + bonds * MEMORY_MB[1] + curves,
        disk_mb: directions
            * (steps * STEP_MB + bonds * (EVENT_MB + SNAPSHOT_MB_PER_BOND * snapshots))
            + curves,
        calibrated: false,
        threads_wall_s: None,
        sharing: Sharing {
            tests,
            within: if (spec.fabric.nodes() as f64) < SHARED_FROM {
                0.0
            } else {
                SHARED
            },
        },
    }
}

/// W, evaluations of each bond over the whole test.
fn evaluations_per_bond(spec: &NonwovenTensile) -> f64 {
    let knobs = spec.accuracy.knobs();
    let bonds = spec.fabric.bonds() as f64 / 1e4;
    let accuracy = knobs.force_accuracy / 100.0;
    let steps = steps_of_way(spec)[0] / 10.0;
    let step = spec.test.strain_step / 0.01;
    let order = match spec.test.breaking {
        Breaking::WeakestFirst => WEAKEST_FIRST,
        Breaking::AllOverStrength | Breaking::None => 1.0,
    };
    let ruptures = ruptures(spec);
    match knobs.solver {
        Solver::NewtonCg if ruptures => {
            let tight = accuracy.min(QUADRATIC_FROM / 100.0);
            let tighter = accuracy / tight;
            let digits = tight.powf(0.29) * tighter.powf(0.13);
            order * 8_500.0 * digits * bonds.powf(0.49) * step.powf(-0.27)
        }
        Solver::NewtonCg => {
            let digits = accuracy
                .powf(if accuracy < 1.0 { 0.55 } else { 0.28 })
                .min(60.0);
            let waves = (spec.fabric.rows() / 50.0).powf(0.35);
            let buckles = (spec.fabric.layers() / 3.0).powf(0.85).max(1.0);
            let strain = (farthest(spec) / 0.1).powf(-0.2);
            let flat = if spec.fabric.is_flat() { FLAT } else { 1.0 };
            flat * 1_000.0 * digits * waves * buckles * steps.sqrt() * strain
        }
        Solver::Sequential | Solver::Parallel => {
            let all_at_once = if knobs.solver == Solver::Parallel {
                1.7
            } else {
                1.0
            };
            let waves = bonds.powf(0.43);
            let sweeps = if ruptures {
                order * 20_400.0 * accuracy.powf(0.7) * step.powf(-0.22)
            } else {
                4_400.0 * accuracy.powf(1.15) * steps.powf(0.27)
            };
            all_at_once * sweeps * waves
        }
        Solver::GradientDescent | Solver::BarzilaiBorwein => {
            let sweeps = knobs.iteration_limit.map_or(DESCENT_SWEEPS, f64::from);
            10.0 * steps * sweeps * DESCENT_MOVES * passes(knobs.descent_gradient)
        }
    }
}

/// Evaluations of a bond, from both its ends, for a move of a descent.
fn passes(gradient: DescentGradient) -> f64 {
    match gradient {
        DescentGradient::Exact => 4.0,
        DescentGradient::AsPrinted => 2.0,
        DescentGradient::Smoothed => 26.0,
    }
}

/// Strain steps of the first pull to the farthest strain, and of all other ways, both of a hair less
/// than a step's rounding.
fn steps_of_way(spec: &NonwovenTensile) -> [f64; 2] {
    let test = &spec.test;
    if test.history.is_empty() {
        return [test.steps() as f64, 0.0];
    }
    // where a force is reached is not known: at the farthest strain, and come back to at none
    let strain_of = |target, otherwise| match target {
        Target::Strain(strain) => strain,
        Target::ForceN(_) => otherwise,
    };
    let (mut way, mut here) = (0.0, 0.0);
    for leg in test.legs() {
        let otherwise = if leg.unloads { 0.0 } else { farthest(spec) };
        let end: f64 = strain_of(leg.target, otherwise);
        way += (end - here).abs();
        here = end;
    }
    let first = (farthest(spec) / test.strain_step).ceil().max(1.0);
    [first, (way / test.strain_step - first).max(0.0)]
}

/// The largest strain, at most that at which a bond of mean strength breaks where only forces are
/// given.
fn farthest(spec: &NonwovenTensile) -> f64 {
    let farthest = spec.test.farthest_strain();
    if spec.test.history.is_empty() {
        return farthest;
    }
    breaking_strain(spec).map_or(farthest, |strain| farthest.min(strain))
}

/// Whether the test goes far enough to tear the fabric: about half the strain at which a bond of
/// mean strength breaks.
fn ruptures(spec: &NonwovenTensile) -> bool {
    spec.test.breaking != Breaking::None
        && breaking_strain(spec).is_none_or(|strain| farthest(spec) > 0.5 * strain)
}

/// Strain at which a bond of mean strength breaks, s = e u + f_r u².
fn breaking_strain(spec: &NonwovenTensile) -> Option<f64> {
    let bond = &spec.bond;
    let (modulus, strength) = (bond.modulus_n?, bond.mean_strength_n?);
    let discriminant = modulus * modulus + 4.0 * bond.friction_modulus_n * strength;
    Some(2.0 * strength / (modulus + discriminant.sqrt()))
}
