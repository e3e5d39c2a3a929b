//! A recorder that keeps the curve that passes through it.
use std::io;

use serde::{Deserialize, Serialize};

use crate::{Decorator, Recorder};

/// A curve in one piece of memory.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    pub columns: Vec<String>,
    /// Row after row.
    values: Vec<f64>,
}

impl Curve {
    /// The points, each with one value for each column.
    pub fn rows(&self) -> impl Iterator<Item = &[f64]> + Clone {
        self.values.chunks_exact(self.columns.len().max(1))
    }

    /// Place of a column.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column == name)
    }
}

/// Keeps the leading columns of a curve on its way to another recorder.
#[allow(
    missing_debug_implementations,
    reason = "it borrows a recorder, which need not have one"
)]
pub struct CurveKeeper<'a> {
    recorder: &'a mut dyn Recorder,
    /// Columns kept at most.
    width: usize,
    curve: Curve,
}

impl<'a> CurveKeeper<'a> {
    pub fn new(recorder: &'a mut dyn Recorder, width: usize) -> Self {
        Self {
            recorder,
            width,
            curve: Curve::default(),
        }
    }

    /// What was kept.
    pub fn into_curve(self) -> Curve {
        self.curve
    }
}

impl Decorator for CurveKeeper<'_> {
    fn inner(&self) -> &dyn Recorder {
        &*self.recorder
    }

    fn inner_mut(&mut self) -> &mut dyn Recorder {
        self.recorder
    }

    fn columns(&mut self, names: &[&str]) -> io::Result<()> {
        let kept = names.iter().take(self.width);
        self.curve.columns = kept.map(|name| (*name).to_owned()).collect();
        self.curve.values.clear();
        self.recorder.columns(names)
    }

    fn point(&mut self, values: &[f64]) -> io::Result<()> {
        let kept = values.iter().take(self.width);
        self.curve.values.extend(kept);
        self.recorder.point(values)
    }
}
