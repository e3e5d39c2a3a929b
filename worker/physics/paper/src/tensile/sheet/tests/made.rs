//! Sheets that are made.
use loadframe_harness::{Ending, Interrupt, InterruptSource, RunContext, Uninterrupted};
use serde_json::{Value, json};

use super::{Record, codes, go, pulp, spec, value};
use crate::tensile::run;

/// A sheet of thirty pieces of fibres with three times as many bonds.
pub(super) fn made() -> Value {
    let mut pulps = pulp();
    pulps[0]["strength_mpa"] = json!(600);
    json!({
        "version": 1, "seed": 3, "pulp": pulps,
        "specimen": {"sheet": {"length_mm": 0.4, "width_mm": 0.2, "grammage_g_per_m2": 20}},
        "bond": {"normal_strength_mpa": 4, "shear_strength_mpa": 4, "strength_variation": 0.3},
        "accuracy": "draft",
    })
}

#[test]
fn a_sheet_has_its_grammage_breaks_and_is_softer_than_coxs() {
    let (report, record) = go(&made(), 1);
    assert!((value(&report, "grammage") / 20.0 - 1.0).abs() < 1e-9);
    let [index, cox] =
        ["tensile_stiffness_index", "cox_stiffness_index"].map(|name| value(&report, name));
    assert!(index > 0.02 * cox && index < cox, "{index} {cox}");
    // by the last avalanche, that takes most or all of the force
    assert_eq!(report.stop_reason, "parted");
    let broken = value(&report, "broken_bonds");
    let events = record.table("events.csv");
    assert!(broken > 20.0 && value(&report, "broken_fibres") > 0.0);
    assert_eq!(
        events.iter().filter(|event| event[6] < 3.0).count() as f64,
        broken
    );
    let modes = ["broken_bonds_opened", "broken_bonds_sheared"];
    let both: f64 = modes.iter().map(|mode| value(&report, mode)).sum();
    assert_eq!(both, broken);
    let curve = record.table("curve.csv");
    assert!(curve.windows(2).all(|pair| pair[1][0] >= pair[0][0]));
    let last = &curve[curve.len() - 1];
    assert_eq!(last[3], broken);
    assert!(last[1] <= 0.3 * value(&report, "max_force"));
    assert!(
        report.quality.values().all(|check| check.ok),
        "{:?}",
        report.quality
    );
    assert_eq!(codes(&report), ["assumed_bond_stiffness"]);
    let lengths = record.table("fibre_lengths.csv");
    let shares: f64 = lengths.iter().map(|row| row[2]).sum();
    assert!((shares - 1.0).abs() < 1e-9);
}

#[test]
fn two_threads_write_the_same_bytes_as_one() {
    let mut body = made();
    body["test"] = json!({"repeats": 2});
    assert_eq!(go(&body, 1), go(&body, 2));
}

#[test]
fn repeats_are_sheets_of_the_seeds_that_follow() {
    let mut body = made();
    body["test"] = json!({"repeats": 2});
    let (joint, record) = go(&body, 1);
    let strengths: Vec<f64> = (3..5)
        .map(|seed| {
            let mut body = made();
            body["seed"] = json!(seed);
            value(&go(&body, 1).0, "tensile_index")
        })
        .collect();
    let mean = strengths.iter().sum::<f64>() / 2.0;
    assert!((value(&joint, "tensile_index") / mean - 1.0).abs() < 1e-12);
    assert!(joint.summary["tensile_index"].interval.is_some());
    assert_eq!(record.table("repeats.csv").len(), 2);
    assert!(record.files.contains_key("repeats_curves.csv"));
    assert!(
        (strengths[0] / strengths[1] - 1.0).abs() > 1e-6,
        "{strengths:?}"
    );
}

#[test]
fn a_sheet_across_the_machine_is_the_sheet_along_it_turned() {
    let mut along = made();
    along["pulp"][0]["shape_factor"] = json!(1.0);
    along["specimen"]["sheet"]["length_mm"] = json!(0.2);
    along["specimen"]["sheet"]["orientation"] = json!({"von_mises": {"concentration": 2}});
    let [mut across, mut both] = [along.clone(), along.clone()];
    across["test"] = json!({"direction": "cd"});
    let [along, across] = [along, across].map(|body| go(&body, 1).0);
    let [md, cd] = [&along, &across].map(|report| value(report, "anisotropy"));
    assert!(md > 0.3 && (md + cd).abs() < 1e-9, "{md} {cd}");
    let ratio = value(&along, "tensile_stiffness") / value(&across, "tensile_stiffness");
    assert!(ratio > 1.5, "{ratio}");
    assert_eq!(value(&along, "bonds"), value(&across, "bonds"));

    // both in one job
    both["test"] = json!({"direction": "both"});
    let (both, record) = go(&both, 2);
    for (name, quantity) in &along.summary {
        assert_eq!(&both.summary[name], quantity);
        assert_eq!(
            value(&both, &format!("{name}_along_cd")),
            value(&across, name)
        );
    }
    let told = value(&both, "anisotropy_of_tensile_stiffness_index");
    assert!((told / ratio - 1.0).abs() < 1e-12, "{told} {ratio}");
    assert!(record.files.contains_key("along_cd/curve.csv"));
}

