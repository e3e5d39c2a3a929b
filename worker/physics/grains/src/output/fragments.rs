//! Fragments of breakable grains: `fragments.csv`.
//!
//! Counts fragments by the number of their members, in the classes of T fig. 4.25.
use serde::{Deserialize, Serialize};

use crate::{observe::fragments::Fragments, scene::model::NO_GRAIN, step::engine::Engine};

/// Largest number of members of each class; the last class has no end.
const CLASSES: [usize; 4] = [1, 9, 49, 134];

/// Columns of `fragments.csv`.
pub(crate) const COLUMNS: [&str; 14] = [
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
];

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
}

impl FragmentRow {
    /// As these pairs of bodies hold together now.
    pub(crate) fn new(engine: &Engine, stage: usize, bonds: &[[u32; 2]]) -> Self {
        let grains = &engine.model.grains;
        let fragments = Fragments::joined(engine.model.masses.len(), bonds);
        let count = grains.len();
        let (mut members, mut masses) = (vec![0_usize; count], vec![0.0; count]);
        let mut present = vec![false; count];
        for (body, mass, _) in engine.present_bodies() {
            let grain = grains[body as usize];
            if grain == NO_GRAIN {
                continue;
            }
            present[grain as usize] = true;
            let fragment = fragments.of_body(body) as usize;
            members[fragment] += 1;
            masses[fragment] += mass;
        }
        let mut full = vec![0_usize; count];
        for grain in grains.iter().filter(|grain| **grain != NO_GRAIN) {
            full[*grain as usize] += 1;
        }
        let (mut pieces, mut whole, mut largest) = (0_usize, 0_usize, 0);
        let mut shares = [0.0; CLASSES.len() + 1];
        for (fragment, size) in members.iter().enumerate().filter(|(_, size)| **size > 0) {
            pieces += 1;
            largest = largest.max(*size);
            whole += usize::from(*size == full[grains[fragment] as usize]);
            let class = CLASSES.iter().position(|most| size <= most);
            shares[class.unwrap_or(CLASSES.len())] += masses[fragment];
        }
        let mass: f64 = shares.iter().sum();
        let bodies: usize = members.iter().sum();
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
        ]
    }
}
