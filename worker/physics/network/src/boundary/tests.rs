//! Nodes held along some axes against closed forms, by every method.
use loadframe_harness::{SimulationError, Uninterrupted};
use loadframe_numerics::Team;

use super::*;
use crate::{
    Bonds, Laws, Network,
    assembly::Assembly,
    configuration::Verdict,
    equilibrium::{
        Descent, Gradient, Method, Search, Settled, Workspace, calm,
        work::{Meter, Work},
    },
    law::BondLaw,
    load_path::{Part, parts},
    sample::squares,
};

/// A method and the limit of resultants [N] that it is given, of forces of some 0.1 N.
type Way = (Method, f64);

const NEWTON: Way = (Method::NewtonCg, 1e-9);
const SEQUENTIAL: Way = (Method::Sequential, 1e-9);
const ALL: [Way; 4] = [
    NEWTON,
    SEQUENTIAL,
    (
        Method::Parallel {
            relaxation_factor: 0.5,
        },
        1e-9,
    ),
    // its moves are as short as the limit: a million times more of them would be of no use
    (
        Method::Descent(Descent {
            gradient: Gradient::Exact,
            step: None,
            is_adaptive: false,
        }),
        1e-5,
    ),
];

/// Errors of forces [N] and of displacements [mm] that a limit leaves where bonds are as stiff as here, some
/// N/mm.
fn near(limit: f64) -> f64 {
    10.0 * limit
}

fn set(name: &str, ways: [Option<f64>; 3]) -> Set {
    Set {
        name: name.to_owned(),
        ways,
    }
}

fn linear(modulus: f64) -> BondLaw {
    BondLaw {
        modulus,
        friction_modulus: 0.0,
        compression_stiffness: modulus,
    }
}

fn network(
    nodes: &[([f64; 2], Hold)],
    bonds: &[([u32; 2], f64)],
    others: impl IntoIterator<Item = Set>,
) -> Network {
    let positions: Vec<Vector> = nodes
        .iter()
        .map(|([x, y], _)| Vector::new(*x, *y, 0.0))
        .collect();
    let ends: Vec<[u32; 2]> = bonds.iter().map(|(ends, _)| *ends).collect();
    let span = |[a, b]: &[u32; 2]| (positions[*a as usize] - positions[*b as usize]).norm();
    Network {
        holds: nodes.iter().map(|(_, hold)| *hold).collect(),
        sets: Set::jaws().into_iter().chain(others).collect(),
        bonds: Bonds {
            rest_lengths: ends.iter().map(span).collect(),
            strengths: vec![f64::INFINITY; ends.len()],
            laws: Laws::Each(bonds.iter().map(|(_, modulus)| linear(*modulus)).collect()),
            ends,
        },
        positions,
        rows: Vec::new(),
    }
}

/// The network with its sets at λ [mm], its free nodes in equilibrium.
fn at(
    network: &Network,
    load: f64,
    (method, force_limit): Way,
) -> Result<(Assembly, Settled), SimulationError> {
    let intact = vec![true; network.bonds.len()];
    let mut assembly = Assembly::new(network);
    assembly.load(network, &intact, &parts(network, &intact));
    let start: Vec<Vector> = (0..network.positions.len() as u32)
        .map(|node| {
            network
                .set_of(node)
                .map_or(Vector::zeros(), |set| set.displacement(load))
        })
        .collect();
    let search = Search {
        method,
        iteration_limit: 100_000,
        force_limit,
        step_cap: 1.0,
        calm: calm(1e4),
    };
    let mut meter = Meter::new(Work::default(), &Uninterrupted);
    let mut workspace = Workspace::default();
    let settled = search
        .run(
            &assembly,
            &start,
            &Team::new(1)?,
            &mut workspace,
            &mut meter,
        )
        .expect("nothing interrupts");
    Ok((assembly, settled))
}

/// Asserts that forces on all sets balance each other, and returns them.
fn balanced(assembly: &Assembly, settled: &Settled, limit: f64) -> Vec<Vector> {
    assert_ne!(settled.residual.verdict, Verdict::Unbalanced);
    let forces = settled.configuration.forces_on_sets(assembly);
    let sum: Vector = forces.iter().sum();
    assert!(sum.norm() < near(limit), "{forces:?}");
    forces
}

