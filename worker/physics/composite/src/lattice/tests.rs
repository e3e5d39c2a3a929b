//! Energies against their derivatives, the cell against the springs it is made of.
use super::cell::{ALONG_X, ALONG_Y, Cell, CellMatrix, HOURGLASS};
use super::*;
use crate::material::{Material, Orthotropic, PlaneState};
use crate::section::Grid;
use crate::stiffness::turned;

fn orthotropic(e1: f64, e2: f64, nu12: f64, g12: f64) -> Stiffness {
    let constants = Orthotropic {
        modulus_1_mpa: e1,
        modulus_2_mpa: e2,
        poisson_ratio_12: nu12,
        shear_modulus_12_mpa: Some(g12),
        modulus_3_mpa: None,
        poisson_ratio_13: None,
        poisson_ratio_23: None,
        shear_modulus_13_mpa: None,
        shear_modulus_23_mpa: None,
    };
    let material = Material::Orthotropic(constants);
    material.stiffness(PlaneState::Stress).unwrap().0
}

fn cell(stiffness: Stiffness, sides: [f64; 2], thickness: f64) -> Cell {
    Cell {
        sides,
        volume: sides[0] * sides[1] * thickness,
        stiffness,
        hourglass: cell::hourglass(&stiffness, sides, thickness),
        bars: None,
    }
}

/// Some displacements without any symmetry, of about `size`.
fn shaken(size: f64) -> Corners {
    let mut u = [0.0; 8];
    for (place, value) in u.iter_mut().enumerate() {
        *value = size * (1.7 + 2.3 * place as f64 + (place * place) as f64).sin();
    }
    u
}

/// Numerical derivatives of forces against the tangent, and of the energy against the forces.
fn derivatives_agree(cell: &Cell, u: &Corners) {
    let h = 1e-6;
    let (_, forces) = cell.large_forces(u);
    let matrix = cell.large_matrix(u, true);
    let scale = matrix.iter().flatten().fold(0.0_f64, |a, b| a.max(b.abs()));
    for place in 0..8 {
        let moved = |by: f64| {
            let mut moved = *u;
            moved[place] += by;
            cell.large_forces(&moved)
        };
        let (above, below) = (moved(h), moved(-h));
        let slope = (above.0 - below.0) / (2.0 * h);
        assert!(
            (slope - forces[place]).abs() < 1e-6 * scale,
            "force {place}"
        );
        for (row, entries) in matrix.iter().enumerate() {
            let slope = (above.1[row] - below.1[row]) / (2.0 * h);
            assert!(
                (slope - entries[place]).abs() < 1e-7 * scale,
                "tangent {row} {place}: {slope} {}",
                entries[place]
            );
        }
    }
}

#[test]
fn forces_and_tangent_of_the_large_cell_are_derivatives_of_its_energy() {
    for angle in [0.0, 20.0, 75.0] {
        let stiffness = turned(&orthotropic(11_500.0, 6_430.0, 0.28, 3_555.2), angle);
        let cell = cell(stiffness, [1.3, 0.7], 2.0);
        derivatives_agree(&cell, &shaken(0.02));
        derivatives_agree(&cell, &shaken(0.2));
    }
}

#[test]
fn a_rigid_motion_of_any_size_gives_no_force() {
    let stiffness = turned(&orthotropic(230_000.0, 6_430.0, 0.28, 3_555.2), 33.0);
    let cell = cell(stiffness, [1.3, 0.7], 2.0);
    for angle in (0..24).map(|step| f64::from(step) * 15.0_f64.to_radians()) {
        let (s, c) = angle.sin_cos();
        let mut u = [0.0; 8];
        for (corner, [x, y]) in [[0.0, 0.0], [1.3, 0.0], [1.3, 0.7], [0.0, 0.7]]
            .into_iter()
            .enumerate()
        {
            u[2 * corner] = c * x - s * y - x + 5.0;
            u[2 * corner + 1] = s * x + c * y - y - 3.0;
        }
        let (energy, forces) = cell.large_forces(&u);
        assert!(energy < 1e-20, "{energy}");
        assert!(forces.iter().all(|force| force.abs() < 1e-8));
        // A bond between the opposite corners knows no rotation either.
        let bond = Bond {
            particles: [0, 1],
            stiffness_n_per_mm: 11_500.0,
            vector_mm: [1.3, 0.7],
        };
        let (stretch, _) = bond.large_stretch(&[u[0], u[1], u[4], u[5]]);
        assert!(stretch.abs() < 1e-14);
    }
}

