//! Fragments of breakable grains: `fragments.csv` and `fragment_sizes.csv`.
//!
//! Counts fragments by the number of their members, in the classes of T fig. 4.25 all the time, and one by
//! one at the end. A grain is whole when all of its members hold together.
use std::{collections::BTreeMap, io};

use loadframe_harness::Recorder;
use serde::{Deserialize, Serialize};

use super::table::write_table;
use crate::{observe::fragments::Fragments, scene::model::NO_GRAIN, step::engine::Engine};

/// Largest number of members of each class; the last class has no end.
const CLASSES: [usize; 4] = [1, 9, 49, 134];

/// Columns of `fragments.csv`.
pub(crate) const COLUMNS: [&str; 15] = [
    "step",
    "time_s",
    "stage",
    "grains",
    "whole_grains",
    "fragments",
    "mean_fragment_members",
    "largest_fragment_members",
    "mass_kg",
    "mass_share_1",
    "mass_share_2_to_9",
    "mass_share_10_to_49",
    "mass_share_50_to_134",
    "mass_share_from_135",
    "mass_share_whole_grains",
];

/// Columns of `fragment_sizes.csv`: the mass curve over the size of fragments.
const SIZE_COLUMNS: [&str; 4] = ["members", "fragments", "mass_kg", "mass_share_up_to"];

/// What breakable grains have become at a row of the curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct FragmentRow {
    pub(crate) step: u64,
    /// [s].
    pub(crate) time: f64,
    pub(crate) stage: usize,
    grains: usize,
    whole: usize,
    fragments: usize,
    /// Members of a fragment.
    mean_members: f64,
    largest: usize,
    /// [kg].
    mass: f64,
    /// Parts of the mass, by class.
    pub(crate) shares: [f64; CLASSES.len() + 1],
    /// Part of the mass that is whole grains.
    pub(crate) whole_share: f64,
}

/// Members and mass [kg] of each fragment, by the number of its lowest body; none elsewhere.
fn pieces(engine: &Engine, bonds: &[[u32; 2]]) -> Vec<(usize, f64)> {
    let grains = &engine.model.grains;
    let fragments = Fragments::joined(engine.model.masses.len(), bonds);
    let mut pieces = vec![(0_usize, 0.0); grains.len()];
    for (body, mass, _) in engine.present_bodies() {
        if grains[body as usize] != NO_GRAIN {
            let piece = &mut pieces[fragments.of_body(body) as usize];
            piece.0 += 1;
            piece.1 += mass;
        }
    }
    pieces
}

/// Gives the recorder the mass curve over the size of fragments as these pairs of bodies hold together.
pub(crate) fn write_sizes(
    engine: &Engine,
    bonds: &[[u32; 2]],
    recorder: &mut dyn Recorder,
) -> io::Result<()> {
    let mut sizes: BTreeMap<usize, (usize, f64)> = BTreeMap::new();
    for (members, mass) in pieces(engine, bonds) {
        if members > 0 {
            let size = sizes.entry(members).or_default();
            size.0 += 1;
            size.1 += mass;
        }
    }
    let whole: f64 = sizes.values().map(|(_, mass)| mass).sum();
    let mut so_far = 0.0;
    let mut rows = Vec::with_capacity(SIZE_COLUMNS.len() * sizes.len());
    for (members, (count, mass)) in sizes {
        so_far += mass;
        rows.extend([members as f64, count as f64, mass, so_far / whole]);
    }
    write_table(recorder, "fragment_sizes.csv", &SIZE_COLUMNS, &rows)
}

impl FragmentRow {
    /// As these pairs of bodies hold together now.
    pub(crate) fn new(engine: &Engine, stage: usize, bonds: &[[u32; 2]]) -> Self {
        let grains = &engine.model.grains;
        let found = pieces(engine, bonds);
        let count = grains.len();
        let mut present = vec![false; count];
        for (fragment, (members, _)) in found.iter().enumerate() {
            if *members > 0 {
                present[grains[fragment] as usize] = true;
            }
        }
        let mut full = vec![0_usize; count];
        for grain in grains.iter().filter(|grain| **grain != NO_GRAIN) {
            full[*grain as usize] += 1;
        }
        let (mut pieces, mut whole, mut largest) = (0_usize, 0_usize, 0);
        let (mut bodies, mut whole_mass) = (0, 0.0);
        let mut shares = [0.0; CLASSES.len() + 1];
        for (fragment, (size, mass)) in found.iter().enumerate().filter(|(_, found)| found.0 > 0) {
            pieces += 1;
            bodies += size;
            largest = largest.max(*size);
            if *size == full[grains[fragment] as usize] {
                whole += 1;
                whole_mass += mass;
            }
            let class = CLASSES.iter().position(|most| size <= most);
            shares[class.unwrap_or(CLASSES.len())] += mass;
        }
        let mass: f64 = shares.iter().sum();
        Self {
            step: engine.state.step,
            time: engine.state.time,
            stage,
            grains: present.iter().filter(|present| **present).count(),
            whole,
            fragments: pieces,
            mean_members: bodies as f64 / pieces.max(1) as f64,
            largest,
            mass,
            shares: shares.map(|share| if mass > 0.0 { share / mass } else { 0.0 }),
            whole_share: if mass > 0.0 { whole_mass / mass } else { 0.0 },
        }
    }

    /// The numbers of [`COLUMNS`].
    pub(crate) fn numbers(&self) -> [f64; COLUMNS.len()] {
        let [one, few, some, many, most] = self.shares;
        [
            self.step as f64,
            self.time,
            (self.stage + 1) as f64,
            self.grains as f64,
            self.whole as f64,
            self.fragments as f64,
            self.mean_members,
            self.largest as f64,
            self.mass,
            one,
            few,
            some,
            many,
            most,
            self.whole_share,
        ]
    }
}
