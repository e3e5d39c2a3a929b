//! Plane stiffnesses against the formulas of textbooks.
use super::*;
use crate::section::stiffness::compliance;

const FIBRE: Orthotropic = Orthotropic {
    modulus_1_mpa: 11_500.0,
    modulus_2_mpa: 6_430.0,
    poisson_ratio_12: 0.28,
    shear_modulus_12_mpa: None,
    modulus_3_mpa: None,
    poisson_ratio_13: None,
    poisson_ratio_23: None,
    shear_modulus_13_mpa: None,
    shear_modulus_23_mpa: None,
};

/// A carbon fibre ply with nine constants, none of them like another.
const PLY: Orthotropic = Orthotropic {
    modulus_1_mpa: 140_000.0,
    modulus_2_mpa: 10_000.0,
    poisson_ratio_12: 0.30,
    shear_modulus_12_mpa: Some(5_000.0),
    modulus_3_mpa: Some(9_000.0),
    poisson_ratio_13: Some(0.25),
    poisson_ratio_23: Some(0.45),
    shear_modulus_13_mpa: Some(4_000.0),
    shear_modulus_23_mpa: Some(3_300.0),
};

/// Round-off of turned and inverted compliances, over the largest stiffness.
const ROUND_OFF: f64 = 1e-12;

#[test]
fn along_the_plane_a_ply_has_the_formulas_of_its_state() {
    let (e1, e2, e3) = (140_000.0, 10_000.0, 9_000.0);
    let (nu12, nu13, nu23) = (0.30, 0.25, 0.45);
    let (stress, notes) = Material::Orthotropic(PLY)
        .stiffness(PlaneState::Stress)
        .unwrap();
    assert!(notes.is_empty());
    let d = 1.0 - nu12 * nu12 * e2 / e1;
    for (found, expected) in [
        (stress[(0, 0)], e1 / d),
        (stress[(0, 1)], nu12 * e2 / d),
        (stress[(1, 1)], e2 / d),
        (stress[(2, 2)], 5_000.0),
    ] {
        assert!((found / expected - 1.0).abs() < ROUND_OFF);
    }
    assert!(stress[(0, 2)] == 0.0 && stress[(1, 2)] == 0.0);
    // Plane strain: C₁₁ = E₁ (1 - ν₂₃ν₃₂)/Δ, C₁₂ = E₁ (ν₂₁ + ν₃₁ν₂₃)/Δ, C₂₂ = E₂ (1 - ν₁₃ν₃₁)/Δ.
    let (nu21, nu31, nu32) = (nu12 * e2 / e1, nu13 * e3 / e1, nu23 * e3 / e2);
    let delta = 1.0 - nu12 * nu21 - nu23 * nu32 - nu13 * nu31 - 2.0 * nu21 * nu32 * nu13;
    let (strain, _) = Material::Orthotropic(PLY)
        .stiffness(PlaneState::Strain)
        .unwrap();
    for (found, expected) in [
        (strain[(0, 0)], e1 * (1.0 - nu23 * nu32) / delta),
        (strain[(0, 1)], e1 * (nu21 + nu31 * nu23) / delta),
        (strain[(1, 1)], e2 * (1.0 - nu13 * nu31) / delta),
        (strain[(2, 2)], 5_000.0),
    ] {
        assert!((found / expected - 1.0).abs() < ROUND_OFF);
    }
}

#[test]
fn across_the_plane_a_ply_shows_its_axes_3_and_2() {
    let (e2, e3, nu23) = (10_000.0, 9_000.0, 0.45);
    let nu32 = nu23 * e3 / e2;
    for angle in [90.0, -90.0, 270.0] {
        let (stress, _) = Material::Orthotropic(PLY)
            .stiffness_out_of_plane(PlaneState::Stress, angle)
            .unwrap();
        let d = 1.0 - nu23 * nu32;
        for (found, expected) in [
            (stress[(0, 0)], e3 / d),
            (stress[(0, 1)], nu32 * e2 / d),
            (stress[(1, 1)], e2 / d),
            (stress[(2, 2)], 3_300.0),
        ] {
            assert!((found / expected - 1.0).abs() < ROUND_OFF);
        }
    }
    // Axes named anew: 1 and 3 of the material change places.
    let renamed = Orthotropic {
        modulus_1_mpa: 9_000.0,
        modulus_3_mpa: Some(140_000.0),
        poisson_ratio_12: 0.45 * 9_000.0 / 10_000.0,
        poisson_ratio_13: Some(0.25 * 9_000.0 / 140_000.0),
        poisson_ratio_23: Some(0.30 * 10_000.0 / 140_000.0),
        shear_modulus_12_mpa: Some(3_300.0),
        shear_modulus_23_mpa: Some(5_000.0),
        ..PLY
    };
    let (turned, _) = Material::Orthotropic(PLY)
        .stiffness_out_of_plane(PlaneState::Strain, 90.0)
        .unwrap();
    let (expected, _) = Material::Orthotropic(renamed)
        .stiffness(PlaneState::Strain)
        .unwrap();
    assert!((turned - expected).amax() < ROUND_OFF * expected.amax());
}

