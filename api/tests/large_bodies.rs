//! Bodies that are large and well formed: whatever list of whatever kind is long, checking takes time
//! and memory in proportion to the body, and tells no more than is read.
//!
//! One test, because memory is that of the process.
use std::collections::BTreeSet;
use std::fmt::Write as _;

use loadframe_api::{Calibration, JobKind, Limits, Submission, SubmissionError};
use serde_json::{Value, json};

/// Length of a list that is made long [bytes],
const SIZE: usize = 60_000;
/// and of bodies in which everything has to do with everything.
const CROWD: usize = 1_500_000;
/// Processor time that a body may take [s]. Those of a crowd that are gone through in pairs take a
/// hundred times as long; the dev profile is some ten times slower than a release.
const LONGEST_S: f64 = 10.0;
/// Peak memory over the body's bytes, with what a small one takes [bytes]. A value of two bytes, `0,`,
/// is 72 once it is read.
const MEMORY_PER_BYTE: f64 = 120.0;
const MEMORY: f64 = 10e6;
/// Violations listed at most, and bytes of one as JSON.
const LISTED: usize = 100;
const LONGEST_VIOLATION: usize = 8_000;

struct Body {
    name: String,
    text: String,
}

/// Processor time of this thread so far [s].
fn processor_time() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").expect("Linux");
    let nanoseconds = text.split(' ').next().and_then(|word| word.parse().ok());
    nanoseconds.map_or(f64::NAN, |nanoseconds: f64| nanoseconds * 1e-9)
}

/// Largest memory of this process [bytes] since the mark was set back.
fn peak_memory() -> f64 {
    let text = std::fs::read_to_string("/proc/self/status").expect("Linux");
    let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes = line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<f64>().ok());
    kilobytes.map_or(f64::NAN, |kilobytes| kilobytes * 1024.0)
}

fn examples() -> impl Iterator<Item = (&'static str, Value)> {
    let all = JobKind::ALL.iter().flat_map(|kind| kind.examples());
    all.map(|example| {
        let body = serde_json::from_str(example.body).expect("examples are JSON");
        (example.name, body)
    })
}

/// Pointers to all lists and objects of `value`, each once however many entries of a list have it.
fn containers(value: &Value, pointer: &str, place: &str, found: &mut Vec<(String, String)>) {
    match value {
        Value::Array(items) => {
            found.push((pointer.to_owned(), place.to_owned()));
            if let Some(first) = items.first() {
                containers(first, &format!("{pointer}/0"), &format!("{place}/*"), found);
            }
        }
        Value::Object(fields) => {
            found.push((pointer.to_owned(), place.to_owned()));
            for (name, field) in fields {
                let name = name.replace('~', "~0").replace('/', "~1");
                containers(
                    field,
                    &format!("{pointer}/{name}"),
                    &format!("{place}/{name}"),
                    found,
                );
            }
        }
        _ => {}
    }
}

/// Every example, with each of its lists grown by its own entries or by wrong ones, and each of its
/// objects by fields that it may not have.
fn grown() -> Vec<Body> {
    let mut bodies = Vec::new();
    let mut seen = BTreeSet::new();
    for (name, example) in examples() {
        let mut places = Vec::new();
        containers(&example, "", "", &mut places);
        for (pointer, place) in places {
            if !seen.insert((example["kind"].to_string(), place)) {
                continue;
            }
            let mut grow = |what: &str, change: &dyn Fn(&mut Value)| {
                let mut body = example.clone();
                change(body.pointer_mut(&pointer).expect("it was found"));
                bodies.push(Body {
                    name: format!("{name}{pointer}: {what}"),
                    text: body.to_string(),
                });
            };
            let list_of = |entry: Value| {
                let count = SIZE / (entry.to_string().len() + 1);
                Value::Array(vec![entry; count])
            };
            match example.pointer(&pointer).expect("it was found") {
                Value::Array(items) => {
                    if let Some(first) = items.first() {
                        grow("the same again", &|list| *list = list_of(first.clone()));
                    }
                    grow("null", &|list| *list = list_of(Value::Null));
                    grow("empty objects", &|list| *list = list_of(json!({})));
                    grow("numbers", &|list| *list = list_of(json!(7)));
                }
                Value::Object(_) => {
                    for (what, entry) in [("null", Value::Null), ("objects", json!({}))] {
                        grow(&format!("more fields, {what}"), &|fields| {
                            let count = SIZE / 15;
                            for number in 0..count {
                                fields[format!("x{number}")] = entry.clone();
                            }
                        });
                    }
                    grow("the same again under other names", &|fields| {
                        let own = fields.as_object().expect("it is one");
                        let Some(first) = own.values().next().cloned() else {
                            return;
                        };
                        let count = SIZE / (first.to_string().len() + 10);
                        for number in 0..count {
                            fields[format!("x{number}")] = first.clone();
                        }
                    });
                }
                _ => {}
            }
        }
    }
    bodies
}

