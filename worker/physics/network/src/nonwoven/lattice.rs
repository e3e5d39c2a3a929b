//! Layers of a hexagonal lattice between two jaws.
//!
//! Nodes are numbered by row, layer, column, jaw points before and after them; bonds come in runs
//! from nodes i, i + 1, ... to nodes j, j + 1, ..., so that walking along them walks along memory.
//!
//! The halved diagonals of half-bond jaws are the grip, not the material: they strain like every
//! bond but do not break. Otherwise the test would end in jaw breaks, which standards discard: on
//! the lattice of table 6 the force maximum would fall by 3 %.
//!
//! Source: [Zilka2022] tables 2 and 6, sections 1.2.2 and 2.2.
use std::ops::Range;

use loadframe_api::spec::nonwoven_tensile::{Jaws, Lattice};
use loadframe_harness::rng::{Purpose, Streams};
use rand::{RngExt, distr::StandardUniform};

use crate::{
    Row, Vector,
    boundary::{BOTTOM, Hold, TOP},
};

/// Nodes and bonds of a lattice, before laws and strengths are given to the bonds.
#[derive(Clone, Debug, Default)]
pub(super) struct Points {
    pub(super) positions: Vec<Vector>,
    pub(super) holds: Vec<Hold>,
    pub(super) ends: Vec<[u32; 2]>,
    pub(super) rows: Vec<Row>,
    /// Numbers of the first and the last halved diagonals, below and above the bonds of the lattice.
    pub(super) grips: [Range<usize>; 2],
    /// First and last node of each row in the middle third, in every layer.
    pub(super) middle_rows: Vec<[u32; 2]>,
    /// Distance of the jaws [mm].
    pub(super) gauge_length: f64,
    /// Each row or column counts with its spacing [mm].
    pub(super) width: f64,
    /// Numbers of the bonds in the lattice as it is given, by which their strength is drawn; empty
    /// where they are their own.
    pub(super) numbers: Vec<usize>,
}

/// The numbering of a lattice's nodes.
pub(super) struct Numbering<'a> {
    pub(super) lattice: &'a Lattice,
    /// Jaw points of one jaw.
    pub(super) jaw_points: u32,
}

impl<'a> Numbering<'a> {
    pub(super) fn new(lattice: &'a Lattice) -> Self {
        let jaw_points = match lattice.jaws {
            Jaws::HalfBond => 2 * lattice.points_per_row,
            Jaws::ClampedRows => 0,
        };
        Self {
            lattice,
            jaw_points,
        }
    }

    /// Points in a row: n_x in even rows, n_x + 1 in odd ones.
    pub(super) fn columns(&self, row: u32) -> u32 {
        self.lattice.points_per_row + row % 2
    }

    /// Number of the first node of a row in a layer.
    pub(super) fn first(&self, row: u32, layer: u32) -> u32 {
        let pair = 2 * self.lattice.points_per_row + 1;
        let points_before = row / 2 * pair + row % 2 * self.lattice.points_per_row;
        self.jaw_points + points_before * self.lattice.layers + layer * self.columns(row)
    }

    pub(super) fn is_clamped(&self, row: u32) -> bool {
        self.lattice.jaws == Jaws::ClampedRows && (row == 0 || row == self.lattice.rows - 1)
    }
}

/// Builds the lattice; `seed` moves its nodes.
pub(super) fn points(lattice: &Lattice, seed: u64) -> Points {
    let numbering = Numbering::new(lattice);
    let [across, spacing, _] = lattice.spacing_mm;
    let (first_row, last_row) = (0, lattice.rows - 1);
    let mut points = Points {
        width: f64::from(lattice.points_per_row) * across,
        ..Points::default()
    };
    match lattice.jaws {
        Jaws::HalfBond => {
            points.gauge_length = f64::from(lattice.rows) * spacing;
            points.add_jaw(lattice, Some(BOTTOM), -0.5 * spacing);
            points.grips[0] = points.join_jaw(&numbering, first_row, 0);
        }
        Jaws::ClampedRows => points.gauge_length = f64::from(last_row) * spacing,
    }
    points.add_nodes(&numbering, seed);
    for row in 0..lattice.rows {
        for layer in 0..lattice.layers {
            points.join_row(&numbering, row, layer);
        }
    }
    if lattice.jaws == Jaws::HalfBond {
        let top = points.positions.len() as u32;
        points.add_jaw(lattice, Some(TOP), (f64::from(last_row) + 0.5) * spacing);
        points.grips[1] = points.join_jaw(&numbering, last_row, top);
    }
    points.middle_rows = middle_rows(&numbering);
    points
}

