//! Strips add up to the whole.
use loadframe_harness::SimulationError;

use super::*;
use crate::{
    Vector,
    assembly::Assembly,
    configuration::Configuration,
    field::Field,
    sample::{assembled, squares, stretch},
};

/// Nodes along each side.
const SIDE: u32 = 150;

/// Squares out of the plane; every 97th diagonal leads far away, up or down.
fn net() -> Assembly {
    let mut network = squares(SIDE);
    for [first, second] in &mut network.bonds.ends {
        let far = (*first * 7919 + 12_345) % (SIDE * SIDE);
        if *second == *first + SIDE + 1 && *first % 97 == 0 && far != *first {
            *second = far;
        }
    }
    for (node, position) in (0_u32..).zip(&mut network.positions) {
        position.z = 0.2 * (f64::from(node) * 0.7).sin();
    }
    stretch(&mut network, 0.9);
    assembled(&network)
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
