//! Jaw forces against a second solution that shares no code with the engine: Newton's method with
//! the full Hessian as a dense matrix, on positions instead of displacements.
mod scene;

use loadframe_api::spec::nonwoven_tensile::{Bond, Jaw, NetworkBond, NonwovenTensile, Solver};
use nalgebra::{DMatrix, DVector, Vector3};
use rand::RngExt;
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use scene::{bond, explicit, run, solver};

/// Agreement at `force_accuracy` 1e10: forces are balanced to 1e-10 of a bond's.
const TIGHT: f64 = 1e-10;
/// Agreement when both are as exact as doubles allow; what is left is rounding of some hundred
/// bond forces.
const TIGHTEST: f64 = 1e-12;

struct Bar {
    ends: [usize; 2],
    rest_length: f64,
    modulus: f64,
    friction_modulus: f64,
    compression_stiffness: f64,
}

/// A rough block of 4 x 6 x 2 nodes, braced in all planes; bonds differ in modulus, and their rest
/// lengths from the distance by up to 5 %, so that the block is stressed before the test.
fn block(seed: u64) -> (Vec<([f64; 3], Jaw)>, Vec<Bar>) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut nodes = Vec::new();
    for k in 0..2 {
        for j in 0..6 {
            for i in 0..4 {
                let jaw = match j {
                    0 => Jaw::Bottom,
                    5 => Jaw::Top,
                    _ => Jaw::Free,
                };
                let place = [i, j, k].map(|index| f64::from(index) * 10.0);
                let shake = if jaw == Jaw::Free { 4.0 } else { 0.0 };
                let shaken = place.map(|x| x + shake * (random.random::<f64>() - 0.5));
                nodes.push((shaken, jaw));
            }
        }
    }
    let mut bars = Vec::new();
    for first in 0..nodes.len() {
        for second in first + 1..nodes.len() {
            let span = Vector3::from(nodes[second].0) - Vector3::from(nodes[first].0);
            let is_held = nodes[first].1 != Jaw::Free && nodes[second].1 != Jaw::Free;
            if span.norm() < 16.0 && !is_held {
                bars.push(Bar {
                    ends: [first, second],
                    rest_length: span.norm() * (0.95 + 0.1 * random.random::<f64>()),
                    modulus: 0.3 + 0.2 * random.random::<f64>(),
                    friction_modulus: 2.0 * random.random::<f64>(),
                    compression_stiffness: 0.1 + 0.2 * random.random::<f64>(),
                });
            }
        }
    }
    (nodes, bars)
}

fn spec(nodes: &[([f64; 3], Jaw)], bars: &[Bar]) -> NonwovenTensile {
    let bonds = bars.iter().map(|bar| NetworkBond {
        rest_length_mm: Some(bar.rest_length),
        modulus_n: Some(bar.modulus),
        friction_modulus_n: Some(bar.friction_modulus),
        compression_stiffness_n: Some(bar.compression_stiffness),
        ..bond(bar.ends[0] as u32, bar.ends[1] as u32)
    });
    let mut spec = explicit(nodes, bonds.collect(), Bond::default());
    (spec.test.strain_step, spec.test.max_strain) = (0.02, 0.3);
    spec
}

/// Tension and the two stiffnesses T'/l₀ and T/l at a strain.
fn response(bar: &Bar, length: f64) -> (f64, f64, f64) {
    let strain = length / bar.rest_length - 1.0;
    let (tension, slope) = if strain > 0.0 {
        (
            bar.modulus * strain + bar.friction_modulus * strain.powi(2),
            bar.modulus + 2.0 * bar.friction_modulus * strain,
        )
    } else {
        (
            bar.compression_stiffness * strain,
            bar.compression_stiffness,
        )
    };
    (tension, slope / bar.rest_length, tension / length)
}

