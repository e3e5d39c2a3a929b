//! Strips add up to the whole.
use super::*;
use crate::{
    SimulationError,
    network::{
        Bonds, Hold, Laws, Network, Vector, assembly::Assembly, configuration::Configuration,
        field::Field, law::BondLaw, load_path::parts,
    },
};

/// Nodes along each side.
const SIDE: u32 = 150;

/// Squares with a diagonal between two sides that are held; every 97th diagonal leads far away, up
/// or down.
fn net() -> Assembly {
    let node = |column: u32, row: u32| row * SIDE + column;
    let mut ends = Vec::new();
    for (row, column) in (0..SIDE).flat_map(|row| (0..SIDE).map(move |column| (row, column))) {
        for (right, up) in [(1, 0), (0, 1), (1, 1)] {
            if column + right == SIDE || row + up == SIDE {
                continue;
            }
            let here = node(column, row);
            let there = node(column + right, row + up);
            let far = (here * 7919 + 12_345) % (SIDE * SIDE);
            let is_far = right + up == 2 && here % 97 == 0 && far != here;
            ends.push([here, if is_far { far } else { there }]);
        }
    }
    let place = |node: u32| {
        let shake = (f64::from(node) * 0.7).sin();
        Vector::new(f64::from(node % SIDE), f64::from(node / SIDE), 0.2 * shake)
    };
    let network = Network {
        positions: (0..SIDE * SIDE).map(place).collect(),
        holds: (0..SIDE * SIDE)
            .map(|node| match node / SIDE {
                0 => Hold::Bottom,
                row if row + 1 == SIDE => Hold::Top,
                _ => Hold::Free,
            })
            .collect(),
        bonds: Bonds {
            rest_lengths: ends
                .iter()
                .map(|[a, b]| 0.9 * (place(*a) - place(*b)).norm())
                .collect(),
            strengths: vec![f64::INFINITY; ends.len()],
            laws: Laws::Same(BondLaw {
                modulus: 1.0,
                friction_modulus: 0.5,
                compression_stiffness: 0.3,
            }),
            ends,
        },
        rows: Vec::new(),
    };
    let intact = vec![true; network.bonds.len()];
    let mut assembly = Assembly::new(&network);
    assembly.load(&network, &intact, &parts(&network, &intact));
    assembly
}

fn wave(places: usize, length: f64) -> Field<f64> {
    let at = |place: usize| {
        let phase = place as f64 / length;
        0.05 * Vector::new(phase.sin(), phase.cos(), (2.0 * phase).sin())
    };
    Field::of(&(0..places).map(at).collect::<Vec<_>>(), 3)
}

#[test]
fn every_bond_acts_once_at_both_its_ends() -> Result<(), SimulationError> {
    let assembly = net();
    let strips = &assembly.strips;
    assert!(strips.count() > 2, "{strips:?}");
    assert!(!strips.left_over().blocks.is_empty());
    let places = assembly.places();
    let team = Team::new(3)?;
    let at: Configuration<f64> = Configuration::new(&assembly, wave(places, 31.0), &team);
    let field = wave(places, 17.0);
    let mut product = Field::zeros(places, 3);
    let mut spill = Spill::new(strips, 3);
    let stiffness = &at.stiffness;
    let curvature = stiffness.multiply(&assembly, &field, &mut product, &mut spill, &team);

    let mut resultants = vec![Vector::zeros(); places];
    let mut forces = vec![Vector::zeros(); places];
    let (mut energy, mut work) = (0.0, 0.0);
    for slot in assembly.slots() {
        let [first, second] = assembly.ends[slot].map(|end| end as usize);
        let bond = at.bond(&assembly, slot);
        let pull = bond.direction * bond.tension;
        resultants[first] += pull;
        resultants[second] -= pull;
        energy += bond.energy;
        let difference = field.at(first) - field.at(second);
        let along = bond.direction * bond.direction.dot(&difference);
        let force = along * bond.axial + (difference - along) * bond.transverse;
        forces[first] += force;
        forces[second] -= force;
        work += force.dot(&difference);
    }
    // sums of some ten numbers of order one, of 67 000 for energy and work
    for place in 0..places {
        assert!((at.resultants.at(place) - resultants[place]).amax() < 1e-13);
        assert!((product.at(place) - forces[place]).amax() < 1e-13);
    }
    assert!((at.energy - energy).abs() < 1e-12 * energy);
    assert!((curvature - work).abs() < 1e-12 * work);
    Ok(())
}