#[test]
fn an_oblique_ply_stretches_and_shears_by_the_turned_compliance() {
    // 1/E_x = c⁴/E₁ + s⁴/E₃ + c²s² (1/G₁₃ - 2ν₁₃/E₁), 1/G_xy = c²/G₁₂ + s²/G₂₃,
    // ν_xy/E_x = c² ν₁₂/E₁ + s² ν₃₂/E₃.
    for (angle, sense) in [(30.0_f64, 1.0), (45.0, -1.0), (75.0, 1.0)] {
        let (s, c) = angle.to_radians().sin_cos();
        let (stiffness, notes) = Material::Orthotropic(PLY)
            .stiffness_out_of_plane(PlaneState::Stress, sense * angle)
            .unwrap();
        assert!(notes.is_empty());
        let found = compliance(&stiffness);
        let stretch = c.powi(4) / 140_000.0
            + s.powi(4) / 9_000.0
            + c * c * s * s * (1.0 / 4_000.0 - 2.0 * 0.25 / 140_000.0);
        let contraction = c * c * 0.30 / 140_000.0 + s * s * 0.45 / 10_000.0;
        let shear = c * c / 5_000.0 + s * s / 3_300.0;
        assert!((found[(0, 0)] / stretch - 1.0).abs() < ROUND_OFF);
        assert!((found[(0, 1)] / -contraction - 1.0).abs() < ROUND_OFF);
        assert!((found[(2, 2)] / shear - 1.0).abs() < ROUND_OFF);
        assert!((found[(1, 1)] * 10_000.0 - 1.0).abs() < ROUND_OFF);
    }
}

#[test]
fn an_isotropic_material_with_nine_constants_is_the_same_at_every_angle() {
    let (e, nu) = (85.0, 0.3);
    let all = Material::Orthotropic(Orthotropic {
        modulus_1_mpa: e,
        modulus_2_mpa: e,
        poisson_ratio_12: nu,
        ..FIBRE
    });
    let isotropic = Material::Isotropic {
        youngs_modulus_mpa: e,
        poisson_ratio: nu,
    };
    for state in [PlaneState::Stress, PlaneState::Strain] {
        let (expected, _) = isotropic.stiffness(state).unwrap();
        for angle in [0.0, 17.0, 45.0, 90.0, 133.0] {
            let (found, _) = all.stiffness_out_of_plane(state, angle).unwrap();
            assert!(
                (found - expected).amax() < ROUND_OFF * e,
                "{state:?} {angle}"
            );
        }
    }
}

#[test]
fn only_constants_that_matter_are_told() {
    let told = |state, angle| -> Vec<&str> {
        let (_, notes) = Material::Orthotropic(FIBRE)
            .stiffness_out_of_plane(state, angle)
            .unwrap();
        notes.iter().map(|note| note.constant).collect()
    };
    assert_eq!(told(PlaneState::Stress, 0.0), ["G₁₂ [MPa]"]);
    assert_eq!(
        told(PlaneState::Stress, 90.0),
        ["E₃ [MPa]", "ν₂₃", "G₂₃ [MPa]"]
    );
    assert_eq!(
        told(PlaneState::Strain, 45.0),
        [
            "G₁₂ [MPa]",
            "E₃ [MPa]",
            "ν₁₃",
            "ν₂₃",
            "G₁₃ [MPa]",
            "G₂₃ [MPa]"
        ]
    );
    // Three ratios that do not go together are refused where all three matter.
    let together = Material::Orthotropic(Orthotropic {
        poisson_ratio_23: Some(0.97),
        poisson_ratio_12: 0.6,
        ..FIBRE
    });
    assert!(together.stiffness(PlaneState::Stress).is_ok());
    assert!(matches!(
        together.stiffness_out_of_plane(PlaneState::Stress, 45.0),
        Err(CompositeError::UnstableTogether { .. })
    ));
}

#[test]
fn hubers_estimate_of_the_papers_fibre() {
    let (stiffness, notes) = Material::Orthotropic(FIBRE)
        .stiffness(PlaneState::Stress)
        .unwrap();
    assert!((stiffness[(2, 2)] - 3_555.2).abs() < 0.05);
    assert_eq!(notes.len(), 1);
    assert_eq!(notes[0].constant, "G₁₂ [MPa]");
    assert!((hubers_shear_modulus(85.0, 85.0, 0.3) - 85.0 / 2.6).abs() < 1e-12);
    assert!((hubers_shear_modulus(85.0, 85.0, -0.3) - 85.0 / 1.4).abs() < 1e-12);
}

