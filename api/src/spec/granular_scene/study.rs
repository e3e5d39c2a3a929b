//! What an accuracy study varies in a granular scene.
use super::{GranularScene, Record, Stage, TimeStep};
use crate::spec_trait::Studied;
use crate::study::Knob;

/// Time steps tried, as parts of the critical one; the last is the reference.
const STEPS: [&str; 5] = ["0.8", "0.4", "0.2", "0.1", "0.05"];
/// Factors on all moduli tried; the last, the materials as they are, is the reference.
const SOFTENINGS: [&str; 4] = ["1e-3", "1e-2", "1e-1", "1"];
/// Factors on all densities tried; the last, the materials as they are, is the reference.
const DENSITIES: [&str; 4] = ["1e3", "1e2", "1e1", "1"];
/// Factors on the speed of what is driven; the last, a tenth of what the scene says, is the reference.
const RATES: [&str; 4] = ["10", "3", "1", "0.1"];
/// Results that say how the bodies stand and what they carry.
const COMPARED: [&str; 3] = ["contacts", "coordination_number", "elastic_energy"];

impl Studied for GranularScene {
    fn knobs(&self) -> Vec<Knob> {
        let mut knobs = Vec::new();
        if let TimeStep::Automatic(_) = self.time_step_s {
            let fraction = self.accuracy.knobs().critical_step_fraction;
            knobs.push(finer(
                "critical_step_fraction",
                "the time step over the critical one, a number from 1e-6 to 0.9",
                fraction,
                &STEPS,
            ));
            // a given time step would become needlessly small for softened materials
            knobs.push(finer(
                "stiffness",
                "a factor on the Young's modulus of all materials and their cement, a number above 0",
                1.0,
                &SOFTENINGS,
            ));
            knobs.push(finer(
                "density",
                "a factor on the density of all materials while gravity is divided by it, so that \
                 weights stay (mass scaling), a number above 0",
                1.0,
                &DENSITIES,
            ));
        }
        if self.stages.iter().any(Stage::is_driven) {
            knobs.push(finer(
                "loading_rate",
                "a factor on the speed at which walls and bodies are driven over the same ways, a \
                 number above 0",
                1.0,
                &RATES,
            ));
        }
        knobs
    }

    fn turn(&mut self, knob: &str, value: &str) -> Option<()> {
        let number: f64 = value.parse().ok()?;
        match knob {
            "critical_step_fraction" => {
                self.accuracy
                    .change(|knobs| knobs.critical_step_fraction = number);
            }
            "stiffness" if number > 0.0 && number.is_finite() => {
                for material in self.materials.values_mut() {
                    *material = material.clone().softened(number);
                }
                let planes = self.planes.iter_mut();
                for stiffness in planes.filter_map(|plane| plane.contact_stiffness_n_per_m.as_mut())
                {
                    *stiffness *= number;
                }
            }
            "density" if number > 0.0 && number.is_finite() => {
                for material in self.materials.values_mut() {
                    material.density_kg_per_m3 *= number;
                }
                for component in &mut self.gravity_m_per_s2 {
                    *component /= number;
                }
            }
            "loading_rate" if number > 0.0 && number.is_finite() => self.hasten(number),
            _ => return None,
        }
        Some(())
    }

    fn single(&mut self, seed: u64) {
        self.seed = seed;
        self.record = Record {
            every_steps: self.record.every_steps,
            from_stage: self.record.from_stage,
            bodies: Some(Vec::new()),
            ..Record::default()
        };
    }

    fn compares(result: &str) -> bool {
        COMPARED.contains(&result)
    }
}

