//! Arrays against closed series, bounds, and errors against finer grids.
use super::*;

/// Antiplane shear modulus of a square array over the matrix', by the three-term series of
/// [PerrinsMcKenzieMcPhedran1979].
fn square_series(ratio: f64, f: f64) -> f64 {
    let t = (1.0 + ratio) / (1.0 - ratio);
    let inner = t + f
        - 0.305_827 * f.powi(4) * t / (t * t - 1.402_958 * f.powi(8))
        - 0.013_362 * f.powi(8) / t;
    1.0 - 2.0 * f / inner
}

/// The same of a hexagonal array.
fn hexagonal_series(ratio: f64, f: f64) -> f64 {
    let t = (1.0 + ratio) / (1.0 - ratio);
    let inner = t + f
        - 0.075_422 * f.powi(6) * t / (t * t - 1.060_283 * f.powi(12))
        - 0.000_076 * f.powi(12) / t;
    1.0 - 2.0 * f / inner
}

#[test]
fn shear_along_arrays_approaches_the_series_of_perrins() {
    for (ratio, f) in [(10.0, 0.3), (50.0, 0.5), (0.02, 0.5), (10.0, 0.6)] {
        // E = 2 (1 + ν) G with ν = 1/4
        let (matrix, fibre) = (isotropic(2.5, 0.25), isotropic(2.5 * ratio, 0.25));
        let square = UnitCell::square(matrix, fibre, f, 1.0).unwrap();
        let hexagonal = UnitCell::hexagonal(matrix, fibre, f, 1.0).unwrap();
        for (cell, exact, grids) in [
            (square, square_series(ratio, f), [[24, 24], [60, 60]]),
            (hexagonal, hexagonal_series(ratio, f), [[24, 40], [60, 104]]),
        ] {
            let errors = grids.map(|grid| {
                let constants = cell.effective(grid).unwrap().constants;
                assert!((constants.g12_mpa / constants.g13_mpa - 1.0).abs() < 0.02);
                constants.g12_mpa / exact - 1.0
            });
            assert!(errors[1].abs() < 6e-3, "{ratio} {f}: {errors:?}");
            assert!(
                errors[1].abs() < 0.7 * errors[0].abs().max(1e-3),
                "{errors:?}"
            );
        }
    }
}

#[test]
fn a_hexagonal_array_is_isotropic_across_the_fibres_in_the_limit() {
    let cell = UnitCell::hexagonal(epoxy(), glass(), 0.6, 0.01).unwrap();
    let gaps = [[24, 42], [72, 124]].map(|grid| {
        let c = cell.effective(grid).unwrap().constants;
        [
            (c.e2_mpa / c.e3_mpa - 1.0).abs(),
            (c.g12_mpa / c.g13_mpa - 1.0).abs(),
            (c.nu12 / c.nu13 - 1.0).abs(),
            (2.0 * (1.0 + c.nu23) * c.g23_mpa / c.e2_mpa - 1.0).abs(),
        ]
    });
    // the grid knows 2 from 3, the less the finer it is
    assert!(gaps[1].iter().all(|gap| *gap < 6e-3), "{gaps:?}");
    assert!(gaps[1][3] < 0.5 * gaps[0][3], "{gaps:?}");
}

#[test]
fn a_few_thin_fibres_follow_the_dilute_limit() {
    // Up to f² the composite cylinders of the lower bound are the dilute answer for k, G₁₂, E₁; the
    // part above the matrix is compared.
    let cell = UnitCell::square(epoxy(), glass(), 0.03, 0.01).unwrap();
    let effective = cell.effective([100; 2]).unwrap();
    let bound = bounds::companions(&glass(), &epoxy(), 0.03).unwrap();
    let bound = bound.hashin_shtrikman_lower.unwrap();
    let c = effective.stiffness;
    let (k_m, g_m) = (3_000.0 / (2.0 * 1.35 * 0.30), 3_000.0 / 2.7);
    let k = 0.25 * (c[1][1] + c[2][2] + 2.0 * c[1][2]);
    // the bounds' own E₂ and ν₂₃ belong to different moduli: k from its formula instead
    let k_f = 70_000.0 / (2.0 * 1.22 * 0.56);
    let dilute = k_m + 0.03 / (1.0 / (k_f - k_m) + 0.97 / (k_m + g_m));
    assert!(((k - k_m) / (dilute - k_m) - 1.0).abs() < 0.02);
    assert!(((c[5][5] - g_m) / (bound.g12_mpa - g_m) - 1.0).abs() < 0.02);
    let e1 = effective.constants.e1_mpa;
    assert!((e1 / bound.e1_mpa - 1.0).abs() < 1e-5, "{e1}");
}

#[test]
fn errors_hold_against_a_far_finer_grid() {
    let far = [160, 160];
    let near = [40, 40];
    for cell in [
        UnitCell::square(epoxy(), glass(), 0.55, 0.01).unwrap(),
        scattered(epoxy(), glass()),
        scattered(epoxy(), ply()),
        scattered(glass(), epoxy()),
    ] {
        let (coarse, errors) = cell.refined(near).unwrap();
        let fine = cell.effective(far).unwrap().constants.values();
        let stated = errors.constants.values();
        for place in 0..9 {
            let found = coarse.constants.values()[place];
            let error = (found - fine[place]).abs();
            assert!(error <= stated[place], "{}", Constants::NAMES[place]);
            // and is no empty promise
            assert!(stated[place] < 0.12 * fine[place].abs());
        }
    }
}

