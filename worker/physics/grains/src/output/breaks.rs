//! Where and when bonds broke: `broken_bonds.csv`, and `broken_bonds.vtp` as a map of them.
//!
//! Bonds are compared at the rows of the curve: one that held at the last row and does not at this one
//! broke in between, and is placed in the middle between its bodies as they are now. Bonds of bodies
//! that were taken out did not break.
use std::io;

use loadframe_harness::{
    Recorder,
    vtk::{Array, Points},
};

use super::{journal::Journal, table::write_table};
use crate::step::engine::Engine;

const COLUMNS: [&str; 9] = [
    "step", "time_s", "stage", "x_m", "y_m", "z_m", "grain", "body_a", "body_b",
];

/// Adds the bonds that broke since the last row; `held` are the pairs of bodies whose bonds hold.
pub(crate) fn add_rows(engine: &Engine, journal: &mut Journal, mut held: Vec<[u32; 2]>) {
    for pair in &mut held {
        pair.sort_unstable();
    }
    held.sort_unstable();
    let gone: Vec<[u32; 2]> = (journal.bonds.iter())
        .filter(|pair| held.binary_search(pair).is_err())
        .copied()
        .collect();
    journal.bonds = held;
    if gone.is_empty() {
        return;
    }
    let particles = &engine.state.particles;
    let mut centres = vec![None; engine.model.masses.len()];
    for (row, body) in particles.centres.iter().zip(&particles.owners) {
        centres[*body as usize] = Some(row.vector());
    }
    let state = &engine.state;
    for [a, b] in gone {
        let (Some(first), Some(second)) = (centres[a as usize], centres[b as usize]) else {
            continue;
        };
        let middle = 0.5 * (first + second);
        let grain = engine.model.grains[a as usize];
        journal.breaks.extend([
            state.step as f64,
            state.time,
            journal.number() as f64,
            middle.x,
            middle.y,
            middle.z,
            f64::from(grain),
            f64::from(a),
            f64::from(b),
        ]);
    }
}

/// Gives table and map to the recorder, if anything broke.
pub(crate) fn write(journal: &Journal, recorder: &mut dyn Recorder) -> io::Result<()> {
    if journal.breaks.is_empty() {
        return Ok(());
    }
    write_table(recorder, "broken_bonds.csv", &COLUMNS, &journal.breaks)?;
    let rows = || journal.breaks.chunks_exact(COLUMNS.len());
    let points: Vec<[f64; 3]> = rows().map(|row| [row[3], row[4], row[5]]).collect();
    let times: Vec<f64> = rows().map(|row| row[1]).collect();
    let whole = |column: usize| -> Vec<i32> { rows().map(|row| row[column] as i32).collect() };
    let (stages, grains) = (whole(2), whole(6));
    let map = Points {
        points: &points,
        data: &[
            Array::scalars("time_s", &times),
            Array::indices("stage", &stages),
            Array::indices("grain", &grains),
        ],
    };
    recorder.file("broken_bonds.vtp", &mut |out| map.write(out))
}
