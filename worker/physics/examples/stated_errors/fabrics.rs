//! Fabrics drawn at random.
use loadframe_api::spec::nonwoven_tensile::{
    Accuracy, Bond, Direction, Fabric, Jaws, Knobs, Lattice, NonwovenTensile, Output, Test,
};
use loadframe_api::{JobSpec, Report};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::sort::{Knob, Sort};

/// Fabrics by the least and the most that they have: of points along a side, and of layers.
pub(crate) struct Fabrics {
    pub(crate) sides: [f64; 2],
    pub(crate) layers: [u32; 2],
}

/// Of a hundred to two thousand bonds.
pub(crate) const SMALL: Fabrics = Fabrics {
    sides: [6.0, 17.0],
    layers: [1, 3],
};
/// Of a thousand to forty thousand.
pub(crate) const LARGE: Fabrics = Fabrics {
    sides: [16.0, 80.0],
    layers: [1, 3],
};

/// A_cc and break precision of the presets.
const PRESETS: [[f64; 2]; 3] = [[5.0, 0.05], [100.0, 0.01], [1e4, 0.002]];
/// Strain steps over the strain of mean strength that people take.
const USUAL_STEPS: [f64; 2] = [0.005, 0.04];

impl Sort for Fabrics {
    fn results(&self) -> &'static [&'static str] {
        &[
            "strength",
            "strain_at_max_force",
            "modulus_at_10_percent",
            "poisson_ratio",
            "energy_absorption",
        ]
    }

    /// A_cc, strain step over the strain of mean strength, break precision.
    fn knobs(&self) -> Vec<Knob> {
        let knob = |source, levels: &[f64]| Knob {
            source,
            levels: levels.to_vec(),
        };
        vec![
            knob("solver", &[5.0, 20.0, 100.0, 1e3, 1e4, 1e5]),
            knob("strain_step", &[0.04, 0.02, 0.01, 0.005, 0.002_5]),
            knob("break_precision", &[0.05, 0.01, 0.002, 0.000_5]),
        ]
    }

    fn base(&self) -> Vec<f64> {
        vec![1e4, 0.01, 0.002]
    }

    fn presets(&self, seed: u64) -> Vec<Vec<f64>> {
        let random = &mut ChaCha8Rng::seed_from_u64(seed ^ 0x5e77);
        let presets = PRESETS.iter().map(|[a_cc, precision]| {
            let [least, most] = USUAL_STEPS;
            vec![*a_cc, decades(random, least, most), *precision]
        });
        presets.collect()
    }

    fn job(&self, seed: u64, setting: &[f64]) -> JobSpec {
        let (mut spec, strain) = self.drawn(seed);
        spec.test.strain_step = setting[1] * strain;
        spec.accuracy = Accuracy::Knobs(Knobs {
            force_accuracy: setting[0],
            break_precision: Some(setting[2]),
            ..Knobs::default()
        });
        JobSpec::NonwovenTensile(Box::new(spec))
    }

    fn traits(&self, seed: u64, _: &Report) -> Vec<(&'static str, f64)> {
        let (spec, strain) = self.drawn(seed);
        let Fabric::Lattice(lattice) = &spec.fabric else {
            return Vec::new();
        };
        let bond = &spec.bond;
        let over_modulus = |value: f64| value / bond.modulus_n.unwrap_or(f64::NAN);
        let [x, y, z] = lattice.spacing_mm;
        vec![
            ("bonds", lattice.bonds() as f64),
            (
                "rows_over_points_per_row",
                f64::from(lattice.rows) / f64::from(lattice.points_per_row),
            ),
            ("mean_irregularity", lattice.irregularity[0]),
            (
                "compression_stiffness_over_modulus",
                over_modulus(bond.compression_stiffness_n),
            ),
            (
                "friction_modulus_over_modulus",
                over_modulus(bond.friction_modulus_n),
            ),
            ("strain_of_mean_strength", strain),
            ("strength_sigma", bond.strength_sigma),
            ("spacing_x_over_y", x / y),
            ("spacing_z_over_y", z / y),
        ]
    }
}

impl Fabrics {
    /// A fabric and the strain at which its bond of mean strength breaks.
    fn drawn(&self, seed: u64) -> (NonwovenTensile, f64) {
        let random = &mut ChaCha8Rng::seed_from_u64(seed);
        let [fewest, most] = self.sides;
        let points_per_row = decades(random, fewest, most) as u32;
        let rows = 2 * (decades(random, 0.5 * fewest, 0.5 * most) as u32) + 1;
        let layers = random.random_range(self.layers[0]..=self.layers[1]);
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
                spacing_mm: [
                    2.0 * decades(random, 0.7, 1.4),
                    2.0,
                    decades(random, 0.7, 1.4),
                ],
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
}

/// Between two numbers, evenly over their orders of magnitude.
pub(crate) fn decades(random: &mut ChaCha8Rng, from: f64, to: f64) -> f64 {
    random.random_range(from.ln()..to.ln()).exp()
}
