//! What an accuracy study varies in a test of soil.
use super::{Accuracy, Shearing, Soil};
use crate::spec_trait::Studied;
use crate::study::Knob;

/// Results that do not grow with the specimen.
const COMPARED: [&str; 6] = [
    "peak_friction_angle",
    "critical_friction_angle",
    "dilatancy_angle",
    "initial_void_ratio",
    "peak_deviator_stress",
    "peak_shear_stress",
];

impl<T: Shearing> Studied for Soil<T> {
    fn knobs(&self) -> Vec<Knob> {
        let knobs = self.accuracy.knobs();
        vec![
            Knob::new(
                "critical_step_fraction",
                "the time step over the critical one, a number from 1e-6 to 0.9",
                knobs.critical_step_fraction,
                &["0.8", "0.6", "0.4", "0.2"],
                "0.1",
            )
            .of_other_specimens(),
            Knob::new(
                "inertial_number",
                "the inertial number that sets the rate of shear, from 1e-6 to 1",
                knobs.inertial_number,
                &["1e-2", "3e-3", "1e-3", "3e-4"],
                "1e-4",
            ),
        ]
    }

    fn turn(&mut self, knob: &str, text: &str) -> Option<()> {
        let number: f64 = text.parse().ok()?;
        let mut knobs = self.accuracy.knobs();
        match knob {
            "critical_step_fraction" => knobs.critical_step_fraction = number,
            "inertial_number" => knobs.inertial_number = number,
            _ => return None,
        }
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
