//! Motion: frequencies, energy, and one rest for all schemes.
use super::sections::{clamped_sides, forces, isotropic, papers, plain, uniform};
use crate::error::CompositeError;
use crate::lattice::{BondPattern, BondStiffness, Geometry, Lattice, PaperRule};
use crate::load::LoadPlace;
use crate::measure::{face_mean_mm, point_mm};
use crate::motion::{Damping, Motion, MotionOptions, Rest, Scheme, critical_time_step_s};
use crate::section::{Division, Section};
use crate::solve::{StaticOptions, equilibrium};
use crate::supports::{Face, FaceSupport, Supports};

/// What all ways to rest must agree to.
const ONE_ANSWER: f64 = 1e-3;

fn options(scheme: Scheme, geometry: Geometry) -> MotionOptions {
    MotionOptions {
        scheme,
        geometry,
        time_step_s: None,
        damping: Damping::Kinetic,
    }
}

fn papers_lattice(section: &Section, cells: [usize; 2]) -> Lattice {
    let layout = section.layout(Division::Uniform { cells }).unwrap();
    let rule = PaperRule {
        stiffness: BondStiffness::PWave,
        pattern: BondPattern::Cross,
    };
    Lattice::paper(section, &layout, rule).unwrap()
}

/// Largest difference of displacements over the largest displacement.
fn difference(found: &[f64], expected: &[f64]) -> f64 {
    let size = expected.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    let apart = found.iter().zip(expected).map(|(a, b)| (a - b).abs());
    apart.fold(0.0_f64, f64::max) / size
}

/// Half the time between the first and the third passage through 0 of a released tip.
fn period(lattice: &Lattice, supports: &Supports, start: &[f64], tip: usize) -> f64 {
    let load = vec![0.0; lattice.displacements()];
    let mut motion = Motion::new(
        lattice,
        supports,
        &load,
        MotionOptions {
            damping: Damping::None,
            ..options(Scheme::Verlet, Geometry::Linear)
        },
    )
    .unwrap();
    motion.displace(start);
    let first = motion.elastic_energy_n_mm();
    let mut passages = Vec::new();
    let mut last = motion.displacements_mm()[tip];
    while passages.len() < 3 {
        motion.advance().unwrap();
        let now = motion.displacements_mm()[tip];
        if now * last < 0.0 {
            passages.push(motion.time_s() - motion.time_step_s() * now / (now - last));
        }
        last = now;
    }
    // Elastic energy at a step and kinetic half a step before: together within a few per mille of
    // what was put in, whatever the number of steps.
    let energy = motion.elastic_energy_n_mm() + motion.kinetic_energy_n_mm();
    assert!((energy / first - 1.0).abs() < 0.02, "{energy} {first}");
    passages[2] - passages[0]
}

#[test]
fn a_rod_vibrates_along_itself_at_the_speed_of_sound() {
    let (e, density, length) = (1_000.0, 1_200.0, 20.0);
    let lattice = uniform(&plain([length, 1.0], isotropic(e, 0.0), 0.0), [40, 2]);
    let grid = lattice.grid();
    let supports = Supports::of_faces(grid, &[(Face::Left, FaceSupport::Clamped)]).unwrap();
    let shape: Vec<f64> = (0..grid.particles())
        .flat_map(|particle| {
            let [x, _] = grid.place_mm(particle);
            [1e-3 * (std::f64::consts::FRAC_PI_2 * x / length).sin(), 0.0]
        })
        .collect();
    let found = period(&lattice, &supports, &shape, 2 * grid.particle(40, 1));
    // mm/s from N/mm² and t/mm³.
    let speed = (e / (density * 1e-12)).sqrt();
    let exact = 4.0 * length / speed;
    assert!((found / exact - 1.0).abs() < 1e-3, "{found} {exact}");
}

