//! Onset of damage.
use super::*;
use crate::strength::{InterfaceStrength, Limit, Strength};

fn limit(mpa: f64) -> Option<Limit> {
    Some(Limit {
        limit: mpa,
        fracture_energy_n_per_mm: None,
    })
}

fn interface(normal: f64, shear: f64) -> Option<InterfaceStrength> {
    Some(InterfaceStrength {
        normal: limit(normal)?,
        shear: limit(shear)?,
    })
}

fn isotropic_limits(tension_mpa: Option<f64>, compression_mpa: Option<f64>) -> PhaseStrength {
    PhaseStrength {
        is_orthotropic: false,
        limits: Strength {
            tension: tension_mpa.and_then(limit),
            compression: compression_mpa.and_then(limit),
            ..Strength::default()
        },
    }
}

/// A matrix that tension alone breaks, and fibres that break along their own.
fn strengths() -> Strengths {
    Strengths {
        matrix: isotropic_limits(Some(80.0), None),
        fibre: PhaseStrength {
            is_orthotropic: true,
            limits: Strength {
                tension: limit(2_000.0),
                compression: limit(1_000.0),
                ..Strength::default()
            },
        },
        interface: interface(60.0, 90.0),
    }
}

#[test]
fn a_uniform_cell_fails_at_its_strength() {
    let cell = scattered(epoxy(), epoxy());
    let effective = cell.effective([24; 2]).unwrap();
    let onset = |stress: [f64; 6]| {
        effective
            .onset(&Load::Stress(stress), &strengths())
            .unwrap()
    };
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
fn every_limit_of_a_material_counts_where_it_acts() {
    // of one material all through, so that every stress is the load
    let cell = scattered(epoxy(), epoxy());
    let effective = cell.effective([24; 2]).unwrap();
    let orthotropic = PhaseStrength {
        is_orthotropic: true,
        limits: Strength {
            tension: limit(2_000.0),
            compression: limit(1_000.0),
            across_tension: limit(50.0),
            across_compression: limit(150.0),
            shear: limit(70.0),
        },
    };
    let isotropic = isotropic_limits(Some(80.0), Some(200.0));
    let sheared = 1.0 / ((0.5_f64 / 50.0).powi(2) + (0.5_f64 / 70.0).powi(2)).sqrt();
    for (stress, of_isotropic, of_orthotropic) in [
        ([1.0, 0.0, 0.0, 0.0, 0.0, 0.0], 80.0, 2_000.0),
        ([-1.0, 0.0, 0.0, 0.0, 0.0, 0.0], 200.0, 1_000.0),
        ([0.0, 1.0, 0.0, 0.0, 0.0, 0.0], 80.0, 50.0),
        ([0.0, 0.0, -1.0, 0.0, 0.0, 0.0], 200.0, 150.0),
        // τ along the fibres, principal stresses ±τ; across them, σ = τ at 45°
        ([0.0, 0.0, 0.0, 0.0, 0.0, 1.0], 80.0, 70.0),
        ([0.0, 0.0, 0.0, 0.0, 1.0, 0.0], 80.0, 70.0),
        ([0.0, 0.0, 0.0, 1.0, 0.0, 0.0], 80.0, 50.0),
        // (σ/Y)² + (τ/S)² of σ = τ = ½; principal stress (1 + √5)/4
        (
            [0.0, 0.5, 0.0, 0.0, 0.0, 0.5],
            80.0 * 4.0 / (1.0 + 5.0_f64.sqrt()),
            sheared,
        ),
    ] {
        for (phase, expected) in [(isotropic, of_isotropic), (orthotropic, of_orthotropic)] {
            let both = Strengths {
                matrix: phase,
                fibre: phase,
                interface: None,
            };
            let onset = effective.onset(&Load::Stress(stress), &both).unwrap();
            for site in [onset.matrix, onset.fibre] {
                let factor = site.unwrap().factor;
                assert!(
                    (factor / expected - 1.0).abs() < 1e-8,
                    "{stress:?}: {factor} {expected}"
                );
            }
        }
    }
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
        matrix: isotropic_limits(Some(60.0), None),
        interface: interface(60.0, 1e12),
        ..strengths()
    };
    // of an isotropic fibre the largest principal stress counts, σ₂₂; pressed, what is pulled here
    let principal = Strengths {
        fibre: isotropic_limits(Some(60.0), None),
        ..strengths
    };
    let pressed = Strengths {
        matrix: isotropic_limits(None, Some(60.0)),
        fibre: isotropic_limits(None, Some(60.0)),
        interface: None,
    };
    let push = Load::Strain([0.0, -1.0, 0.0, 0.0, 0.0, 0.0]);
    let mut misses = Vec::new();
    for grid in [[60; 2], [96; 2]] {
        let effective = cell.effective(grid).unwrap();
        let onset = effective.onset(&load, &strengths).unwrap();
        let of_principal = effective.onset(&load, &principal).unwrap();
        let of_push = effective.onset(&push, &pressed).unwrap();
        for (pushed, pulled) in [
            (of_push.matrix, of_principal.matrix),
            (of_push.fibre, of_principal.fibre),
        ] {
            let share = pushed.unwrap().factor / pulled.unwrap().factor;
            assert!((share - 1.0).abs() < 1e-9, "{share}");
        }
        let across = 60.0 / of_principal.fibre.unwrap().factor / face - 1.0;
        assert!(across.abs() < 0.06, "{across}");
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
    let all = Strengths {
        matrix: isotropic_limits(Some(80.0), Some(200.0)),
        fibre: isotropic_limits(Some(500.0), Some(900.0)),
        ..strengths()
    };
    let between = Strengths {
        fibre: PhaseStrength {
            is_orthotropic: true,
            limits: Strength {
                across_tension: limit(50.0),
                across_compression: limit(150.0),
                shear: limit(70.0),
                ..Strength::default()
            },
        },
        ..strengths()
    };
    for strengths in [strengths(), all, between] {
        for (place, sign) in [(1, 1.0), (1, -1.0), (2, 1.0), (3, 1.0), (5, 1.0)] {
            let mut stress = [0.0; 6];
            stress[place] = sign;
            let load = Load::Stress(stress);
            let onset = effective.onset(&load, &strengths).unwrap();
            let stated = errors.onset(&onset, &load, &strengths).unwrap();
            let finer = finer.onset(&load, &strengths).unwrap();
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
}

#[test]
fn strengths_that_are_none_are_refused() {
    let cell = scattered(epoxy(), glass());
    let effective = cell.effective([16; 2]).unwrap();
    let load = Load::Stress([0.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    let refused = effective.onset(
        &load,
        &Strengths {
            matrix: isotropic_limits(Some(-1.0), None),
            ..strengths()
        },
    );
    assert!(refused.unwrap_err().to_string().contains("tensile"));
    assert!(effective.fields(&Load::Strain([f64::NAN; 6])).is_err());
    let none = effective.onset(&load, &Strengths::default()).unwrap();
    assert!(none.first().is_none());
}
