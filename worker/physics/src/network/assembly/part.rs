//! Some free nodes of an assembly between all others at rest.
use std::sync::OnceLock;

use super::{Assembly, slots_of};
use crate::network::{
    Laws, Vector,
    blocks::Blocks,
    field::Field,
    places::{NONE, Places},
};

impl Assembly {
    /// The assembly of the `free` places, ascending, and of the acting bonds at them, whose other
    /// ends are held. Its nodes have the numbers of their places here, its bonds belong to no
    /// network. `numbers` has an entry for each place, [`NONE`] before and after.
    pub(crate) fn part(&self, free: &[u32], numbers: &mut [u32]) -> Self {
        let (nodes, origins, ends) = self.around(free, numbers);
        let places = Places::part(nodes, free.len());
        let Blocks {
            blocks,
            bonds,
            ends,
            strips,
        } = Blocks::new(&ends, places.nodes.len());
        let position = |place: &u32| match *place {
            NONE => Vector::zeros(),
            place => self.positions.at(place as usize),
        };
        let positions: Vec<Vector> = places.nodes.iter().map(position).collect();
        let origin = |bond: &u32| origins.get(*bond as usize).map(|slot| *slot as usize);
        let pick = |values: &[f64], default: f64| -> Vec<f64> {
            let of_slot = |bond| origin(bond).map_or(default, |slot| values[slot]);
            bonds.iter().map(of_slot).collect()
        };
        Self {
            positions: Field::of(&positions, self.dimensions),
            rest_lengths: pick(&self.rest_lengths, 1.0),
            excess: if self.excess.is_empty() {
                Vec::new()
            } else {
                pick(&self.excess, 0.0)
            },
            laws: match &self.laws {
                Laws::Same(law) => Laws::Same(*law),
                Laws::Each(laws) => {
                    let of_slot = |bond| laws[origin(bond).unwrap_or(0)];
                    Laws::Each(bonds.iter().map(of_slot).collect())
                }
            },
            rounding: self.rounding,
            acts: bonds.iter().map(|b| u8::from(*b != NONE)).collect(),
            acting: origins.len(),
            dimensions: self.dimensions,
            incidence: OnceLock::new(),
            // too small to have long waves
            mesh: OnceLock::from(None),
            at_rest: OnceLock::from(None),
            slots: slots_of(&bonds, origins.len()),
            places,
            blocks,
            strips,
            ends,
            bonds,
        }
    }

    /// The places of a part, held ones last, the slots of its bonds, and their ends in terms of the
    /// order of these places.
    fn around(&self, free: &[u32], numbers: &mut [u32]) -> (Vec<u32>, Vec<u32>, Vec<[u32; 2]>) {
        let mut nodes = free.to_vec();
        let (mut slots, mut ends) = (Vec::new(), Vec::new());
        for (number, place) in free.iter().enumerate() {
            numbers[*place as usize] = number as u32;
        }
        for place in free {
            for (slot, other) in self.incidence().around(*place as usize) {
                if !self.acts(slot as usize) || other == *place {
                    continue;
                }
                let number = &mut numbers[other as usize];
                if *number == NONE {
                    *number = nodes.len() as u32;
                    nodes.push(other);
                }
                // a bond between two free nodes is met twice
                if *number >= free.len() as u32 || *place < other {
                    slots.push(slot);
                    ends.push(self.ends[slot as usize].map(|end| numbers[end as usize]));
                }
            }
        }
        for place in &nodes {
            numbers[*place as usize] = NONE;
        }
        (nodes, slots, ends)
    }
}
