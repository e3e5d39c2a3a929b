//! What the JSON Schema cannot say: counts that must fit together, bonds that must hold something.
use super::{
    Breaking, Direction, Fabric, Jaw, Lattice, MOST_STEPS, Network, NonwovenTensile, history,
};
use crate::spec::repeats::check_seeds;
use crate::violations::LISTED_OF_A_SORT;
use crate::{DisjointSets, Violation, Violations};

/// More nodes than this are refused: a network of this size takes about 10 GB.
const MOST_NODES: u64 = 20_000_000;
/// Rest lengths below this [mm] make stiffness overflow.
const SHORTEST_BOND_MM: f64 = 1e-9;

pub(super) fn check(spec: &NonwovenTensile, violations: &mut Violations) {
    match &spec.fabric {
        Fabric::Lattice(lattice) => check_lattice(lattice, violations),
        Fabric::Network(network) => check_network(network, violations),
    }
    check_bond(spec, violations);
    check_output(spec, violations);
    check_landscape(spec, violations);
    violations.extend(check_seeds(spec.seed, spec.test.repeats, "repeats"));
    check_directions(spec, violations);
    history::check(spec, violations);
    let steps = spec.test.steps();
    if spec.test.strain_step > spec.test.max_strain {
        violations.push(
            Violation::new(
                "/test/strain_step",
                "out_of_range",
                "the strain step is larger than the whole strain",
            )
            .value(spec.test.strain_step)
            .allowed(format!("≤ max_strain = {}", spec.test.max_strain))
            .unit("1"),
        );
    } else if steps > MOST_STEPS {
        violations.push(
            Violation::new(
                "/test/strain_step",
                "too_many_steps",
                format!("max_strain/strain_step gives {steps} steps"),
            )
            .value(spec.test.strain_step)
            .allowed(format!(
                "at most {MOST_STEPS} steps: ≥ {:e}",
                spec.test.max_strain / MOST_STEPS as f64
            ))
            .unit("1"),
        );
    }
}

fn check_output(spec: &NonwovenTensile, violations: &mut Violations) {
    let end = spec.test.max_strain;
    for (list, strains) in [
        (
            "force_distribution_strains",
            &spec.output.force_distribution_strains,
        ),
        ("reading_strains", &spec.output.reading_strains),
    ] {
        let beyond = strains.iter().enumerate();
        let beyond = beyond.filter(|(_, strain)| **strain > end);
        violations.extend(beyond.take(LISTED_OF_A_SORT).map(|(index, strain)| {
            Violation::new(
                format!("/output/{list}/{index}"),
                "out_of_range",
                "the test ends before this strain",
            )
            .value(*strain)
            .allowed(format!("≤ max_strain = {end}"))
            .unit("1")
        }));
    }
}

fn check_landscape(spec: &NonwovenTensile, violations: &mut Violations) {
    let Some(landscape) = &spec.output.force_landscape else {
        return;
    };
    let pointer = "/output/force_landscape";
    let end = spec.test.max_strain;
    if landscape.strain > end {
        violations.push(
            Violation::new(
                format!("{pointer}/strain"),
                "out_of_range",
                "the test ends before this strain",
            )
            .value(landscape.strain)
            .allowed(format!("≤ max_strain = {end}"))
            .unit("1"),
        );
    }
    let Some(node) = landscape.node else { return };
    let nodes = spec.fabric.nodes();
    let is_held = match &spec.fabric {
        Fabric::Lattice(_) => false,
        Fabric::Network(network) => network
            .jaws
            .get(node as usize)
            .is_some_and(|jaw| *jaw != Jaw::Free),
    };
    if u64::from(node) >= nodes || is_held {
        violations.push(
            Violation::new(
                format!("{pointer}/node"),
                "no_such_node",
                "there is no free node of this number",
            )
            .value(node)
            .allowed(format!("a free node among 0 … {}", nodes.saturating_sub(1))),
        );
    }
}

