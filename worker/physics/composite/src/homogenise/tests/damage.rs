//! Onset of damage.
use super::*;

const STRENGTHS: Strengths = Strengths {
    matrix_tension_mpa: Some(80.0),
    fibre_tension_mpa: Some(2_000.0),
    fibre_compression_mpa: Some(1_000.0),
    interface_normal_mpa: Some(60.0),
    interface_shear_mpa: Some(90.0),
};

#[test]
fn a_uniform_cell_fails_at_its_strength() {
    let cell = scattered(epoxy(), epoxy());
    let effective = cell.effective([24; 2]).unwrap();
    let onset = |stress: [f64; 6]| effective.onset(&Load::Stress(stress), &STRENGTHS).unwrap();
    let factor = |site: Option<Site>| site.unwrap().factor;
    let pulled = onset([0.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    assert!((factor(pulled.matrix) / 80.0 - 1.0).abs() < 1e-9);
    assert!(pulled.fibre.is_none(), "no stress along the fibre");
    // where the face lies across the load: σ = 60, and at no angle less: (c²/60)² + (sc/90)² ≤ 1/60²
    assert!((factor(pulled.interface) / 60.0 - 1.0).abs() < 0.02);
    assert_eq!(pulled.first().unwrap().0, Part::Interface);
    let along = onset([1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert!((factor(along.fibre) / 2_000.0 - 1.0).abs() < 1e-9);
    assert!((factor(along.matrix) / 80.0 - 1.0).abs() < 1e-9);
    let pushed = onset([-1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert!((factor(pushed.fibre) / 1_000.0 - 1.0).abs() < 1e-9);
    assert!(pushed.matrix.is_none(), "compressed");
    // shear along the fibres: principal stress τ in the matrix, τ along faces across it
    let sheared = onset([0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    assert!((factor(sheared.matrix) / 80.0 - 1.0).abs() < 1e-9);
    assert!((factor(sheared.interface) / 90.0 - 1.0).abs() < 0.02);
}

#[test]
fn a_thin_fibre_has_eshelbys_stress_on_its_face() {
    // Plane strain, ε₂₂ alone. In an inclusion of few the strains are uniform: with
    // α = k_m/(k_m + G_m) and β = (k_m + 2 G_m)/(2 (k_m + G_m)) the parts of the far strain are
    // ε_k = 1/(1 + α (k_f/k_m - 1)) and ε_G = 1/(1 + β (G_f/G_m - 1)) [Eshelby1957], in two
    // dimensions. The far strain is that of the matrix, (1 - f + f ε)⁻¹ of the mean [MoriTanaka1973].
    let f = 0.03;
    let cell = UnitCell::square(epoxy(), glass(), f, 0.01).unwrap();
    let bulk = |e: f64, nu: f64| e / (2.0 * (1.0 + nu) * (1.0 - 2.0 * nu));
    let (k_m, k_f) = (bulk(3_000.0, 0.35), bulk(70_000.0, 0.22));
    let (g_m, g_f) = (3_000.0 / 2.7, 70_000.0 / 2.44);
    let alpha = k_m / (k_m + g_m);
    let beta = (k_m + 2.0 * g_m) / (2.0 * (k_m + g_m));
    let inside = |part: f64| part / (1.0 - f + f * part);
    let of_bulk = inside(1.0 / (1.0 + alpha * (k_f / k_m - 1.0)));
    let of_shear = inside(1.0 / (1.0 + beta * (g_f / g_m - 1.0)));
    // ε₂₂ = 1: ε₂₂ + ε₃₃ = 1 and ε₂₂ - ε₃₃ = 1; σ₂₂ = k (ε₂₂ + ε₃₃) + G (ε₂₂ - ε₃₃)
    let face = k_f * of_bulk + g_f * of_shear;
    // σ₁₁ = λ (ε₂₂ + ε₃₃) = 2 ν k (ε₂₂ + ε₃₃)
    let along = 2.0 * 0.22 * k_f * of_bulk;
    let load = Load::Strain([0.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    let strengths = Strengths {
        interface_normal_mpa: Some(60.0),
        fibre_tension_mpa: Some(2_000.0),
        matrix_tension_mpa: Some(60.0),
        ..Strengths::default()
    };
    let mut misses = Vec::new();
    for grid in [[60; 2], [96; 2]] {
        let onset = cell
            .effective(grid)
            .unwrap()
            .onset(&load, &strengths)
            .unwrap();
        let normal = 60.0 / onset.interface.unwrap().factor / face - 1.0;
        let fibre = 2_000.0 / onset.fibre.unwrap().factor / along - 1.0;
        let matrix = 60.0 / onset.matrix.unwrap().factor / face - 1.0;
        misses.push([normal, fibre, matrix]);
        // at the pole: beside the fibre along 2
        let [y, z] = onset.interface.unwrap().at_mm;
        let middle = cell.size_mm[0] / 2.0;
        assert!((z - middle).abs() < 0.002 && ((y - middle).abs() - 0.005).abs() < 0.002);
    }
    for [normal, fibre, matrix] in &misses {
        assert!(normal.abs() < 0.03 && fibre.abs() < 0.06 && matrix.abs() < 0.04);
    }
}

#[test]
fn the_error_of_an_onset_covers_a_finer_grid() {
    let cell = scattered(epoxy(), glass());
    let (effective, errors) = cell.refined([48; 2]).unwrap();
    let finer = cell.effective([144; 2]).unwrap();
    for place in [1, 2, 3, 5] {
        let mut stress = [0.0; 6];
        stress[place] = 1.0;
        let load = Load::Stress(stress);
        let onset = effective.onset(&load, &STRENGTHS).unwrap();
        let stated = errors.onset(&onset, &load, &STRENGTHS).unwrap();
        let finer = finer.onset(&load, &STRENGTHS).unwrap();
        for (stated, pair) in stated.into_iter().zip([
            (onset.matrix, finer.matrix),
            (onset.fibre, finer.fibre),
            (onset.interface, finer.interface),
        ]) {
            let (Some(here), Some(finer)) = pair else {
                // shear along the fibres does not stretch them
                assert!(place == 5 && stated.is_none());
                continue;
            };
            let error = (here.factor / finer.factor - 1.0).abs();
            assert!(error <= stated.unwrap(), "{place}: {error} {stated:?}");
        }
    }
}

#[test]
fn strengths_that_are_none_are_refused() {
    let cell = scattered(epoxy(), glass());
    let effective = cell.effective([16; 2]).unwrap();
    let load = Load::Stress([0.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    let refused = effective.onset(
        &load,
        &Strengths {
            matrix_tension_mpa: Some(-1.0),
            ..STRENGTHS
        },
    );
    assert!(refused.unwrap_err().to_string().contains("matrix"));
    assert!(effective.fields(&Load::Strain([f64::NAN; 6])).is_err());
    let none = effective.onset(&load, &Strengths::default()).unwrap();
    assert!(none.first().is_none());
}
