//! What an accuracy study varies in a granular scene.
use super::{Accuracy, GranularScene, Knobs, Record, TimeStep};
use crate::study::Knob;

/// Time steps tried, as parts of the critical one; the last is the reference.
const STEPS: [&str; 5] = ["0.8", "0.4", "0.2", "0.1", "0.05"];
/// Factors on all moduli tried; the last, the materials as they are, is the reference.
const SOFTENINGS: [&str; 4] = ["1e-3", "1e-2", "1e-1", "1"];
/// Results that say how the bodies stand and what they carry.
const COMPARED: [&str; 3] = ["contacts", "coordination_number", "elastic_energy"];

pub(super) fn knobs(spec: &GranularScene) -> Vec<Knob> {
    let knob = |name, description, present, values: &[&str]| {
        let (finest, grid) = values.split_last().unwrap_or((&"", &[]));
        Knob {
            name,
            description,
            present,
            grid: grid.iter().map(|value| (*value).to_owned()).collect(),
            reference: vec![(name, (*finest).to_owned())],
            keeps_specimen: true,
        }
    };
    let mut knobs = Vec::new();
    if let TimeStep::Automatic(_) = spec.time_step_s {
        let fraction = spec.accuracy.knobs().critical_step_fraction;
        knobs.push(knob(
            "critical_step_fraction",
            "the time step over the critical one, a number from 1e-6 to 0.9",
            fraction.to_string(),
            &STEPS,
        ));
        // a given time step would become needlessly small for softened materials
        knobs.push(knob(
            "stiffness",
            "a factor on the Young's modulus of all materials, a number above 0",
            "1".to_owned(),
            &SOFTENINGS,
        ));
    }
    knobs
}

/// Sets a knob; `None` when the value is not one it takes. Ranges are left to the schema.
pub(super) fn turn(spec: &mut GranularScene, knob: &str, value: &str) -> Option<()> {
    let number: f64 = value.parse().ok()?;
    match knob {
        "critical_step_fraction" => {
            spec.accuracy = Accuracy::Knobs(Knobs {
                critical_step_fraction: number,
            });
        }
        "stiffness" if number > 0.0 && number.is_finite() => {
            for material in spec.materials.values_mut() {
                material.youngs_modulus_pa *= number;
            }
        }
        _ => return None,
    }
    Some(())
}

/// One run of this seed that writes as little as it can.
pub(super) fn single(spec: &mut GranularScene, seed: u64) {
    spec.seed = seed;
    spec.record = Record {
        every_steps: spec.record.every_steps,
        bodies: Some(Vec::new()),
        ..Record::default()
    };
}

pub(super) fn compares(result: &str) -> bool {
    COMPARED.contains(&result)
}

#[cfg(test)]
mod tests {
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
                    assert!(same || knob.name == "stiffness", "{}: {present}", knob.name);
                    if knob.name != "stiffness" {
                        spec.check().expect("a valid spec");
                    }
                }
            }
        }
    }

    #[test]
    fn a_given_time_step_leaves_nothing_to_vary_and_words_are_no_numbers() {
        let automatic = example(JobKind::GranularScene.examples()[1].body);
        let mut spec = automatic.clone();
        assert!(spec.turn("stiffness", "soft").is_err());
        assert!(spec.turn("stiffness", "-1").is_err());
        assert_eq!(spec, automatic);
        spec.turn("stiffness", "0.5").expect("a factor");
        assert_ne!(spec, automatic);
        let given = example(JobKind::GranularScene.examples()[0].body);
        assert!(given.knobs().is_empty());
    }
}