/// A scene of `CROWD` bytes whose bodies are written by `body`, from their numbers.
fn scene(name: &str, body: impl Fn(usize) -> String, rest: &str) -> Body {
    let mut bodies = String::new();
    let mut number = 0;
    while bodies.len() < CROWD {
        let comma = if number > 0 { "," } else { "" };
        write!(bodies, "{comma}{}", body(number)).expect("into memory");
        number += 1;
    }
    let text = format!(
        r#"{{"kind": "granular_scene", "spec": {{"version": 1, "materials": {{
            "steel": {{"density_kg_per_m3": 7850, "youngs_modulus_pa": 2.1e8, "stiffness_ratio": 0.3,
                "friction_angle_rad": 0.5}},
            "glue": {{"density_kg_per_m3": 2000, "youngs_modulus_pa": 2.1e8, "stiffness_ratio": 0.3,
                "friction_angle_rad": 0.5, "normal_cohesion_pa": 1e6, "shear_cohesion_pa": 1e6}}}},
            "bodies": [{bodies}], {rest} }}}}"#
    );
    let name = name.to_owned();
    Body { name, text }
}

const RUN: &str = r#""stages": [{"run": {"steps": 10}}]"#;

/// Scenes whose bodies have something to do with all others.
fn crowds() -> Vec<Body> {
    let sphere = |radius: f64, at: [f64; 3], rest: &str| {
        format!(
            r#"{{"sphere":{{"radius_m":{radius}}},"material":"steel","position_m":{at:?}{rest}}}"#
        )
    };
    let held = r#","fixed":["x","y","z","rx","ry","rz"]"#;
    let plane = |number: usize| [0.0, (number % 50) as f64, (number / 50) as f64];
    let mut all = vec![
        scene("one place", |_| sphere(0.1, [0.0; 3], ""), RUN),
        scene("one plane", |number| sphere(0.4, plane(number), ""), RUN),
        scene(
            "one line",
            |number| sphere(0.4, [0.0, 0.0, number as f64], ""),
            RUN,
        ),
        scene("held in one place", |_| sphere(0.1, [0.0; 3], held), RUN),
        scene(
            "nearly in one place, to be relaxed",
            |number| sphere(0.1, [number as f64 * 1e-9, 0.0, 0.0], ""),
            r#""stages": [{"relax": {"steps": 10}}]"#,
        ),
        scene(
            "nearly in one place, bonded",
            |number| sphere(0.1, [number as f64 * 1e-9, 0.0, 0.0], "").replace("steel", "glue"),
            RUN,
        ),
        scene(
            "sizes over fifteen decades",
            |number| {
                let radius = 1e-9 * 10_f64.powf((number % 15) as f64);
                sphere(radius, [number as f64 * 1e6 * 2.1, 0.0, 0.0], "")
            },
            RUN,
        ),
    ];
    let members = r#"{"offset_m":[0,0,0],"radius_m":0.1},"#.repeat(CROWD / 40);
    let clump = format!(
        r#"{{"clump": {{"members": [{}]}}, "material": "steel", "position_m": [0, 0, 0]}}"#,
        members.trim_end_matches(',')
    );
    all.push(scene("members in one place", |_| clump.clone(), RUN));
    let filled = |radius: f64| {
        format!(
            r#"{{"clump": {{"filled": {{"shape": {{"box": {{"sides_m": [1, 1, 1]}}}}, "member_radius_m": {radius}}}}},
               "material": "steel", "position_m": [0, 0, 0]}}"#
        )
    };
    all.push(scene("shapes of many members", |_| filled(0.0125), RUN));
    all.push(scene("shapes of too many members", |_| filled(1e-9), RUN));
    let planes: Vec<String> = (0..1000)
        .map(|number| {
            format!(r#"{{"name":"p{number}","axis":"z","position_m":-{number},"facing":1,"material":"steel"}}"#)
        })
        .collect();
    let planes = format!(r#""planes": [{}], {RUN}"#, planes.join(","));
    all.push(scene(
        "many planes",
        |number| sphere(0.4, [number as f64, 0.0, 2.0], ""),
        &planes,
    ));
    let triangle = "[[-9e3,-9e3,0],[9e3,-9e3,1],[0,9e3,2]]";
    let facets = vec![triangle; CROWD / 45].join(",");
    let facets = format!(
        r#""facets": [{{"name": "f", "material": "steel", "triangles_m": [{facets}]}}], {RUN}"#
    );
    all.push(scene(
        "triangles through all",
        |number| sphere(0.4, plane(number), ""),
        &facets,
    ));
    let drive =
        r#"{"drive":{"steps":1,"bodies":[{"body":0,"velocity":{"velocity_m_per_s":[0,0,1]}}]}},"#;
    let stages = drive.repeat(CROWD / 90);
    let stages = format!(r#""stages": [{}]"#, stages.trim_end_matches(','));
    all.push(scene(
        "a body driven often",
        |number| sphere(0.4, plane(number), ""),
        &stages,
    ));
    let nodes = "null,".repeat(1_000_000);
    let text = format!(
        r#"{{"kind": "nonwoven_tensile", "spec": {{"version": 1, "fabric": {{"network": {{
            "nodes_mm": [{}], "jaws": [], "bonds": []}}}}}}}}"#,
        nodes.trim_end_matches(',')
    );
    let name = "a million wrong nodes".to_owned();
    all.push(Body { name, text });
    all
}

