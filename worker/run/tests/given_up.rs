//! The largest specimens that are drawn before their jobs are submitted: whoever makes them looks often enough
//! whether they are still wanted, and gives them up when they are not.
use std::sync::Mutex;
use std::time::Duration;

use loadframe_api::{JobKind, JobSpec, Submission};
use loadframe_physics::{Halt, Interrupt, InterruptSource, Uninterrupted};
use loadframe_run::preview;
use serde_json::{Value, json};

/// Between two looks, of a core, in a build for tests, which is several times slower than that of a server; which
/// gives a picture ten seconds.
const LONGEST: Duration = Duration::from_secs(5);
/// Parts that a server draws.
const MOST_PARTS: f64 = 200_000.0;

/// When somebody looked, and the look from which on nothing is wanted any more.
struct Looks {
    times: Mutex<Vec<Duration>>,
    wanted: usize,
}

impl Looks {
    fn until(wanted: usize) -> Self {
        Self {
            times: Mutex::new(vec![worked()]),
            wanted,
        }
    }

    /// How many there were, and the longest time between two, or after the last.
    fn ended(self) -> (usize, Duration) {
        let mut times = self.times.into_inner().expect("nobody panicked");
        let count = times.len() - 1;
        times.push(worked());
        let longest = times.windows(2).map(|pair| pair[1] - pair[0]).max();
        (count, longest.unwrap_or_default())
    }
}

impl InterruptSource for Looks {
    fn interrupt(&self) -> Option<Interrupt> {
        let mut times = self.times.lock().expect("nobody panicked");
        times.push(worked());
        (times.len() > self.wanted).then_some(Interrupt::Cancel)
    }
}

/// What this thread has had of a core: pictures are made on it, and others do not count.
fn worked() -> Duration {
    let stat = std::fs::read_to_string("/proc/thread-self/schedstat").expect("Linux tells");
    let nanoseconds = stat.split(' ').next().and_then(|text| text.parse().ok());
    Duration::from_nanos(nanoseconds.expect("a number"))
}

fn example(kind: JobKind, place: usize) -> Value {
    serde_json::from_str(kind.examples()[place].body).expect("JSON")
}

fn spec_of(job: &Value) -> JobSpec {
    let job = Submission::from_slice(job.to_string().as_bytes());
    job.unwrap_or_else(|error| panic!("{error:?}")).spec
}

/// Draws it to the end, and then gives it up at several of its looks.
fn is_given_up_in_time(what: &str, job: &Value) {
    let spec = spec_of(job);
    let parts = spec.extent().parts;
    assert!(parts <= MOST_PARTS, "{what}: {parts} parts are not drawn");
    let looks = Looks::until(usize::MAX);
    let drawn = preview(&spec, &looks).unwrap_or_else(|halt| panic!("{what}: {halt:?}"));
    assert!(!drawn.files.is_empty(), "{what}");
    let (count, longest) = looks.ended();
    assert!(
        longest < LONGEST,
        "{what}, {parts} parts, {count} looks: {longest:.1?} without one"
    );
    for look in [1, count / 2] {
        let looks = Looks::until(look);
        let halted = preview(&spec, &looks);
        let halt = halted.expect_err("nothing is wanted");
        let is_given_up = matches!(halt, Halt::Interrupted(Interrupt::Cancel));
        assert!(is_given_up, "{what}, look {look} of {count}: {halt:?}");
        let (_, longest) = looks.ended();
        assert!(longest < LONGEST, "{what}, look {look}: {longest:.1?}");
    }
}

#[test]
fn a_lattice_of_nonwoven_is_given_up() {
    let mut job = example(JobKind::NonwovenTensile, 0);
    let lattice = &mut job["spec"]["fabric"]["lattice"];
    lattice["points_per_row"] = json!(150);
    lattice["rows"] = json!(101);
    is_given_up_in_time("nonwoven", &job);
}

#[test]
fn a_network_that_is_given_is_given_up() {
    let mut job = example(JobKind::NonwovenTensile, 0);
    // a ladder of long rungs
    let rungs = 60_000;
    let nodes: Vec<[f64; 3]> = (0..2 * rungs)
        .map(|node| [f64::from(node % 2), f64::from(node / 2), 0.0])
        .collect();
    let jaw = |node: i32| match node / 2 {
        0 => "bottom",
        rung if rung == rungs - 1 => "top",
        _ => "free",
    };
    let jaws: Vec<&str> = (0..2 * rungs).map(jaw).collect();
    let along = (0..2 * rungs - 2).map(|node| json!({ "nodes": [node, node + 2] }));
    let bonds: Vec<Value> = along
        .chain((1..rungs).map(|rung| json!({ "nodes": [2 * rung, 2 * rung + 1] })))
        .collect();
    job["spec"]["fabric"] =
        json!({ "network": { "nodes_mm": nodes, "jaws": jaws, "bonds": bonds, "width_mm": 1 } });
    is_given_up_in_time("a network", &job);
}

