//! Large rotations against closed forms and published numbers.
use super::*;

/// A square beam of unit width without Poisson contraction, as benchmarks have it.
fn square(youngs_modulus_gpa: f64) -> BeamSection {
    BeamSection {
        area_um2: 1.0,
        inertia_um4: 1.0 / 12.0,
        polar_um4: 1.0 / 6.0,
        youngs_modulus_gpa,
        shear_modulus_gpa: 0.5 * youngs_modulus_gpa,
        shear_coefficient: 5.0 / 6.0,
        strength_gpa: None,
        width_um: 1.0,
        line_density_ug_per_um: 1e-6,
        yielding: None,
    }
}

fn benchmark(points: Vec<[f64; 3]>, section: BeamSection, segment_um: Option<f64>) -> Network {
    let fibre = FrameFibre {
        centre_line_um: points,
        section,
    };
    let model = FrameModel {
        segment_um,
        ..model(Level::Beam, 1e6)
    };
    Network::new(&[fibre], &[], model).unwrap()
}

#[test]
fn an_end_moment_rolls_a_cantilever_to_half_a_circle() {
    // M = π E I/L; with ten segments ten equal sides on an arc. Stiff against twist, which is not asked.
    // Beyond half a circle a moment of fixed axis tips the beam out of the plane, and Newton goes with it
    let length = 50.0;
    let section = BeamSection {
        polar_um4: 10.0,
        ..square(1.0e4)
    };
    let network = benchmark(vec![[0.0; 3], [length, 0.0, 0.0]], section, Some(5.0));
    let flexural = section.youngs_modulus_gpa * section.inertia_um4;
    let tip = network.nodes() - 1;
    for (share, steps, cosine) in [(0.25, 4, 0.0_f64), (0.5, 8, -1.0)] {
        let moment = share * 2.0 * std::f64::consts::PI * flexural / length;
        let load = NodeLoad {
            node: tip,
            force_mn: [0.0; 3],
            moment_mn_um: [0.0, 0.0, moment],
        };
        let rest = network.rest_at_large(0.0, &[load], steps).unwrap();
        // sides of 5 turn by 36 degrees each, the first by half of it against x
        let turn: f64 = share * std::f64::consts::PI / 5.0;
        let (mut x, mut y) = (0.0, 0.0);
        for side in 0..10 {
            let angle = turn * (f64::from(side) + 0.5);
            x += 5.0 * angle.cos();
            y += 5.0 * angle.sin();
        }
        let [ux, uy, uz] = rest.displacement_um[tip];
        for (found, expected) in [(length + ux, x), (uy, y), (uz, 0.0)] {
            assert!((found - expected).abs() < 1e-6, "{found} {expected}");
        }
        close(
            rest.energy_nj,
            0.5 * moment * moment * length / flexural,
            1e-7,
        );
        // the end has turned by 2 π share
        let [_, _, angle] = rest.rotation[tip];
        assert!((angle.cos() - cosine).abs() < 1e-6);
    }
}

#[test]
fn a_bend_of_45_degrees_moves_as_bathe_and_bolourchi() {
    // [BatheBolourchi1979]: radius 100, E = 1e7, force 600 across; tip at (15.9, 47.2, 53.4)
    let section = square(1.0e7);
    let points: Vec<[f64; 3]> = (0..=8)
        .map(|i| {
            let angle = std::f64::consts::FRAC_PI_4 * f64::from(i) / 8.0;
            [100.0 * (1.0 - angle.cos()), 100.0 * angle.sin(), 0.0]
        })
        .collect();
    let network = benchmark(points, section, None);
    let load = NodeLoad {
        node: 8,
        force_mn: [0.0, 0.0, 600.0],
        moment_mn_um: [0.0; 3],
    };
    let rest = network.rest_at_large(0.0, &[load], 6).unwrap();
    let [x, y, z] = rest.displacement_um[8];
    // readings of published solutions with eight elements differ by 0.2
    for (found, published) in [(x, -13.4), (y, -23.5), (z, 53.4)] {
        assert!((found - published).abs() < 0.25, "{found} {published}");
    }
}

#[test]
fn small_loads_give_what_small_displacements_do() {
    let arms = fibre(&[[0.0; 3], [80.0, 0.0, 0.0], [80.0, 50.0, 20.0]]);
    let across = fibre(&[[80.0, 25.0, 40.0], [60.0, 25.0, 10.0]]);
    let bonds = [bond([0, 1], [100.0, 5.0])];
    let network = Network::new(&[arms, across], &bonds, model(Level::Beam, 1e6)).unwrap();
    let tip = network.nodes() - 1;
    let load = NodeLoad {
        node: tip,
        force_mn: [1e-6, -2e-6, 3e-6],
        moment_mn_um: [0.0, 1e-5, 1e-5],
    };
    let small = network.rest(0.0, &[load]).unwrap();
    let large = network.rest_at_large(0.0, &[load], 1).unwrap();
    for node in 0..network.nodes() {
        let scale = small.displacement_um[tip][2].abs();
        for axis in 0..3 {
            let differ = small.displacement_um[node][axis] - large.displacement_um[node][axis];
            assert!(differ.abs() < 1e-5 * scale, "{differ} {scale}");
        }
    }
    close(large.energy_nj, small.energy_nj, 1e-5);
}

