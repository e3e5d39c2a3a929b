//! Fabrics drawn at random from the range in which errors are measured, and the finest test of each.
use std::io::{self, Write};

use loadframe_api::spec::nonwoven_tensile::{
    Accuracy, Bond, Direction, Fabric, Jaws, Knobs, Lattice, NonwovenTensile, Output, Test,
};
use loadframe_api::{JobSpec, Report};
use loadframe_physics::{Ending, Recorder, RunContext, Uninterrupted, simulate};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Results that do not grow with the specimen.
pub(crate) const RESULTS: [&str; 5] = [
    "strength",
    "strain_at_max_force",
    "modulus_at_10_percent",
    "poisson_ratio",
    "energy_absorption",
];
/// Against which errors are measured: A_cc, strain step over the strain of mean strength, precision.
pub(crate) const FINEST: [f64; 3] = [1e4, 0.002_5, 0.001];

/// Between two numbers, evenly over their orders of magnitude.
fn decades(random: &mut impl Rng, from: f64, to: f64) -> f64 {
    random.random_range(from.ln()..to.ln()).exp()
}

/// How large fabrics are: points along a side, and layers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Size {
    pub(crate) points: [f64; 2],
    pub(crate) layers: [u32; 2],
}

/// Fabrics of a hundred to two thousand bonds.
#[allow(dead_code)] // the test measures only what is larger
pub(crate) const SMALL: Size = Size {
    points: [6.0, 13.0],
    layers: [1, 3],
};

/// A fabric and the strain at which its bond of mean strength breaks.
pub(crate) fn drawn(seed: u64, size: Size) -> (NonwovenTensile, f64) {
    let random = &mut ChaCha8Rng::seed_from_u64(seed);
    let [fewest, most] = size.points;
    let points_per_row = decades(random, fewest, most) as u32;
    let rows = 2 * (decades(random, 0.5 * fewest, 0.5 * most) as u32) + 1;
    let layers = random.random_range(size.layers[0]..=size.layers[1]);
    let irregularity = random.random_range(0.2..0.8);
    let modulus = decades(random, 0.1, 1.0);
    let friction = modulus * decades(random, 0.3, 8.0);
    let strain: f64 = decades(random, 0.3, 2.0);
    let spec = NonwovenTensile {
        version: 1,
        seed,
        fabric: Fabric::Lattice(Lattice {
            points_per_row,
            rows,
            layers,
            spacing_mm: [2.0 * decades(random, 0.7, 1.4), 2.0, 1.0],
            irregularity: [irregularity; 3],
            jaws: if random.random_bool(0.5) {
                Jaws::HalfBond
            } else {
                Jaws::ClampedRows
            },
            thickness_mm: None,
            grammage_g_per_m2: None,
        }),
        bond: Bond {
            modulus_n: Some(modulus),
            friction_modulus_n: friction,
            compression_stiffness_n: modulus * decades(random, 0.1, 1.5),
            mean_strength_n: Some((modulus + friction * strain) * strain),
            strength_sigma: random.random_range(0.15..0.6),
            strength_draw: Default::default(),
        },
        test: Test {
            max_strain: 4.0 * strain,
            directions: vec![if random.random_bool(0.5) {
                Direction::Y
            } else {
                Direction::X
            }],
            ..Test::default()
        },
        accuracy: Accuracy::default(),
        output: Output {
            snapshot_every_steps: 0,
            ..Output::default()
        },
    };
    (spec, strain)
}

/// A spec at A_cc, a strain step over `strain`, and a break precision.
pub(crate) fn at(
    spec: &NonwovenTensile,
    strain: f64,
    [a_cc, step, precision]: [f64; 3],
) -> NonwovenTensile {
    let mut spec = spec.clone();
    spec.test.strain_step = step * strain;
    spec.accuracy = Accuracy::Knobs(Knobs {
        force_accuracy: a_cc,
        break_precision: Some(precision),
        ..Knobs::default()
    });
    spec
}

/// A random choice of the three knobs within what is measured.
pub(crate) fn settings(seed: u64) -> [f64; 3] {
    let random = &mut ChaCha8Rng::seed_from_u64(seed ^ 0x5e77);
    [
        decades(random, 5.0, 2e3),
        decades(random, 0.005, 0.05),
        decades(random, 0.002, 0.05),
    ]
}

/// The report of a test, `None` where it has none.
pub(crate) fn report(spec: &NonwovenTensile) -> Option<Report> {
    tested(spec).map(|(report, _)| report)
}

/// The report of a test and what it said to its log.
pub(crate) fn tested(spec: &NonwovenTensile) -> Option<(Report, Vec<String>)> {
    let mut log = Log::default();
    let context = RunContext {
        threads: 1,
        interrupt: &Uninterrupted,
        checkpoint: None,
    };
    let job = JobSpec::NonwovenTensile(Box::new(spec.clone()));
    match simulate(&job, context, &mut log) {
        Ok(Ending::Finished(report)) => Some((report, log.0)),
        _ => None,
    }
}

/// What a result was found to be.
pub(crate) fn value(report: &Report, name: &str) -> Option<f64> {
    report.summary.get(name)?.value
}

/// A recorder that keeps nothing but its log.
#[derive(Default)]
struct Log(Vec<String>);

impl Recorder for Log {
    fn columns(&mut self, _: &[&str]) -> io::Result<()> {
        Ok(())
    }

    fn point(&mut self, _: &[f64]) -> io::Result<()> {
        Ok(())
    }

    fn file(
        &mut self,
        _: &str,
        write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        write(&mut io::sink())
    }

    fn progress(&mut self, _: f64, _: &str) {}

    fn log(&mut self, message: &str) {
        self.0.push(message.to_owned());
    }

    fn checkpoint_due(&self) -> bool {
        false
    }

    fn checkpoint(&mut self, _: &[u8]) -> io::Result<()> {
        Ok(())
    }
}
