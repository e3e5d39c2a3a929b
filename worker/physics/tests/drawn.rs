//! Specs drawn at random around the extremes: every equilibrium is reached.
mod scene;

use loadframe_api::spec::nonwoven_tensile::{Breaking, Jaws, NonwovenTensile, Solver};
use rand::{Rng, RngExt, SeedableRng, seq::IndexedRandom};
use rand_chacha::ChaCha8Rng;
use scene::{lattice, polyester, run, solver};

/// Of every run of the tests.
const SPECS: u64 = 50;
/// Of the long run.
const MANY: u64 = 1000;
/// Steps of one test, at most.
const STEPS: f64 = 150.0;

/// Between two numbers, evenly over their orders of magnitude.
fn decades(random: &mut impl Rng, from: f64, to: f64) -> f64 {
    (random.random_range(from.ln()..to.ln())).exp()
}

/// Zero in one case out of four.
fn decades_or_zero(random: &mut impl Rng, from: f64, to: f64) -> f64 {
    if random.random_bool(0.25) {
        0.0
    } else {
        decades(random, from, to)
    }
}

fn drawn(number: u64) -> NonwovenTensile {
    let random = &mut ChaCha8Rng::seed_from_u64(number);
    let rows = 2 * random.random_range(1..16) + 1;
    let mut spec = polyester(random.random_range(2..24), rows, random.random_range(1..5));
    spec.seed = number;
    let fabric = lattice(&mut spec);
    fabric.spacing_mm = fabric
        .spacing_mm
        .map(|side| side * decades(random, 0.5, 2.0));
    fabric.irregularity = [0, 1, 2].map(|_| *[0.0, 0.5, 0.9, 1.0].choose(random).expect("some"));
    fabric.jaws = *[Jaws::HalfBond, Jaws::ClampedRows]
        .choose(random)
        .expect("some");
    spec.bond.modulus_n = Some(decades(random, 0.04, 4.0));
    spec.bond.friction_modulus_n = decades_or_zero(random, 0.01, 1000.0);
    spec.bond.compression_stiffness_n = decades_or_zero(random, 1e-6, 100.0);
    spec.bond.mean_strength_n = Some(decades(random, 0.3, 30.0));
    spec.bond.strength_sigma = random.random_range(0.0..2.0);
    spec.test.strain_step = decades(random, 1e-3, 0.5);
    spec.test.max_strain = (STEPS * spec.test.strain_step).min(3.0);
    let rules = [
        Breaking::AllOverStrength,
        Breaking::WeakestFirst,
        Breaking::None,
    ];
    spec.test.breaking = *rules.choose(random).expect("some");
    spec.accuracy = solver(Solver::NewtonCg, decades(random, 10.0, 1000.0));
    spec
}

/// Those of the specs of these numbers that did not balance at every step.
fn unbalanced(numbers: std::ops::Range<u64>) -> Vec<u64> {
    let is_unbalanced = |number: &u64| {
        let (report, _) = run(&drawn(*number));
        !report.quality["unconverged_steps"].ok
    };
    numbers.filter(is_unbalanced).collect()
}

#[test]
fn newton_reaches_every_equilibrium_of_specs_drawn_at_random() {
    assert_eq!(unbalanced(0..SPECS), [0; 0]);
}

#[test]
#[ignore = "takes ten minutes"]
fn newton_reaches_every_equilibrium_of_many_specs_drawn_at_random() {
    assert_eq!(unbalanced(SPECS..MANY), [0; 0]);
}
