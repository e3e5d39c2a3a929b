//! Parts relax, and the whole knows of it.
use loadframe_harness::{SimulationError, Uninterrupted};
use loadframe_numerics::Team;

use super::*;
use crate::{
    Laws, Network, Vector,
    equilibrium::{Method, Workspace, work::Work},
    field::Field,
    sample::{assembled, squares, stretch},
};

const SIDE: u32 = 61;
/// The node that gets pushed.
const PUSHED: usize = 30 * 61 + 30;

const SEARCH: Search = Search {
    method: Method::NewtonCg,
    iteration_limit: 100,
    force_limit: 1e-8,
    step_cap: 1.0,
    calm: CALM,
};

fn meter() -> Meter<'static> {
    Meter::new(Work::default(), &Uninterrupted)
}

/// In equilibrium at 5 % strain but for some nodes, which are aside by this [mm].
fn pushed(
    assembly: &Assembly,
    pushes: &[(usize, Vector)],
) -> Result<Configuration, SimulationError> {
    let team = Team::new(1)?;
    let nodes = 0..SIDE * SIDE;
    let stretched = nodes.map(|node| Vector::new(0.0, 0.05 * f64::from(node / SIDE), 0.0));
    let mut displacements: Vec<Vector> = stretched.collect();
    let mut workspace = Workspace::default();
    let settled = SEARCH
        .run(
            assembly,
            &displacements,
            &team,
            &mut workspace,
            &mut meter(),
        )
        .expect("nothing interrupts");
    let mut here = settled.configuration;
    assembly.put(&here.displacements, &mut displacements);
    for (node, push) in pushes {
        displacements[*node] += push;
    }
    assembly.pick_into(&displacements, &mut here.displacements);
    here.update(assembly, &team);
    Ok(here)
}

fn relax(assembly: &Assembly, here: &mut Configuration) -> bool {
    let residual = here.residual(assembly, SEARCH.force_limit);
    Neighbourhoods::default()
        .relax(&SEARCH, assembly, here, &residual, &mut meter())
        .expect("nothing interrupts")
        .is_some()
}

/// What is between two of the same numbers, at most.
fn apart<T: Copy + Into<f64>>(a: &[T], b: &[T]) -> f64 {
    assert_eq!(a.len(), b.len());
    let pairs = a.iter().zip(b);
    pairs.fold(0.0, |most, (a, b)| {
        most.max((Into::<f64>::into(*a) - Into::<f64>::into(*b)).abs())
    })
}

/// Lets the surroundings of a pushed node relax: all that is known of the whole must be as if
/// summed anew.
fn check(assembly: &Assembly, push: Vector) -> Result<(), SimulationError> {
    let start = pushed(assembly, &[(PUSHED, push)])?;
    let mut here = start.clone();
    assert!(relax(assembly, &mut here));
    assert!(here.energy < start.energy);

    let mut anew = here.clone();
    anew.update(assembly, &Team::new(1)?);
    // some roundings of numbers of order one, of thousands for the energy
    assert!((here.energy - anew.energy).abs() < 1e-12 * start.energy);
    assert!(apart(&here.tensions, &anew.tensions) < 1e-14);
    let [before, after] = [&here, &anew].map(|at| at.resultants.components());
    for (here, anew) in before.iter().zip(&after) {
        assert!(apart(here, anew) < 1e-14);
    }
    assert!(apart(&here.stiffness.transverse, &anew.stiffness.transverse) < 1e-6);
    for slot in assembly.slots() {
        let [here, anew] = [&here, &anew].map(|at| at.stiffness.positive(slot));
        assert!(apart(&here, &anew) < 1e-6);
    }

    // what is within five bonds moved, what is farther did not
    let (mut near, mut far) = (0, 0);
    for place in assembly.free() {
        let node = assembly.node(place);
        let [column, row] = [node % 61, node / 61].map(|at| at.abs_diff(30));
        if column.max(row) > RINGS + 1 {
            far += 1;
            assert_eq!(here.displacements.at(place), start.displacements.at(place));
        } else if column + row <= RINGS {
            near += 1;
            assert!(here.resultants.at(place).norm() <= SEARCH.force_limit);
        }
    }
    assert!(near > 50 && far > 3000, "{near}, {far}");
    Ok(())
}

