//! Specs that are small and ask for much: whatever counts a schema allows, a spec is refused or its
//! estimate tells what it would take.
use std::collections::BTreeSet;

use loadframe_api::{
    Calibration, Estimate, JobKind, Limits, Submission, SubmissionError, Violation, kind_schema,
};
use serde_json::{Value, json};

/// What a server gives a job, see its configuration.
const LIMITS: Limits = Limits {
    wall_s: 7.0 * 24.0 * 3600.0,
    memory_mb: 8_000.0,
    disk_mb: 20_000.0,
};

fn estimate(body: &Value) -> Result<Estimate, Vec<Violation>> {
    match Submission::from_slice(body.to_string().as_bytes()) {
        Ok(submission) => Ok(submission.spec.estimate(&Calibration::default())),
        Err(SubmissionError::Invalid(violations)) => Err(violations),
        Err(syntax) => panic!("{syntax}"),
    }
}

fn codes(body: &Value) -> Vec<String> {
    let violations = estimate(body).expect_err("refused");
    let place = |violation: Violation| format!("{} {}", violation.pointer, violation.code);
    violations.into_iter().map(place).collect()
}

/// Whether a server of the usual limits takes the job.
fn is_taken(body: &Value) -> bool {
    estimate(body).is_ok_and(|estimate| LIMITS.exceeded(&estimate).is_empty())
}

fn example(name: &str) -> Value {
    let examples = JobKind::ALL.iter().flat_map(|kind| kind.examples());
    let mut named = examples.filter(|example| example.name == name);
    serde_json::from_str(named.next().expect("it is there").body).expect("examples are JSON")
}

/// Pointers to all numbers of `value`, with the limits that `schema` gives them.
fn numbers(value: &Value, schema: &Value, pointer: &str, found: &mut Vec<(String, Value)>) {
    for keyword in ["oneOf", "anyOf"] {
        for branch in schema[keyword].as_array().into_iter().flatten() {
            numbers(value, branch, pointer, found);
        }
    }
    match value {
        Value::Number(_) => {
            let limits = ["minimum", "maximum"].map(|limit| schema[limit].clone());
            let limits = limits.into_iter().filter(Value::is_number);
            found.extend(limits.map(|limit| (pointer.to_owned(), limit)));
        }
        Value::Array(items) => {
            for (index, item) in items.iter().enumerate().take(4) {
                numbers(item, &schema["items"], &format!("{pointer}/{index}"), found);
            }
        }
        Value::Object(fields) => {
            for (name, field) in fields {
                let place = name.replace('~', "~0").replace('/', "~1");
                let known = schema["properties"].get(name);
                let schema = known.unwrap_or(&schema["additionalProperties"]);
                numbers(field, schema, &format!("{pointer}/{place}"), found);
            }
        }
        _ => {}
    }
}

#[test]
fn every_number_at_the_ends_of_its_range_is_refused_or_priced() {
    let mut tried = BTreeSet::new();
    for kind in JobKind::ALL {
        for example in kind.examples() {
            let text = Submission::from_slice(example.body.as_bytes())
                .expect("valid")
                .spec;
            // all defaults written out, so that every number is there
            let spec: Value = serde_json::from_str(&text.to_json()).expect("JSON");
            let mut all = Vec::new();
            numbers(&spec, kind_schema(*kind), "", &mut all);
            for (pointer, limit) in all {
                if !tried.insert((kind.name(), pointer.clone(), limit.to_string())) {
                    continue;
                }
                let mut spec = spec.clone();
                *spec.pointer_mut(&pointer).expect("it was found") = limit.clone();
                let body = json!({"kind": kind.name(), "spec": spec});
                let Ok(estimate) = estimate(&body) else {
                    continue;
                };
                let parts = [estimate.wall_s, estimate.memory_mb, estimate.disk_mb];
                // what is no number is beyond every limit; none is below nothing
                assert!(
                    parts.iter().all(|part| part.is_nan() || *part >= 0.0),
                    "{} {pointer} = {limit}: {estimate:?}",
                    example.name
                );
            }
        }
    }
    assert!(tried.len() > 500, "{}", tried.len());
}

fn scene(rest: Value) -> Value {
    let mut spec = json!({
        "version": 1,
        "materials": {"steel": {"density_kg_per_m3": 7850, "youngs_modulus_pa": 2.1e8,
            "stiffness_ratio": 0.3, "friction_angle_rad": 0.5}},
        "bodies": [{"sphere": {"radius_m": 0.01}, "material": "steel", "position_m": [0, 0, 0.5]}],
        "planes": [{"name": "base", "axis": "z", "position_m": 0, "facing": 1, "material": "steel"}],
        "stages": [{"run": {"steps": 10}}],
    });
    for (name, field) in rest.as_object().expect("an object") {
        spec[name] = field.clone();
    }
    json!({"kind": "granular_scene", "spec": spec})
}

