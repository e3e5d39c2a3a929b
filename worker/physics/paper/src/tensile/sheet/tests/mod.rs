//! Sheets through the whole job, against closed forms where there are any.
#![allow(
    clippy::float_cmp,
    reason = "counts, zeros and what is copied are exact"
)]
use std::io::Write;

use indexmap::IndexMap;
use loadframe_api::spec::paper_tensile::PaperTensile;
use loadframe_api::{JobSpec, Report, Submission};
use loadframe_harness::{Ending, Recorder, RunContext, Uninterrupted};
use serde_json::{Value, json};

use crate::tensile::run;

mod given;
mod lab;
mod made;
mod tubes;
mod yielding;

/// Keeps what a run says.
#[derive(Default, Debug, PartialEq)]
struct Record {
    points: Vec<Vec<f64>>,
    files: IndexMap<String, Vec<u8>>,
    checkpoint: Vec<u8>,
}

impl Recorder for Record {
    fn columns(&mut self, _names: &[&str]) -> std::io::Result<()> {
        self.points.clear();
        Ok(())
    }

    fn point(&mut self, values: &[f64]) -> std::io::Result<()> {
        self.points.push(values.to_vec());
        Ok(())
    }

    fn file(
        &mut self,
        name: &str,
        write: &mut dyn FnMut(&mut dyn Write) -> std::io::Result<()>,
    ) -> std::io::Result<()> {
        let mut bytes = Vec::new();
        write(&mut bytes)?;
        self.files.insert(name.to_owned(), bytes);
        Ok(())
    }

    fn progress(&mut self, fraction: f64, _phase: &str) {
        assert!((0.0..=1.0).contains(&fraction));
    }

    fn log(&mut self, _message: &str) {}

    fn checkpoint_due(&self) -> bool {
        false
    }

    fn checkpoint(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.checkpoint = bytes.to_vec();
        Ok(())
    }
}

impl Record {
    fn table(&self, name: &str) -> Vec<Vec<f64>> {
        let text = std::str::from_utf8(&self.files[name]).unwrap();
        let rows = text.lines().skip(1).map(|line| {
            let cells = line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN));
            cells.collect()
        });
        rows.collect()
    }
}

fn spec(body: &Value) -> PaperTensile {
    let job = json!({"kind": "paper_tensile", "spec": body});
    let submission = Submission::from_slice(job.to_string().as_bytes()).unwrap();
    let JobSpec::PaperTensile(spec) = submission.spec else {
        panic!("another kind");
    };
    *spec
}

fn go(body: &Value, threads: usize) -> (Report, Record) {
    let context = RunContext {
        threads,
        interrupt: &Uninterrupted,
        checkpoint: None,
    };
    let mut record = Record::default();
    match run(&spec(body), context, &mut record).unwrap() {
        Ending::Finished(report) => (report, record),
        other => panic!("{other:?}"),
    }
}

fn value(report: &Report, name: &str) -> f64 {
    report.summary[name].value.unwrap()
}

fn codes(report: &Report) -> Vec<&str> {
    let codes = report.warnings.iter();
    codes.map(|warning| warning.code.as_str()).collect()
}

fn pulp() -> Value {
    json!([{"name": "softwood", "length_mm": 1.0, "length_variation": 0.3, "width_um": 28, "wall_um": 2,
            "coarseness_mg_per_m": 0.245, "youngs_modulus_gpa": 30, "poisson_ratio": 0.3,
            "shear_modulus_gpa": 2.5, "shape_factor": 0.97}])
}
