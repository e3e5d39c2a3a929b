//! One material, layers, and relations that hold for every geometry.
use super::*;
use crate::homogenise::cells::{PlaneCells, ShearCells};
use crate::homogenise::phase::{Cut, strains_turned};
use crate::homogenise::spectrum::Spectrum;
use crate::homogenise::torus::{Field, Torus};

/// Round-off of a few thousand pixels.
const ROUND_OFF: f64 = 1e-10;

/// Of faces that cut pixels, on the grids taken here; it falls with the size of pixels.
const FACES: f64 = 4e-3;

#[test]
fn a_cell_of_one_material_gives_it_back() {
    for material in [ply(), epoxy()] {
        let effective = scattered(material, material).effective([20, 24]).unwrap();
        let expected = rows(&space(&material));
        assert!(difference(&effective, &expected) < ROUND_OFF);
        // E₁ of the ply is given, not found
        if material == ply() {
            let given = [
                140_000.0, 10_000.0, 9_000.0, 0.30, 0.25, 0.45, 5_000.0, 4_000.0, 3_300.0,
            ];
            for (value, given) in effective.constants.values().into_iter().zip(given) {
                assert!((value / given - 1.0).abs() < ROUND_OFF, "{value} {given}");
            }
        }
    }
}

#[test]
fn the_spectrum_undoes_the_forces_of_a_uniform_body() {
    // even and odd numbers of pixels, oblong ones, and a material with nine constants
    for grid in [[8, 6], [9, 7], [10, 5]] {
        let torus = Torus {
            grid,
            sides_mm: [0.3, 0.5],
        };
        let kinds = vec![0; torus.nodes()];
        let mut field: Field = (0..torus.nodes())
            .map(|node| [((node * node) % 11) as f64, ((3 * node + 1) % 7) as f64])
            .collect();
        for unknown in 0..2 {
            let mean = field.iter().map(|u| u[unknown]).sum::<f64>() / torus.nodes() as f64;
            field.iter_mut().for_each(|u| u[unknown] -= mean);
        }
        let undone = |cells: &dyn Fn(&Field, &mut Field)| {
            let mut back = field.clone();
            cells(&field, &mut back);
            back.iter()
                .zip(&field)
                .map(|(a, b)| (a[0] - b[0]).abs().max((a[1] - b[1]).abs()))
                .fold(0.0, f64::max)
        };
        let plane = PlaneCells::new(&[space(&ply())], torus.sides_mm, |_| 1.0);
        let shear = ShearCells::new(&[space(&ply())], torus.sides_mm, |_| 1.0);
        let worst = [
            undone(&|field, back| {
                let mut forces = field.clone();
                torus.forces(&plane, &kinds, field, &mut forces);
                Spectrum::new(&torus, &plane, 0).solve(&forces, back);
            }),
            undone(&|field, back| {
                let mut forces = field.clone();
                torus.forces(&shear, &kinds, field, &mut forces);
                Spectrum::new(&torus, &shear, 0).solve(&forces, back);
            }),
        ];
        assert!(
            worst.iter().all(|worst| *worst < 1e-11),
            "{grid:?} {worst:?}"
        );
    }
}

#[test]
fn layers_are_the_exact_laminate_though_faces_cut_pixels() {
    // 0.43 of fibre between z = 0.2 and 0.63 of the height: both faces within pixels of 1/10
    let phases = [space(&epoxy()), space(&ply())];
    let (low, high): (f64, f64) = (2.0, 6.3);
    for turned in [false, true] {
        let normal = if turned { [1.0, 0.0] } else { [0.0, 1.0] };
        let grid = if turned { [10, 6] } else { [6, 10] };
        let pixels = Pixels::of_cuts(grid, [0.1, 0.13], phases, |pixel| {
            let along = if turned { pixel % 10 } else { pixel / 6 } as f64;
            Cut {
                fibre_share: (high.min(along + 1.0) - low.max(along)).clamp(0.0, 1.0),
                normal,
            }
        });
        let effective = Effective::of(pixels, 0.43, Vec::new()).unwrap();
        let laminate = Cut {
            fibre_share: 0.43,
            normal,
        }
        .stiffness(&phases[0], &phases[1]);
        assert!(difference(&effective, &rows(&laminate)) < 1e-9);
        // by hand: 1/C₃₃ = ⟨1/C₃₃⟩ of isotropic layers, and ⟨G₁₂⟩ along them
        let place = if turned { 1 } else { 2 };
        let across = 1.0 / (0.57 / phases[0][(place, place)] + 0.43 / phases[1][(place, place)]);
        let along = if turned { 4 } else { 5 };
        let shear = 0.57 * phases[0][(along, along)] + 0.43 * phases[1][(along, along)];
        assert!((effective.stiffness[place][place] / across - 1.0).abs() < 1e-9);
        assert!((effective.stiffness[along][along] / shear - 1.0).abs() < 1e-9);
    }
}