#[test]
fn small_displacements_of_the_large_cell_are_those_of_the_linear_one() {
    let stiffness = turned(&orthotropic(11_500.0, 6_430.0, 0.28, 3_555.2), 33.0);
    let cell = cell(stiffness, [1.3, 0.7], 2.0);
    let u = shaken(1e-7);
    let (linear_energy, linear) = cell.linear_forces(&u);
    let (energy, large) = cell.large_forces(&u);
    let size = linear.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    for (a, b) in linear.iter().zip(&large) {
        assert!((a - b).abs() < 1e-5 * size);
    }
    assert!((energy - linear_energy).abs() < 1e-5 * energy);
    let (tangent, matrix) = (cell.large_matrix(&[0.0; 8], true), cell.linear_matrix());
    for (a, b) in tangent.iter().flatten().zip(matrix.iter().flatten()) {
        assert!((a - b).abs() < 1e-9);
    }
}

#[test]
fn the_linear_matrix_gives_the_linear_forces() {
    let stiffness = turned(&orthotropic(11_500.0, 6_430.0, 0.28, 3_555.2), 33.0);
    let cell = cell(stiffness, [1.3, 0.7], 2.0);
    let u = shaken(0.1);
    let (energy, forces) = cell.linear_forces(&u);
    let mut work = 0.0;
    for (row, force) in cell.linear_matrix().iter().zip(&forces) {
        let product: f64 = row.iter().zip(&u).map(|(k, u)| k * u).sum();
        assert!((product - force).abs() < 1e-9 * force.abs().max(1.0));
    }
    for (force, u) in forces.iter().zip(&u) {
        work += 0.5 * force * u;
    }
    assert!((work - energy).abs() < 1e-12 * energy);
}

/// Adds k d dᵀ of a spring between two corners of a cell.
fn add_spring(matrix: &mut CellMatrix, [from, to]: [usize; 2], k: f64, d: [f64; 2]) {
    for (row, row_sign) in [(from, -1.0), (to, 1.0)] {
        for (column, column_sign) in [(from, -1.0), (to, 1.0)] {
            for i in 0..2 {
                for j in 0..2 {
                    matrix[2 * row + i][2 * column + j] += row_sign * column_sign * k * d[i] * d[j];
                }
            }
        }
    }
}

/// Equivalence of section 4 of the theory: edge springs k₁ₓ and k₁ᵧ (half of each belongs to the
/// cell), diagonals k₂, the area term κ and the hourglass correction make the exact cell.
#[test]
fn an_aligned_square_cell_is_the_lattice_of_springs_with_area_and_hourglass_terms() {
    let (pitch, t) = (0.7, 2.0);
    for c in [
        orthotropic(11_500.0, 6_430.0, 0.28, 3_555.2),
        orthotropic(85.0, 85.0, 0.3, 85.0 / 2.6),
        orthotropic(85.0, 85.0, 1.0 / 3.0, 85.0 * 3.0 / 8.0),
        orthotropic(230_000.0, 6_430.0, -0.2, 500.0),
    ] {
        let k1x = t * (c[(0, 0)] - c[(0, 1)]);
        let k1y = t * (c[(1, 1)] - c[(0, 1)]);
        let k2 = t * c[(2, 2)];
        let area = t * (c[(0, 1)] - c[(2, 2)]);
        let mut springs = [[0.0; 8]; 8];
        for edge in [[0, 1], [3, 2]] {
            add_spring(&mut springs, edge, k1x / 2.0, [1.0, 0.0]);
        }
        for edge in [[0, 3], [1, 2]] {
            add_spring(&mut springs, edge, k1y / 2.0, [0.0, 1.0]);
        }
        let half = std::f64::consts::FRAC_1_SQRT_2;
        add_spring(&mut springs, [0, 2], k2, [half, half]);
        add_spring(&mut springs, [1, 3], k2, [-half, half]);
        // κ e², e = ε_xx + ε_yy at the cell's centre, over the cell's area.
        let mut dilatation = [0.0; 8];
        for corner in 0..4 {
            dilatation[2 * corner] = ALONG_X[corner] / (2.0 * pitch);
            dilatation[2 * corner + 1] = ALONG_Y[corner] / (2.0 * pitch);
        }
        let ex = t * (c[(0, 0)] - c[(0, 1)] * c[(0, 1)] / c[(1, 1)]);
        let ey = t * (c[(1, 1)] - c[(0, 1)] * c[(0, 1)] / c[(0, 0)]);
        for row in 0..8 {
            for column in 0..8 {
                springs[row][column] += area * pitch * pitch * dilatation[row] * dilatation[column];
                let h = HOURGLASS[row / 2] * HOURGLASS[column / 2];
                match [row % 2, column % 2] {
                    [0, 0] => springs[row][column] += (ex / 12.0 - k1x / 4.0) * h,
                    [1, 1] => springs[row][column] += (ey / 12.0 - k1y / 4.0) * h,
                    _ => {}
                }
            }
        }
        let exact = cell(c, [pitch, pitch], t).linear_matrix();
        let scale = c.amax();
        for (a, b) in exact.iter().flatten().zip(springs.iter().flatten()) {
            assert!((a - b).abs() < 1e-12 * scale, "{a} {b}");
        }
    }
}