/// Suspends after so many questions, as a worker does: until it is heard.
struct After(std::sync::atomic::AtomicIsize);

impl InterruptSource for After {
    fn interrupt(&self) -> Option<Interrupt> {
        let left = self.0.fetch_sub(1, std::sync::atomic::Ordering::Relaxed);
        (left <= 0).then_some(Interrupt::Suspend)
    }
}

#[test]
fn a_test_that_was_suspended_goes_on_to_the_same_bytes() {
    goes_on(&made(), &[0, 7]);
}

/// A test that is suspended after so many steps, and goes on with two threads, leaves the same bytes.
pub(super) fn goes_on(body: &Value, steps: &[usize]) {
    let (report, whole) = go(body, 1);
    for &steps in steps {
        let mut record = Record::default();
        let interrupt = After((steps as isize).into());
        let context = RunContext {
            threads: 1,
            interrupt: &interrupt,
            checkpoint: None,
        };
        let ending = run(&spec(body), context, &mut record).unwrap();
        assert!(matches!(ending, Ending::Suspended));
        let checkpoint = std::mem::take(&mut record.checkpoint);
        let context = RunContext {
            threads: 2,
            interrupt: &Uninterrupted,
            checkpoint: Some(&checkpoint),
        };
        let Ending::Finished(again) = run(&spec(body), context, &mut record).unwrap() else {
            panic!("it did not finish");
        };
        assert_eq!(
            (&again.summary, &again.quality),
            (&report.summary, &report.quality)
        );
        assert_eq!(record.points, whole.points);
        let mut files: Vec<_> = record.files.iter().collect();
        let mut expected: Vec<_> = whole.files.iter().collect();
        files.sort();
        expected.sort();
        assert!(files == expected, "after {steps}");
    }
}

#[test]
fn a_truss_of_short_fibres_is_told_to_be_a_mechanism() {
    let mut body = made();
    body["pulp"][0]["length_mm"] = json!(0.2);
    body["specimen"]["sheet"]["width_mm"] = json!(0.1);
    body["model"] = json!({"level": "truss"});
    let (report, _) = go(&body, 1);
    assert!(
        codes(&report).contains(&"truss_mechanism"),
        "{:?}",
        report.warnings
    );
}

#[test]
fn extremes_have_a_result_that_balances() {
    let small = |change: &dyn Fn(&mut Value)| {
        let mut body = made();
        body["specimen"]["sheet"]["length_mm"] = json!(0.2);
        body["specimen"]["sheet"]["width_mm"] = json!(0.1);
        body["bond"]["stiffness_n_per_m_per_um2"] = json!(250);
        change(&mut body);
        body
    };
    let set = |pointer: &'static str, value: Value| {
        small(&|body| *body.pointer_mut(pointer).unwrap() = value.clone())
    };
    let grammage = "/specimen/sheet/grammage_g_per_m2";
    for (name, body) in [
        ("5 g/m2", set(grammage, json!(5))),
        (
            "500 g/m2",
            small(&|body| {
                body["specimen"]["sheet"]["grammage_g_per_m2"] = json!(500);
                body["test"] = json!({"max_strain": 1e-5});
            }),
        ),
        ("curls", set("/pulp/0/shape_factor", json!(0.5))),
        ("no lumen", set("/pulp/0/wall_um", json!(14))),
        ("wall as thick as half the width and soft in shear", {
            let mut body = set("/pulp/0/wall_um", json!(14));
            body["pulp"][0]["shear_modulus_gpa"] = json!(0.3);
            body
        }),
        (
            "soft in shear",
            set("/pulp/0/shear_modulus_gpa", json!(0.3)),
        ),
        (
            "stiff in shear",
            set("/pulp/0/shear_modulus_gpa", json!(15)),
        ),
        ("long fibres", set("/pulp/0/length_mm", json!(20))),
        (
            "no bonds",
            set(
                "/bond",
                json!({"normal_strength_mpa": 0, "shear_strength_mpa": 0}),
            ),
        ),
        ("bonds that hold", set("/bond", json!({}))),
        (
            "soft bonds",
            set("/bond/stiffness_n_per_m_per_um2", json!(1e-3)),
        ),
        (
            "hard bonds",
            set("/bond/stiffness_n_per_m_per_um2", json!(1e5)),
        ),
        (
            "strength without limit",
            set("/bond/normal_strength_mpa", json!(1e6)),
        ),
        (
            "a strain of ten per cent",
            small(&|body| body["test"] = json!({"max_strain": 0.1})),
        ),
        (
            "a strain of one",
            small(&|body| body["test"] = json!({"max_strain": 1.0})),
        ),
        (
            "at random",
            small(&|body| {
                body["specimen"]["sheet"]["placement"] = json!({"random": {"thickness_um": 30}});
            }),
        ),
    ] {
        let (report, _) = go(&body, 1);
        let held = report.quality.values().all(|check| check.ok);
        assert!(held, "{name}: {:?}", report.quality);
        let finite = ["max_force", "tensile_index", "stretch", "energy_absorption"];
        for result in finite {
            let found = value(&report, result);
            assert!(
                found.is_finite() && found >= 0.0,
                "{name}: {result} {found}"
            );
        }
    }
}