#[test]
fn a_cantilever_vibrates_as_a_beam() {
    let (e, density, length, height) = (1_000.0, 1_200.0, 20.0, 1.0);
    let lattice = uniform(&plain([length, height], isotropic(e, 0.3), 0.0), [40, 2]);
    let grid = lattice.grid();
    let supports = Supports::of_faces(grid, &[(Face::Left, FaceSupport::Clamped)]).unwrap();
    // Its weight bends a cantilever nearly as its first vibration does.
    let load = forces(&lattice, [0.0, -1e-3], LoadPlace::Body);
    let bent = equilibrium(&lattice, &supports, &load, &StaticOptions::default()).unwrap();
    let tip = 2 * grid.particle(40, 1) + 1;
    let found = period(&lattice, &supports, &bent.displacements_mm, tip);
    let area_density = density * 1e-12 * height;
    let bending = e * height.powi(3) / 12.0;
    let beam = std::f64::consts::TAU * length.powi(2) / 1.875_104_f64.powi(2)
        * (area_density / bending).sqrt();
    // Shear and rotary inertia, which the beam formula leaves out, make it 0.5 % slower.
    assert!((found / beam - 1.005).abs() < 0.006, "{found} {beam}");
}

#[test]
fn every_scheme_comes_to_the_rest_of_the_static_solution() {
    let section = papers(0.0);
    for lattice in [uniform(&section, [6, 6]), papers_lattice(&section, [6, 6])] {
        let supports = clamped_sides(&lattice);
        let load = forces(&lattice, [0.0, -10.0], LoadPlace::Face(Face::Top));
        for geometry in [Geometry::Linear, Geometry::Large] {
            let expected = equilibrium(
                &lattice,
                &supports,
                &load,
                &StaticOptions {
                    geometry,
                    ..StaticOptions::default()
                },
            )
            .unwrap();
            for scheme in [
                Scheme::Verlet,
                Scheme::Pbd { iterations: 4 },
                Scheme::Xpbd { iterations: 4 },
            ] {
                let mut motion =
                    Motion::new(&lattice, &supports, &load, options(scheme, geometry)).unwrap();
                let rest = motion.settle(Rest::default()).unwrap();
                let apart = difference(&rest.displacements_mm, &expected.displacements_mm);
                assert!(apart < ONE_ANSWER, "{scheme:?} {geometry:?} {apart}");
                assert!(rest.reaction_error < 1e-5);
            }
        }
    }
}

#[test]
fn rest_depends_on_neither_time_step_nor_iterations() {
    let section = papers(90.0);
    for lattice in [uniform(&section, [5, 5]), papers_lattice(&section, [5, 5])] {
        let supports = clamped_sides(&lattice);
        let load = forces(&lattice, [0.0, -10.0], LoadPlace::Face(Face::Top));
        let expected = equilibrium(&lattice, &supports, &load, &StaticOptions::default()).unwrap();
        let critical = critical_time_step_s(&lattice, &supports);
        for (scheme, share) in [
            (Scheme::Verlet, 0.3),
            (Scheme::Verlet, 1.0),
            (Scheme::Pbd { iterations: 1 }, 0.3),
            (Scheme::Pbd { iterations: 1 }, 1.0),
            (Scheme::Pbd { iterations: 8 }, 0.3),
            (Scheme::Pbd { iterations: 8 }, 1.0),
            (Scheme::Xpbd { iterations: 1 }, 1.0),
            (Scheme::Xpbd { iterations: 8 }, 1.0),
            (Scheme::Xpbd { iterations: 8 }, 10.0),
            (Scheme::Xpbd { iterations: 50 }, 100.0),
        ] {
            let mut motion = Motion::new(
                &lattice,
                &supports,
                &load,
                MotionOptions {
                    time_step_s: Some(share * critical),
                    ..options(scheme, Geometry::Linear)
                },
            )
            .unwrap();
            let rest = motion.settle(Rest::default()).unwrap();
            let apart = difference(&rest.displacements_mm, &expected.displacements_mm);
            assert!(apart < ONE_ANSWER, "{scheme:?} {share} {apart}");
        }
    }
}

