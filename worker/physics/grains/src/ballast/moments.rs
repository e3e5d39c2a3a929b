//! What breakable grains have become at four moments of a test, as in [Dubina2014] fig. 4.25.
use loadframe_api::spec::ballast::Phase;

use super::tester::Tester;

/// Rows of the scene's table of fragments.
pub(super) struct Moments<'a> {
    pub(super) header: &'a str,
    /// When poured, before the cycles, at the largest force, at the end.
    pub(super) rows: Vec<(&'static str, &'a str)>,
}

impl<'a> Moments<'a> {
    pub(super) fn of(tester: &'a Tester<'_>) -> Self {
        let mut lines = tester.fragments().lines();
        let header = lines.next().unwrap_or_default();
        let all: Vec<&str> = lines.collect();
        let number = |row: &str, name: &str| value(header, row, name).unwrap_or(f64::NAN);
        let mut phases = tester.script.phases.iter();
        let first_load = phases.position(|phase| *phase == Phase::Load);
        let is_before =
            |row: &&&str| first_load.is_none_or(|load| number(row, "stage") < load as f64);
        let peak = tester.peak_row().map_or(f64::INFINITY, |row| row.time);
        let moments = [
            ("poured", all.first()),
            ("before_loading", all.iter().rev().find(is_before)),
            ("peak", all.iter().find(|row| number(row, "time_s") >= peak)),
            ("end", all.last()),
        ];
        let rows = moments.into_iter();
        Self {
            header,
            rows: rows
                .filter_map(|(moment, row)| Some((moment, *row?)))
                .collect(),
        }
    }

    /// Each moment with the share of mass in single spheres and in pieces of 135 and more: the ends
    /// of the mass curve.
    pub(super) fn shares(&self) -> impl Iterator<Item = (&'static str, [f64; 2])> {
        self.rows.iter().map(|(moment, row)| {
            let shares = ["mass_share_1", "mass_share_from_135"];
            let share = |name| value(self.header, row, name).unwrap_or(f64::NAN);
            (*moment, shares.map(share))
        })
    }
}

fn value(header: &str, row: &str, name: &str) -> Option<f64> {
    let column = header.split(',').position(|known| known == name)?;
    row.split(',').nth(column)?.parse().ok()
}
