//! How long motion takes to come to rest, foreseen from the slowest vibration that a load excites.
use super::sections::{clamped_sides, forces, isotropic, papers, plain, uniform};
use crate::lattice::{Geometry, Lattice};
use crate::load::LoadPlace;
use crate::motion::{Damping, Motion, MotionOptions, Rest, Scheme, lowest_frequency_per_s};
use crate::solve::{StaticOptions, equilibrium};
use crate::supports::{Face, FaceSupport, Supports};

fn held_left(lattice: &Lattice) -> Supports {
    Supports::of_faces(lattice.grid(), &[(Face::Left, FaceSupport::Clamped)]).unwrap()
}

#[test]
fn a_load_excites_the_vibration_that_lies_along_it() {
    let (e, density, length, height) = (1_000.0, 1_200.0, 20.0, 1.0);
    let lattice = uniform(&plain([length, height], isotropic(e, 0.0), 0.0), [40, 2]);
    let supports = held_left(&lattice);
    let lowest = |force| {
        let load = forces(&lattice, force, LoadPlace::Body);
        lowest_frequency_per_s(&lattice, &supports, &load).unwrap()
    };
    // mm/s from N/mm² and t/mm³
    let speed = (e / (density * 1e-12_f64)).sqrt();
    let rod = std::f64::consts::FRAC_PI_2 * speed / length;
    let found = lowest([1.0, 0.0]).unwrap();
    assert!((found / rod - 1.0).abs() < 2e-3, "{found} {rod}");
    // h / √12 is the radius of gyration; shear and rotary inertia take 0.5 %
    let beam = 1.875_104_f64.powi(2) * speed * height / 12.0_f64.sqrt() / (length * length);
    let found = lowest([0.0, 1.0]).unwrap();
    assert!((found / beam - 0.995).abs() < 6e-3, "{found} {beam}");
    assert_eq!(lowest([0.0, 0.0]), None);
}

#[test]
fn the_steps_to_rest_are_foreseen_and_the_rest_is_that_of_the_static_solution() {
    let clamped = |cells| {
        let lattice = uniform(&papers(0.0), cells);
        let supports = clamped_sides(&lattice);
        (lattice, supports)
    };
    let slender = {
        let lattice = uniform(&plain([16.0, 4.0], isotropic(1_000.0, 0.3), 0.0), [16, 4]);
        let supports = held_left(&lattice);
        (lattice, supports)
    };
    for (lattice, supports) in [clamped([6, 6]), clamped([16, 16]), slender] {
        let load = forces(&lattice, [0.0, -1.0], LoadPlace::Face(Face::Top));
        let expected = equilibrium(&lattice, &supports, &load, &StaticOptions::default()).unwrap();
        let options = MotionOptions {
            scheme: Scheme::Verlet,
            geometry: Geometry::Linear,
            time_step_s: None,
            damping: Damping::Critical,
        };
        let mut motion = Motion::new(&lattice, &supports, &load, options).unwrap();
        let until = Rest::default();
        let foreseen = motion.steps_to_rest(until.residual).unwrap();
        let rest = motion.settle(until).unwrap();
        let taken = motion.steps() as f64 / foreseen;
        assert!((0.6..1.2).contains(&taken), "{taken} of {foreseen}");
        let size = expected
            .displacements_mm
            .iter()
            .fold(0.0_f64, |a, b| a.max(b.abs()));
        let pairs = rest.displacements_mm.iter().zip(&expected.displacements_mm);
        let apart = pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
        assert!(apart < 1e-3 * size, "{apart} of {size}");
    }
}
