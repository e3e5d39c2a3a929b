//! Breaks are found, not stepped over: maximum force and its strain are those of the path of equilibria,
//! whatever the strain step.
mod scene;

use loadframe_api::{
    Report,
    spec::nonwoven_tensile::{
        Accuracy, Bond, Breaking, Jaw, Knobs, NetworkBond, NonwovenTensile, StrengthDraw,
    },
};
use scene::{bond, explicit, polyester, run, value};

/// Default precision of a break, the part of the maximum force within which it is found.
const PRECISION: f64 = 0.01;
const RULES: [Breaking; 2] = [Breaking::AllOverStrength, Breaking::WeakestFirst];

fn law(modulus: f64) -> Bond {
    Bond {
        modulus_n: Some(modulus),
        friction_modulus_n: 0.0,
        compression_stiffness_n: 0.0,
        mean_strength_n: Some(1.0),
        strength_sigma: 0.0,
        strength_draw: StrengthDraw::LogNormal,
    }
}

/// Bonds side by side between the jaws, with these strengths [N].
fn bundle(modulus: f64, strengths: &[f64]) -> NonwovenTensile {
    let mut nodes = Vec::new();
    let mut bonds = Vec::new();
    for (number, strength) in strengths.iter().enumerate() {
        let x = number as f64;
        nodes.push(([x, 0.0, 0.0], Jaw::Bottom));
        nodes.push(([x, 10.0, 0.0], Jaw::Top));
        bonds.push(NetworkBond {
            strength_n: Some(*strength),
            ..bond(2 * number as u32, 2 * number as u32 + 1)
        });
    }
    let mut spec = explicit(&nodes, bonds, law(modulus));
    spec.test.breaking = Breaking::AllOverStrength;
    spec.accuracy = Accuracy::default();
    spec
}

fn set_precision(spec: &mut NonwovenTensile, break_precision: Option<f64>) {
    spec.accuracy = Accuracy::Knobs(Knobs {
        break_precision,
        ..spec.accuracy.knobs()
    });
}

fn assert_within(found: f64, expected: f64, precision: f64, what: &str) {
    assert!(
        (found - expected).abs() <= precision * expected,
        "{what}: {found}, expected {expected}"
    );
}

fn has_warning(report: &Report, code: &str) -> bool {
    report.warnings.iter().any(|warning| warning.code == code)
}

#[test]
fn one_bond_has_its_strength_at_its_strain_at_any_step() {
    for rule in RULES {
        for modulus in [30.0, 60.0, 101.0, 150.0, 7000.0] {
            for strain_step in [0.001, 0.01, 0.1] {
                let mut spec = bundle(modulus, &[1.0]);
                spec.test.breaking = rule;
                spec.test.strain_step = strain_step;
                let (report, _) = run(&spec);
                let what = format!("modulus {modulus}, step {strain_step}");
                assert_within(value(&report, "max_force"), 1.0, PRECISION, &what);
                let strain = value(&report, "strain_at_max_force");
                assert_within(strain, 1.0 / modulus, PRECISION, &what);
                assert!(report.warnings.is_empty(), "{what}: {:?}", report.warnings);
            }
        }
    }
}

#[test]
fn a_whole_step_that_oversteps_the_break_says_so() {
    let mut spec = bundle(60.0, &[1.0]);
    set_precision(&mut spec, None);
    let (report, _) = run(&spec);
    // read after breaking, at whole steps: 0.01 x 60
    assert_within(value(&report, "max_force"), 0.6, 1e-12, "as in the thesis");
    assert!(has_warning(&report, "break_overstepped"));
    assert!(!report.quality["overstepped_force"].ok);
    // the force had risen from 0.6 to 1.2 N over a strength of 1 N
    assert_within(
        report.quality["overstepped_force"].value,
        0.2 / 0.6,
        1e-9,
        "by how much",
    );
}

/// Strengths of a bundle, spread evenly from `weakest` to 1 N.
fn spread(count: usize, weakest: f64) -> Vec<f64> {
    let step = (1.0 - weakest) / (count - 1) as f64;
    (0..count)
        .map(|number| weakest + step * number as f64)
        .collect()
}

