//! What an accuracy study varies in a unit cell.
use super::{Arrangement, CompositeCell};
use crate::spec_trait::Studied;
use crate::study::Knob;

const CELLS: [&str; 4] = ["8", "16", "32", "64"];
const FINEST: &str = "128";
const FIBRES: [&str; 4] = ["4", "10", "30", "100"];
const MOST_FIBRES: &str = "300";

impl Studied for CompositeCell {
    fn knobs(&self) -> Vec<Knob> {
        let mut knobs = vec![Knob::new(
            "cells_per_fibre",
            "cells of the grid through the thinnest fibre, a whole number from 2",
            self.chosen_knobs().cells_per_fibre,
            &CELLS,
            FINEST,
        )];
        if let Arrangement::Random(random) = &self.arrangement {
            let fibres = Knob::new(
                "fibres",
                "fibres in the cell, a whole number from 1",
                random.fibres,
                &FIBRES,
                MOST_FIBRES,
            );
            knobs.push(fibres.of_other_specimens());
        }
        knobs
    }

    fn turn(&mut self, knob: &str, value: &str) -> Option<()> {
        match (knob, &mut self.arrangement) {
            ("cells_per_fibre", _) => {
                let cells = value.parse().ok()?;
                self.accuracy.change(|knobs| knobs.cells_per_fibre = cells);
            }
            ("fibres", Arrangement::Random(random)) => random.fibres = value.parse().ok()?,
            _ => return None,
        }
        Some(())
    }

    fn single(&mut self, seed: u64) {
        self.seed = seed;
        self.repeats = 1;
        self.output.picture = false;
    }

    fn compares(_result: &str) -> bool {
        true
    }
}