impl Points {
    /// The 2 n_x points of a half-bond jaw at height `y`: where the halved diagonals of all layers
    /// meet, in the mid-plane, a quarter of a spacing to both sides of each end node.
    fn add_jaw(&mut self, lattice: &Lattice, jaw: Hold, y: f64) {
        let [along_row, _, between_layers] = lattice.spacing_mm;
        let z = 0.5 * f64::from(lattice.layers - 1) * between_layers;
        for point in 0..2 * lattice.points_per_row {
            let x = (f64::from(point) * 0.5 + 0.25) * along_row;
            self.positions.push(Vector::new(x, y, z));
            self.holds.push(jaw);
        }
    }

    /// The number by which a bond's strength is drawn.
    pub(super) fn number(&self, bond: usize) -> usize {
        self.numbers.get(bond).copied().unwrap_or(bond)
    }

    /// Whether a bond is a halved diagonal in a jaw.
    pub(super) fn is_grip(&self, bond: usize) -> bool {
        self.grips.iter().any(|grip| grip.contains(&bond))
    }

    /// The halved diagonals between an end row and its jaw, whose points start at number `jaw`.
    /// Returns the numbers of these bonds.
    fn join_jaw(&mut self, numbering: &Numbering<'_>, row: u32, jaw: u32) -> Range<usize> {
        let from = self.ends.len();
        for layer in 0..numbering.lattice.layers {
            for side in 0..2 {
                for column in 0..numbering.columns(row) {
                    let node = numbering.first(row, layer) + column;
                    let point = jaw + 2 * column + side;
                    self.ends.push([node.min(point), node.max(point)]);
                }
            }
        }
        from..self.ends.len()
    }

    fn add_nodes(&mut self, numbering: &Numbering<'_>, seed: u64) {
        let lattice = numbering.lattice;
        let streams = Streams::new(seed, Purpose::Irregularity);
        let mut number = 0;
        for row in 0..lattice.rows {
            let hold = match (numbering.is_clamped(row), row) {
                (false, _) => None,
                (true, 0) => Some(BOTTOM),
                (true, _) => Some(TOP),
            };
            let offset = if row.is_multiple_of(2) { 0.5 } else { 0.0 };
            for layer in 0..lattice.layers {
                let place = Vector::new(offset, f64::from(row), f64::from(layer));
                self.rows.push(Row {
                    first: self.positions.len() as u32,
                    count: numbering.columns(row),
                    origin: place.component_mul(&Vector::from(lattice.spacing_mm)),
                    spacing: lattice.spacing_mm[0],
                });
                for column in 0..numbering.columns(row) {
                    let place = [f64::from(column) + offset, f64::from(row), f64::from(layer)];
                    let mut generator = streams.of(number);
                    let coordinate = |axis: usize| {
                        let drawn: f64 = generator.sample(StandardUniform);
                        let irregularity = lattice.irregularity[axis];
                        let moved = match hold {
                            None => irregularity * drawn - 0.5 * irregularity,
                            Some(_) => 0.0,
                        };
                        (place[axis] + moved) * lattice.spacing_mm[axis]
                    };
                    let [x, y, z] = [0, 1, 2].map(coordinate);
                    self.positions.push(Vector::new(x, y, z));
                    self.holds.push(hold);
                    number += 1;
                }
            }
        }
    }

    /// Bonds of a row in a layer: within the row, to the next row, to the next layer. Bonds
    /// between two held nodes do nothing and are left out.
    fn join_row(&mut self, numbering: &Numbering<'_>, row: u32, layer: u32) {
        let lattice = numbering.lattice;
        let (first, columns) = (numbering.first(row, layer), numbering.columns(row));
        if !numbering.is_clamped(row) {
            self.join_run(first, first + 1, columns - 1);
        }
        if row + 1 < lattice.rows {
            let above = numbering.first(row + 1, layer);
            if row.is_multiple_of(2) {
                self.join_run(first, above, columns);
                self.join_run(first, above + 1, columns);
            } else {
                self.join_run(first + 1, above, columns - 1);
                self.join_run(first, above, columns - 1);
            }
        }
        if layer + 1 < lattice.layers && !numbering.is_clamped(row) {
            self.join_run(first, numbering.first(row, layer + 1), columns);
        }
    }

    pub(super) fn join_run(&mut self, first: u32, second: u32, count: u32) {
        self.ends
            .extend((0..count).map(|step| [first + step, second + step]));
    }
}

