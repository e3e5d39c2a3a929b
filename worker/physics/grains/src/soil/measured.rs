//! What a test of soil is read off: rows of a scene by the names of their columns.
use std::collections::BTreeMap;

use loadframe_api::Report;
use loadframe_api::spec::soil::Script;
use loadframe_harness::ReportBuilder;

use super::Tabled;

/// A test that can be read off a scene.
pub trait Measured: Tabled {
    /// A row of the scene, given the first one, in the terms of the test: as many as it has columns.
    #[doc(hidden)]
    fn row(&self, script: &Script, row: &Reading<'_>, first: &Reading<'_>) -> Vec<f64>;

    /// The stress that walls keep during the test: its place in a row, and what it is to be [kPa].
    #[doc(hidden)]
    fn kept_stress(&self) -> (usize, f64);

    /// Forces of two walls [N] that are in balance when nothing is left of motion.
    #[doc(hidden)]
    fn balance(&self, row: &Reading<'_>) -> [f64; 2];

    /// Results, from the rows of the test and the first and last of the scene.
    #[doc(hidden)]
    fn results(&self, report: &mut ReportBuilder, script: &Script, rows: &Rows);

    /// Adds what the errors of results do to others that are read off the curve by them.
    #[doc(hidden)]
    fn propagate(&self, _report: &mut Report, _rows: &Rows) {}
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

/// A stress is kept where it is within this part of what it is to be: walls that follow are within some
/// hundredths of it, and behind grains that suddenly give way next to nothing is left of it.
const KEPT: f64 = 0.1;

/// A column of rows over another.
pub(super) fn points(rows: &[&Vec<f64>], x: usize, y: usize) -> Vec<(f64, f64)> {
    rows.iter().map(|row| (row[x], row[y])).collect()
}

impl Rows {
    /// Rows in which the walls keep their stress. A ratio of stresses means something in these alone.
    pub(super) fn kept(&self, (place, asked): (usize, f64)) -> Vec<&Vec<f64>> {
        let is_kept = |row: &&Vec<f64>| (row[place] / asked - 1.0).abs() <= KEPT;
        self.test.iter().filter(is_kept).collect()
    }

    /// Part of the rows in which they do not.
    pub(super) fn not_kept(&self, stress: (usize, f64)) -> f64 {
        1.0 - self.kept(stress).len() as f64 / self.test.len().max(1) as f64
    }

    /// The state before the test, and that at its end.
    pub(super) fn ends(&self) -> Option<[Reading<'_>; 2]> {
        let reading = |values| Reading {
            places: &self.places,
            values,
        };
        Some([reading(self.scene.first()?), reading(self.scene.last()?)])
    }

    /// Σ |F_a + F_b| over Σ |F_a|.
    pub(super) fn imbalance(&self) -> f64 {
        self.imbalance[0] / self.imbalance[1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ratio_is_read_where_the_stress_is_kept() {
        let stresses = [(40.0, 100.0), (60.0, 95.0), (0.5, 0.1), (20.0, 85.0)];
        let row =
            |(way, (shear, normal)): (usize, (f64, f64))| vec![way as f64, normal, shear / normal];
        let rows = Rows {
            test: stresses.into_iter().enumerate().map(row).collect(),
            ..Rows::default()
        };
        let ratios = points(&rows.kept((1, 100.0)), 0, 2);
        assert_eq!(ratios, [(0.0, 0.4), (1.0, 60.0 / 95.0)]);
        assert!((rows.not_kept((1, 100.0)) - 0.5).abs() < 1e-15);
    }
}
