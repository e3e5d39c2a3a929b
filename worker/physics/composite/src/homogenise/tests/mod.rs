//! Unit cells against what is known of them exactly.
mod arrays;
mod damage;
mod exact;
mod random;

use super::pixels::Pixels;
use super::*;
use crate::material::Orthotropic;

fn isotropic(youngs_modulus_mpa: f64, poisson_ratio: f64) -> Material {
    Material::Isotropic {
        youngs_modulus_mpa,
        poisson_ratio,
    }
}

/// Glass of 70 GPa in epoxy of 3 GPa.
fn glass() -> Material {
    isotropic(70_000.0, 0.22)
}

fn epoxy() -> Material {
    isotropic(3_000.0, 0.35)
}

/// Nine constants, none like another.
fn ply() -> Material {
    Material::Orthotropic(Orthotropic {
        modulus_1_mpa: 140_000.0,
        modulus_2_mpa: 10_000.0,
        poisson_ratio_12: 0.30,
        shear_modulus_12_mpa: Some(5_000.0),
        modulus_3_mpa: Some(9_000.0),
        poisson_ratio_13: Some(0.25),
        poisson_ratio_23: Some(0.45),
        shear_modulus_13_mpa: Some(4_000.0),
        shear_modulus_23_mpa: Some(3_300.0),
    })
}

fn space(material: &Material) -> Space {
    material.stiffness_of_space().unwrap().0
}

/// Largest difference of two stiffnesses over the larger stiffness of the strains it belongs to.
fn difference(a: &Effective, b: &[[f64; 6]; 6]) -> f64 {
    let mut largest = 0.0_f64;
    for i in 0..6 {
        for j in 0..6 {
            let scale = (b[i][i] * b[j][j]).sqrt();
            largest = largest.max((a.stiffness[i][j] - b[i][j]).abs() / scale);
        }
    }
    largest
}

fn rows(space: &Space) -> [[f64; 6]; 6] {
    [0, 1, 2, 3, 4, 5].map(|i| [0, 1, 2, 3, 4, 5].map(|j| space[(i, j)]))
}

/// Four fibres at places without any symmetry.
fn scattered(matrix: Material, fibre: Material) -> UnitCell {
    let fibre_at = |y: f64, z: f64, diameter_mm: f64| RoundFibre {
        centre_mm: [y, z],
        diameter_mm,
    };
    UnitCell {
        size_mm: [0.020, 0.020],
        matrix,
        fibre,
        fibres: vec![
            fibre_at(0.0030, 0.0040, 0.007),
            fibre_at(0.0110, 0.0050, 0.006),
            fibre_at(0.0190, 0.0125, 0.008),
            fibre_at(0.0085, 0.0140, 0.007),
        ],
    }
}
