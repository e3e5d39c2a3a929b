//! Cells against what is known of them.
use super::*;

fn isotropic(youngs_modulus_mpa: f64, poisson_ratio: f64) -> Material {
    Material::Isotropic {
        youngs_modulus_mpa,
        poisson_ratio,
    }
}

#[test]
fn experiment() {
    let shear = |e: f64, nu: f64| e / (2.0 * (1.0 + nu));
    let list: Vec<[f64; 2]> = vec![
        [1.0, 1.0],
        [1.0, 0.3],
        [1.0, 0.1],
        [1.0, 0.01],
        [0.1, 0.1],
        [0.3, 0.3],
    ];
    for (contrast, fraction) in [(24.0, 0.5), (0.01, 0.5), (1000.0, 0.5)] {
        let cell = UnitCell::square(
            isotropic(1.0, 0.35),
            isotropic(contrast, 0.2),
            fraction,
            0.007,
        )
        .unwrap();
        let k = shear(contrast, 0.2) / shear(1.0, 0.35);
        let t = (1.0 + 1.0) * 0.0 + (1.0 + k) / (1.0 - k);
        let f = fraction;
        let exact = 1.0
            - 2.0 * f
                / (t + f
                    - 0.305827 * f.powi(4) * t / (t * t - 1.402958 * f.powi(8))
                    - 0.013362 * f.powi(8) / t);
        for &h in &list {
            print!("contrast {contrast} h {h:?}:");
            for n in [32, 64, 128] {
                let (phases, notes) = cell.checked([n; 2]).unwrap();
                let e = Effective::with_hourglass(Pixels::new(&cell, [n; 2], phases), f, notes, h)
                    .unwrap();
                let c = e.constants;
                print!(
                    "  [{n}] G12 err {:+.2e} E2 {:.6} G23 {:.6} nu23 {:.5} it {}",
                    c.g12_mpa / shear(1.0, 0.35) / exact - 1.0,
                    c.e2_mpa,
                    c.g23_mpa,
                    c.nu23,
                    e.iterations
                );
            }
            println!();
        }
    }
}
use super::pixels::Pixels;
