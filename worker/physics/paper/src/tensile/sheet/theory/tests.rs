//! Theories against their closed forms.
#![allow(clippy::float_cmp, reason = "zeros and ones are exact")]
use super::*;
use crate::sheet::FibreSection;
use serde_json::json;

fn pulp(strength_mpa: Option<f64>) -> Pulp {
    let mut pulp = json!({"name": "a", "length_mm": 1.0, "width_um": 20, "wall_um": 2, "youngs_modulus_gpa": 30,
                          "poisson_ratio": 0.3, "shear_modulus_gpa": 3});
    pulp["strength_mpa"] = json!(strength_mpa);
    serde_json::from_value(pulp).unwrap()
}

const SECTION: FibreSection = FibreSection {
    width_um: 20.0,
    wall_um: 2.0,
    thickness_um: 5.0,
    coarseness_ug_per_um: 1.5e-4,
};
/// π 2 (20 - 2) µm².
const AREA_UM2: f64 = std::f64::consts::PI * 36.0;

/// Fibres of 100 µm about the middle of a square, at equally spaced angles.
fn fan(count: u32) -> Sheet {
    let fibres = (0..count).map(|index| {
        let angle = std::f64::consts::PI * (f64::from(index) + 0.5) / f64::from(count);
        let [x, y] = [50.0 * angle.cos(), 50.0 * angle.sin()];
        SheetFibre {
            pulp: 0,
            section: SECTION,
            centre_line_um: vec![[500.0 - x, 500.0 - y, 0.0], [500.0 + x, 500.0 + y, 0.0]],
        }
    });
    Sheet {
        size_um: [1000.0; 2],
        fibres: fibres.collect(),
        contacts: Vec::new(),
    }
}

fn near(found: f64, expected: f64) {
    assert!(
        (found / expected - 1.0).abs() < 1e-9,
        "{found}, not {expected}"
    );
}

#[test]
fn uniform_directions_have_a_third_of_e_over_rho_and_three_eighths_between_jaws() {
    let theory = Theory::of(&fan(36), &[&pulp(None)], &[], None, None);
    let density = SECTION.coarseness_ug_per_um / AREA_UM2;
    let cox = theory.cox.unwrap();
    // GPa over µg/µm³ is 10⁻⁶ kN m/g
    near(cox.free, 1e-6 * 30.0 / density / 3.0);
    near(cox.held, 1e-6 * 30.0 / density * 3.0 / 8.0);
    // without bonds and jaws nothing strains them
    assert_eq!(theory.shear_lag, None);
    assert_eq!((theory.zero_span, theory.page), (None, None));
}

#[test]
fn many_uniform_directions_have_three_eighths_of_the_strength_at_zero_span() {
    let found = |count| {
        let theory = Theory::of(&fan(count), &[&pulp(Some(600.0))], &[], None, None);
        theory.zero_span.unwrap()
    };
    let expected = 1e-3 * 0.6 * AREA_UM2 / SECTION.coarseness_ug_per_um * 3.0 / 8.0;
    // the first fibre breaks at 600 MPa once its share cos² of the strain, near to 1, is reached
    let cosine = (0.5 * std::f64::consts::PI / 3600.0).cos();
    near(found(3600), expected / cosine.powi(2));
    // of two at 45° each has the share 1/2 of the strain and 1/√2 of its tension along the pull, and a
    // section crosses 1/√2 of their length
    near(found(2), expected / (3.0 / 8.0) / 2.0);
}

#[test]
fn fibres_along_the_pull_have_their_own_strength_at_zero_span() {
    let mut sheet = fan(1);
    sheet.fibres[0].centre_line_um = vec![[400.0, 500.0, 0.0], [600.0, 500.0, 0.0]];
    let theory = Theory::of(&sheet, &[&pulp(Some(600.0))], &[], None, None);
    let along = 1e-3 * 0.6 * AREA_UM2 / SECTION.coarseness_ug_per_um;
    near(theory.zero_span.unwrap(), along);
    // as many nearly across the pull bear nothing, and do not break before strains that nobody reaches
    for across in [1e-6, 1e-9] {
        let mut mixed = fan(100);
        for (index, fibre) in mixed.fibres.iter_mut().enumerate() {
            fibre.centre_line_um = if index % 2 == 0 {
                vec![[400.0, 500.0, 0.0], [600.0, 500.0, 0.0]]
            } else {
                vec![[0.0, 400.0, 0.0], [200.0 * across, 600.0, 0.0]]
            };
        }
        let theory = Theory::of(&mixed, &[&pulp(Some(600.0))], &[], None, None);
        near(theory.zero_span.unwrap(), 0.5 * along);
    }
}