fn bulged() -> Network {
    let mut network = squares(SIDE);
    for (node, position) in (0_u32..).zip(&mut network.positions) {
        position.z = 0.2 * (f64::from(node) * 0.7).sin();
    }
    stretch(&mut network, 0.9);
    network
}

#[test]
fn the_whole_knows_what_its_parts_did() -> Result<(), SimulationError> {
    let assembly = assembled(&bulged());
    assert_eq!(assembly.dimensions(), 3);
    check(&assembly, Vector::new(0.2, -0.1, 0.3))?;
    // past its neighbours, so that bonds buckle
    check(&assembly, Vector::new(0.9, 0.8, 0.1))
}

#[test]
fn a_flat_part_stays_flat() -> Result<(), SimulationError> {
    for part in [1.0, 0.95] {
        let mut network = squares(SIDE);
        stretch(&mut network, part);
        let assembly = assembled(&network);
        assert_eq!(assembly.dimensions(), 2);
        check(&assembly, Vector::new(0.2, -0.1, 0.0))?;
    }
    Ok(())
}

#[test]
fn every_bond_of_a_part_keeps_its_own_law() -> Result<(), SimulationError> {
    let mut network = bulged();
    let laws = (0..network.bonds.len()).map(|bond| {
        let mut law = network.bonds.laws.of(bond);
        law.modulus += 0.5 * (0.3 * bond as f64).sin();
        law
    });
    network.bonds.laws = Laws::Each(laws.collect());
    let mut assembly = assembled(&network);
    check(&assembly, Vector::new(0.2, -0.1, 0.3))?;
    assembly.rounding = Some(0.01);
    check(&assembly, Vector::new(0.2, -0.1, 0.3))
}

#[test]
fn bonds_that_do_not_act_are_in_no_part() -> Result<(), SimulationError> {
    let network = bulged();
    let mut assembly = assembled(&network);
    let bonds = network.bonds.ends.iter().enumerate();
    let around = bonds.filter(|(_, ends)| ends.contains(&(PUSHED as u32)));
    for (bond, _) in around.take(2) {
        assembly.release(bond);
    }
    check(&assembly, Vector::new(0.2, -0.1, 0.3))
}

#[test]
fn what_is_out_of_balance_everywhere_is_left_to_the_whole() {
    let assembly = assembled(&bulged());
    let displacements = Field::zeros(assembly.places(), 3);
    let mut here = Configuration::new(&assembly, displacements, &Team::alone());
    let energy = here.energy;
    assert!(!relax(&assembly, &mut here));
    assert_eq!(here.energy.to_bits(), energy.to_bits());
}

#[test]
fn where_all_else_is_calm_only_what_is_near_the_limit_is_in_a_part() -> Result<(), SimulationError>
{
    const OTHER: usize = 10 * 61 + 10;
    let assembly = assembled(&bulged());
    let [most, less] = [2e-3, 5e-4].map(|x| Vector::new(x, 0.0, 0.0));
    let start = pushed(&assembly, &[(PUSHED, most), (OTHER, less)])?;
    let largest = start.residual(&assembly, 0.0).largest;
    let search = Search {
        force_limit: largest / 2.0,
        ..SEARCH
    };
    let residual = start.residual(&assembly, search.force_limit);
    let far = |mean: f64| {
        let residual = Residual { mean, ..residual };
        let mut parts = Neighbourhoods::default();
        let again = parts
            .relax(
                &search,
                &assembly,
                &mut start.clone(),
                &residual,
                &mut meter(),
            )
            .expect("nothing interrupts");
        let members = parts.members.iter();
        let nodes: Vec<usize> = members
            .map(|place| assembly.node(*place as usize))
            .collect();
        let is_member = [PUSHED, OTHER].map(|node| nodes.contains(&node));
        (is_member, again.expect("few nodes are far") / largest)
    };
    assert!(residual.mean < 0.1 * search.force_limit);
    assert_eq!(far(residual.mean), ([true, false], AGAIN[1]));
    assert_eq!(far(search.force_limit), ([true, true], AGAIN[0]));
    Ok(())
}