#[test]
fn plane_stress_gives_back_its_constants() {
    let (stiffness, _) = Material::Orthotropic(FIBRE)
        .stiffness(PlaneState::Stress)
        .unwrap();
    let s = compliance(&stiffness);
    assert!((1.0 / s[(0, 0)] - 11_500.0).abs() < 1e-8);
    assert!((1.0 / s[(1, 1)] - 6_430.0).abs() < 1e-8);
    assert!((-s[(0, 1)] / s[(0, 0)] - 0.28).abs() < 1e-12);
}

#[test]
fn an_isotropic_material_written_as_an_orthotropic_one_is_the_same_in_plane_strain() {
    let (e, nu) = (85.0, 0.3);
    let orthotropic = Material::Orthotropic(Orthotropic {
        modulus_1_mpa: e,
        modulus_2_mpa: e,
        poisson_ratio_12: nu,
        ..FIBRE
    });
    let isotropic = Material::Isotropic {
        youngs_modulus_mpa: e,
        poisson_ratio: nu,
    };
    for state in [PlaneState::Stress, PlaneState::Strain] {
        let (a, _) = orthotropic.stiffness(state).unwrap();
        let (b, _) = isotropic.stiffness(state).unwrap();
        assert!((a - b).amax() < 1e-12 * e, "{state:?}");
    }
    let (strain, notes) = orthotropic.stiffness(PlaneState::Strain).unwrap();
    let constrained = e * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
    assert!((strain[(0, 0)] - constrained).abs() < 1e-12 * e);
    assert_eq!(notes.len(), 4, "G₁₂, E₃, ν₁₃ and ν₂₃ are told");
}

#[test]
fn constants_of_no_stable_material_are_refused_with_the_bound() {
    let refused = |constants| {
        Material::Orthotropic(constants)
            .stiffness(PlaneState::Strain)
            .unwrap_err()
            .to_string()
    };
    let unstable = refused(Orthotropic {
        poisson_ratio_12: 1.4,
        ..FIBRE
    });
    assert!(unstable.contains("ν₁₂ is 1.4") && unstable.contains("1.337"));
    assert!(
        refused(Orthotropic {
            modulus_2_mpa: 0.0,
            ..FIBRE
        })
        .contains("modulus 2")
    );
    let together = refused(Orthotropic {
        poisson_ratio_23: Some(0.97),
        poisson_ratio_12: 0.6,
        ..FIBRE
    });
    assert!(together.contains("must be positive"), "{together}");
    let isotropic = Material::Isotropic {
        youngs_modulus_mpa: 85.0,
        poisson_ratio: 0.5,
    };
    assert!(isotropic.stiffness(PlaneState::Stress).is_ok());
    let refused = isotropic.stiffness(PlaneState::Strain).unwrap_err();
    assert!(refused.to_string().contains("plane strain"), "{refused}");
}

#[test]
fn the_stiffness_of_space_holds_that_of_plane_strain_and_undoes_the_compliance() {
    let (space, notes) = Material::Orthotropic(PLY).stiffness_of_space().unwrap();
    assert!(notes.is_empty());
    let (plane, _) = Material::Orthotropic(PLY)
        .stiffness(PlaneState::Strain)
        .unwrap();
    for (i, j, place) in [
        (0, 0, (0, 0)),
        (0, 1, (0, 1)),
        (1, 1, (1, 1)),
        (5, 5, (2, 2)),
    ] {
        assert!((space[(i, j)] - plane[place]).abs() < ROUND_OFF * 140_000.0);
    }
    // Pulled along 3 it stretches by 1/E₃ and thins by ν₂₃/E₂ along 2, ν₁₃/E₁ along 1.
    let strain = [-0.25 / 140_000.0, -0.45 / 10_000.0, 1.0 / 9_000.0];
    for row in 0..3 {
        let stress: f64 = (0..3).map(|j| space[(row, j)] * strain[j]).sum();
        let expected = if row == 2 { 1.0 } else { 0.0 };
        assert!((stress - expected).abs() < 1e-12, "{row}: {stress}");
    }
    assert_eq!((space[(3, 3)], space[(4, 4)]), (3_300.0, 4_000.0));
    let (isotropic, _) = Material::Isotropic {
        youngs_modulus_mpa: 85.0,
        poisson_ratio: 0.3,
    }
    .stiffness_of_space()
    .unwrap();
    // E (1 - ν)/((1 + ν)(1 - 2ν)) and E/(2 (1 + ν))
    assert!((isotropic[(2, 2)] - 85.0 * 0.7 / (1.3 * 0.4)).abs() < 1e-12 * 85.0);
    assert!((isotropic[(4, 4)] - 85.0 / 2.6).abs() < 1e-12 * 85.0);
}
