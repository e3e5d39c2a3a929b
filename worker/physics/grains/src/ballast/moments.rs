//! What breakable grains have become at four moments of a test, as in [Dubina2014] fig. 4.25.
use loadframe_api::spec::ballast::Phase;

use super::heard::Heard;
use crate::output::fragments::FragmentRow;

/// When poured, before the cycles, at the largest force, at the end.
pub(super) struct Moments(pub(super) Vec<(&'static str, FragmentRow)>);

impl Moments {
    /// Of all rows on fragments.
    pub(super) fn of(heard: &Heard<'_>, all: &[FragmentRow]) -> Self {
        let mut phases = heard.script.phases.iter();
        let first_load = phases.position(|phase| *phase == Phase::Load);
        let is_before = |row: &&FragmentRow| first_load.is_none_or(|load| row.stage < load);
        let peak = heard.peak_row().map_or(f64::INFINITY, |row| row.time);
        let moments = [
            ("poured", all.first()),
            ("before_loading", all.iter().rev().find(is_before)),
            ("peak", all.iter().find(|row| row.time >= peak)),
            ("end", all.last()),
        ];
        let known = moments.into_iter();
        Self(
            known
                .filter_map(|(moment, row)| Some((moment, *row?)))
                .collect(),
        )
    }

    /// Each moment with the share of mass in single spheres and in pieces of 135 and more, the ends
    /// of the mass curve, and in whole grains.
    pub(super) fn shares(&self) -> impl Iterator<Item = (&'static str, [f64; 3])> {
        self.0.iter().map(|(moment, row)| {
            let [single, .., large] = row.shares;
            (*moment, [single, large, row.whole_share])
        })
    }
}
