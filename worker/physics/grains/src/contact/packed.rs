//! Lists of contacts in a checkpoint: columns of numbers, whatever law they belong to. (Were each law
//! written and read by its own type, as much code would be compiled as for working through its contacts.)
use loadframe_harness::checkpoint::{self, CheckpointError};
use serde::{Deserialize, Serialize};

use super::blocks::State;
use crate::numbers::lanes::{Array, LANES};

/// Sees the columns of blocks one after the other, and may change them.
pub(crate) trait Columns {
    fn ends(&mut self, column: &mut [u32; LANES]);

    fn numbers(&mut self, column: &mut Array);

    fn all_numbers(&mut self, columns: &mut [Array]) {
        for column in columns {
            self.numbers(column);
        }
    }
}

/// The lists of a patch.
#[derive(Serialize, Deserialize)]
pub(super) struct PackedLists {
    pub(super) inner: PackedList,
    pub(super) outer: PackedList,
    /// Rows of the halo by block of `outer`.
    pub(super) places: Vec<[u32; LANES]>,
    pub(super) walls: Vec<PackedList>,
    pub(super) facets: PackedList,
    /// How many facets are near each sphere that has any.
    pub(super) visitors: Vec<u32>,
}

/// A list.
#[derive(Serialize, Deserialize)]
pub(super) struct PackedList {
    state: State,
    columns: Packed,
}

/// A list of contacts that can be packed.
pub(super) trait List {
    fn state(&self) -> &State;

    /// Shows the columns of all blocks.
    fn show(&self, columns: &mut dyn Columns);

    /// Takes as many blocks as `state` has, with these columns.
    fn fill(&mut self, state: State, columns: &mut dyn Columns);
}

impl PackedList {
    pub(super) fn of(list: &dyn List) -> Self {
        let mut columns = Packed::default();
        list.show(&mut columns);
        Self {
            state: list.state().clone(),
            columns,
        }
    }

    /// Makes of an empty list what it was.
    ///
    /// # Errors
    /// When these are the contacts of another law.
    pub(super) fn fill(self, list: &mut dyn List) -> Result<(), CheckpointError> {
        let mut columns = Unpacking {
            ends: &self.columns.ends,
            numbers: &self.columns.numbers,
            is_short: false,
        };
        list.fill(self.state, &mut columns);
        if columns.is_short || !columns.ends.is_empty() || !columns.numbers.is_empty() {
            return Err(checkpoint::form("its contacts have another law"));
        }
        Ok(())
    }
}

/// Columns as they were seen.
#[derive(Default, Serialize, Deserialize)]
struct Packed {
    ends: Vec<u32>,
    numbers: Vec<f64>,
}

/// Columns to be read in the order in which they were seen.
struct Unpacking<'a> {
    ends: &'a [u32],
    numbers: &'a [f64],
    is_short: bool,
}

impl Columns for Packed {
    fn ends(&mut self, column: &mut [u32; LANES]) {
        self.ends.extend_from_slice(column);
    }

    fn numbers(&mut self, column: &mut Array) {
        self.numbers.extend_from_slice(column);
    }
}

impl Columns for Unpacking<'_> {
    fn ends(&mut self, column: &mut [u32; LANES]) {
        match self.ends.split_first_chunk() {
            Some((first, rest)) => (*column, self.ends) = (*first, rest),
            None => self.is_short = true,
        }
    }

    fn numbers(&mut self, column: &mut Array) {
        match self.numbers.split_first_chunk() {
            Some((first, rest)) => (*column, self.numbers) = (*first, rest),
            None => self.is_short = true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        contact::{
            law::{Cemented, Coulomb, HertzMindlin, Kept, Law, Linear, Resisting},
            lists::{Lists, PatchLists},
            past::Past,
            stiffness::{Cement, Resistance, Springs},
        },
        numbers::Vector,
    };

    /// Two blocks of pairs in the patch, and one of each other kind.
    fn lists<F: Law>() -> PatchLists<F> {
        let mut lists = PatchLists::<F>::default();
        let springs = |number: f64| Springs {
            normal: 1e5 + number,
            ratio: 0.3,
            friction: 0.5 + number,
            dashpots: [7.0, 3.0],
            resistance: Resistance {
                stiffness: [2.0, 5.0 + number],
                ..Resistance::default()
            },
            cement: Cement::default(),
        };
        let past = |number: f64| Past {
            shear: Vector::new(number, 2.0, 3.0),
            root: 0.1 + number,
            ..Past::default()
        };
        for pair in 0..10_u32 {
            let number = f64::from(pair);
            lists.add_inner([pair, pair + 1], &springs(number), Some(&past(number)));
        }
        lists.add_outer([3, 40], 2, &springs(0.5), Some(&past(20.0)));
        lists.add_plane(1, 7, &springs(0.7), Some(&past(30.0)));
        lists.add_facets(
            8,
            &[(4, springs(0.9), Some(past(40.0))), (5, springs(0.0), None)],
        );
        lists.finish(3);
        lists
    }

    fn told(lists: &dyn Lists) -> Vec<String> {
        let mut told = Vec::new();
        lists.see(&mut |touching| {
            let springs = [touching.constant, touching.shear_ratio, touching.friction];
            let past = touching.law.past(touching.lane);
            told.push(format!("{:?} {springs:?} {past:?}", touching.who));
        });
        told
    }

    fn assert_come_back<F: Law>() -> Result<(), CheckpointError> {
        let packed = lists::<F>().pack()?;
        let again = PatchLists::<F>::unpack(&packed)?;
        assert_eq!(again.pack()?, packed);
        assert_eq!(told(&again), told(&lists::<F>()));
        assert_eq!(told(&again).len(), 13);
        assert_eq!(again.candidates(), 13);
        Ok(())
    }

    #[test]
    fn lists_come_back_as_they_were_and_not_under_another_law() -> Result<(), CheckpointError> {
        assert_come_back::<Coulomb<Linear, Kept>>()?;
        assert_come_back::<Resisting<HertzMindlin>>()?;
        assert_come_back::<Cemented>()?;
        let packed = lists::<HertzMindlin>().pack()?;
        assert!(PatchLists::<Coulomb<Linear, Kept>>::unpack(&packed).is_err());
        assert!(PatchLists::<Cemented>::unpack(&packed).is_err());
        Ok(())
    }
}