#[test]
fn a_slanted_laminate_is_the_straight_one_turned() {
    // ply and normal turned together by an angle whose cosine is 3/5
    let normal = [0.6, 0.8];
    let phases = [space(&epoxy()), space(&glass())];
    let cut = |normal| Cut {
        fibre_share: 0.3,
        normal,
    };
    let straight = cut([1.0, 0.0]).stiffness(&phases[0], &phases[1]);
    let slanted = cut(normal).stiffness(&phases[0], &phases[1]);
    let turn = strains_turned(normal);
    let expected = turn.transpose() * straight * turn;
    assert!((slanted - expected).amax() < 1e-12 * expected.amax());
}

#[test]
fn phases_of_equal_shear_modulus_have_hills_bulk_modulus() {
    // [Hill1964]: 1/(k* + G) = ⟨1/(k + G)⟩ whatever the geometry, and G₂₃* = G, G₁₂* = G.
    let shear = 1_000.0;
    let of = |nu: f64| isotropic(2.0 * shear * (1.0 + nu), nu);
    let (matrix, fibre) = (of(0.45), of(0.05));
    let cell = scattered(matrix, fibre);
    let effective = cell.effective([40; 2]).unwrap();
    let bulk = |nu: f64| shear / (1.0 - 2.0 * nu);
    let f = cell.fraction();
    let exact = 1.0 / ((1.0 - f) / (bulk(0.45) + shear) + f / (bulk(0.05) + shear)) - shear;
    let c = effective.stiffness;
    let found = 0.25 * (c[1][1] + c[2][2] + 2.0 * c[1][2]);
    assert!((found / exact - 1.0).abs() < FACES, "{found} {exact}");
    assert!((c[3][3] / shear - 1.0).abs() < FACES);
    assert!((c[4][4] / shear - 1.0).abs() < ROUND_OFF);
    assert!((c[5][5] / shear - 1.0).abs() < ROUND_OFF);
}

#[test]
fn phases_that_change_places_obey_kellers_theorem() {
    // [Keller1964] for a cell without axes of symmetry [Mendelson1975]: with the matrix G* of γ₁₂
    // and γ₁₃, det G*(a in b) det G*(b in a) = (a b)²; G = E/(2 (1 + ν)) is 1 and 10
    let (a, b) = (isotropic(2.5, 0.25), isotropic(25.0, 0.25));
    let misses = [[24; 2], [48; 2]].map(|grid| {
        let determinant = |cell: UnitCell| {
            let c = cell.effective(grid).unwrap().stiffness;
            c[4][4] * c[5][5] - c[4][5] * c[5][4]
        };
        let product = determinant(scattered(a, b)) * determinant(scattered(b, a));
        (product / 100.0 - 1.0).abs()
    });
    assert!(
        misses[1] < FACES && misses[1] < 0.7 * misses[0],
        "{misses:?}"
    );
}

#[test]
fn stretch_along_the_fibres_follows_hills_relations() {
    // [Hill1964]: E₁ - ⟨E⟩ and ν₁₂ - ⟨ν⟩ follow from k* in a composite isotropic across the fibres,
    // which a hexagonal array is.
    let cell = UnitCell::hexagonal(epoxy(), glass(), 0.5, 0.01).unwrap();
    let effective = cell.effective([32, 56]).unwrap();
    let (e_m, nu_m, e_f, nu_f) = (3_000.0, 0.35, 70_000.0, 0.22);
    let bulk = |e: f64, nu: f64| e / (2.0 * (1.0 + nu) * (1.0 - 2.0 * nu));
    let (k_m, k_f) = (bulk(e_m, nu_m), bulk(e_f, nu_f));
    let c = effective.stiffness;
    let k = 0.25 * (c[1][1] + c[2][2] + 2.0 * c[1][2]);
    let pressure = 0.5 / k_m + 0.5 / k_f - 1.0 / k;
    let ratio = (nu_f - nu_m) / (1.0 / k_f - 1.0 / k_m);
    let e1 = 0.5 * (e_m + e_f) + 4.0 * ratio * ratio * pressure;
    let nu12 = 0.5 * (nu_m + nu_f) - ratio * pressure;
    // the relations hold on the grid as in the limit: cut pixels are laminates, which obey them
    let found = effective.constants.e1_mpa;
    assert!((found / e1 - 1.0).abs() < 1e-6, "{found} {e1}");
    // (C₁₂ + C₁₃)/2 = 2 k ν₁₂
    let found = (c[0][1] + c[0][2]) / (4.0 * k);
    assert!((found / nu12 - 1.0).abs() < 1e-6, "{found} {nu12}");
}