#[test]
fn strain_is_built_up_through_bonds_as_cox_has_it_and_jaws_double_a_fibre() {
    let mut sheet = fan(2);
    let bond = |stiffness_mn_per_um3| FrameBond {
        fibres: [0, 1],
        at_um: [50.0; 2],
        area_um2: 400.0,
        stiffness_mn_per_um3,
        normal_strength_mn: None,
        shear_strength_mn: None,
    };
    let lag = |sheet: &Sheet, bond: FrameBond| built_up(sheet, &[bond], |_| 30.0);
    // k = 100 mN/µm over 100 µm
    let x = 0.5 * 100.0 * (0.25 * 400.0 / 100.0 / (30.0 * AREA_UM2)).sqrt();
    near(lag(&sheet, bond(0.25))[0], 1.0 - x.tanh() / x);
    near(lag(&sheet, bond(0.25))[1], 1.0 - x.tanh() / x);
    // no lag of bonds without give, nothing of none
    assert!(lag(&sheet, bond(1e9))[0] > 0.9999);
    let mut void = bond(0.25);
    (void.normal_strength_mn, void.shear_strength_mn) = (Some(0.0), Some(0.0));
    assert_eq!(lag(&sheet, void)[0], 0.0);
    // a jaw at one end, then at the other too
    sheet.fibres[0].centre_line_um = vec![[0.0, 500.0, 0.0], [100.0, 500.0, 0.0]];
    near(
        lag(&sheet, bond(0.25))[0],
        1.0 - (2.0 * x).tanh() / (2.0 * x),
    );
    sheet.size_um[0] = 100.0;
    near(lag(&sheet, bond(0.25))[0], 1.0);
}

#[test]
fn small_shares_meet_the_formula_that_large_ones_have() {
    near(
        share(0.999_9 * SMALL) / 0.999_9_f64.powi(2),
        SMALL * SMALL / 3.0,
    );
    assert!((share(1.000_1 * SMALL) / share(0.999_9 * SMALL) - 1.000_4).abs() < 1e-4);
}

/// Z 150 N m/g, L 2 mm, c 0.15 mg/m, P 72 µm; b 2 and 4 MPa by RBA 0.2 … 0.5: N m/g, to the digits
/// that were worked out by hand.
#[test]
fn pages_equation_gives_its_worked_example() {
    let mut measured = Statistics::of(&fan(3), 4).unwrap();
    (measured.mean_width_um, measured.length_weighted_um) = (36.0, 2000.0);
    for (strength, expected) in [
        (2.0, [25.8, 35.3, 43.2, 50.0]),
        (4.0, [43.2, 55.8, 65.3, 72.7]),
    ] {
        for (area, expected) in [0.2, 0.3, 0.4, 0.5].into_iter().zip(expected) {
            measured.relative_bonded_area = area;
            let page = Page::new(Some(150.0), Some(strength), 1.5e-4, &measured).unwrap();
            assert!((page.index - expected).abs() < 0.051, "{page:?} {expected}");
        }
    }
    // fibres alone
    let page = Page::new(Some(150.0), None, 1.5e-4, &measured).unwrap();
    near(page.index, 8.0 / 9.0 * 150.0);
    assert_eq!(page.bond_share, 0.0);
    // no bonds
    measured.relative_bonded_area = 0.0;
    let page = Page::new(Some(150.0), Some(4.0), 1.5e-4, &measured).unwrap();
    assert_eq!((page.index, page.bond_share), (0.0, 1.0));
    assert_eq!(Page::new(None, None, 1.5e-4, &measured), None);
}

#[test]
fn fibres_that_yield_share_the_force_when_the_first_of_them_breaks() {
    // one along the pull, one at 60 degrees, as long as each other
    let mut sheet = fan(1);
    let along = |cos: f64, sin: f64| {
        vec![
            [500.0, 500.0, 0.0],
            [500.0 + 100.0 * cos, 500.0 + 100.0 * sin, 0.0],
        ]
    };
    sheet.fibres[0].centre_line_um = along(1.0, 0.0);
    let mut other = sheet.fibres[0].clone();
    other.centre_line_um = along(0.5, 0.75_f64.sqrt());
    sheet.fibres.push(other);
    let mut pulp = pulp(Some(600.0));
    pulp.yielding = Some(loadframe_api::spec::paper_tensile::Yielding {
        stress_mpa: 300.0,
        hardening_modulus_gpa: 3.0,
    });
    let theory = Theory::of(&sheet, &[&pulp], &[], None, None);
    // it breaks at a strain of 0.01 + 0.1, where the other, strained a quarter of it, has 0.3525 GPa
    let other = 0.3 + 3.0 * (0.25 * 0.11 - 0.01);
    let force = 0.6 + 0.25 * other;
    let per_mass = AREA_UM2 / (2.0 * SECTION.coarseness_ug_per_um);
    near(theory.zero_span.unwrap(), 1e-3 * force * per_mass);
}
