//! A lattice pulled along its rows: the same nodes and bonds between other jaws.
//!
//! The jaws of the lattice and the halved diagonals that lead to them are taken off, x and y change
//! places, and the first and last node of each row are held where they are. Bonds keep the strength
//! they have when the lattice is pulled along y, so both directions are tests of one specimen.
//! Clamped rows, which lack the bonds that their jaw makes idle, get them for this.
use loadframe_api::spec::nonwoven_tensile::Lattice;

use super::lattice::{self, Numbering, Points};
use crate::{
    Vector,
    boundary::{BOTTOM, TOP},
};

/// Builds the turned lattice; `seed` moves its nodes as it does those of the upright one.
pub(super) fn points(lattice: &Lattice, seed: u64) -> Points {
    let mut upright = lattice::points(lattice, seed);
    let numbering = Numbering::new(lattice);
    join_clamped_rows(&mut upright, &numbering);
    let before = numbering.jaw_points;
    let nodes = before as usize..upright.positions.len() - before as usize;
    let turn = |position: &Vector| Vector::new(position.y, position.x, position.z);
    let mut points = Points {
        positions: upright.positions[nodes.clone()].iter().map(turn).collect(),
        holds: vec![None; nodes.len()],
        middle_rows: middle_columns(&numbering),
        width: f64::from(lattice.rows) * lattice.spacing_mm[1],
        ..Points::default()
    };
    let mut lengths = 0.0;
    for row in 0..lattice.rows {
        for layer in 0..lattice.layers {
            let first = (numbering.first(row, layer) - before) as usize;
            let last = first + numbering.columns(row) as usize - 1;
            points.holds[first] = Some(BOTTOM);
            points.holds[last] = Some(TOP);
            lengths += points.positions[last].y - points.positions[first].y;
        }
    }
    points.gauge_length = lengths / f64::from(lattice.rows * lattice.layers);
    for (number, ends) in upright.ends.iter().enumerate() {
        if upright.is_grip(number) {
            continue;
        }
        let ends = ends.map(|node| node - before);
        // between two held nodes a bond does nothing
        if ends
            .iter()
            .any(|node| points.holds[*node as usize].is_none())
        {
            points.ends.push(ends);
            points.numbers.push(number);
        }
    }
    points
}

/// The bonds within clamped rows, numbered after all others.
fn join_clamped_rows(points: &mut Points, numbering: &Numbering<'_>) {
    let lattice = numbering.lattice;
    for row in (0..lattice.rows).filter(|row| numbering.is_clamped(*row)) {
        for layer in 0..lattice.layers {
            let (first, columns) = (numbering.first(row, layer), numbering.columns(row));
            points.join_run(first, first + 1, columns - 1);
            if layer + 1 < lattice.layers {
                points.join_run(first, numbering.first(row, layer + 1), columns);
            }
        }
    }
}

/// Lower and upper end of the columns in the middle third, in every layer: the nodes of the two end
/// rows, which are even and stand above each other.
fn middle_columns(numbering: &Numbering<'_>) -> Vec<[u32; 2]> {
    let lattice = numbering.lattice;
    let outside = lattice.points_per_row / 3;
    let columns = outside..lattice.points_per_row - outside;
    let node = |row, layer, column| numbering.first(row, layer) + column - numbering.jaw_points;
    let ends = |column, layer| [0, lattice.rows - 1].map(|row| node(row, layer, column));
    columns
        .flat_map(|column| (0..lattice.layers).map(move |layer| ends(column, layer)))
        .collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp, reason = "these numbers are exact or copied")]
    use super::*;
    use loadframe_api::spec::nonwoven_tensile::Jaws;
    use std::collections::BTreeSet;

    fn fabric(jaws: Jaws) -> Lattice {
        Lattice {
            points_per_row: 7,
            rows: 9,
            layers: 2,
            spacing_mm: [20.0, 15.0, 10.0],
            irregularity: [0.5; 3],
            jaws,
            thickness_mm: None,
            grammage_g_per_m2: None,
        }
    }

    const NODES: usize = (5 * 7 + 4 * 8) * 2;
    const BONDS: usize = 2 * (5 * 6 + 4 * 7) + 2 * 8 * 2 * 7 + NODES / 2;
    /// Along each edge the diagonals of its zigzag in both layers, and the bonds between the layers.
    const HELD: usize = 2 * (8 * 2 + 9);

    #[test]
    fn nodes_and_bonds_are_those_of_the_lattice_without_its_jaws() {
        for jaws in [Jaws::HalfBond, Jaws::ClampedRows] {
            let lattice = fabric(jaws);
            let (upright, turned) = (lattice::points(&lattice, 3), points(&lattice, 3));
            assert_eq!(
                (turned.positions.len(), turned.ends.len()),
                (NODES, BONDS - HELD)
            );
            let before = (upright.positions.len() - NODES) / 2;
            for (turned, upright) in turned.positions.iter().zip(&upright.positions[before..]) {
                assert_eq!(
                    [turned.x, turned.y, turned.z],
                    [upright.y, upright.x, upright.z]
                );
            }
            for (bond, ends) in turned.ends.iter().enumerate() {
                // those of clamped rows come after all that the upright lattice has
                if let Some(known) = upright.ends.get(turned.number(bond)) {
                    assert_eq!(ends.map(|node| node + before as u32), *known);
                }
            }
            let numbers: BTreeSet<usize> = turned.numbers.iter().copied().collect();
            let ends: BTreeSet<[u32; 2]> = turned.ends.iter().copied().collect();
            assert_eq!(
                (numbers.len(), ends.len()),
                (turned.ends.len(), turned.ends.len())
            );
        }
    }

    #[test]
    fn the_ends_of_every_row_are_held_and_columns_reach_from_row_to_row() {
        let lattice = fabric(Jaws::HalfBond);
        let turned = points(&lattice, 3);
        // even rows begin at 10 and end at 130, odd ones at 0 and 140; nodes move by 5 at most
        for (jaw, y) in [(Some(BOTTOM), -5.0..=15.0), (Some(TOP), 125.0..=145.0)] {
            let nodes = turned.positions.iter().zip(&turned.holds);
            let held: Vec<f64> = nodes
                .filter(|(_, hold)| **hold == jaw)
                .map(|(p, _)| p.y)
                .collect();
            assert_eq!(held.len(), 9 * 2);
            assert!(held.iter().all(|height| y.contains(height)), "{held:?}");
        }
        // rows are 120 and 140 long, five and four of nine; nodes move by a quarter spacing at most
        assert!((turned.gauge_length - (5.0 * 120.0 + 4.0 * 140.0) / 9.0).abs() < 5.0);
        assert_eq!(turned.width, 9.0 * 15.0);
        // columns 2, 3, 4 of seven, in two layers
        assert_eq!(turned.middle_rows.len(), 3 * 2);
        for ends in &turned.middle_rows {
            let [low, high] = ends.map(|node| turned.positions[node as usize]);
            assert!((high.x - low.x - 120.0).abs() <= 7.5 && (high.y - low.y).abs() <= 10.0);
        }
    }
}