/// Where `falling`, positive below and negative beyond, is zero.
fn zero(falling: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (-1.0, 1.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if falling(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Force of a linear bond from a fixed point on a node [N].
fn pull(modulus: f64, from: [f64; 2], node: [f64; 2], moved: [f64; 2]) -> [f64; 2] {
    let rest = (node[0] - from[0]).hypot(node[1] - from[1]);
    let span = [0, 1].map(|axis| from[axis] - node[axis] - moved[axis]);
    let length = span[0].hypot(span[1]);
    span.map(|span| modulus * (length - rest) / rest * span / length)
}

#[test]
fn an_apex_lifted_along_y_finds_its_own_x() -> Result<(), SimulationError> {
    // two bars of 1 and 3 N from the ground to an apex that is lifted and free aside
    let feet = [[-1.0, 0.0], [1.5, 0.0]];
    let (apex, moduli, lift) = ([0.0, 1.0], [1.0, 3.0], 0.2);
    let nodes = [
        (feet[0], Some(BOTTOM)),
        (feet[1], Some(BOTTOM)),
        (apex, Some(2)),
    ];
    let bonds = [([0, 2], moduli[0]), ([1, 2], moduli[1])];
    let lifted = set("apex", [None, Some(1.0), None]);
    let network = network(&nodes, &bonds, [lifted]);
    let on_apex = |x: f64| {
        let pulls = [0, 1].map(|bar: usize| pull(moduli[bar], feet[bar], apex, [x, lift]));
        [0, 1].map(|axis: usize| pulls[0][axis] + pulls[1][axis])
    };
    let x = zero(|x| on_apex(x)[0]);
    assert!(x.abs() > 0.01, "{x}");
    for (method, limit) in ALL {
        let (assembly, settled) = at(&network, lift, (method, limit))?;
        let forces = balanced(&assembly, &settled, limit);
        assert!(
            (forces[2] - Vector::new(0.0, on_apex(x)[1], 0.0)).norm() < near(limit),
            "{method:?}"
        );
        let place = assembly.free().start;
        let moved = settled.configuration.displacements.at(place);
        // lifted by exactly so much
        assert_eq!(moved.y.to_bits(), lift.to_bits(), "{method:?}");
        assert!(
            (moved.x - x).abs() < near(limit),
            "{method:?}: {} and {x}",
            moved.x
        );
    }
    Ok(())
}

#[test]
fn a_guide_takes_what_pulls_aside_and_nothing_else() -> Result<(), SimulationError> {
    // bars of 2 and 4 N in a row between jaws; what joins them is drawn aside, and guided along y
    let nodes = [
        ([0.0, 0.0], Some(BOTTOM)),
        ([0.0, 1.0], Some(2)),
        ([0.0, 2.0], Some(TOP)),
        ([2.0, 1.0], Some(BOTTOM)),
    ];
    let bonds = [([0, 1], 2.0), ([1, 2], 4.0), ([1, 3], 1.0)];
    let mut network = network(&nodes, &bonds, [set("guide", [Some(0.0), None, Some(0.0)])]);
    network.bonds.rest_lengths[2] = 1.9;
    let load = 0.3;
    let aside = |y: f64| {
        let length = 2_f64.hypot(y);
        let tension = (length - 1.9) / 1.9;
        [tension * 2.0 / length, -tension * y / length]
    };
    let y = zero(|y| 4.0 * (load - y) - 2.0 * y + aside(y)[1]);
    for (method, limit) in ALL {
        let (assembly, settled) = at(&network, load, (method, limit))?;
        let forces = balanced(&assembly, &settled, limit);
        assert!(
            (forces[2] - Vector::new(aside(y)[0], 0.0, 0.0)).norm() < near(limit),
            "{method:?}"
        );
        assert!(
            (forces[1].y + 4.0 * (load - y)).abs() < near(limit),
            "{method:?}"
        );
    }
    Ok(())
}

#[test]
fn what_is_drawn_aside_and_out_of_the_plane_pulls_along_the_chain() -> Result<(), SimulationError> {
    // bars of 2 and 4 N, 1 mm each, in series; the far end goes along all axes
    let nodes = [
        ([0.0, 0.0], Some(BOTTOM)),
        ([0.0, 1.0], None),
        ([0.0, 2.0], Some(2)),
    ];
    let bonds = [([0, 1], 2.0), ([1, 2], 4.0)];
    let ways = [0.5, 1.0, 0.25];
    let network = network(&nodes, &bonds, [set("far", ways.map(Some))]);
    let load = 0.4;
    let chain = Vector::new(0.0, 2.0, 0.0) + Vector::from(ways) * load;
    // T = 2 e = 4 f of the strains e and f of the bars, which add up to the elongation
    let tension = (chain.norm() - 2.0) * 8.0 / 6.0;
    for (method, limit) in ALL {
        let (assembly, settled) = at(&network, load, (method, limit))?;
        let forces = balanced(&assembly, &settled, limit);
        let expected = -tension * chain.normalize();
        assert!((forces[2] - expected).norm() < near(limit), "{method:?}");
    }
    Ok(())
}

#[test]
fn sides_held_in_width_keep_it_and_their_forces_balance() -> Result<(), SimulationError> {
    let side = 12;
    let mut network = squares(side);
    // left and right edges slide along y
    for (name, column) in [("left", 0), ("right", side - 1)] {
        let number = network.sets.len() as u16;
        network.sets.push(set(name, [Some(0.0), None, None]));
        for row in 1..side - 1 {
            network.holds[(row * side + column) as usize] = Some(number);
        }
    }
    let (assembly, settled) = at(&network, 1.0, NEWTON)?;
    let forces = balanced(&assembly, &settled, NEWTON.1);
    // what would neck pulls its sides inwards
    assert!(forces[2].x > 0.01 && forces[3].x < -0.01, "{forces:?}");
    for place in assembly.free() {
        let held = assembly.guide_of(place).unwrap_or_default();
        let moved = settled.configuration.displacements.at(place);
        assert!(!held[0] || moved.x == 0.0);
    }
    // and by another method
    let (assembly, relaxed) = at(&network, 1.0, SEQUENTIAL)?;
    let others = relaxed.configuration.forces_on_sets(&assembly);
    for (one, other) in forces.iter().zip(&others) {
        // a relaxation leaves long waves
        assert!((one - other).norm() < 1e-5, "{one} {other}");
    }
    Ok(())
}

#[test]
fn what_hangs_on_one_guide_alone_goes_with_it_and_carries_nothing() {
    let nodes = [
        ([0.0, 0.0], Some(2)),
        ([1.0, 0.0], None),
        ([5.0, 0.0], Some(BOTTOM)),
        ([6.0, 0.0], Some(2)),
    ];
    let bonds = [([0, 1], 1.0), ([2, 3], 1.0)];
    let network = network(&nodes, &bonds, [set("lift", [None, Some(0.5), None])]);
    let parts = parts(&network, &[true; 2]);
    assert_eq!(parts[..2], [Part::With(2); 2]);
    assert_eq!(parts[2..], [Part::With(BOTTOM), Part::Loaded]);
}