/// A single bond: (7) is exact whatever τ and n, even far beyond the stable step of springs.
#[test]
fn a_single_bond_relaxed_by_half_displacements_is_its_spring() {
    let section = plain([1.0, 1.0], isotropic(85.0, 0.3), 0.0);
    let full = papers_lattice(&section, [1, 1]);
    let mut lattice = full.clone();
    // Only the lower edge is left.
    lattice.keep_bonds(|bond| bond.particles == [0, 1]);
    let mut supports = Supports::none(lattice.grid());
    for displacement in [0, 1, 3, 4, 5, 6, 7] {
        supports
            .hold(lattice.grid(), displacement / 2, displacement % 2, 0.0)
            .unwrap();
    }
    let mut load = vec![0.0; 8];
    load[2] = 0.01;
    let stiffness = lattice.bonds()[0].stiffness_n_per_mm;
    for (iterations, share) in [(1, 0.2), (1, 3.0), (5, 0.2), (5, 3.0), (40, 30.0)] {
        let critical = critical_time_step_s(&lattice, &supports);
        let mut motion = Motion::new(
            &lattice,
            &supports,
            &load,
            MotionOptions {
                time_step_s: Some(share * critical),
                damping: Damping::Viscous {
                    per_s: 1.0 / critical,
                },
                ..options(Scheme::Pbd { iterations }, Geometry::Large)
            },
        )
        .unwrap();
        for _ in 0..2_000 {
            motion.advance().unwrap();
        }
        let stretch = motion.displacements_mm()[2];
        assert!(
            (stretch * stiffness / 0.01 - 1.0).abs() < 1e-9,
            "{iterations} {share}"
        );
    }
}

/// To the letter the paper's method is off by an error that falls with the square of τ.
#[test]
fn the_papers_shifts_approach_the_springs_with_the_square_of_the_time_step() {
    let section = plain([70.0, 70.0], isotropic(85.0, 0.3), 0.0);
    let lattice = papers_lattice(&section, [4, 4]);
    let supports = clamped_sides(&lattice);
    let load = forces(&lattice, [0.0, -10.0], LoadPlace::Face(Face::Top));
    let expected = equilibrium(&lattice, &supports, &load, &StaticOptions::default()).unwrap();
    let critical = critical_time_step_s(&lattice, &supports);
    let error = |share: f64| {
        let mut motion = Motion::new(
            &lattice,
            &supports,
            &load,
            MotionOptions {
                time_step_s: Some(share * critical),
                ..options(Scheme::Pbd { iterations: 2 }, Geometry::Linear)
            },
        )
        .unwrap();
        for _ in 0..(4_000.0 / share) as u32 {
            motion.advance().unwrap();
        }
        difference(motion.displacements_mm(), &expected.displacements_mm)
    };
    let errors = [0.4, 0.2, 0.1].map(error);
    assert!(
        errors[0] > 1e-3,
        "the letter alone is not the answer: {errors:?}"
    );
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.6..2.4).contains(&order), "{errors:?}");
    }
}

#[test]
fn a_time_step_beyond_the_stable_one_is_refused() {
    let lattice = uniform(&papers(0.0), [4, 4]);
    let supports = clamped_sides(&lattice);
    let load = forces(&lattice, [0.0, -10.0], LoadPlace::Face(Face::Top));
    let critical = critical_time_step_s(&lattice, &supports);
    let motion = |time_step_s| {
        Motion::new(
            &lattice,
            &supports,
            &load,
            MotionOptions {
                time_step_s: Some(time_step_s),
                ..options(Scheme::Verlet, Geometry::Linear)
            },
        )
    };
    assert!(matches!(
        motion(1.01 * critical),
        Err(CompositeError::UnstableTimeStep { .. })
    ));
    assert!(motion(critical).is_ok());
    assert!(motion(f64::NAN).is_err());
}