/// The assumed-stress rectangle with five stress parameters, worked out by quadrature:
/// K = Gᵀ H⁻¹ G with H = ∫ Pᵀ S P, G = ∫ Pᵀ B, P = [1 0 0 η 0; 0 1 0 0 ξ; 0 0 1 0 0].
#[test]
fn a_rectangular_cell_is_the_assumed_stress_element_at_any_angle() {
    use nalgebra::SMatrix;
    let (a, b, t) = (1.3, 0.4, 2.0);
    for angle in [0.0, 20.0, 45.0, 70.0] {
        let c = turned(&orthotropic(11_500.0, 643.0, 0.28, 355.0), angle);
        let s = c.try_inverse().unwrap();
        let mut h = SMatrix::<f64, 5, 5>::zeros();
        let mut g = SMatrix::<f64, 5, 8>::zeros();
        let gauss = 1.0 / 3.0_f64.sqrt();
        for (xi, eta) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            let (xi, eta) = (xi * gauss, eta * gauss);
            let weight = t * a * b / 4.0;
            let mut p = SMatrix::<f64, 3, 5>::zeros();
            p[(0, 0)] = 1.0;
            p[(1, 1)] = 1.0;
            p[(2, 2)] = 1.0;
            p[(0, 3)] = eta;
            p[(1, 4)] = xi;
            let mut strain = SMatrix::<f64, 3, 8>::zeros();
            for corner in 0..4 {
                let (sx, sy) = (ALONG_X[corner], ALONG_Y[corner]);
                let dx = sx * (1.0 + sy * eta) / 4.0 * 2.0 / a;
                let dy = sy * (1.0 + sx * xi) / 4.0 * 2.0 / b;
                strain[(0, 2 * corner)] = dx;
                strain[(1, 2 * corner + 1)] = dy;
                strain[(2, 2 * corner)] = dy;
                strain[(2, 2 * corner + 1)] = dx;
            }
            h += p.transpose() * s * p * weight;
            g += p.transpose() * strain * weight;
        }
        let element = g.transpose() * h.try_inverse().unwrap() * g;
        let exact = cell(c, [a, b], t).linear_matrix();
        for row in 0..8 {
            for column in 0..8 {
                let difference = exact[row][column] - element[(row, column)];
                assert!(
                    difference.abs() < 1e-10 * c.amax(),
                    "{angle} {row} {column}"
                );
            }
        }
    }
}

#[test]
fn bond_forces_balance_what_the_cells_exert() {
    let grid = Grid::of_lines(vec![0.0, 1.3], vec![0.0, 0.7]).unwrap();
    let stiffness = turned(&orthotropic(11_500.0, 6_430.0, 0.28, 3_555.2), 20.0);
    let lattice = Lattice {
        hourglass: vec![cell::hourglass(&stiffness, [1.3, 0.7], 2.0)],
        bars: Vec::new(),
        stiffness: vec![stiffness],
        thickness_mm: 2.0,
        bonds: Vec::new(),
        masses_t: vec![1.0; 4],
        grid,
    };
    // Particles by rows: the corners' order with the last two swapped.
    let corners = shaken(0.1);
    let mut u = corners;
    u[4..6].copy_from_slice(&corners[6..8]);
    u[6..8].copy_from_slice(&corners[4..6]);
    let mut forces = [0.0; 8];
    lattice.forces(Geometry::Linear, &u, &mut forces);
    let bonds = lattice.cell_bonds(Geometry::Linear, 0, &u).unwrap();
    let length = 1.3_f64.hypot(0.7);
    let (c, s) = (1.3 / length, 0.7 / length);
    let expected = [
        [
            -bonds.bottom - bonds.rising * c,
            -bonds.left - bonds.rising * s,
        ],
        [
            bonds.bottom + bonds.falling * c,
            -bonds.right - bonds.falling * s,
        ],
        [
            -bonds.top - bonds.falling * c,
            bonds.left + bonds.falling * s,
        ],
        [bonds.top + bonds.rising * c, bonds.right + bonds.rising * s],
    ];
    for (particle, expected) in expected.into_iter().enumerate() {
        for axis in 0..2 {
            let difference = forces[2 * particle + axis] - expected[axis];
            assert!(difference.abs() < 1e-9, "{particle} {axis} {difference}");
        }
    }
    // In the lattice of nu = 1/3 they are the springs' own elongations times their stiffness.
    let c = orthotropic(85.0, 85.0, 1.0 / 3.0, 85.0 * 3.0 / 8.0);
    let square = Lattice {
        hourglass: vec![[0.0; 2]],
        stiffness: vec![c],
        grid: Grid::of_lines(vec![0.0, 1.0], vec![0.0, 1.0]).unwrap(),
        ..lattice
    };
    let (exx, eyy, gxy) = (1e-3, -4e-4, 7e-4);
    let uniform = [0.0, 0.0, exx, 0.0, gxy, eyy, exx + gxy, eyy];
    let bonds = square.cell_bonds(Geometry::Linear, 0, &uniform).unwrap();
    let (k1, k2) = (2.0 * 85.0 * 3.0 / 4.0, 2.0 * 85.0 * 3.0 / 8.0);
    assert!((bonds.bottom - 0.5 * k1 * exx).abs() < 1e-12);
    assert!((bonds.right - 0.5 * k1 * eyy).abs() < 1e-12);
    let stretch = std::f64::consts::SQRT_2 * 0.5 * (exx + eyy + gxy);
    assert!((bonds.rising - k2 * stretch).abs() < 1e-12);
}

