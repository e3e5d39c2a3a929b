//! What an accuracy study varies in a unit cell.
use super::{Accuracy, Arrangement, CompositeCell, Knobs};
use crate::study::Knob;

const CELLS: [&str; 4] = ["8", "16", "32", "64"];
const FINEST: &str = "128";
const FIBRES: [&str; 4] = ["4", "10", "30", "100"];
const MOST_FIBRES: &str = "300";

pub(super) fn knobs(spec: &CompositeCell) -> Vec<Knob> {
    let words = |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect();
    let mut knobs = vec![Knob {
        name: "cells_per_fibre",
        description: "cells of the grid through the thinnest fibre, a whole number from 2",
        present: spec.chosen_knobs().cells_per_fibre.to_string(),
        grid: words(&CELLS),
        reference: vec![("cells_per_fibre", FINEST.to_owned())],
        keeps_specimen: true,
    }];
    if let Arrangement::Random(random) = &spec.arrangement {
        knobs.push(Knob {
            name: "fibres",
            description: "fibres in the cell, a whole number from 1",
            present: random.fibres.to_string(),
            grid: words(&FIBRES),
            reference: vec![("fibres", MOST_FIBRES.to_owned())],
            keeps_specimen: false,
        });
    }
    knobs
}

/// Sets a knob; `None` when the value is not one it takes. Ranges are left to the schema.
pub(super) fn turn(spec: &mut CompositeCell, knob: &str, value: &str) -> Option<()> {
    match knob {
        "cells_per_fibre" => {
            spec.accuracy = Accuracy::Knobs(Knobs {
                cells_per_fibre: value.parse().ok()?,
            });
        }
        "fibres" => {
            let Arrangement::Random(random) = &mut spec.arrangement else {
                return None;
            };
            random.fibres = value.parse().ok()?;
        }
        _ => return None,
    }
    Some(())
}