/// Ends of the rows in the middle third of the height, in every layer.
fn middle_rows(numbering: &Numbering<'_>) -> Vec<[u32; 2]> {
    let lattice = numbering.lattice;
    let outside = lattice.rows / 3;
    let rows = outside..lattice.rows - outside;
    let ends = |row, layer| {
        let first = numbering.first(row, layer);
        [first, first + numbering.columns(row) - 1]
    };
    rows.flat_map(|row| (0..lattice.layers).map(move |layer| ends(row, layer)))
        .collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp, reason = "these numbers are exact")]
    use super::*;

    fn pet(jaws: Jaws) -> Lattice {
        Lattice {
            points_per_row: 49,
            rows: 51,
            layers: 3,
            spacing_mm: [20.0, 20.0, 10.0],
            irregularity: [0.5; 3],
            jaws,
            thickness_mm: None,
            grammage_g_per_m2: None,
        }
    }

    #[test]
    fn clamped_rows_have_the_counts_of_table_6() {
        let points = points(&pet(Jaws::ClampedRows), 1);
        assert_eq!(points.positions.len(), (26 * 49 + 25 * 50) * 3);
        // all lattice bonds, less those within the two end rows
        let in_rows = 3 * (26 * 48 + 25 * 49);
        let diagonals = 3 * 50 * 2 * 49;
        let between_layers = 2 * (26 * 49 + 25 * 50);
        let held = 2 * (3 * 48 + 2 * 49);
        assert_eq!(
            points.ends.len(),
            in_rows + diagonals + between_layers - held
        );
        assert_eq!(points.ends.len(), 26_683);
        assert_eq!(points.gauge_length, 50.0 * 20.0);
    }

    #[test]
    fn half_bond_jaws_hold_two_points_per_column_in_the_mid_plane() {
        let points = points(&pet(Jaws::HalfBond), 1);
        assert_eq!(points.positions.len(), 7572 + 4 * 49);
        assert_eq!(points.ends.len(), 27_167 + 2 * 2 * 49 * 3);
        assert_eq!(points.gauge_length, 51.0 * 20.0);
        let grips = (0..points.ends.len()).filter(|bond| points.is_grip(*bond));
        let touches_jaw = |bond: usize| {
            let holds = points.ends[bond].map(|node| points.holds[node as usize]);
            holds != [None; 2]
        };
        assert!(grips.clone().all(touches_jaw) && grips.count() == 2 * 2 * 49 * 3);
        let held = |jaw| {
            let nodes = points.positions.iter().zip(&points.holds);
            let held = nodes.filter(move |(_, hold)| **hold == jaw);
            held.map(|(position, _)| *position).collect::<Vec<_>>()
        };
        assert_eq!(held(Some(BOTTOM)).len(), 98);
        assert_eq!(held(Some(BOTTOM))[1], Vector::new(15.0, -10.0, 10.0));
        assert_eq!(held(Some(TOP))[97], Vector::new(975.0, 1010.0, 10.0));
    }

    #[test]
    fn regular_bonds_have_the_lengths_of_the_lattice() {
        let mut lattice = pet(Jaws::HalfBond);
        lattice.irregularity = [0.0; 3];
        let points = points(&lattice, 1);
        let diagonal = 10.0_f64.hypot(20.0);
        let half = (5.0_f64 * 5.0 + 10.0 * 10.0).sqrt();
        // in the outer layers the halved diagonals also lead to the mid-plane
        let outer_half = (5.0_f64 * 5.0 + 10.0 * 10.0 + 10.0 * 10.0).sqrt();
        for [first, second] in &points.ends {
            let span = points.positions[*second as usize] - points.positions[*first as usize];
            let length = span.norm();
            let known = [10.0, 20.0, diagonal, half, outer_half];
            assert!(known.iter().any(|known| (length - known).abs() < 1e-9));
        }
    }

    #[test]
    fn no_node_has_more_than_eight_bonds_and_no_bond_is_double() {
        for jaws in [Jaws::HalfBond, Jaws::ClampedRows] {
            let points = points(&pet(jaws), 1);
            let mut bonds = vec![0; points.positions.len()];
            for node in points.ends.iter().flatten() {
                bonds[*node as usize] += 1;
            }
            assert_eq!(bonds.iter().max(), Some(&8));
            let mut ends = points.ends.clone();
            ends.sort_unstable();
            ends.dedup();
            assert_eq!(ends.len(), points.ends.len());
        }
    }

    #[test]
    fn nodes_stay_within_half_their_irregularity() {
        let regular = Lattice {
            irregularity: [0.0; 3],
            ..pet(Jaws::HalfBond)
        };
        let (moved, regular) = (points(&pet(Jaws::HalfBond), 3), points(&regular, 3));
        let mut largest = Vector::zeros();
        for (moved, regular) in moved.positions.iter().zip(&regular.positions) {
            largest = largest.sup(&(moved - regular).abs());
        }
        let bound = Vector::new(0.25 * 20.0, 0.25 * 20.0, 0.25 * 10.0);
        assert!((bound - largest).min() >= 0.0 && (bound - largest).max() < 0.01);
    }

    #[test]
    fn middle_rows_reach_from_edge_to_edge() {
        let points = points(&pet(Jaws::HalfBond), 1);
        // rows 17 to 33, in three layers
        assert_eq!(points.middle_rows.len(), 17 * 3);
        for [first, last] in &points.middle_rows {
            let span = points.positions[*last as usize] - points.positions[*first as usize];
            assert!((span.x - 970.0).abs() <= 20.0 && span.y.abs() <= 10.0);
        }
    }
}
