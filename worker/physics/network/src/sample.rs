//! A network for tests.
use super::{
    Bonds, Laws, Network, Vector,
    assembly::Assembly,
    boundary::{BOTTOM, Set, TOP},
    law::BondLaw,
    load_path::parts,
};

/// Squares of 1 mm with one diagonal, so many nodes a side, in the plane between two jaws.
pub(super) fn squares(side: u32) -> Network {
    let node = |column: u32, row: u32| row * side + column;
    let mut ends = Vec::new();
    for (row, column) in (0..side).flat_map(|row| (0..side).map(move |column| (row, column))) {
        for (right, up) in [(1, 0), (0, 1), (1, 1)] {
            if column + right < side && row + up < side {
                ends.push([node(column, row), node(column + right, row + up)]);
            }
        }
    }
    let position = |node| Vector::new(f64::from(node % side), f64::from(node / side), 0.0);
    let mut network = Network {
        positions: (0..side * side).map(position).collect(),
        holds: (0..side * side)
            .map(|node| match node / side {
                0 => Some(BOTTOM),
                row if row + 1 == side => Some(TOP),
                _ => None,
            })
            .collect(),
        bonds: Bonds {
            rest_lengths: Vec::new(),
            strengths: vec![f64::INFINITY; ends.len()],
            laws: Laws::Same(BondLaw {
                modulus: 1.0,
                friction_modulus: 0.5,
                compression_stiffness: 0.3,
            }),
            ends,
        },
        sets: Set::jaws(),
        rows: Vec::new(),
    };
    stretch(&mut network, 1.0);
    network
}

/// Makes every bond at rest this part of what it spans.
pub(super) fn stretch(network: &mut Network, part: f64) {
    let positions = &network.positions;
    let span = |[a, b]: &[u32; 2]| (positions[*a as usize] - positions[*b as usize]).norm();
    let ends = network.bonds.ends.iter();
    network.bonds.rest_lengths = ends.map(|ends| part * span(ends)).collect();
}

/// The network with all bonds intact.
pub(super) fn assembled(network: &Network) -> Assembly {
    let intact = vec![true; network.bonds.len()];
    let mut assembly = Assembly::new(network);
    assembly.load(network, &intact, &parts(network, &intact));
    assembly
}