#[test]
fn counts_that_wrap_are_too_many() {
    // 2.9e17 grains of 64 members are 2⁶⁴ and some
    let members: Vec<Value> = (0..64)
        .map(|number| json!({"offset_m": [number as f64 * 1e-9, 0, 0], "radius_m": 1e-9}))
        .collect();
    let grains = json!({"material": "steel", "grain": {"clump": {"members": members}},
        "region": {"box": {"lower_m": [0, 0, 1], "upper_m": [1, 1, 2]}},
        "mass_kg": 2.9e17 * 64.0 * 7850.0 * 4.188_790_2e-27, "sizes": {"radius_m": 4e-9}});
    let body = scene(json!({"generate": [grains]}));
    assert!(codes(&body).contains(&"/spec/bodies too_large".to_owned()));
}

#[test]
fn a_stage_that_may_never_end_is_not_cheap() {
    let settle = |time_s: f64| scene(json!({"stages": [{"settle": {"time_s": time_s}}]}));
    assert!(is_taken(&settle(10.0)));
    assert!(!is_taken(&settle(1e9)));
    // the usual limits of a settle do not change what it is taken for
    let short = estimate(&settle(2.0)).expect("valid").wall_s;
    let usual = estimate(&settle(100.0)).expect("valid").wall_s;
    assert!((usual / short - 1.0).abs() < 1e-12);
}

#[test]
fn a_lattice_in_a_region_far_too_large_is_refused() {
    let grains = |side: f64| {
        scene(
            json!({"generate": [{"material": "steel", "arrangement": "hexagonal", "count": 1000,
            "sizes": {"radius_m": 1e-3}, "region": {"box": {"lower_m": [0, 0, 0.6], "upper_m": [side, side, 0.6 + side]}}}]}),
        )
    };
    assert!(is_taken(&grains(0.1)));
    // √2 (1/0.002)³ = 1.8e8 places
    assert_eq!(codes(&grains(1.0)), ["/spec/generate/0/region too_large"]);
}

#[test]
fn a_curve_has_no_more_columns_than_a_server_takes() {
    let planes = |count: usize| {
        let plane = |number: usize| json!({"name": format!("p{number}"), "axis": "z", "position_m": 0, "facing": 1, "material": "steel"});
        let names: Vec<String> = (0..count).map(|number| format!("p{number}")).collect();
        let all: Vec<Value> = (0..count).map(plane).collect();
        scene(json!({"planes": all, "record": {"planes": names}}))
    };
    // 9 columns of every scene and 2 of each plane
    assert!(is_taken(&planes(95)));
    assert_eq!(codes(&planes(96)), ["/spec/record too_many_columns"]);
}

#[test]
fn regions_at_every_step_are_priced() {
    let regions = |count: usize| {
        let region = |number: usize| json!({"name": format!("r{number}")});
        let all: Vec<Value> = (0..count).map(region).collect();
        scene(
            json!({"stages": [{"run": {"steps": 1_000_000}}], "record": {"every_steps": 1, "regions": all}}),
        )
    };
    let wall_s = |count: usize| estimate(&regions(count)).expect("valid").wall_s;
    // as measured: 18 of them made a run 44 times as long
    let ratio = wall_s(18) / wall_s(0);
    assert!((40.0..48.0).contains(&ratio), "{ratio}");
}

#[test]
fn shapes_are_filled_for_a_check_only_as_far_as_a_second_goes() {
    let clump = |number: usize| {
        json!({"clump": {"filled": {"shape": {"box": {"sides_m": [1, 1, 1]}}, "member_radius_m": 0.0125}},
            "material": "steel", "position_m": [3 * number, 0, 2]})
    };
    let bodies = |count: usize| -> Vec<Value> { (0..count).map(clump).collect() };
    // √2 · 40³ = 90 500 members each, as far as their number is known beforehand
    let body = scene(json!({"bodies": bodies(500)}));
    assert_eq!(codes(&body), ["/spec/bodies/22 too_large"]);
}

#[test]
fn a_calibration_reads_its_job_no_more_often_than_a_large_body_is_read() {
    let mut body = example("calibrate");
    let free = body["spec"]["free"].as_array().expect("a list").len();
    body["spec"]["job"]["spec"]["x"] = json!(" ".repeat((16 << 20) / (2 + 2 * free)));
    assert_eq!(codes(&body), ["/spec/job/spec too_large"]);
}

#[test]
fn a_scene_of_slanted_fibres_is_checked_in_no_time_and_their_crossing_is_found() {
    let mut body = example("composite_bending");
    let spec = body["spec"].as_object_mut().expect("an object");
    spec["section"] =
        json!({"length_mm": 70, "height_mm": 70, "thickness_mm": 1, "state": "plane_stress"});
    let fibre = spec["fibres"][0].clone();
    let slanted = |number: usize| {
        let mut fibre = fibre.clone();
        fibre["through_mm"] = json!([7e-3 * number as f64 + 1.0, 35.0]);
        fibre["angle_deg"] = json!(45.0);
        fibre["thickness_mm"] = json!(1e-4);
        fibre
    };
    let mut fibres: Vec<Value> = (0..9_000).map(slanted).collect();
    spec["fibres"] = json!(fibres);
    assert!(estimate(&body).is_ok(), "{:?}", codes(&body));
    let mut crossing = slanted(4_500);
    crossing["angle_deg"] = json!(-45.0);
    fibres.push(crossing);
    body["spec"]["fibres"] = json!(fibres);
    assert_eq!(codes(&body)[0].rsplit(' ').next(), Some("overlap"));
}