/// Only a lattice can be held in another way than it is given, and needs free nodes then.
fn check_directions(spec: &NonwovenTensile, violations: &mut Violations) {
    let mut directions = spec.test.directions.iter();
    let Some(index) = directions.position(|direction| *direction == Direction::X) else {
        return;
    };
    let refuse = |detail: &str| {
        Violation::new(
            format!("/test/directions/{index}"),
            "not_allowed",
            detail.to_owned(),
        )
        .value("x")
        .allowed("\"y\"")
    };
    match &spec.fabric {
        Fabric::Network(_) => violations.push(refuse(
            "a network says which jaw holds each node, for a pull along y; to pull it along x give \
             it turned, x and y exchanged and other nodes held, as a job of its own",
        )),
        Fabric::Lattice(lattice) if lattice.points_per_row < 3 => violations.push(refuse(&format!(
            "a pull along x holds the first and last node of each row; with points_per_row = {} \
             no node of a row is left between them (at least 3 are needed)",
            lattice.points_per_row
        ))),
        Fabric::Lattice(_) => {}
    }
}

fn check_lattice(lattice: &Lattice, violations: &mut Violations) {
    let pointer = "/fabric/lattice";
    if lattice.rows.is_multiple_of(2) {
        violations.push(
            Violation::new(
                format!("{pointer}/rows"),
                "not_odd",
                "the number of rows must be odd, so that both end rows are alike",
            )
            .value(lattice.rows)
            .allowed("odd numbers from 1"),
        );
    }
    if lattice.jaws == super::Jaws::ClampedRows && lattice.rows < 3 {
        violations.push(
            Violation::new(
                format!("{pointer}/rows"),
                "out_of_range",
                "clamped end rows need at least one free row between them",
            )
            .value(lattice.rows)
            .allowed("odd numbers from 3"),
        );
    }
    let nodes = lattice.nodes();
    if nodes > MOST_NODES {
        violations.push(
            Violation::new(
                pointer,
                "too_large",
                "points_per_row, rows and layers give too many nodes",
            )
            .value(nodes)
            .allowed(format!("1 … {MOST_NODES} nodes")),
        );
    }
}

fn check_bond(spec: &NonwovenTensile, violations: &mut Violations) {
    let bonds = match &spec.fabric {
        Fabric::Lattice(_) => None,
        Fabric::Network(network) => Some(&network.bonds),
    };
    let all_give = |own: fn(&super::NetworkBond) -> Option<f64>| {
        bonds.is_some_and(|bonds| bonds.iter().all(|bond| own(bond).is_some()))
    };
    if spec.bond.modulus_n.is_none() && !all_give(|bond| bond.modulus_n) {
        violations.push(missing(
            "/bond/modulus_n",
            "the bonds need a modulus",
            "1e-12 … 1e12",
        ));
    }
    if spec.bond.mean_strength_n.is_none()
        && spec.test.breaking != Breaking::None
        && !all_give(|bond| bond.strength_n)
    {
        violations.push(missing(
            "/bond/mean_strength_n",
            "bonds that may break need a strength (or set /test/breaking to \"none\")",
            "0 … 1e12",
        ));
    }
}

fn missing(pointer: &str, detail: &str, allowed: &str) -> Violation {
    Violation::new(pointer, "missing_field", detail)
        .allowed(allowed)
        .unit("N")
}

fn check_network(network: &Network, violations: &mut Violations) {
    let count = network.nodes_mm.len();
    let pointer = "/fabric/network";
    if network.jaws.len() != count {
        violations.push(
            Violation::new(
                format!("{pointer}/jaws"),
                "wrong_length",
                "jaws needs one entry for each node",
            )
            .value(network.jaws.len())
            .allowed(format!("{count} entries")),
        );
        return;
    }
    let before = violations.count();
    for (index, bond) in network.bonds.iter().enumerate() {
        let place = format!("{pointer}/bonds/{index}");
        let [a, b] = bond.nodes.map(|node| node as usize);
        if a >= count || b >= count {
            violations.push(
                Violation::new(
                    format!("{place}/nodes"),
                    "no_such_node",
                    "the bond names a node that does not exist",
                )
                .value(bond.nodes.to_vec())
                .allowed(format!("0 … {}", count - 1)),
            );
        } else if a == b {
            violations.push(
                Violation::new(
                    format!("{place}/nodes"),
                    "bond_to_itself",
                    "a bond joins two different nodes",
                )
                .value(bond.nodes.to_vec())
                .allowed("two different indices"),
            );
        } else if bond.rest_length_mm.is_none() {
            let distance = distance(network.nodes_mm[a], network.nodes_mm[b]);
            if distance < SHORTEST_BOND_MM {
                violations.push(
                    Violation::new(format!("{place}/nodes"), "zero_length", "the nodes are at the same place: give rest_length_mm, move one, or leave the bond out")
                        .value(distance)
                        .allowed(format!("≥ {SHORTEST_BOND_MM:e}"))
                        .unit("mm"),
                );
            }
        }
        if violations.count() - before >= LISTED_OF_A_SORT {
            return;
        }
    }
    if violations.count() == before {
        check_paths(network, violations);
    }
}

