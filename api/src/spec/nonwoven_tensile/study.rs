//! What an accuracy study varies in a nonwoven tensile test.
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::{Breaking, Direction, Fabric, NonwovenTensile, Output, Solver};
use crate::spec_trait::Studied;
use crate::study::Knob;

/// A_cc of the reference: a digit beyond the preset of that name. Another digit takes a PET test to
/// rupture from 10 s to a minute.
const FINEST_ACCURACY: &str = "1e5";
/// A_cc tried: every factor of about ten costs about twice the time.
const ACCURACIES: [&str; 5] = ["5", "20", "100", "1e3", "1e4"];
/// Strain steps tried, in those of the spec; the last is the reference.
const STEPS: [f64; 6] = [4.0, 2.0, 1.0, 0.5, 0.25, 0.125];
/// Sizes tried, in those of the spec.
const SIZES: [&str; 2] = ["0.5", "1"];
const LARGEST_SIZE: &str = "2";
/// Results that do not grow with the specimen.
const COMPARED: [&str; 5] = [
    "strength",
    "strain_at_max_force",
    "modulus_at_10_percent",
    "poisson_ratio",
    "energy_absorption",
];

impl Studied for NonwovenTensile {
    fn knobs(&self) -> Vec<Knob> {
        let accuracy = self.accuracy.knobs();
        let mut knobs = vec![
            Knob::new(
                "force_accuracy",
                "A_cc, a number from 1 to 1e15: the limit of every node's resultant",
                accuracy.force_accuracy,
                &ACCURACIES,
                FINEST_ACCURACY,
            ),
            Knob {
                reference: vec![
                    ("solver", "newton_cg".to_owned()),
                    ("force_accuracy", FINEST_ACCURACY.to_owned()),
                ],
                ..Knob::new(
                    "solver",
                    "the way to equilibrium: newton_cg, sequential or parallel",
                    word(&accuracy.solver),
                    &["parallel", "sequential", "newton_cg"],
                    "newton_cg",
                )
            },
            strain_steps(self),
        ];
        if self.test.breaking != Breaking::None {
            let precision = accuracy.break_precision;
            knobs.push(Knob::new(
                "break_precision",
                "a number from 1e-6 to 1, or null: how far above its strength a bond may \
                 break whose breaking shows in the force",
                precision.map_or_else(|| "null".to_owned(), |precision| precision.to_string()),
                &["null", "0.05", "0.01", "0.002"],
                "0.0005",
            ));
            knobs.push(Knob::new(
                "breaking",
                "which bonds break in a round: all_over_strength, weakest_first or none",
                word(&self.test.breaking),
                &["all_over_strength", "weakest_first"],
                "weakest_first",
            ));
        }
        if let Fabric::Lattice(_) = self.fabric {
            let size = Knob::new(
                "size",
                "points_per_row and rows in those of the spec, a number above 0: the same \
                 fabric, smaller or larger in both directions",
                1,
                &SIZES,
                LARGEST_SIZE,
            );
            knobs.push(size.of_other_specimens());
        }
        knobs
    }

    fn turn(&mut self, knob: &str, value: &str) -> Option<()> {
        match knob {
            "force_accuracy" => {
                let force_accuracy = value.parse().ok()?;
                self.accuracy
                    .change(|knobs| knobs.force_accuracy = force_accuracy);
            }
            "solver" => {
                let solver: Solver = variant(value)?;
                self.accuracy.change(|knobs| knobs.solver = solver);
            }
            "break_precision" => {
                let break_precision = match value {
                    "null" => None,
                    number => Some(number.parse().ok()?),
                };
                self.accuracy
                    .change(|knobs| knobs.break_precision = break_precision);
            }
            "strain_step" => self.test.strain_step = value.parse().ok()?,
            "breaking" => self.test.breaking = variant(value)?,
            "size" => resize(self, value.parse().ok().filter(|factor| *factor > 0.0)?)?,
            _ => return None,
        }
        Some(())
    }

    /// Along the first direction.
    fn single(&mut self, seed: u64) {
        self.realise(seed);
        let first = self.test.directions.first().copied();
        self.test.directions = vec![first.unwrap_or(Direction::Y)];
    }

    /// Along all directions.
    fn realise(&mut self, seed: u64) {
        self.seed = seed;
        self.test.repeats = 1;
        self.output = Output {
            snapshot_every_steps: 0,
            // these are results
            reading_strains: std::mem::take(&mut self.output.reading_strains),
            ..Output::default()
        };
    }

    fn compares(result: &str) -> bool {
        let is_read = |of: &str| result.starts_with(of) && result.ends_with("_percent");
        COMPARED.contains(&result) || is_read("modulus_at_") || is_read("poisson_ratio_at_")
    }
}