#[test]
fn viscous_damping_leads_to_the_same_rest() {
    let lattice = uniform(&plain([4.0, 4.0], isotropic(85.0, 0.3), 0.0), [4, 4]);
    let supports = clamped_sides(&lattice);
    let load = forces(&lattice, [0.0, -1.0], LoadPlace::Face(Face::Top));
    let expected = equilibrium(&lattice, &supports, &load, &StaticOptions::default()).unwrap();
    let critical = critical_time_step_s(&lattice, &supports);
    let mut motion = Motion::new(
        &lattice,
        &supports,
        &load,
        MotionOptions {
            damping: Damping::Viscous {
                per_s: 0.3 / critical,
            },
            ..options(Scheme::Verlet, Geometry::Linear)
        },
    )
    .unwrap();
    let rest = motion.settle(Rest::default()).unwrap();
    assert!(difference(&rest.displacements_mm, &expected.displacements_mm) < ONE_ANSWER);
    let means = [&rest, &expected]
        .map(|rest| face_mean_mm(lattice.grid(), Face::Top, &rest.displacements_mm)[1]);
    assert!((means[0] / means[1] - 1.0).abs() < ONE_ANSWER);
    assert!(point_mm(lattice.grid(), [2.0, 4.0], &rest.displacements_mm).unwrap()[1] < 0.0);
}

#[test]
fn a_motion_that_turns_a_cell_inside_out_says_where_and_when() {
    let lattice = papers_lattice(&plain([4.0, 4.0], isotropic(85.0, 0.3), 0.0), [4, 4]);
    let supports = clamped_sides(&lattice);
    let load = forces(&lattice, [0.0, -2_000.0], LoadPlace::Point([2.0, 4.0]));
    let mut motion = Motion::new(
        &lattice,
        &supports,
        &load,
        options(Scheme::Pbd { iterations: 4 }, Geometry::Large),
    )
    .unwrap();
    let error = motion.settle(Rest::default()).unwrap_err();
    let CompositeError::Inverted { row, step, .. } = error else {
        panic!("{error}");
    };
    assert!(step > 0 && row > 0);
}

#[test]
fn a_step_is_that_of_the_forces_of_all_cells_on_any_number_of_threads() {
    let lattice = uniform(&papers(0.0), [21, 39]);
    let supports = clamped_sides(&lattice);
    let load = forces(&lattice, [0.0, -10.0], LoadPlace::Face(Face::Top));
    let start: Vec<f64> = (0..lattice.displacements())
        .map(|place| 0.01 * (place as f64 * 0.7).sin())
        .collect();
    for geometry in [Geometry::Linear, Geometry::Large] {
        let moved = |threads: usize| {
            let undamped = MotionOptions {
                damping: Damping::None,
                ..options(Scheme::Verlet, geometry)
            };
            let mut motion = Motion::new(&lattice, &supports, &load, undamped).unwrap();
            motion.share(threads).unwrap();
            motion.displace(&start);
            motion.advance().unwrap();
            let first = motion.displacements_mm().to_vec();
            for _ in 0..20 {
                motion.advance().unwrap();
            }
            (motion.time_step_s(), first, motion.state())
        };
        let (step, first, alone) = moved(1);
        for threads in [2, 3] {
            assert_eq!(moved(threads).2, alone, "{threads} threads");
        }
        // from rest: u + τ² F / 2m
        let mut at_start = supports.displacements();
        for (place, value) in at_start.iter_mut().enumerate() {
            if !supports.is_held(place) {
                *value = start[place];
            }
        }
        let mut held = vec![0.0; at_start.len()];
        lattice.forces(geometry, &at_start, &mut held);
        for (place, now) in first.iter().enumerate() {
            let push = 0.5 * step * step / lattice.masses_t()[place / 2];
            let shift = push * (load[place] - held[place]);
            let shift = if supports.is_held(place) { 0.0 } else { shift };
            let expected = at_start[place] + shift;
            let size = expected.abs().max(shift.abs()).max(1e-6);
            assert!((now - expected).abs() < 1e-13 * size, "{now} {expected}");
        }
    }
}
