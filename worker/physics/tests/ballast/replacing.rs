//! Beds that are poured as spheres, which clumps replace.
use loadframe_api::{JobSpec, spec::ballast::Phase};
use serde_json::{Value, json};

use super::{run, small_oedometer, submission, value};

/// Two balls at ±½ of their radius.
fn pair() -> Value {
    json!({"clump": {"members": [
        {"offset_m": [0, 0, 0.006], "radius_m": 0.012},
        {"offset_m": [0, 0, -0.006], "radius_m": 0.012}]}})
}

/// An oedometer of pairs that come in as spheres.
fn replaced(equal: &str) -> Value {
    let mut job = small_oedometer();
    job["spec"]["grains"]["shape"] = pair();
    job["spec"]["grains"]["sizes"] = json!({"radius_m": 0.02});
    job["spec"]["preparation"] = json!({"compaction": null, "poured_as_spheres": {"equal": equal}});
    // what the load does is no matter here
    job["spec"]["test"] = json!({"smallest_force_n": 100, "peak_force_n": 1e3});
    job["spec"]["preparation"]["longest_settling_s"] = json!(0.5);
    job["spec"]["accuracy"]["inertial_number"] = json!(5e-3);
    job
}

/// Of two balls of radius 1 at ±½, each of which loses a cap of height ½, π h² (3 − h)/3 = 5π/24.
const PAIR: f64 = (8.0 / 3.0 - 2.0 * 5.0 / 24.0) * std::f64::consts::PI;

#[test]
fn a_clump_of_equal_size_lies_inside_its_sphere_and_one_of_equal_mass_is_taken_out_of_its_neighbours()
 {
    let ball = 4.0 / 3.0 * std::f64::consts::PI;
    for (equal, share) in [("size", PAIR / (ball * 1.5_f64.powi(3))), ("mass", 1.0)] {
        let JobSpec::BallastOedometer(spec) = submission(&replaced(equal)).expect("a valid job")
        else {
            panic!("another kind");
        };
        // its scene until the bed is cut to its height
        let script = spec.script();
        let cut = script.phases.iter().position(|phase| *phase == Phase::Cut);
        let mut scene = script.scene;
        scene.stages.truncate(cut.expect("it is cut") + 1);
        scene.record = Default::default();
        let (report, _) = run(&json!({"kind": "granular_scene", "spec": scene}));
        let [spheres, before, after, overlap] = [
            "replaced_spheres",
            "mass_before_replacing",
            "mass_after_replacing",
            "overlap_after_replacing",
        ]
        .map(|name| value(&report, name));
        let each = 2600.0 * ball * 0.02_f64.powi(3);
        assert!(
            (before / (spheres * each) - 1.0).abs() < 1e-9,
            "{before} {spheres}"
        );
        // the union of two balls is known to the engine to 1e-9
        assert!(
            (after / before / share - 1.0).abs() < 1e-6,
            "{equal} {after} {before}"
        );
        // soft spheres at rest overlap by some 1e-3 of their radius, pairs of their mass by tenths
        match equal {
            "size" => assert!(overlap < 5e-3, "{overlap}"),
            _ => assert!(overlap > 0.05, "{overlap}"),
        }
        let largest = &report.quality["largest_overlap_ratio"];
        assert!(largest.value < 0.05, "{}", largest.value);
        let mass = value(&report, "total_mass");
        let clumps = mass / (after / spheres);
        assert!(
            (clumps - clumps.round()).abs() < 1e-6,
            "only clumps are left: {clumps}"
        );
        // the bed is as high as it is to be, at the solid fraction of a loose one
        let solid = mass / 2600.0 / (std::f64::consts::PI * 0.1 * 0.1 * 0.1);
        assert!((0.45..0.65).contains(&solid), "{equal} {solid}");
    }
}

#[test]
fn every_layer_is_replaced_when_it_has_settled_and_before_it_is_cut() {
    let mut job = json!({"kind": "ballast_railbed", "spec": replaced("size")["spec"]});
    job["spec"]["apparatus"] = json!({});
    let spec = job["spec"].as_object_mut().expect("fields");
    spec.remove("test");
    let JobSpec::BallastRailbed(spec) = submission(&job).expect("a valid job") else {
        panic!("another kind");
    };
    let phases = spec.script().phases;
    let replacing: Vec<usize> = (0..phases.len())
        .filter(|at| phases[*at] == Phase::Replace)
        .collect();
    assert_eq!(replacing.len(), 4);
    for pair in replacing.chunks_exact(2) {
        // clumps come in, fall and come to rest; the layer is shaken, if it is, and cut after that
        let [at, last] = [pair[0], pair[1]];
        assert_eq!(last, at + 1);
        assert_eq!([phases[at - 1], phases[last + 1]], [Phase::Settle; 2]);
        let mut after = phases[last + 2..].iter();
        assert_eq!(
            after.find(|phase| **phase != Phase::Settle),
            Some(&Phase::Cut)
        );
    }
}

#[test]
fn what_cannot_take_the_places_of_spheres_is_refused() {
    let refused = |job: &Value| {
        let violations = submission(job).expect_err("this must be refused");
        (violations[0].pointer.clone(), violations[0].detail.clone())
    };
    let option = "/spec/preparation/poured_as_spheres";
    let mut spheres = replaced("size");
    spheres["spec"]["grains"]["shape"] = json!("sphere");
    assert_eq!(refused(&spheres).0, option);

    let mut breakable = replaced("size");
    let shape = json!({"breakable": pair()["clump"]});
    breakable["spec"]["grains"]["shape"] = shape;
    for cohesion in ["normal_cohesion_pa", "shear_cohesion_pa"] {
        breakable["spec"]["materials"]["aggregate"][cohesion] = json!(1e6);
    }
    let (pointer, detail) = refused(&breakable);
    assert_eq!(pointer, option);
    assert!(detail.contains("break"), "{detail}");

    let mut unturned = replaced("size");
    unturned["spec"]["grains"]["turned"] = json!(false);
    assert_eq!(refused(&unturned).0, option);

    // a rod of the sphere's mass has members outside of it
    let rod: Vec<Value> = (-4..=4)
        .map(|at| json!({"offset_m": [0.01 * f64::from(at), 0, 0], "radius_m": 0.01}))
        .collect();
    let mut far = replaced("mass");
    far["spec"]["grains"] =
        json!({"shape": {"clump": {"members": rod}}, "sizes": {"radius_m": 0.01}});
    let (pointer, detail) = refused(&far);
    assert_eq!(pointer, format!("{option}/equal"));
    assert!(detail.contains("outside"), "{detail}");
    far["spec"]["preparation"]["poured_as_spheres"] = json!({});
    submission(&far).expect("the ball around it is its sphere");

    let mut bonded = replaced("size");
    bonded["spec"]["materials"]["aggregate"]["normal_cohesion_pa"] = json!(1e6);
    assert_eq!(refused(&bonded).0, "/spec/materials/aggregate");
}
