//! What a test of soil is read off: rows of a scene by the names of their columns.
use std::collections::BTreeMap;

use loadframe_api::spec::soil::Script;
use loadframe_harness::ReportBuilder;

use super::Tabled;

/// A test that can be read off a scene.
pub trait Measured: Tabled {
    /// A row of the scene, given the first one, in the terms of the test: as many as it has columns.
    #[doc(hidden)]
    fn row(&self, script: &Script, row: &Reading<'_>, first: &Reading<'_>) -> Vec<f64>;

    /// Forces of two walls [N] that are in balance when nothing is left of motion.
    #[doc(hidden)]
    fn balance(&self, row: &Reading<'_>) -> [f64; 2];

    /// Results, from the rows of the test and the first and last of the scene.
    #[doc(hidden)]
    fn results(&self, report: &mut ReportBuilder, script: &Script, rows: &Rows);
}

/// A row of the scene by the names of its columns.
#[derive(Clone, Copy, Debug)]
pub struct Reading<'a> {
    pub(super) places: &'a BTreeMap<String, usize>,
    pub(super) values: &'a [f64],
}

/// What was heard.
#[derive(Debug, Default)]
pub struct Rows {
    pub(super) places: BTreeMap<String, usize>,
    /// The last row of the scene before the test, and every one of it.
    pub(super) scene: Vec<Vec<f64>>,
    /// Rows of the test; the first is the state before it.
    pub(super) test: Vec<Vec<f64>>,
    /// Σ |F_a + F_b| and Σ |F_a| over the rows [N].
    pub(super) imbalance: [f64; 2],
}

impl Reading<'_> {
    /// A number; not one where the scene has no such column.
    pub(super) fn at(&self, name: &str) -> f64 {
        let place = self.places.get(name);
        place.map_or(f64::NAN, |place| self.values[*place])
    }
}

impl Rows {
    /// The state before the test, and that at its end.
    pub(super) fn ends(&self) -> Option<[Reading<'_>; 2]> {
        let reading = |values| Reading {
            places: &self.places,
            values,
        };
        Some([reading(self.scene.first()?), reading(self.scene.last()?)])
    }

    /// A column over another.
    pub(super) fn points(&self, x: usize, y: usize) -> Vec<(f64, f64)> {
        self.test.iter().map(|row| (row[x], row[y])).collect()
    }

    /// Σ |F_a + F_b| over Σ |F_a|.
    pub(super) fn imbalance(&self) -> f64 {
        self.imbalance[0] / self.imbalance[1]
    }
}