#[test]
fn a_section_of_many_fibres_is_given_up() {
    let mut job = example(JobKind::CompositeBending, 0);
    job["spec"]["grid"] = json!({ "cells": [440, 440] });
    // across both axes, from edge to edge
    let fibre = |place: u32| {
        let height = 0.1 * f64::from(place) - 34.0;
        json!({ "material": "fibre", "through_mm": [35, height], "angle_deg": 45, "thickness_mm": 0.01 })
    };
    job["spec"]["fibres"] = json!((0..1_380).map(fibre).collect::<Vec<_>>());
    is_given_up_in_time("a section", &job);
}

#[test]
fn a_section_of_more_cells_than_its_spec_tells_is_refused_before_they_are_laid_out() {
    let mut job = example(JobKind::CompositeBending, 0);
    job["spec"]["grid"] = json!({ "cells": [100, 100], "graded_cells_per_fibre": 8 });
    // short ones, each with faces of its own
    let upright = |place: u32| {
        let at = [0.6 + 0.04 * f64::from(place), 10.0 + f64::from(place % 20)];
        json!({ "material": "fibre", "through_mm": at, "angle_deg": 90, "thickness_mm": 0.03, "length_mm": 0.7 })
    };
    let level = |place: u32| {
        let at = [1.0 + f64::from(place % 60), 36.0 + 0.035 * f64::from(place)];
        json!({ "material": "fibre", "through_mm": at, "angle_deg": 0, "thickness_mm": 0.03, "length_mm": 0.7 })
    };
    let fibres = (0..1_700).map(upright).chain((0..900).map(level));
    job["spec"]["fibres"] = json!(fibres.collect::<Vec<_>>());
    let spec = spec_of(&job);
    assert!(spec.extent().parts <= MOST_PARTS);
    match preview(&spec, &Uninterrupted) {
        Err(Halt::Failed(error)) => {
            let words =
                std::error::Error::source(&error).map_or(error.to_string(), ToString::to_string);
            assert!(words.contains("at most 400000"), "{words}");
        }
        Err(halt) => panic!("{halt:?}"),
        Ok(_) => panic!("it was drawn"),
    }
}

#[test]
fn a_cell_that_is_full_of_fibres_is_given_up() {
    let mut job = example(JobKind::CompositeCell, 0);
    job["spec"]["arrangement"] = json!({
        "random": { "fibre_fraction": 0.66, "fibres": 1000, "diameter_mm": 0.007, "least_gap": 0.1 }
    });
    job["spec"]["accuracy"] = json!({ "cells_per_fibre": 11 });
    is_given_up_in_time("a cell", &job);
}

/// Fibres along the sheet, each of so many points.
fn sheet(fibres: u32, points: u32) -> Value {
    let mut job = example(JobKind::PaperTensile, 0);
    let fibre = |number: u32| {
        let line = (0..points).map(|point| {
            let x = 1000.0 * f64::from(point) / f64::from(points - 1);
            json!([x, 40 * number, 0])
        });
        json!({ "pulp": "softwood", "centre_line_um": line.collect::<Vec<_>>() })
    };
    let fibres: Vec<Value> = (0..fibres).map(fibre).collect();
    job["spec"]["specimen"] =
        json!({ "explicit": { "length_mm": 1, "width_mm": 1, "fibres": fibres, "bonds": [] } });
    job["spec"]["test"] = json!({ "max_strain": 0.01 });
    job
}

#[test]
fn a_sheet_that_is_given_is_given_up() {
    is_given_up_in_time("fibres of many points", &sheet(100, 1_900));
    let mut short = sheet(20, 2);
    short["spec"]["model"] = json!({ "level": "beam", "segment_um": 0.11 });
    is_given_up_in_time("fibres in short segments", &short);
    let mut tubes = sheet(60, 2);
    tubes["spec"]["model"] = json!({ "level": "tube" });
    is_given_up_in_time("tubes", &tubes);
}

#[test]
fn points_between_those_that_are_given_count() {
    let mut job = sheet(1, 2);
    job["spec"]["model"] = json!({ "level": "beam", "segment_um": 0.01 });
    let parts = spec_of(&job).extent().parts;
    assert!((parts - 100_001.0).abs() < 2.0, "{parts}");
    // more than any machine has room for
    job["spec"]["specimen"]["explicit"]["fibres"][0]["centre_line_um"] =
        json!([[0, 0, 0], [1e9, 0, 0]]);
    let refused = Submission::from_slice(job.to_string().as_bytes());
    let words = format!("{:?}", refused.expect_err("too many points"));
    assert!(words.contains("/spec/model/segment_um"), "{words}");
}

#[test]
fn a_sheet_that_is_laid_is_given_up() {
    let mut job = example(JobKind::PaperTensile, 0);
    job["spec"]["specimen"] =
        json!({ "sheet": { "length_mm": 4, "width_mm": 3.8, "grammage_g_per_m2": 40 } });
    job["spec"]["bond"] = json!({ "shear_strength_mpa": 4 });
    job["spec"]["test"] = json!({ "max_strain": 0.01 });
    is_given_up_in_time("a sheet", &job);
}