/// Forces on the top jaw at each strain, and how many bars are compressed at the last.
fn dense_solution(nodes: &[([f64; 3], Jaw)], bars: &[Bar], strains: &[f64]) -> (Vec<f64>, usize) {
    let gauge_length = 50.0;
    let mut places: Vec<Vector3<f64>> = nodes.iter().map(|(place, _)| (*place).into()).collect();
    let free: Vec<usize> = (0..nodes.len())
        .filter(|n| nodes[*n].1 == Jaw::Free)
        .collect();
    let mut row = vec![None; nodes.len()];
    for (index, node) in free.iter().enumerate() {
        row[*node] = Some(3 * index);
    }
    let mut forces = Vec::new();
    let mut last = 0.0;
    for strain in strains {
        for (place, (initial, jaw)) in places.iter_mut().zip(nodes) {
            match jaw {
                Jaw::Top => place.y = initial[1] + strain * gauge_length,
                Jaw::Free => place.y += (strain - last) * initial[1],
                Jaw::Bottom => {}
            }
        }
        last = *strain;
        for _ in 0..60 {
            let mut resultant = DVector::zeros(3 * free.len());
            let mut hessian = DMatrix::zeros(3 * free.len(), 3 * free.len());
            for bar in bars {
                let [i, j] = bar.ends;
                let span = places[j] - places[i];
                let length = span.norm();
                let (tension, axial, transverse) = response(bar, length);
                let n = span / length;
                let along = n * n.transpose();
                let stiffness =
                    along * axial + (nalgebra::Matrix3::identity() - along) * transverse;
                for (node, sign) in [(i, 1.0), (j, -1.0)] {
                    let Some(at) = row[node] else { continue };
                    let mut part = resultant.fixed_rows_mut::<3>(at);
                    part += n * (sign * tension);
                    for (other, other_sign) in [(i, 1.0), (j, -1.0)] {
                        let Some(beside) = row[other] else { continue };
                        let mut block = hessian.fixed_view_mut::<3, 3>(at, beside);
                        block += stiffness * (sign * other_sign);
                    }
                }
            }
            let step = hessian.lu().solve(&resultant).expect("the block is braced");
            for (index, node) in free.iter().enumerate() {
                places[*node] += step.fixed_rows::<3>(3 * index);
            }
            if step.amax() < 1e-14 {
                break;
            }
        }
        let pull = bars.iter().map(|bar| {
            let [i, j] = bar.ends;
            let span = places[j] - places[i];
            let (tension, _, _) = response(bar, span.norm());
            let along_y = tension * span.y / span.norm();
            match (nodes[i].1, nodes[j].1) {
                (_, Jaw::Top) => along_y,
                (Jaw::Top, _) => -along_y,
                _ => 0.0,
            }
        });
        forces.push(pull.sum());
    }
    let is_compressed =
        |bar: &&Bar| (places[bar.ends[1]] - places[bar.ends[0]]).norm() < bar.rest_length;
    (forces, bars.iter().filter(is_compressed).count())
}

#[test]
fn jaw_forces_agree_with_a_dense_solution() {
    for seed in 1..=5 {
        let (nodes, bars) = block(seed);
        let mut spec = spec(&nodes, &bars);
        for (accuracy, tolerance) in [(1e10, TIGHT), (1e15, TIGHTEST)] {
            spec.accuracy = solver(Solver::NewtonCg, accuracy);
            let (report, record) = run(&spec);
            assert!(report.quality["unconverged_steps"].ok);
            let strains = record.column("nominal_strain");
            let (expected, compressed) = dense_solution(&nodes, &bars, &strains);
            assert!(compressed > 20, "only {compressed} bars are compressed");
            let scale = expected
                .iter()
                .fold(0.0_f64, |scale, force| scale.max(force.abs()));
            for jaw in ["force_n", "force_bottom_jaw_n"] {
                for (found, expected) in record.column(jaw).iter().zip(&expected) {
                    let difference = (found - expected).abs();
                    assert!(difference <= tolerance * scale, "{jaw}: {found} {expected}");
                }
            }
        }
    }
}

#[test]
fn relaxations_find_the_same_equilibrium() {
    let (nodes, bars) = block(1);
    let mut spec = spec(&nodes, &bars);
    for method in [Solver::Sequential, Solver::Parallel] {
        spec.accuracy = solver(method, 1e10);
        let (report, record) = run(&spec);
        assert!(report.quality["unconverged_steps"].ok);
        let (expected, _) = dense_solution(&nodes, &bars, &record.column("nominal_strain"));
        for (found, expected) in record.column("force_n").iter().zip(&expected) {
            // a small block has no long waves to hide errors in, but some: two digits fewer
            assert!((found - expected).abs() <= 100.0 * TIGHT * expected.abs().max(1.0));
        }
    }
}
