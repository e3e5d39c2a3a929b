//! The granular engine against closed forms, published numbers and its own promises.
#[path = "../scene/mod.rs"]
mod scene;

mod appendix_a;
mod beams;
mod beams_beside_yade;
mod beside_facets;
mod between_looks;
mod bonds;
mod breakage;
mod collisions;
mod determinism;
mod drives;
mod examples;
mod extremes;
mod facets;
mod flow;
mod friction;
mod impacts;
mod judgement;
mod laws;
mod mats;
mod moving_walls;
mod observables;
mod peers;
mod placing;
mod refusals;
mod replacing;
mod restitution;
mod rolling;
mod rolling_beside_yade;
mod rotation;
mod servo;
mod shear_dashpot;
mod soil;
mod specimens;
mod stages;
mod voids;

use loadframe_api::{JobSpec, Report, Submission, SubmissionError, Violation};
use loadframe_physics::{Ending, SimulationError, Uninterrupted};
use scene::{Record, run_job};
use serde_json::{Value, json};

/// A body of a scene in JSON, as a user writes it.
fn sphere(material: &str, radius: f64, position: [f64; 3], velocity: [f64; 3]) -> Value {
    json!({"sphere": {"radius_m": radius}, "material": material, "position_m": position,
           "velocity_m_per_s": velocity})
}

fn submission(spec: &Value) -> Result<JobSpec, Vec<Violation>> {
    let body = json!({"kind": "granular_scene", "spec": spec});
    match Submission::from_slice(body.to_string().as_bytes()) {
        Ok(submission) => Ok(submission.spec),
        Err(SubmissionError::Invalid(violations)) => Err(violations),
        Err(error) => panic!("{error}"),
    }
}

fn job(spec: &Value) -> JobSpec {
    submission(spec).unwrap_or_else(|violations| panic!("{violations:#?}"))
}

/// Pointer and code of each violation.
fn codes(spec: &Value) -> Vec<(String, String)> {
    let violations = submission(spec).expect_err("this must be refused");
    let codes = violations.into_iter();
    codes
        .map(|violation| (violation.pointer, violation.code))
        .collect()
}

fn one(pointer: &str, code: &str) -> Vec<(String, String)> {
    vec![(pointer.to_owned(), code.to_owned())]
}

/// Runs a scene to its end on `threads`.
fn run_on(spec: &Value, threads: usize) -> (Report, Record) {
    let mut record = Record::default();
    match run_job(&job(spec), &mut record, &Uninterrupted, None, threads) {
        Ok(Ending::Finished(report)) => (report, record),
        other => panic!("{other:?}"),
    }
}

fn run(spec: &Value) -> (Report, Record) {
    run_on(spec, 1)
}

fn failure(spec: &Value) -> SimulationError {
    let mut record = Record::default();
    match run_job(&job(spec), &mut record, &Uninterrupted, None, 1) {
        Err(error) => error,
        other => panic!("{other:?}"),
    }
}

/// Position, velocity and spin of a body after a step.
fn body(record: &Record, step: u64, body: u32) -> [[f64; 3]; 3] {
    let rows = record.table("bodies.csv");
    let is_wanted = |row: &&Vec<f64>| row[0] as u64 == step && row[2] as u32 == body;
    let row = rows.iter().find(is_wanted).expect("the row was recorded");
    [3, 6, 9].map(|at| [row[at], row[at + 1], row[at + 2]])
}

/// Overlap, normal, normal and shear force of the contact of two bodies in a step.
fn contact(record: &Record, step: u64, bodies: [u32; 2]) -> Option<(f64, [[f64; 3]; 3])> {
    let rows = record.table("contacts.csv");
    let is_wanted =
        |row: &&Vec<f64>| row[0] as u64 == step && [row[1] as u32, row[2] as u32] == bodies;
    let row = rows.iter().find(is_wanted)?;
    Some((
        row[3],
        [4, 7, 10].map(|at| [row[at], row[at + 1], row[at + 2]]),
    ))
}

#[track_caller]
fn assert_close(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found - expected).abs() <= tolerance,
        "{found:e} is not {expected:e} ± {tolerance:e}"
    );
}
