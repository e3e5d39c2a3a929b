//! Uniform strain and rigid motion: exact for every material at every angle.
use super::sections::{isotropic, orthotropic, plain, uniform};
use crate::lattice::{Geometry, Lattice};
use crate::section::{Division, Grid, Section};
use crate::solve::{StaticOptions, equilibrium};
use crate::supports::{Face, Supports};

/// Round-off of a solution with stiffnesses that differ a thousandfold.
const EXACT: f64 = 1e-10;

/// Holds the whole boundary at u = G x + ½ of nothing: a uniform strain.
fn held_boundary(grid: &Grid, gradient: [[f64; 2]; 2]) -> Supports {
    let mut supports = Supports::none(grid);
    for face in Face::ALL {
        for line in 0..face.lines_mm(grid).len() {
            let particle = face.particle(grid, line);
            let [x, y] = grid.place_mm(particle);
            for (axis, [by_x, by_y]) in gradient.iter().enumerate() {
                let value = by_x * x + by_y * y;
                supports.hold(grid, particle, axis, value).unwrap();
            }
        }
    }
    supports
}

fn uneven(section: &Section) -> Lattice {
    let mut layout = section.layout(Division::Uniform { cells: [1, 1] }).unwrap();
    layout.grid = Grid::of_lines(
        vec![0.0, 1.0, 1.3, 4.0, 4.2, 7.0],
        vec![0.0, 0.2, 2.0, 2.1, 5.0],
    )
    .unwrap();
    layout.stiffness = vec![layout.stiffness[0]; layout.grid.cells()];
    layout.density = vec![layout.density[0]; layout.grid.cells()];
    Lattice::exact(&layout)
}

#[test]
fn every_material_at_every_angle_is_exact_in_uniform_strain() {
    let gradient = [[1e-3, 4e-4], [-2e-4, -7e-4]];
    let strain = [1e-3, -7e-4, 2e-4];
    for material in [
        isotropic(85.0, 0.3),
        isotropic(85.0, -0.5),
        isotropic(85.0, 0.49),
        orthotropic(11_500.0, 6_430.0, 0.28, None),
        orthotropic(230_000.0, 230.0, 0.3, Some(90.0)),
        orthotropic(230.0, 230_000.0, 1e-4, Some(90_000.0)),
    ] {
        for angle in (0..=12).map(|step| f64::from(step) * 15.0) {
            let section = plain([7.0, 5.0], material, angle);
            for lattice in [uniform(&section, [6, 5]), uneven(&section)] {
                let grid = lattice.grid();
                let supports = held_boundary(grid, gradient);
                let load = vec![0.0; lattice.displacements()];
                let rest =
                    equilibrium(&lattice, &supports, &load, &StaticOptions::default()).unwrap();
                for particle in 0..grid.particles() {
                    let [x, y] = grid.place_mm(particle);
                    for (axis, [by_x, by_y]) in gradient.iter().enumerate() {
                        let expected = by_x * x + by_y * y;
                        let found = rest.displacements_mm[2 * particle + axis];
                        assert!(
                            (found - expected).abs() < EXACT * 7e-3,
                            "{angle} {material:?}"
                        );
                    }
                }
                // Stress and energy are C ε and ½ ε C ε times the volume.
                let section_stiffness =
                    crate::stiffness::turned(&material.stiffness(section.state).unwrap().0, angle);
                let mut energy = 0.0;
                for row in 0..3 {
                    let expected: f64 = (0..3)
                        .map(|column| section_stiffness[(row, column)] * strain[column])
                        .sum();
                    energy += 0.5 * strain[row] * expected * 35.0;
                    let found = lattice
                        .stress(Geometry::Linear, 7, &rest.displacements_mm)
                        .unwrap()[row];
                    assert!((found - expected).abs() < EXACT * section_stiffness.amax() * 1e-3);
                }
                assert!((rest.energy_n_mm - energy).abs() < EXACT * energy);
                assert!(rest.reaction_error < EXACT);
            }
        }
    }
}

#[test]
fn a_rigid_rotation_of_a_whole_section_needs_no_force() {
    let section = plain(
        [7.0, 5.0],
        orthotropic(230_000.0, 230.0, 0.3, Some(90.0)),
        25.0,
    );
    let lattice = uneven(&section);
    for angle in (0..24).map(|step| f64::from(step) * 15.0_f64.to_radians()) {
        let (s, c) = angle.sin_cos();
        let u: Vec<f64> = (0..lattice.grid().particles())
            .flat_map(|particle| {
                let [x, y] = lattice.grid().place_mm(particle);
                [c * x - s * y - x, s * x + c * y - y]
            })
            .collect();
        let mut forces = vec![0.0; u.len()];
        let energy = lattice.forces(Geometry::Large, &u, &mut forces);
        assert!(energy < 1e-18);
        assert!(
            forces.iter().all(|force| force.abs() < 1e-7),
            "of 230 000 N/mm²"
        );
        assert_eq!(lattice.inverted_cell(&u), None);
    }
}

#[test]
fn large_uniform_stretch_is_uniform_and_its_energy_that_of_the_stretch() {
    let section = plain([7.0, 5.0], isotropic(85.0, 0.3), 0.0);
    let lattice = uneven(&section);
    let gradient = [[0.2, 0.5], [-0.3, -0.1]];
    let supports = held_boundary(lattice.grid(), gradient);
    let load = vec![0.0; lattice.displacements()];
    let options = StaticOptions {
        geometry: Geometry::Large,
        ..StaticOptions::default()
    };
    let rest = equilibrium(&lattice, &supports, &load, &options).unwrap();
    for particle in 0..lattice.grid().particles() {
        let [x, y] = lattice.grid().place_mm(particle);
        for (axis, [by_x, by_y]) in gradient.iter().enumerate() {
            let expected = by_x * x + by_y * y;
            let found = rest.displacements_mm[2 * particle + axis];
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        }
    }
    // Stretch U = √(FᵀF) by its closed form in two dimensions: (C + √det C) / √(tr C + 2 √det C).
    let f = nalgebra::Matrix2::<f64>::new(1.2, 0.5, -0.3, 0.9);
    let c = f.transpose() * f;
    let root = c.determinant().sqrt();
    let u = (c + nalgebra::Matrix2::identity() * root) / (c.trace() + 2.0 * root).sqrt();
    let e = nalgebra::Vector3::new(u[(0, 0)] - 1.0, u[(1, 1)] - 1.0, 2.0 * u[(0, 1)]);
    let stiffness = isotropic(85.0, 0.3).stiffness(section.state).unwrap().0;
    let energy = 0.5 * 35.0 * e.dot(&(stiffness * e));
    assert!((rest.energy_n_mm - energy).abs() < 1e-9 * energy);
}
