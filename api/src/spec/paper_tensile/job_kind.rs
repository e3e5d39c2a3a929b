//! The tensile test of paper as a kind of job.
use super::{Accuracy, Direction, PaperTensile, SHEET_CURVE, Specimen, checks, estimate, study};
use crate::spec_trait::Spec;
use crate::{Calibration, Estimate, Violation, study::Knob};

impl Spec for PaperTensile {
    fn check(&self, violations: &mut Vec<Violation>) {
        checks::check(self, violations);
    }

    fn normalise(&mut self) {
        self.accuracy = Accuracy::Knobs(self.accuracy.knobs());
        self.model.level = Some(self.level());
    }

    fn estimate(&self, calibration: &Calibration) -> Estimate {
        estimate::estimate(self, calibration)
    }

    fn curve_columns(&self) -> Vec<String> {
        let names: &[&str] = match &self.specimen {
            Specimen::SingleFibre(fibre) => fibre.load.curve_columns(),
            _ => &SHEET_CURVE,
        };
        names.iter().map(|name| (*name).to_owned()).collect()
    }

    fn largest_strain(&self) -> Option<f64> {
        Some(self.test.max_strain)
    }

    fn seed(&self) -> u64 {
        self.seed
    }

    fn knobs(&self) -> Vec<Knob> {
        study::knobs(self)
    }

    fn turn(&mut self, knob: &str, value: &str) -> Option<()> {
        study::turn(self, knob, value)
    }

    fn single(&mut self, seed: u64) {
        self.seed = seed;
        self.output.snapshot_every_steps = 0;
        if self.test.repeats.is_some() {
            self.test.repeats = Some(1);
        }
        if self.test.direction == Some(Direction::Both) {
            self.test.direction = Some(Direction::Md);
        }
    }

    fn realise(&mut self, seed: u64) {
        let direction = self.test.direction;
        self.single(seed);
        self.test.direction = direction;
    }

    fn compares(result: &str) -> bool {
        study::compares(result)
    }
}
