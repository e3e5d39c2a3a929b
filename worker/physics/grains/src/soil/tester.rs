//! From the rows of a scene to those of a test.
use std::io::{self, Write};

use loadframe_api::spec::soil::Script;
use loadframe_harness::{Decorator, Recorder, csv};

use super::measured::{Measured, Reading, Rows};

/// Stands between the engine and the recorder of a job.
pub(super) struct Tester<'a, T: Measured> {
    test: &'a T,
    pub(super) script: &'a Script,
    recorder: &'a mut dyn Recorder,
    pub(super) rows: Rows,
}

impl<'a, T: Measured> Tester<'a, T> {
    pub(super) fn new(test: &'a T, script: &'a Script, recorder: &'a mut dyn Recorder) -> Self {
        Self {
            test,
            script,
            recorder,
            rows: Rows::default(),
        }
    }

    /// The curve of the test, and the scene.
    pub(super) fn write(&mut self) -> io::Result<()> {
        let rows = &self.rows.test;
        self.recorder.file("curve.csv", &mut |out| {
            csv::header(out, T::COLUMNS)?;
            rows.iter().try_for_each(|row| csv::row(out, row))
        })?;
        let script = self.script;
        self.recorder.file("scene.json", &mut |out| {
            let job = serde_json::json!({"kind": "granular_scene", "spec": script.scene});
            serde_json::to_writer(&mut *out, &job)?;
            writeln!(out)
        })
    }
}

impl<T: Measured> Decorator for Tester<'_, T> {
    fn inner(&self) -> &dyn Recorder {
        &*self.recorder
    }

    fn inner_mut(&mut self) -> &mut dyn Recorder {
        self.recorder
    }

    fn columns(&mut self, names: &[&str]) -> io::Result<()> {
        let places = names.iter().map(|name| (*name).to_owned()).zip(0..);
        self.rows = Rows {
            places: places.collect(),
            ..Rows::default()
        };
        self.recorder.columns(T::COLUMNS)
    }

    fn point(&mut self, values: &[f64]) -> io::Result<()> {
        let places = &self.rows.places;
        let reading = Reading { places, values };
        // people count from 1
        let is_test = reading.at("stage") > self.script.prepared as f64;
        if !is_test {
            // the last of these is where the test begins
            self.rows.scene = vec![values.to_vec()];
            return Ok(());
        }
        let first = self.rows.scene.first().map_or(values, Vec::as_slice);
        let first = Reading {
            places,
            values: first,
        };
        let row = self.test.row(self.script, &reading, &first);
        let before = self.rows.test.is_empty();
        let start = before.then(|| self.test.row(self.script, &first, &first));
        let [one, other] = self.test.balance(&reading);
        self.rows.imbalance[0] += (one + other).abs();
        self.rows.imbalance[1] += one.abs();
        for row in start.into_iter().chain([row]) {
            self.recorder.point(&row)?;
            self.rows.test.push(row);
        }
        self.rows.scene.truncate(1);
        self.rows.scene.push(values.to_vec());
        Ok(())
    }

    fn file(
        &mut self,
        name: &str,
        write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        // the test has a curve of its own
        if name == "curve.csv" {
            return Ok(());
        }
        self.recorder.file(name, write)
    }
}
