//! What bonds still hold together.
//!
//! Bodies are joined by their intact bonds (union-find); a fragment is named by its lowest body.
//! For breakable grains the table `fragments.csv` counts fragments by the number of their members,
//! in the classes of T fig. 4.25.
use super::{
    breaks,
    contact::lists::Who,
    engine::Engine,
    journal::{Journal, Reading},
};

/// Largest number of members of each class; the last class has no end.
const CLASSES: [usize; 4] = [1, 9, 49, 134];

/// Columns of `fragments.csv`.
pub(super) const COLUMNS: [&str; 14] = [
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

/// Number of the grain of a body that is in none.
pub(super) const NO_GRAIN: u32 = u32::MAX;

/// The fragment of each body.
#[derive(Clone, Debug)]
pub(super) struct Fragments(Vec<u32>);

impl Fragments {
    /// As the bonds of the last step hold.
    pub(super) fn of(engine: &Engine) -> Self {
        Self::joined(engine.model.masses.len(), &engine.bonded_bodies())
    }

    /// Of so many bodies, joined by these pairs.
    fn joined(bodies: usize, pairs: &[[u32; 2]]) -> Self {
        let mut parents: Vec<u32> = (0..bodies as u32).collect();
        for [a, b] in pairs {
            let (a, b) = (root(&mut parents, *a), root(&mut parents, *b));
            // the lower number stays, so that a parent is never above its child
            parents[a.max(b) as usize] = a.min(b);
        }
        for body in 0..parents.len() {
            parents[body] = parents[parents[body] as usize];
        }
        Self(parents)
    }

    /// The lowest body of the fragment that a body is part of.
    pub(super) fn of_body(&self, body: u32) -> u32 {
        self.0[body as usize]
    }
}

/// Follows parents, and shortens the way.
fn root(parents: &mut [u32], mut body: u32) -> u32 {
    while parents[body as usize] != body {
        let parent = parents[body as usize];
        parents[body as usize] = parents[parent as usize];
        body = parent;
    }
    body
}

impl Engine {
    /// Pairs of bodies that an intact bond holds together.
    fn bonded_bodies(&self) -> Vec<[u32; 2]> {
        let owners = &self.state.particles.owners;
        let mut bonded = Vec::new();
        for lists in &self.contact_lists {
            lists.see(&mut |touching| {
                if let Who::Pair(pair) = touching.who
                    && touching.law.past(touching.lane).bond.is_intact
                {
                    bonded.push(pair.map(|particle| owners[particle as usize]));
                }
            });
        }
        bonded
    }

    /// Bonds that broke, as far as they are in the scene.
    pub(super) fn broken_bonds(&self, reading: &Reading) -> u64 {
        let state = &self.state;
        state.bonds_made - state.bonds_removed - reading.bonds
    }

    pub(super) fn intact_bonds(&self) -> u64 {
        self.bonded_bodies().len() as u64
    }
}

/// Adds a row on the breakable grains of the scene, if it has any, and the bonds that broke.
pub(super) fn add_row(engine: &Engine, journal: &mut Journal) {
    let grains = &engine.model.grains;
    if grains.is_empty() {
        return;
    }
    let bonds = engine.bonded_bodies();
    let fragments = Fragments::joined(engine.model.masses.len(), &bonds);
    breaks::add_rows(engine, journal, bonds);
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
    let state = &engine.state;
    journal.fragments.extend([
        state.step as f64,
        state.time,
        journal.stage as f64,
        present.iter().filter(|present| **present).count() as f64,
        whole as f64,
        pieces as f64,
        bodies as f64 / pieces.max(1) as f64,
        largest as f64,
        mass,
    ]);
    let shares = shares.map(|share| if mass > 0.0 { share / mass } else { 0.0 });
    journal.fragments.extend(shares);
}