fn strain_steps(spec: &NonwovenTensile) -> Knob {
    let test = &spec.test;
    // neither longer than the test nor beyond what a spec may ask for
    let steps = STEPS.map(|factor| factor * test.strain_step);
    let usable = steps
        .into_iter()
        .filter(|step| *step <= test.max_strain.min(1.0));
    let mut grid: Vec<String> = usable.map(short).collect();
    let finest = grid.pop().unwrap_or_default();
    Knob {
        name: "strain_step",
        description: "nominal strain added per step, a number from 1e-8 to 1",
        present: test.strain_step.to_string(),
        grid,
        reference: vec![("strain_step", finest)],
        keeps_specimen: true,
    }
}

/// A number without the last digits that a product of decimals leaves: 0.00125, not
/// 0.0012500000000000002.
fn short(value: f64) -> String {
    let rounded = format!("{value:.12e}").parse::<f64>();
    rounded.unwrap_or(value).to_string()
}

/// Scales the lattice at equal spacing, layers and shape; rows stay odd.
fn resize(spec: &mut NonwovenTensile, factor: f64) -> Option<()> {
    let Fabric::Lattice(lattice) = &mut spec.fabric else {
        return None;
    };
    let points = f64::from(lattice.points_per_row) * factor;
    lattice.points_per_row = (points.round() as u32).max(1);
    // the odd number nearest to the scaled one, of two the larger
    let rows = f64::from(lattice.rows) * factor;
    lattice.rows = 2 * ((0.5 * (rows - 1.0)).round().max(0.0) as u32) + 1;
    Some(())
}

/// The word of an enum on the wire.
fn word(value: &impl serde::Serialize) -> String {
    let value = serde_json::to_value(value).unwrap_or_default();
    value.as_str().unwrap_or_default().to_owned()
}

fn variant<T: DeserializeOwned>(word: &str) -> Option<T> {
    serde_json::from_value(Value::String(word.to_owned())).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{JobKind, JobSpec, Submission};

    fn example(index: usize) -> JobSpec {
        let body = JobKind::NonwovenTensile.examples()[index].body;
        Submission::from_slice(body.as_bytes())
            .expect("a valid example")
            .spec
    }

    #[test]
    fn every_value_of_every_grid_gives_a_valid_spec_that_says_so() {
        for index in 0..JobKind::NonwovenTensile.examples().len() {
            for knob in example(index).knobs() {
                let reference = knob.reference.iter().map(|(name, value)| (*name, value));
                let grid = knob.grid.iter().map(|value| (knob.name, value));
                for (name, value) in grid.chain(reference) {
                    let mut spec = example(index);
                    spec.turn(name, value).expect("a value it takes");
                    spec.check().expect("a valid spec");
                    let turned = spec.knobs();
                    let turned = turned.iter().find(|turned| turned.name == name);
                    let present = &turned.expect("the knob is still there").present;
                    let same = present == value || present.parse::<f64>() == value.parse::<f64>();
                    assert!(same || name == "size", "{name}: {present} after {value}");
                }
                let mut spec = example(index);
                spec.turn(knob.name, &knob.present).expect("its own value");
                assert_eq!(spec, example(index), "{} {}", knob.name, knob.present);
            }
        }
    }

    #[test]
    fn sizes_keep_their_shape_and_odd_rows() {
        for (factor, points, rows) in [("0.5", 25, 25), ("2", 98, 103), ("0.3", 15, 15)] {
            let mut spec = example(0);
            spec.turn("size", factor).expect("a size");
            let JobSpec::NonwovenTensile(spec) = spec else {
                panic!("the example is a nonwoven");
            };
            let Fabric::Lattice(lattice) = &spec.fabric else {
                panic!("the example is a lattice");
            };
            assert_eq!(
                (lattice.points_per_row, lattice.rows),
                (points, rows),
                "{factor}"
            );
        }
    }

    #[test]
    fn unknown_knobs_and_values_are_refused_by_name() {
        let mut spec = example(0);
        let error = spec.turn("stepsize", "1").expect_err("no such knob");
        let known = "force_accuracy, solver, strain_step, break_precision, breaking, size";
        assert!(error.to_string().ends_with(known), "{error}");
        let error = spec.turn("solver", "magic").expect_err("no such solver");
        assert!(
            error
                .to_string()
                .contains("newton_cg, sequential or parallel"),
            "{error}"
        );
        assert!(spec.turn("size", "-1").is_err());
        spec.turn("force_accuracy", "0.1").expect("a number");
        let violations = spec.check().expect_err("out of range");
        assert_eq!(violations[0].pointer, "/accuracy/force_accuracy");
    }
}
