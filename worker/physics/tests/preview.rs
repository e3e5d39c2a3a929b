//! Specimens drawn before their tests: as their jobs draw them, and as large as the spec foretells.
use std::collections::BTreeMap;
use std::io::{self, Write};

use loadframe_api::{JobKind, JobSpec, Submission};
use loadframe_physics::{Recorder, RunContext, Uninterrupted, preview, simulate};

/// Keeps files by their names.
#[derive(Default)]
struct Files(BTreeMap<String, Vec<u8>>);

impl Recorder for Files {
    fn columns(&mut self, _names: &[&str]) -> io::Result<()> {
        Ok(())
    }

    fn point(&mut self, _values: &[f64]) -> io::Result<()> {
        Ok(())
    }

    fn file(
        &mut self,
        name: &str,
        write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        let mut content = Vec::new();
        write(&mut content)?;
        self.0.insert(name.to_owned(), content);
        Ok(())
    }

    fn progress(&mut self, _fraction: f64, _phase: &str) {}

    fn log(&mut self, _message: &str) {}

    fn checkpoint_due(&self) -> bool {
        false
    }

    fn checkpoint(&mut self, _bytes: &[u8]) -> io::Result<()> {
        Ok(())
    }
}

fn spec(body: &str) -> JobSpec {
    let submission = Submission::from_slice(body.as_bytes()).expect("an example");
    submission.spec
}

fn drawn(spec: &JobSpec, threads: usize) -> BTreeMap<String, Vec<u8>> {
    let mut files = Files::default();
    preview(spec, threads, &mut files).expect("a specimen");
    files.0
}

/// A number of the header of a picture.
fn count(picture: &[u8], name: &str) -> f64 {
    let text = String::from_utf8_lossy(&picture[..picture.len().min(4000)]);
    let (_, rest) = text.split_once(&format!("{name}=\"")).expect("a count");
    let (number, _) = rest.split_once('"').expect("a count");
    number.parse().expect("a count")
}

/// Specs foretell what is drawn within this factor: a picture of 200 000 parts may have as many times more.
const FORETOLD: f64 = 2.5;

#[test]
fn first_examples_are_drawn_as_large_as_their_specs_foretell() {
    for kind in JobKind::ALL {
        let spec = spec(kind.examples()[0].body);
        let files = drawn(&spec, 1);
        let parts = files.iter().filter(|(name, _)| name.ends_with(".vtp"));
        let largest = |picture: &[u8]| {
            let names = ["NumberOfPoints", "NumberOfLines", "NumberOfPolys"];
            let [points, lines, polygons] = names.map(|name| count(picture, name));
            // the corners of polygons are points of their own
            if polygons > 0.0 {
                polygons
            } else {
                points.max(lines)
            }
        };
        let of_bodies = parts.filter(|(name, _)| !name.contains("walls_"));
        let parts = of_bodies.map(|(_, picture)| largest(picture));
        let parts = parts.fold(0.0, f64::max);
        let extent = spec.extent();
        let ratio = parts / extent.parts;
        assert!(
            (1.0 / FORETOLD..=FORETOLD).contains(&ratio),
            "{kind}: {parts} parts, {extent:?}"
        );
    }
}

#[test]
fn a_scene_is_drawn_as_its_job_draws_its_first_moment() {
    let body = include_str!("../../../api/examples/granular_scene_clump_drop.json");
    let mut job: serde_json::Value = serde_json::from_str(body).expect("JSON");
    job["spec"]["record"]["snapshot_every_steps"] = 1_000_000.into();
    let spec = spec(&job.to_string());
    let mut files = Files::default();
    let context = RunContext {
        threads: 1,
        interrupt: &Uninterrupted,
        checkpoint: None,
    };
    simulate(&spec, context, &mut files).expect("it runs");
    let first = drawn(&spec, 2);
    assert!(first.len() >= 2, "{:?}", first.keys());
    for (name, content) in first {
        assert_eq!(files.0.get(&name), Some(&content), "{name}");
    }
}

#[test]
fn a_fabric_and_a_sheet_are_the_same_on_any_number_of_threads() {
    for kind in [JobKind::NonwovenTensile, JobKind::PaperTensile] {
        let spec = spec(kind.examples()[0].body);
        assert_eq!(drawn(&spec, 1), drawn(&spec, 3), "{kind}");
    }
}
