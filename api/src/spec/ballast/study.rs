//! What an accuracy study varies in a test of ballast.
use super::{Accuracy, Apparatus, Ballast, Knobs};
use crate::spec_trait::Studied;
use crate::study::Knob;

/// A knob: name, what it is, values tried from coarse to fine, the last of which is the reference.
struct Line {
    name: &'static str,
    description: &'static str,
    values: [&'static str; 5],
}

const LINES: [Line; 4] = [
    Line {
        name: "critical_step_fraction",
        description: "the time step over the critical one, a number from 1e-6 to 0.9",
        values: ["0.8", "0.6", "0.4", "0.2", "0.1"],
    },
    Line {
        name: "stiffness",
        description: "a factor on the moduli of all materials during the test, from 1e-9 to 1",
        values: ["1e-3", "1e-2", "3e-2", "1e-1", "1"],
    },
    Line {
        name: "preparation_modulus_pa",
        description: "the aggregate's modulus while the bed is prepared, at most, from 1e3 to 1e15",
        values: ["1e7", "1e8", "1e9", "1e10", "1e15"],
    },
    Line {
        name: "inertial_number",
        description: "the inertial number that sets the period of a cycle, from 1e-6 to 1",
        values: ["1e-2", "3e-3", "1e-3", "3e-4", "1e-4"],
    },
];

/// Results that do not grow with the specimen or with what is given.
const COMPARED: [&str; 8] = [
    "unloading_stiffness",
    "peak_displacement",
    "residual_displacement",
    "last_cycle_displacement",
    "oedometric_modulus",
    "porosity",
    "initial_porosity",
    "coordination_number",
];

fn value<'a>(knobs: &'a mut Knobs, name: &str) -> Option<&'a mut f64> {
    match name {
        "critical_step_fraction" => Some(&mut knobs.critical_step_fraction),
        "stiffness" => Some(&mut knobs.stiffness),
        "preparation_modulus_pa" => Some(&mut knobs.preparation_modulus_pa),
        "inertial_number" => Some(&mut knobs.inertial_number),
        _ => None,
    }
}

impl<A: Apparatus> Studied for Ballast<A> {
    fn knobs(&self) -> Vec<Knob> {
        let mut present = self.accuracy.knobs();
        let lines = LINES.iter().filter(|line| {
            // a period that is given does not follow any number
            line.name != "inertial_number" || !self.test.has_period()
        });
        let knob = |line: &Line| {
            let [grid @ .., finest] = line.values;
            let present = value(&mut present, line.name).map_or(f64::NAN, |value| *value);
            let knob = Knob::new(line.name, line.description, present, &grid, finest);
            // a step more or less, and grains come to lie elsewhere; the period matters after that only
            if line.name == "inertial_number" {
                knob
            } else {
                knob.of_other_specimens()
            }
        };
        lines.map(knob).collect()
    }

    fn turn(&mut self, knob: &str, text: &str) -> Option<()> {
        let number: f64 = text.parse().ok()?;
        let mut knobs = self.accuracy.knobs();
        *value(&mut knobs, knob)? = number;
        self.accuracy = Accuracy::Knobs(knobs);
        Some(())
    }

    fn single(&mut self, seed: u64) {
        self.seed = seed;
        self.repeats = 1;
        self.output.snapshots = 0;
    }

    fn compares(result: &str) -> bool {
        COMPARED.contains(&result)
    }
}