#[test]
fn turning_everything_with_its_load_turns_the_answer() {
    // a cantilever along x and one along another direction
    let turn = nalgebra::UnitQuaternion::from_scaled_axis(nalgebra::Vector3::new(0.3, -0.5, 0.8));
    let points = [[0.0, 0.0, 0.0], [40.0, 0.0, 0.0], [70.0, 30.0, 20.0]];
    let turned = |point: [f64; 3]| -> [f64; 3] { (turn * nalgebra::Vector3::from(point)).into() };
    let force = [1.0, -50.0, 80.0];
    let rest = |points: Vec<[f64; 3]>, force_mn: [f64; 3]| {
        let network = benchmark(points, tube(), Some(8.0));
        let tip = network.nodes() - 1;
        let load = NodeLoad {
            node: tip,
            force_mn,
            moment_mn_um: [0.0; 3],
        };
        let rest = network.rest_at_large(0.0, &[load], 3).unwrap();
        (rest.displacement_um[tip], rest.energy_nj)
    };
    let (straight, energy) = rest(points.to_vec(), force);
    let (found, other) = rest(points.map(turned).to_vec(), turned(force));
    assert!(straight[2].abs() > 5.0, "rotations are large: {straight:?}");
    for (found, expected) in found.into_iter().zip(turned(straight)) {
        assert!((found - expected).abs() < 1e-6, "{found} {expected}");
    }
    close(other, energy, 1e-7);
}

#[test]
fn a_kinked_bar_straightens_and_then_pulls() {
    // sides of √(50² + 30²): straight at an elongation of 16.619, and a spring beyond
    let kinked = fibre(&[[0.0; 3], [50.0, 30.0, 0.0], [100.0, 0.0, 0.0]]);
    let network = Network::new(&[kinked], &[], model(Level::Truss, 100.0)).unwrap();
    let straight = 2.0 * f64::hypot(50.0, 30.0);
    let rest = network.rest_at_large(20.0, &[], 40).unwrap();
    let axial = tube().youngs_modulus_gpa * tube().area_um2;
    close(
        rest.jaw_force_mn[1],
        axial * (120.0 - straight) / straight,
        1e-6,
    );
}

#[test]
fn joints_break_in_order_at_large_motions_too() {
    let mut fibres = Vec::new();
    let mut bonds = Vec::new();
    for (row, strength) in [2.0, 3.0, 1.0].into_iter().enumerate() {
        let y = 100.0 * row as f64;
        fibres.push(fibre(&[[0.0, y, 0.0], [60.0, y, 0.0]]));
        fibres.push(fibre(&[[40.0, y, 0.0], [100.0, y, 0.0]]));
        bonds.push(FrameBond {
            shear_strength_mn: Some(strength),
            ..bond([2 * row as u32, 2 * row as u32 + 1], [50.0, 10.0])
        });
    }
    let axial = tube().youngs_modulus_gpa * tube().area_um2;
    let stiffness = 1.0 / (100.0 / axial + 1.0 / (0.01 * 400.0));
    let test = LargePullTest {
        until: PullTest {
            max_strain: 0.1,
            stop_force_fraction: 0.0,
            break_precision: 0.0,
        },
        strain_step: 0.002,
    };
    let network = Network::new(&fibres, &bonds, model(Level::Beam, 100.0)).unwrap();
    let mut pull = LargePull::new(&network, test).unwrap();
    let mut events = Vec::new();
    let end = loop {
        match pull.advance().unwrap() {
            LargeStep::Broke(event) => events.push(event),
            LargeStep::Reached { force_mn, .. } => assert!(force_mn > 0.0),
            LargeStep::Ended(end) => break end,
        }
    };
    assert_eq!(end, PullEnd::Parted);
    let order: Vec<Broken> = events.iter().map(|event| event.broken).collect();
    assert_eq!(order, [Broken::Bond(2), Broken::Bond(0), Broken::Bond(1)]);
    for (index, event) in events.iter().enumerate() {
        close(event.elongation_um, (index + 1) as f64 / stiffness, 1e-6);
        assert_eq!(event.avalanche, index as u32 + 1);
    }
}