/// Bars against their own arithmetic: each line's ends in the bilinear field of the corners, its elongation,
/// and the energy of many of them side by side.
#[test]
fn bars_stretch_as_their_ends_in_the_field_of_the_corners_do() {
    let ([a, b], t, axis) = ([1.3, 0.7], 2.0, [0.6, 0.8]);
    let (modulus, lines) = (9_000.0, 4_000);
    let corners = shaken(0.01);
    let at = |p: [f64; 2], part: usize| -> f64 {
        (0..4)
            .map(|k| {
                let x = 0.5 * (1.0 + ALONG_X[k] * 2.0 * p[0] / a);
                let y = 0.5 * (1.0 + ALONG_Y[k] * 2.0 * p[1] / b);
                x * y * corners[2 * k + part]
            })
            .sum()
    };
    // from the lower to the upper edge, at places 0.05 to 0.25 of the middle of the cell
    let (mut energy, mut moments) = (0.0, [0.0; 3]);
    for line in 0..lines {
        let middle = [0.05 + 0.2 * (f64::from(line) + 0.5) / f64::from(lines), 0.0];
        let length = b / axis[1];
        let end = |sign: f64| [0, 1].map(|k| middle[k] + sign * 0.5 * length * axis[k]);
        let (from, to) = (end(-1.0), end(1.0));
        let longer: f64 = (0..2)
            .map(|part| axis[part] * (at(to, part) - at(from, part)))
            .sum();
        // across the fibre lines are nearer than along x
        let area = length * 0.2 * axis[1] / f64::from(lines);
        energy += 0.5 * modulus * t * area * (longer / length).powi(2);
        let g = (axis[0] * middle[1] + axis[1] * middle[0]) / (a * b);
        for (power, moment) in moments.iter_mut().enumerate() {
            *moment += modulus * area * g.powi(power as i32);
        }
    }
    let stiffness = {
        let along = nalgebra::Vector3::from(strain_along(axis));
        along * along.transpose() * (moments[0] / (a * b))
    };
    let cell = Cell {
        hourglass: [0.0; 2],
        bars: Some(CellBars {
            axis,
            stiffness: [t * moments[1], t * moments[2]],
        }),
        ..cell(Stiffness::identity(), [a, b], t)
    };
    let cell = Cell { stiffness, ..cell };
    let (stored, _) = cell.linear_forces(&corners);
    assert!((stored / energy - 1.0).abs() < 1e-9, "{stored} {energy}");
    // forces and matrix are the derivatives of that energy
    let plain = Cell {
        stiffness: stiffness + orthotropic(85.0, 85.0, 0.3, 32.0),
        hourglass: [4.0, 5.0],
        ..cell
    };
    derivatives_agree(&plain, &shaken(0.05));
    let (_, forces) = plain.linear_forces(&corners);
    for (row, force) in plain.linear_matrix().iter().zip(forces) {
        let product: f64 = row.iter().zip(&corners).map(|(k, u)| k * u).sum();
        assert!((product - force).abs() < 1e-9 * force.abs().max(1.0));
    }
}
