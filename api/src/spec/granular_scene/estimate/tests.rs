//! Steps that are expected beside those that runs took.
use crate::{JobSpec, Submission};

use super::GranularScene;

/// What a run may take more or less than is told.
const FACTOR: f64 = 1.4;

fn scene(example: &str) -> GranularScene {
    let job = Submission::from_slice(example.as_bytes()).expect("a valid example");
    match job.spec {
        JobSpec::GranularScene(spec) => *spec,
        JobSpec::Triaxial(spec) => spec.script().scene,
        JobSpec::DirectShear(spec) => spec.script().scene,
        _ => panic!("no scene"),
    }
}

#[test]
fn steps_are_about_those_that_examples_took() {
    // counted by `loadframe run` of each
    for (example, took) in [
        (
            include_str!("../../../../examples/granular_scene_bent_rod.json"),
            12_666.0,
        ),
        (
            include_str!("../../../../examples/triaxial.json"),
            145_460.0,
        ),
        (
            include_str!("../../../../examples/direct_shear.json"),
            125_973.0,
        ),
    ] {
        let expected = scene(example).steps();
        assert!(
            (took / FACTOR..took * FACTOR).contains(&expected),
            "{expected} beside {took}"
        );
    }
}

#[test]
fn a_sphere_that_resists_rolling_and_a_small_clump_are_more_work_than_a_sphere() {
    let soil = scene(include_str!("../../../../examples/triaxial.json"));
    let mut smooth = soil.clone();
    for material in smooth.materials.values_mut() {
        material.rolling_resistance = None;
    }
    let ratio = soil.work() / smooth.work();
    assert!((ratio - super::RESISTING).abs() < 1e-12, "{ratio}");
    // 1.6 + 2·0.35 and 1.6 + 8·0.35
    assert!((super::work_of_clumps(10.0, 20.0) - 23.0).abs() < 1e-12);
    assert!((super::work_of_clumps(1.0, 8.0) - 4.4).abs() < 1e-12);
}