#[test]
#[expect(clippy::print_stdout, reason = "figures are for people")]
fn checking_is_linear_in_the_body_whatever_is_long_in_it() {
    // schemas are compiled once
    for (name, example) in examples() {
        let checked = Submission::from_slice(example.to_string().as_bytes());
        assert!(checked.is_ok(), "{name}");
    }
    let limits = Limits {
        wall_s: 1e9,
        memory_mb: 64e3,
        disk_mb: 1e6,
    };
    let mut failures = String::new();
    let (mut slowest, mut largest) = ((0.0, String::new()), (0.0, String::new()));
    for body in grown().into_iter().chain(crowds()) {
        // 5 sets the mark back (proc_pid_clear_refs(5))
        std::fs::write("/proc/self/clear_refs", "5").expect("Linux");
        let (before, start) = (peak_memory(), processor_time());
        let checked = Submission::from_slice(body.text.as_bytes());
        let estimated = checked.map(|submission| {
            let estimate = submission.spec.estimate(&Calibration::default());
            (limits.exceeded(&estimate).is_empty(), estimate)
        });
        let took = processor_time() - start;
        let memory = peak_memory() - before;
        let per_byte = (memory - MEMORY) / body.text.len() as f64;
        if took > slowest.0 {
            slowest = (took, body.name.clone());
        }
        if per_byte > largest.0 {
            largest = (per_byte, body.name.clone());
        }
        if took > LONGEST_S || per_byte > MEMORY_PER_BYTE {
            let length = body.text.len();
            writeln!(
                failures,
                "{}: {length} bytes, {took:.2} s, {memory:.2e} bytes of memory",
                body.name
            )
            .expect("into memory");
        }
        match estimated {
            Ok((_, estimate)) => {
                let all = [estimate.wall_s, estimate.memory_mb, estimate.disk_mb];
                let is_sane = all.iter().all(|one| one.is_finite() && *one >= 0.0);
                assert!(is_sane, "{}: {estimate:?}", body.name);
            }
            Err(SubmissionError::Syntax(violation)) => panic!("{}: {violation}", body.name),
            Err(SubmissionError::Invalid(violations)) => {
                assert!((1..=LISTED).contains(&violations.len()), "{}", body.name);
                for violation in violations {
                    let text = serde_json::to_string(&violation).expect("plain data");
                    assert!(text.len() < LONGEST_VIOLATION, "{}: {text}", body.name);
                }
            }
        }
    }
    println!("slowest: {slowest:?} s; most memory: {largest:?} bytes for each of the body");
    assert_eq!(failures, "");
}