/// A knob whose last value is the reference.
fn finer(
    name: &'static str,
    description: &'static str,
    present: f64,
    values: &[&'static str],
) -> Knob {
    let (finest, grid) = values.split_last().unwrap_or((&"", &[]));
    Knob::new(name, description, present, grid, finest)
}

#[cfg(test)]
mod tests {
    #![allow(
        clippy::float_cmp,
        reason = "factors are powers of two, or done the same way"
    )]
    use super::Stage;
    use crate::{JobKind, JobSpec, Submission};

    fn example(body: &str) -> JobSpec {
        let submission = Submission::from_slice(body.as_bytes());
        submission.expect("a valid example").spec
    }

    #[test]
    fn every_time_step_of_the_grid_gives_a_valid_spec_that_says_so() {
        for file in JobKind::GranularScene.examples() {
            for knob in example(file.body).knobs() {
                let reference = knob.reference.iter().map(|(_, value)| value);
                for value in knob.grid.iter().chain(reference) {
                    let mut spec = example(file.body);
                    spec.turn(knob.name, value).expect("a value it takes");
                    let turned = spec.knobs();
                    let turned = turned.iter().find(|turned| turned.name == knob.name);
                    let present = &turned.expect("still there").present;
                    let same = present.parse::<f64>() == value.parse::<f64>();
                    // the others are factors on what the spec says
                    let is_absolute = knob.name == "critical_step_fraction";
                    assert!(same || !is_absolute, "{}: {present}", knob.name);
                    if is_absolute {
                        spec.check().expect("a valid spec");
                    }
                }
            }
        }
    }

    #[test]
    fn words_are_no_numbers_and_nothing_is_set_by_them() {
        let automatic = example(JobKind::GranularScene.examples()[1].body);
        let mut spec = automatic.clone();
        assert!(spec.turn("stiffness", "soft").is_err());
        assert!(spec.turn("stiffness", "-1").is_err());
        assert_eq!(spec, automatic);
        spec.turn("stiffness", "0.5").expect("a factor");
        assert_ne!(spec, automatic);
        assert!(spec.turn("loading_rate", "0").is_err());
    }

    #[test]
    fn a_hastened_scene_does_the_same_ways_and_mass_scaling_keeps_weights() {
        let body = r#"{"kind": "granular_scene", "spec": {"version": 1,
            "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e7}},
            "planes": [{"name": "top", "axis": "z", "position_m": 1, "facing": -1, "material": "stone"}],
            "stages": [{"run": {"time_s": 0.5}},
                {"move_plane": {"name": "top", "velocity_m_per_s": -0.1, "time_s": 2}},
                {"drive": {"walls": [{"name": "top", "sine": {"amplitude_m": [0, 0, 0.1],
                    "frequency_hz": 2}}], "steps": 1000}}]}}"#;
        let mut spec = example(body);
        spec.turn("loading_rate", "4").expect("a factor");
        spec.turn("density", "100").expect("a factor");
        let JobSpec::GranularScene(scene) = spec else {
            panic!("another kind")
        };
        assert_eq!(scene.materials["stone"].density_kg_per_m3, 260_000.0);
        assert_eq!(scene.gravity_m_per_s2[2], -9.81 / 100.0);
        let [
            Stage::Run(run),
            Stage::MovePlane(moved),
            Stage::Drive(drive),
        ] = &scene.stages[..]
        else {
            panic!("other stages")
        };
        assert_eq!(run.time_s, Some(0.5));
        assert_eq!((moved.velocity_m_per_s, moved.time_s), (-0.4, Some(0.5)));
        let sine = drive.walls[0].sine.expect("a sine");
        assert_eq!((sine.frequency_hz, drive.steps), (8.0, Some(250)));
    }

    #[test]
    fn cement_is_softened_with_its_material() {
        let body = r#"{"kind": "granular_scene", "spec": {"version": 1,
            "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e7,
                "parallel_bond": {"youngs_modulus_pa": 3e6, "tensile_strength_pa": 1e5,
                    "shear_strength_pa": 1e5}}},
            "bodies": [{"sphere": {"radius_m": 0.01}, "material": "stone", "position_m": [0, 0, 0]}],
            "stages": [{"run": {"time_s": 0.5}}]}}"#;
        let mut spec = example(body);
        spec.turn("stiffness", "0.25").expect("a factor");
        let JobSpec::GranularScene(scene) = spec else {
            panic!("another kind")
        };
        let stone = &scene.materials["stone"];
        let bond = stone.parallel_bond.expect("cement");
        assert_eq!(stone.youngs_modulus_pa, 2.5e6);
        assert_eq!(bond.youngs_modulus_pa, 7.5e5);
        // strengths are no moduli
        assert_eq!(bond.tensile_strength_pa, 1e5);
    }

    #[test]
    fn a_given_time_step_and_nothing_driven_leave_nothing_to_vary() {
        let given = example(JobKind::GranularScene.examples()[0].body);
        assert!(given.knobs().is_empty());
    }
}
