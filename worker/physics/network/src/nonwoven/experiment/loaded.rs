//! What carries load, as bonds break.
use crate::{
    Network,
    assembly::Assembly,
    load_path::{Part, parts},
    nonwoven::state::Event,
};

/// What follows from which bonds are intact.
#[derive(Debug)]
pub(crate) struct Loaded {
    pub(crate) intact: Vec<bool>,
    pub(crate) parts: Vec<Part>,
    pub(crate) assembly: Assembly,
    /// Of the bond in each slot [N].
    pub(super) strengths: Vec<f64>,
}

impl Loaded {
    pub(super) fn new(network: &Network, intact: Vec<bool>) -> Self {
        let parts = parts(network, &intact);
        let mut assembly = Assembly::new(network);
        assembly.load(network, &intact, &parts);
        let strengths = &network.bonds.strengths;
        let of_slot = |slot| {
            assembly
                .bond_in(slot)
                .map_or(f64::INFINITY, |bond| strengths[bond])
        };
        Self {
            strengths: (0..assembly.ends.len()).map(of_slot).collect(),
            intact,
            parts,
            assembly,
        }
    }

    /// After these bonds broke.
    pub(super) fn follow(&mut self, network: &Network, broken: &[Event]) {
        let bonds = || broken.iter().map(|event| event.bond as usize);
        for bond in bonds() {
            self.intact[bond] = false;
            self.assembly.release(bond);
        }
        // a bond whose ends hang together without it parts nothing
        if !bonds().all(|bond| self.assembly.is_bridged(bond)) {
            self.parts = parts(network, &self.intact);
            self.assembly.load(network, &self.intact, &self.parts);
        }
    }
}