/// Every free node must hang on a jaw, and the jaws on each other: otherwise nothing holds the
/// node's place, or there is nothing to pull.
fn check_paths(network: &Network, violations: &mut Violations) {
    let pointer = "/fabric/network";
    let mut is_held = true;
    for (jaw, name) in [(Jaw::Bottom, "bottom"), (Jaw::Top, "top")] {
        if !network.jaws.contains(&jaw) {
            is_held = false;
            violations.push(
                Violation::new(
                    format!("{pointer}/jaws"),
                    "empty_jaw",
                    format!("no node is held by the {name} jaw"),
                )
                .value("0 nodes")
                .allowed("at least 1 node"),
            );
        }
    }
    let mean = |jaw| {
        let held = network
            .nodes_mm
            .iter()
            .zip(&network.jaws)
            .filter(|(_, j)| **j == jaw);
        let (sum, count) = held.fold((0.0, 0.0), |(sum, count), (node, _)| {
            (sum + node[1], count + 1.0)
        });
        sum / count
    };
    let gauge = mean(Jaw::Top) - mean(Jaw::Bottom);
    if gauge <= SHORTEST_BOND_MM {
        violations.push(
            Violation::new(
                format!("{pointer}/nodes_mm"),
                "no_gauge_length",
                "the top jaw must lie above the bottom jaw along y",
            )
            .value(gauge)
            .allowed(format!("mean y of top − bottom ≥ {SHORTEST_BOND_MM:e}"))
            .unit("mm"),
        );
    }
    if !is_held {
        return;
    }
    let mut parts = DisjointSets::new(network.nodes_mm.len());
    for bond in &network.bonds {
        parts.join(bond.nodes[0], bond.nodes[1]);
    }
    let mut held_by = vec![(false, false); network.nodes_mm.len()];
    for (node, jaw) in (0_u32..).zip(&network.jaws) {
        let held = &mut held_by[parts.root(node) as usize];
        held.0 |= *jaw == Jaw::Bottom;
        held.1 |= *jaw == Jaw::Top;
    }
    if !held_by.contains(&(true, true)) {
        violations.push(
            Violation::new(
                format!("{pointer}/bonds"),
                "no_load_path",
                "no chain of bonds joins the bottom jaw to the top jaw",
            )
            .value(network.bonds.len())
            .allowed("at least one chain of bonds from jaw to jaw"),
        );
    }
    let adrift = (0_u32..).zip(&network.jaws).filter(|(node, jaw)| {
        **jaw == Jaw::Free && held_by[parts.root(*node) as usize] == (false, false)
    });
    let adrift: Vec<u32> = adrift
        .map(|(node, _)| node)
        .take(LISTED_OF_A_SORT)
        .collect();
    violations.extend(adrift.into_iter().map(|node| {
        Violation::new(
            format!("{pointer}/nodes_mm/{node}"),
            "node_adrift",
            "no chain of bonds leads from this node to a jaw: bond it or leave it out",
        )
        .value(network.nodes_mm[node as usize].to_vec())
        .allowed("at least one chain of bonds to a jaw")
    }));
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3)
        .map(|axis| (a[axis] - b[axis]).powi(2))
        .sum::<f64>()
        .sqrt()
}
