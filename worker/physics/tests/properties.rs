//! What holds for any network: results follow when it is turned, scaled or renumbered.
mod scene;

use loadframe_api::spec::nonwoven_tensile::{
    Bond, Jaw, NetworkBond, NonwovenTensile, StrengthDraw,
};
use proptest::prelude::*;
use scene::{bond, explicit, run};

/// Residuals are at round-off; a soft network multiplies them by its condition, below 1e4 here.
const TOLERANCE: f64 = 1e-9;

const LAW: Bond = Bond {
    modulus_n: Some(1.0),
    friction_modulus_n: 2.0,
    compression_stiffness_n: 0.3,
    mean_strength_n: None,
    strength_sigma: 0.0,
    strength_draw: StrengthDraw::LogNormal,
};

type Nodes = Vec<([f64; 3], Jaw)>;

/// Nodes of a shaken 3 x 4 x 2 block and the bonds between neighbours.
fn block(shake: &[f64]) -> (Nodes, Vec<NetworkBond>) {
    let mut nodes = Nodes::new();
    let mut shake = shake.iter();
    for place in (0..24).map(|n| [n % 3, n / 3 % 4, n / 12]) {
        let jaw = match place[1] {
            0 => Jaw::Bottom,
            3 => Jaw::Top,
            _ => Jaw::Free,
        };
        let shaken = place.map(|index| f64::from(index) + shake.next().unwrap_or(&0.0));
        nodes.push((shaken, jaw));
    }
    let mut bonds = Vec::new();
    for first in 0..24_u32 {
        for second in first + 1..24 {
            let [a, b] = [first, second].map(|node| nodes[node as usize].0);
            let square: f64 = (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum();
            if square < 2.6 {
                bonds.push(bond(first, second));
            }
        }
    }
    (nodes, bonds)
}

fn stretched(nodes: &Nodes, bonds: &[NetworkBond]) -> NonwovenTensile {
    let mut spec = explicit(nodes, bonds.to_vec(), LAW);
    (spec.test.strain_step, spec.test.max_strain) = (0.05, 0.2);
    spec
}

fn assert_same(first: &[f64], second: &[f64]) -> Result<(), TestCaseError> {
    for (first, second) in first.iter().zip(second) {
        prop_assert!(
            (first - second).abs() <= TOLERANCE,
            "{first} against {second}"
        );
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn turning_about_the_pulling_direction_changes_no_force(
        shake in prop::collection::vec(-0.2..0.2, 72),
        angle in 0.0..std::f64::consts::TAU,
    ) {
        let (nodes, bonds) = block(&shake);
        let turned = nodes.iter().map(|([x, y, z], jaw)| {
            let (sin, cos) = angle.sin_cos();
            ([cos * x + sin * z, *y, cos * z - sin * x], *jaw)
        });
        let forces = run(&stretched(&nodes, &bonds)).1.column("force_n");
        let of_turned = run(&stretched(&turned.collect(), &bonds)).1.column("force_n");
        assert_same(&forces, &of_turned)?;
    }

    #[test]
    fn forces_depend_on_shape_not_on_size(
        shake in prop::collection::vec(-0.2..0.2, 72),
        scale in 1e-3..1e3,
    ) {
        let (nodes, bonds) = block(&shake);
        let scaled = nodes.iter().map(|(place, jaw)| (place.map(|x| x * scale), *jaw));
        let forces = run(&stretched(&nodes, &bonds)).1.column("force_n");
        let of_scaled = run(&stretched(&scaled.collect(), &bonds)).1.column("force_n");
        assert_same(&forces, &of_scaled)?;
    }

    #[test]
    fn the_order_of_bonds_does_not_matter(
        shake in prop::collection::vec(-0.2..0.2, 72),
        shift in 1..60_usize,
    ) {
        let (nodes, mut bonds) = block(&shake);
        let forces = run(&stretched(&nodes, &bonds)).1.column("force_n");
        bonds.rotate_left(shift);
        for bond in bonds.iter_mut().step_by(2) {
            bond.nodes.reverse();
        }
        assert_same(&forces, &run(&stretched(&nodes, &bonds)).1.column("force_n"))?;
    }

    #[test]
    fn the_jaws_feel_the_same_force_and_the_work_is_stored(
        shake in prop::collection::vec(-0.2..0.2, 72),
    ) {
        let (nodes, bonds) = block(&shake);
        let mut spec = stretched(&nodes, &bonds);
        spec.test.strain_step = 0.002;
        let (_, record) = run(&spec);
        let forces = record.column("force_n");
        assert_same(&forces, &record.column("force_bottom_jaw_n"))?;
        // nothing breaks, so the jaw's work is in the bonds; the trapezoidal rule is off by
        // F'' h²/12 per unit length, here with F'' of some tens of newtons
        let work: f64 = forces.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).sum::<f64>();
        let jaws = jaw_distance(&nodes) * 0.002;
        let stored = record.column("stored_energy_n_mm");
        let last = stored.last().copied().unwrap_or(0.0);
        prop_assert!((work * jaws - last).abs() < 1e-4 * last.max(1.0), "{} {last}", work * jaws);
    }
}

fn jaw_distance(nodes: &Nodes) -> f64 {
    let mean = |wanted: Jaw| {
        let held: Vec<f64> = nodes
            .iter()
            .filter(|(_, jaw)| *jaw == wanted)
            .map(|(place, _)| place[1])
            .collect();
        held.iter().sum::<f64>() / held.len() as f64
    };
    mean(Jaw::Top) - mean(Jaw::Bottom)
}