#[test]
fn the_stiffness_is_symmetric_positive_and_balanced() {
    let effective = scattered(epoxy(), ply()).effective([40; 2]).unwrap();
    let c = effective.matrix();
    assert!(c == c.transpose());
    assert!(c.symmetric_eigenvalues().min() > 0.0);
    assert!(effective.residual < 1e-7, "{}", effective.residual);
    // pulled across: the mean of the pixels' stresses is the stress asked for
    let asked = [0.0, 1.0, 0.0, 0.0, 0.5, 0.0];
    let fields = effective.fields(&Load::Stress(asked)).unwrap();
    for place in 0..6 {
        let mean: f64 = fields.iter().map(|s| s[place]).sum::<f64>() / fields.len() as f64;
        assert!((mean - asked[place]).abs() < 1e-6, "{place}: {mean}");
    }
}

#[test]
fn a_cell_turned_by_a_right_angle_has_2_and_3_changed() {
    let cell = scattered(epoxy(), glass());
    let mut turned = cell.clone();
    turned.size_mm.reverse();
    for fibre in &mut turned.fibres {
        fibre.centre_mm = [0.020 - fibre.centre_mm[1], fibre.centre_mm[0]];
    }
    let (first, second) = (
        cell.effective([32, 40]).unwrap().constants,
        turned.effective([40, 32]).unwrap().constants,
    );
    for (a, b) in [
        (first.e1_mpa, second.e1_mpa),
        (first.e2_mpa, second.e3_mpa),
        (first.e3_mpa, second.e2_mpa),
        (first.nu12, second.nu13),
        (first.g12_mpa, second.g13_mpa),
        (first.g23_mpa, second.g23_mpa),
        (first.nu23 / first.e2_mpa, second.nu23 / second.e2_mpa),
    ] {
        assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
    }
}

#[test]
fn a_shift_by_whole_pixels_changes_nothing() {
    let cell = scattered(epoxy(), glass());
    let mut shifted = cell.clone();
    for fibre in &mut shifted.fibres {
        // 7 and 13 of 32 pixels, out of the cell and in again
        fibre.centre_mm[0] += 0.020 * 7.0 / 32.0;
        fibre.centre_mm[1] -= 0.020 * 13.0 / 32.0;
    }
    let (first, second) = (
        cell.effective([32; 2]).unwrap(),
        shifted.effective([32; 2]).unwrap(),
    );
    assert!(difference(&first, &second.stiffness) < 1e-10);
}

#[test]
fn bad_cells_are_refused_by_name() {
    let refused = |cell: UnitCell| cell.effective([16; 2]).unwrap_err().to_string();
    let mut cell = scattered(epoxy(), glass());
    cell.fibres[2].centre_mm = [0.0001, 0.0005];
    let text = refused(cell);
    assert!(
        text.contains("fibres 0 and 2") && text.contains("overlap"),
        "{text}"
    );
    let mut cell = scattered(epoxy(), glass());
    cell.fibres.truncate(1);
    cell.fibres[0].diameter_mm = 0.021;
    assert!(refused(cell).contains("fibres 0 and 0"));
    let mut cell = scattered(epoxy(), glass());
    cell.fibres[1].diameter_mm = f64::NAN;
    assert!(refused(cell).contains("diameter"));
    let cell = scattered(epoxy(), isotropic(1.0, 0.5));
    assert!(refused(cell).contains("Poisson"));
    let cell = scattered(epoxy(), glass());
    assert!(cell.effective([16, 3]).is_err() && cell.effective([16, 5_000]).is_err());
    assert!(
        cell.refined([18, 16])
            .unwrap_err()
            .to_string()
            .contains("multiple of 4")
    );
    assert!(UnitCell::square(epoxy(), glass(), 0.79, 1.0).is_err());
    assert!(UnitCell::hexagonal(epoxy(), glass(), f64::NAN, 1.0).is_err());
}

#[test]
fn a_cell_without_fibres_is_matrix() {
    let mut cell = scattered(epoxy(), glass());
    cell.fibres.clear();
    let effective = cell.effective([8; 2]).unwrap();
    assert!(difference(&effective, &rows(&space(&epoxy()))) < ROUND_OFF);
}