#[test]
fn bounds_enclose_arrays_and_each_other() {
    for f in [0.1, 0.4, 0.7] {
        let bounds = bounds::companions(&glass(), &epoxy(), f).unwrap();
        let (lower, upper) = (
            bounds.hashin_shtrikman_lower.unwrap(),
            bounds.hashin_shtrikman_upper.unwrap(),
        );
        let cell = UnitCell::hexagonal(epoxy(), glass(), f, 0.01).unwrap();
        let effective = cell.effective([40, 68]).unwrap();
        let c = effective.constants;
        for ((lower, upper), (value, name)) in lower
            .values()
            .into_iter()
            .zip(upper.values())
            .zip(c.values().into_iter().zip(Constants::NAMES))
        {
            // a percent for the grid
            let slack = 0.01 * value;
            assert!(
                lower < upper && lower - slack < value && value < upper + slack,
                "{f} {name}: {lower} {value} {upper}"
            );
        }
        for (inner, outer) in [
            (lower.e2_mpa, bounds.reuss.e2_mpa),
            (lower.g12_mpa, bounds.reuss.g12_mpa),
            (bounds.voigt.e2_mpa, upper.e2_mpa),
            (bounds.voigt.g23_mpa, upper.g23_mpa),
        ] {
            assert!(inner > outer, "{inner} {outer}");
        }
        let found = bounds::beyond(&effective, None, &glass(), &epoxy()).unwrap();
        assert!(found.is_empty(), "{found:?}");
        // Halpin-Tsai's G₁₂ with ξ = 1 is the lower bound, and E₂ lies between
        assert!((bounds.halpin_tsai.g12_mpa / lower.g12_mpa - 1.0).abs() < 1e-12);
        assert!((lower.e2_mpa..upper.e2_mpa).contains(&bounds.halpin_tsai.e2_mpa));
    }
}

#[test]
fn bounds_meet_where_phases_are_alike_and_obey_hills_relation() {
    let same = bounds::companions(&epoxy(), &epoxy(), 0.3).unwrap();
    for bound in [
        same.voigt,
        same.reuss,
        same.hashin_shtrikman_lower.unwrap(),
        same.hashin_shtrikman_upper.unwrap(),
    ] {
        assert!((bound.e2_mpa / 3_000.0 - 1.0).abs() < 1e-12);
        assert!((bound.nu23 - 0.35).abs() < 1e-12 && (bound.nu12 - 0.35).abs() < 1e-12);
    }
    let values = [same.halpin_tsai, same.chamis].map(|estimate| estimate.e2_mpa);
    assert!(values.iter().all(|e2| (e2 / 3_000.0 - 1.0).abs() < 1e-12));
    // by hand, f = 1/2: G₁₂ = G_m (G_m (1 - f) + G_f (1 + f))/(G_m (1 + f) + G_f (1 - f))
    let (g_m, g_f) = (3_000.0 / 2.7, 70_000.0 / 2.44);
    let by_hand = g_m * (0.5 * g_m + 1.5 * g_f) / (1.5 * g_m + 0.5 * g_f);
    let half = bounds::companions(&glass(), &epoxy(), 0.5).unwrap();
    let lower = half.hashin_shtrikman_lower.unwrap();
    assert!((lower.g12_mpa / by_hand - 1.0).abs() < 1e-12);
    // E₁ by k at its bound through [Hill1964]
    let bulk = |e: f64, nu: f64| e / (2.0 * (1.0 + nu) * (1.0 - 2.0 * nu));
    let (k_m, k_f) = (bulk(3_000.0, 0.35), bulk(70_000.0, 0.22));
    let k = 1.0 / (0.5 / (k_m + g_m) + 0.5 / (k_f + g_m)) - g_m;
    let ratio = (0.22 - 0.35) / (1.0 / k_f - 1.0 / k_m);
    let e1 = 36_500.0 + 4.0 * ratio * ratio * (0.5 / k_m + 0.5 / k_f - 1.0 / k);
    assert!(
        (lower.e1_mpa / e1 - 1.0).abs() < 1e-12,
        "{} {e1}",
        lower.e1_mpa
    );
    // a material with directions across the fibres has none
    let none = bounds::companions(&ply(), &epoxy(), 0.5).unwrap();
    assert!(none.hashin_shtrikman_lower.is_none());
}

#[test]
fn moduli_beyond_their_bounds_are_told() {
    let cell = UnitCell::hexagonal(epoxy(), glass(), 0.4, 0.01).unwrap();
    let effective = cell.effective([24, 40]).unwrap();
    // held against fibres too soft for it, and against a matrix too stiff
    let above = bounds::beyond(&effective, None, &isotropic(6_000.0, 0.3), &epoxy()).unwrap();
    assert_eq!(above.len(), 3);
    assert!(above.iter().all(|beyond| beyond.is_upper));
    let below = bounds::beyond(&effective, None, &glass(), &isotropic(12_000.0, 0.3)).unwrap();
    assert_eq!(below.len(), 3);
    let text = below[2].to_string();
    assert!(
        text.contains("G₁₂") && text.contains("below the lower"),
        "{text}"
    );
    // an error as large as the way to the bound excuses it
    let errors = effective.constants;
    let excused = bounds::beyond(
        &effective,
        Some(&errors),
        &glass(),
        &isotropic(6_000.0, 0.3),
    )
    .unwrap();
    assert!(excused.is_empty(), "{excused:?}");
}