#[test]
fn a_bundle_carries_what_daniels_says() {
    // [Daniels1945]: all bonds share one strain, so the force before the k-th weakest breaks is its
    // strength times the number of those that are left
    for (count, weakest) in [(2, 0.9), (7, 0.3), (40, 0.7), (400, 0.2)] {
        let strengths = spread(count, weakest);
        let forces = strengths.iter().enumerate();
        let (strongest, max_force) = forces
            .map(|(broken, strength)| (*strength, strength * (count - broken) as f64))
            .reduce(|best, next| if next.1 > best.1 { next } else { best })
            .expect("there are bonds");
        for rule in RULES {
            for modulus in [1.0, 33.0, 900.0] {
                let mut spec = bundle(modulus, &strengths);
                spec.test.breaking = rule;
                let (report, record) = run(&spec);
                let what = format!("{count} bonds from {weakest} N, modulus {modulus}, {rule:?}");
                assert_within(value(&report, "max_force"), max_force, PRECISION, &what);
                let strain = value(&report, "strain_at_max_force");
                // near a smooth maximum many strains have its force
                let near = if count > 40 { 0.1 } else { 2.0 * PRECISION };
                assert_within(strain, strongest / modulus, near, &what);
                let events = record.files["events.csv"].clone();
                let events = String::from_utf8(events).expect("text");
                let first = events.lines().nth(1).expect("an event");
                let first: f64 = first
                    .split(',')
                    .nth(2)
                    .expect("its strain")
                    .parse()
                    .expect("a number");
                assert_within(first, weakest / modulus, PRECISION, &what);
            }
        }
    }
}

#[test]
fn a_brittle_lattice_does_not_know_its_strain_step() {
    let mut results = Vec::new();
    for strain_step in [0.0003, 0.003, 0.01, 0.03] {
        let mut spec = polyester(9, 11, 2);
        spec.bond.modulus_n = Some(100.0);
        spec.bond.friction_modulus_n = 0.0;
        spec.bond.compression_stiffness_n = 10.0;
        spec.test.strain_step = strain_step;
        spec.accuracy = Accuracy::default();
        let (report, _) = run(&spec);
        // two peaks of nearly one height follow each other: their strain is not compared
        let strain = value(&report, "strain_at_max_force");
        assert!(strain < 0.05, "breaks at {strain}");
        assert!(!has_warning(&report, "break_overstepped"), "{strain_step}");
        results.push(value(&report, "max_force"));
    }
    for max_force in &results[1..] {
        // each of the two is found within the precision
        let what = format!("{results:?}");
        assert_within(*max_force, results[0], 2.0 * PRECISION, &what);
    }
}

#[test]
fn the_curve_shows_both_ends_of_a_fall_and_stays_in_order() {
    let (_, record) = run(&bundle(33.0, &spread(7, 0.3)));
    let strains = record.column("nominal_strain");
    assert!(
        strains.windows(2).all(|pair| pair[0] <= pair[1]),
        "{strains:?}"
    );
    let doubled = strains.windows(2).filter(|pair| pair[0] >= pair[1]).count();
    assert_eq!(doubled, 7, "{strains:?}");
    let broken = record.column("broken_bonds");
    assert_eq!(broken.last(), Some(&7.0));
}

#[test]
fn readings_are_at_strains_of_the_spec_and_have_a_reason_once_the_specimen_has_parted() {
    // 60 N times the strain, until 1 N: parted at a strain of 1/60
    let mut spec = bundle(60.0, &[1.0]);
    spec.output.reading_strains = vec![0.005, 0.0125, 0.02];
    let (report, _) = run(&spec);
    for name in ["0_5", "1_25"] {
        let secant = value(&report, &format!("secant_stiffness_at_{name}_percent"));
        assert_within(secant, 60.0, 1e-9, name);
        // the specimen is 10 mm wide
        let modulus = value(&report, &format!("modulus_at_{name}_percent"));
        assert_within(modulus, 6000.0, 1e-9, name);
    }
    for name in [
        "modulus_at_2_percent",
        "poisson_ratio_at_2_percent",
        "modulus_at_10_percent",
    ] {
        let quantity = &report.summary[name];
        assert_eq!(quantity.value, None, "{name}");
        let reason = quantity.reason.as_deref().expect("a reason");
        assert!(
            reason.contains("parted before, at a nominal strain of 0.016"),
            "{reason}"
        );
    }
    // bonds side by side are no width
    let reason = report.summary["poisson_ratio_at_0_5_percent"]
        .reason
        .as_deref();
    assert!(
        reason.is_some_and(|reason| reason.contains("nothing")),
        "{reason:?}"
    );
    let known = &report.summary["modulus_at_0_5_percent"];
    assert_eq!(known.reason, None);
}
