//! The preconditioner by itself, and what iterations it leaves.
use loadframe_numerics::Team;

use super::cycle::Cycle;
use super::operator::{Nodal, Operator, dot};
use crate::frame::tests::{bond, fibre};
use crate::frame::{Attachment, FrameFibre, FrameModel, Level, Means, Network, Solver};

/// Fibres along and across the pull, each bonded to all that it crosses; those across come in pairs that
/// are `apart` [µm].
fn lattice(fibres: usize, apart: f64, attachment: Attachment) -> Network {
    let spacing = 40.0;
    let length_um = spacing * (fibres + 1) as f64;
    let place = |index: usize| spacing * (index + 1) as f64;
    let mut lines: Vec<FrameFibre> = (0..fibres)
        .map(|along| fibre(&[[0.0, place(along), 0.0], [length_um, place(along), 0.0]]))
        .collect();
    let mut bonds = Vec::new();
    for across in 0..fibres {
        for x in [place(across), place(across) + apart] {
            let number = lines.len() as u32;
            lines.push(fibre(&[[x, 0.0, 5.0], [x, length_um, 5.0]]));
            bonds.extend((0..fibres).map(|along| bond([along as u32, number], [x, place(along)])));
        }
    }
    let model = FrameModel {
        level: Level::Beam,
        segment_um: Some(60.0),
        attachment,
        length_um,
    };
    Network::new(&lines, &bonds, model).unwrap()
}

/// Everything active and, but for the jaws, free.
fn operator(network: &Network) -> Operator<'_, 6> {
    let mut operator = Operator::new(network, &network.unbroken());
    for element in 0..network.elements().len() {
        operator.set_active(element, true);
    }
    for node in 0..network.fibre_nodes() {
        operator.is_free[node] = network.jaw(node).is_none();
    }
    operator
}

/// Numbers in [-1/2, 1/2) at free nodes: multiples of a square root.
fn scattered(operator: &Operator<'_, 6>, root: f64) -> Nodal<6> {
    let nodes = operator.is_free.iter().enumerate();
    nodes
        .map(|(node, &is_free)| {
            std::array::from_fn(|motion| {
                let number = ((6 * node + motion) as f64 * root).fract() - 0.5;
                if is_free { number } else { 0.0 }
            })
        })
        .collect()
}

fn product(a: &Nodal<6>, b: &Nodal<6>) -> f64 {
    a.iter().zip(b).map(|(a, b)| dot(a, b)).sum()
}

#[test]
fn the_cycle_is_symmetric_and_takes_from_every_error_also_with_an_older_factor_of_bodies() {
    let team = Team::alone();
    for attachment in [Attachment::Node, Attachment::Inside] {
        let network = lattice(6, 10.0, attachment);
        let mut operator = operator(&network);
        let mut cycle = Cycle::<f64, 6>::new(&operator, &team).unwrap();
        for broken in [0, network.bonds() / 3] {
            for bond in (0..network.bonds()).step_by(3).take(broken) {
                operator.set_active(network.segments() + bond, false);
            }
            for fibre in 0..network.fibres() {
                cycle.factor_again(&operator, fibre).unwrap();
            }
            let [a, b] = [2.0_f64, 3.0].map(|square| scattered(&operator, square.sqrt()));
            let mut moved = a.clone();
            let own = cycle.solve(&operator, &team, &a, &mut moved);
            let with_other = product(&b, &moved);
            cycle.solve(&operator, &team, &b, &mut moved);
            let other = product(&a, &moved);
            assert!(own > 0.0);
            assert!(
                (with_other - other).abs() < 1e-10 * own,
                "{with_other} {other}"
            );

            // e - M K e has less energy than e
            let mut forces = a.clone();
            let energy = operator.apply(&team, &a, &mut forces);
            cycle.solve(&operator, &team, &forces, &mut moved);
            let rest = a.iter().zip(&moved);
            let rest: Nodal<6> = rest
                .map(|(a, moved)| std::array::from_fn(|motion| a[motion] - moved[motion]))
                .collect();
            let left = operator.apply(&team, &rest, &mut forces);
            assert!(left > 0.0 && left < energy, "{left} of {energy}");
        }
    }
}

fn iterations(network: &Network) -> usize {
    let rest = network.rest_by(1.0, &[], &Means::by(Solver::Iterative));
    rest.unwrap().iterations
}

#[test]
fn bonds_nearly_at_one_place_cost_no_iterations() {
    // the segment between two bonds is 10 000 times as stiff as others
    let apart = [10.0, 1e-3].map(|apart| iterations(&lattice(6, apart, Attachment::Node)));
    assert!(apart[1] <= apart[0] + apart[0] / 4, "{apart:?}");
}

#[test]
fn a_larger_sheet_needs_about_as_many_iterations() {
    // nine times the area: with fibres alone three times as many
    let sizes = [6, 18].map(|fibres| iterations(&lattice(fibres, 10.0, Attachment::Node)));
    assert!(sizes[1] <= sizes[0] + sizes[0] / 2, "{sizes:?}");
}
