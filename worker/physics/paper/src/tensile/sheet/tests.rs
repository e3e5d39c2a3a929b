//! Sheets through the whole job, against closed forms where there are any.
#![allow(
    clippy::float_cmp,
    reason = "counts, zeros and what is copied are exact"
)]
use std::io::Write;

use indexmap::IndexMap;
use loadframe_api::spec::paper_tensile::PaperTensile;
use loadframe_api::{JobSpec, Report, Submission};
use loadframe_harness::{Ending, Interrupt, InterruptSource, Recorder, RunContext, Uninterrupted};
use serde_json::{Value, json};

use crate::tensile::run;

/// Keeps what a run says.
#[derive(Default, Debug, PartialEq)]
struct Record {
    points: Vec<Vec<f64>>,
    files: IndexMap<String, Vec<u8>>,
    checkpoint: Vec<u8>,
}

impl Recorder for Record {
    fn columns(&mut self, _names: &[&str]) -> std::io::Result<()> {
        self.points.clear();
        Ok(())
    }

    fn point(&mut self, values: &[f64]) -> std::io::Result<()> {
        self.points.push(values.to_vec());
        Ok(())
    }

    fn file(
        &mut self,
        name: &str,
        write: &mut dyn FnMut(&mut dyn Write) -> std::io::Result<()>,
    ) -> std::io::Result<()> {
        let mut bytes = Vec::new();
        write(&mut bytes)?;
        self.files.insert(name.to_owned(), bytes);
        Ok(())
    }

    fn progress(&mut self, fraction: f64, _phase: &str) {
        assert!((0.0..=1.0).contains(&fraction));
    }

    fn log(&mut self, _message: &str) {}

    fn checkpoint_due(&self) -> bool {
        false
    }

    fn checkpoint(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.checkpoint = bytes.to_vec();
        Ok(())
    }
}

impl Record {
    fn table(&self, name: &str) -> Vec<Vec<f64>> {
        let text = std::str::from_utf8(&self.files[name]).unwrap();
        let rows = text.lines().skip(1).map(|line| {
            let cells = line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN));
            cells.collect()
        });
        rows.collect()
    }
}

fn spec(body: &Value) -> PaperTensile {
    let job = json!({"kind": "paper_tensile", "spec": body});
    let submission = Submission::from_slice(job.to_string().as_bytes()).unwrap();
    let JobSpec::PaperTensile(spec) = submission.spec else {
        panic!("another kind");
    };
    *spec
}

fn go(body: &Value, threads: usize) -> (Report, Record) {
    let context = RunContext {
        threads,
        interrupt: &Uninterrupted,
        checkpoint: None,
    };
    let mut record = Record::default();
    match run(&spec(body), context, &mut record).unwrap() {
        Ending::Finished(report) => (report, record),
        other => panic!("{other:?}"),
    }
}

fn value(report: &Report, name: &str) -> f64 {
    report.summary[name].value.unwrap()
}

fn codes(report: &Report) -> Vec<&str> {
    let codes = report.warnings.iter();
    codes.map(|warning| warning.code.as_str()).collect()
}

/// E A = 30 GPa × π 2 (28 − 2) µm² [mN].
const EA_MN: f64 = 30.0 * std::f64::consts::PI * 2.0 * 26.0;

fn pulp() -> Value {
    json!([{"name": "softwood", "length_mm": 1.0, "length_variation": 0.3, "width_um": 28, "wall_um": 2,
            "coarseness_mg_per_m": 0.245, "youngs_modulus_gpa": 30, "poisson_ratio": 0.3,
            "shear_modulus_gpa": 2.5, "shape_factor": 0.97}])
}

/// Two fibres of which each reaches 600 µm into a gap of 1 mm, bonded where their middles meet.
fn lap() -> Value {
    json!({
        "version": 1, "seed": 1, "pulp": pulp(),
        "specimen": {"explicit": {
            "length_mm": 1.0, "width_mm": 0.1,
            "fibres": [
                {"pulp": "softwood", "centre_line_um": [[0, 0, 0], [600, 0, 0]]},
                {"pulp": "softwood", "centre_line_um": [[400, 0, 0], [1000, 0, 0]]},
            ],
            "bonds": [{"fibres": [0, 1], "at_um": [500, 100], "area_um2": 400, "shear_strength_n": 0.004}],
        }},
        "bond": {"normal_strength_mpa": 100, "shear_strength_mpa": 1, "stiffness_n_per_m_per_um2": 250},
        "test": {"max_strain": 0.05},
    })
}

#[test]
fn a_lap_of_two_fibres_is_three_springs_in_series_until_its_bond_shears() {
    let (report, record) = go(&lap(), 1);
    // 250 N/m/µm² × 400 µm² = 1e5 N/m = 100 mN/µm; each fibre 500 µm long
    let softness_um_per_mn = 500.0 / EA_MN + 1.0 / 100.0 + 500.0 / EA_MN;
    // its own 4 mN, not the 1 MPa × 400 µm² = 0.4 mN of all bonds
    let strain = 4.0 * softness_um_per_mn / 1000.0;
    let near = |name: &str, expected: f64| {
        let found = value(&report, name);
        assert!(
            (found / expected - 1.0).abs() < 1e-9,
            "{name}: {found}, not {expected}"
        );
    };
    near("max_force", 0.004);
    near("tensile_strength", 0.004 / 0.1);
    near("stretch", strain);
    near(
        "tensile_stiffness",
        1e-3 * 1000.0 / softness_um_per_mn / 0.1,
    );
    // half of 4 mN over the elongation, in nJ, over 1 mm × 0.1 mm
    near(
        "energy_absorption",
        0.5 * 4.0 * 1000.0 * strain * 1e-9 / 1e-7,
    );
    // 1200 µm of 0.245 mg/m over 1e5 µm²
    let grammage = 1.2e-3 * 0.245e-3 / (1e-3 * 1e-4);
    near("grammage", grammage);
    near("tensile_index", 40.0 / grammage);
    near("breaking_length", 40.0 / grammage / 9.80665);
    near(
        "tensile_stiffness_index",
        1e-3 * 1000.0 / softness_um_per_mn / 0.1 / grammage,
    );
    near("broken_bonds", 1.0);
    near("broken_bonds_sheared", 1.0);
    assert_eq!(report.stop_reason, "parted");
    assert_eq!(codes(&report), Vec::<&str>::new());
    assert!(
        report.quality.values().all(|check| check.ok),
        "{:?}",
        report.quality
    );

    // the curve: nothing, the largest force, and its fall at the same strain
    assert_eq!(record.points, record.table("curve.csv"));
    let strains: Vec<f64> = record.points.iter().map(|point| point[0]).collect();
    let forces: Vec<f64> = record.points.iter().map(|point| point[1]).collect();
    assert_eq!(strains.len(), 3);
    assert!((strains[1] / strain - 1.0).abs() < 1e-9 && strains[2] == strains[1]);
    assert!(forces[0] == 0.0 && (forces[1] / 0.004 - 1.0).abs() < 1e-9 && forces[2] == 0.0);
    let event = &record.table("events.csv")[0];
    assert_eq!(event[..2], [1.0, 1.0]);
    assert_eq!((event[3], event[6]), (0.0, 2.0));
    assert!((event[4] / 0.004 - 1.0).abs() < 1e-9);
    // all that was stored, in N mm
    let stored = 0.5 * 0.004 * strain;
    assert!((event[5] / stored - 1.0).abs() < 1e-9, "{}", event[5]);
    let pictures = [
        "snapshots/sheet_00001.vtp",
        "snapshots/sheet_00002.vtp",
        "snapshots.pvd",
    ];
    assert!(pictures.iter().all(|name| record.files.contains_key(*name)));
}

#[test]
fn a_bond_takes_strength_and_stiffness_by_its_area_and_says_what_was_assumed() {
    let mut body = lap();
    body["specimen"]["explicit"]["bonds"][0]["shear_strength_n"] = Value::Null;
    body["bond"] = json!({"shear_strength_mpa": 5});
    let (report, _) = go(&body, 1);
    // 5 MPa × 400 µm² = 2 mN
    assert!((value(&report, "max_force") / 0.002 - 1.0).abs() < 1e-9);
    // two halves of a wall of π 2 × 26/28 µm and 3 GPa: 3/t GPa/µm, and 1 GPa/µm = 1000 N/m/µm²
    let thickness_um = std::f64::consts::PI * 2.0 * 26.0 / 28.0;
    let bond_mn_per_um = 3.0 / thickness_um * 400.0;
    let softness = 1000.0 / EA_MN + 1.0 / bond_mn_per_um;
    let expected = 1e-3 * 1000.0 / softness / 0.1;
    assert!((value(&report, "tensile_stiffness") / expected - 1.0).abs() < 1e-9);
    assert_eq!(codes(&report), ["assumed_bond_stiffness"]);
    let told = format!("{:.4}", 1000.0 * 3.0 / thickness_um);
    assert!(
        report.warnings[0].detail.contains(&told),
        "{}",
        report.warnings[0].detail
    );
}

#[test]
fn a_fibre_breaks_where_it_is_stressed_most_and_the_order_of_a_sheet_does_not_matter() {
    // side by side: one straight fibre that breaks at 1 %, and the lap, which holds on
    let mut body = lap();
    body["pulp"][0]["strength_mpa"] = json!(300);
    body["bond"]["shear_strength_mpa"] = json!(1000);
    body["specimen"]["explicit"]["bonds"][0]["shear_strength_n"] = json!(0.5);
    let straight =
        json!({"pulp": "softwood", "centre_line_um": [[0, 50, 0], [300, 50, 0], [1000, 50, 0]]});
    body["specimen"]["explicit"]["fibres"]
        .as_array_mut()
        .unwrap()
        .push(straight.clone());
    let (report, record) = go(&body, 1);
    let softness = 1000.0 / EA_MN + 1.0 / 100.0;
    let forces = [EA_MN * 0.01, 10.0 / softness];
    assert!((value(&report, "max_force") / (1e-3 * (forces[0] + forces[1])) - 1.0).abs() < 1e-9);
    assert!((value(&report, "stretch") / 0.01 - 1.0).abs() < 1e-9);
    let event = &record.table("events.csv")[0];
    assert!(event[3].is_nan() && event[4].is_nan());
    assert_eq!((event[6], event[9]), (3.0, 2.0));
    assert!((event[11] / 300.0 - 1.0).abs() < 1e-9);
    assert!((event[12] / (1e-3 * forces[1]) - 1.0).abs() < 1e-9);
    assert_eq!(value(&report, "broken_fibres"), 2.0);

    // the same in another order, and the bond named from its other side
    let explicit = &mut body["specimen"]["explicit"];
    explicit["fibres"] = json!([straight, explicit["fibres"][1], explicit["fibres"][0]]);
    explicit["bonds"] =
        json!([{"fibres": [1, 2], "at_um": [100, 500], "area_um2": 400, "shear_strength_n": 0.5}]);
    let (turned, _) = go(&body, 1);
    for (name, quantity) in &report.summary {
        let (one, other) = (quantity.value.unwrap(), value(&turned, name));
        assert!(
            (one - other).abs() <= 1e-9 * one.abs(),
            "{name}: {one} and {other}"
        );
    }
}

#[test]
fn nothing_that_ties_the_jaws_is_a_force_of_zero_and_a_sentence() {
    let mut body = lap();
    body["specimen"]["explicit"]["bonds"] = json!([]);
    let (report, record) = go(&body, 1);
    assert_eq!(report.stop_reason, "no_load_path");
    assert_eq!(codes(&report), ["no_load_path"]);
    assert_eq!(value(&report, "max_force"), 0.0);
    assert_eq!(value(&report, "tensile_index"), 0.0);
    assert_eq!(record.points.len(), 1);
    // a bond without strength is none
    let mut body = lap();
    body["specimen"]["explicit"]["bonds"][0]["shear_strength_n"] = json!(0);
    body["bond"]["normal_strength_mpa"] = json!(0);
    let (report, _) = go(&body, 1);
    assert_eq!(report.stop_reason, "no_load_path");
    assert_eq!(value(&report, "void_bonds"), 1.0);
}

/// Both fibres are held at both ends and do not turn there. Where they cross they move alike, and turn
/// against one another, which the bond resists.
#[test]
fn two_crossed_fibres_are_two_built_in_beams_and_break_by_tension_and_bending() {
    let mut body = lap();
    body["pulp"][0]["strength_mpa"] = json!(600);
    body["specimen"]["explicit"]["fibres"] = json!([
        {"pulp": "softwood", "centre_line_um": [[0, 0, 0], [400, 300, 0]]},
        {"pulp": "softwood", "centre_line_um": [[0, 300, 0], [400, 0, 0]]},
    ]);
    body["specimen"]["explicit"]["length_mm"] = json!(0.4);
    body["specimen"]["explicit"]["bonds"] =
        json!([{"fibres": [0, 1], "at_um": [250, 250], "area_um2": 400}]);
    body["bond"] = json!({"stiffness_n_per_m_per_um2": 250});
    let (report, record) = go(&body, 1);
    let (length_um, cos, sin) = (500.0, 0.8, 0.6);
    let area = std::f64::consts::PI * 2.0 * 26.0;
    let inertia = std::f64::consts::PI / 64.0 * (28_f64.powi(4) - 24_f64.powi(4));
    // halves of a length h, of 12 E I/(κ G A h²) = Φ; the bond has s a²/12 against turning
    let half_um = 0.5 * length_um;
    let shear_mn = 2.6 / 4.9 * 2.5 * area;
    let phi = 12.0 * 30.0 * inertia / (shear_mn * half_um * half_um);
    let bending = 30.0 * inertia / (1.0 + phi);
    let bond_mn_um = 0.25 * 400.0 * 400.0 / 12.0;
    // per elongation of the jaws: half a beam moves by w across at its middle and turns there by t
    let w = 0.5 * sin;
    let turn = 6.0 * bending / half_um.powi(2) * w / ((4.0 + phi) * bending / half_um + bond_mn_um);
    let across = 12.0 * bending / half_um.powi(3) * w - 6.0 * bending / half_um.powi(2) * turn;
    let moment = 6.0 * bending / half_um.powi(2) * w - (2.0 - phi) * bending / half_um * turn;
    let tension = 30.0 * area / length_um * cos;
    let stiffness_mn_per_um = 2.0 * (tension * cos + across * sin);
    let expected = stiffness_mn_per_um * 400.0 * 1e-3 / 0.1;
    let found = value(&report, "tensile_stiffness");
    assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    let elongation = 0.6 / (tension / area + moment * 14.0 / inertia);
    let found = value(&report, "stretch") * 400.0;
    assert!(
        (found / elongation - 1.0).abs() < 1e-9,
        "{found} {elongation}"
    );
    assert!((record.table("events.csv")[0][11] / 600.0 - 1.0).abs() < 1e-9);
}

#[test]
fn bonds_that_do_not_break_leave_a_straight_line() {
    let mut body = lap();
    body["specimen"]["explicit"]["bonds"][0]["shear_strength_n"] = Value::Null;
    body["bond"] = json!({"stiffness_n_per_m_per_um2": 250});
    let (report, record) = go(&body, 1);
    assert_eq!(codes(&report), ["nothing_broke"]);
    assert_eq!(report.stop_reason, "max_strain");
    assert_eq!(record.points.len(), 2);
    assert!((record.points[1][0] - 0.05).abs() < 1e-12);
}

/// A sheet of thirty pieces of fibres with three times as many bonds.
fn made() -> Value {
    let mut pulps = pulp();
    pulps[0]["strength_mpa"] = json!(600);
    json!({
        "version": 1, "seed": 3, "pulp": pulps,
        "specimen": {"sheet": {"length_mm": 0.4, "width_mm": 0.2, "grammage_g_per_m2": 20}},
        "bond": {"normal_strength_mpa": 4, "shear_strength_mpa": 4, "strength_variation": 0.3},
    })
}

#[test]
fn a_sheet_has_its_grammage_breaks_and_is_softer_than_coxs() {
    let (report, record) = go(&made(), 1);
    assert!((value(&report, "grammage") / 20.0 - 1.0).abs() < 1e-9);
    let [index, cox] =
        ["tensile_stiffness_index", "cox_stiffness_index"].map(|name| value(&report, name));
    assert!(index > 0.02 * cox && index < cox, "{index} {cox}");
    assert_eq!(report.stop_reason, "force_dropped");
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

/// Suspends after so many questions.
struct After(std::sync::atomic::AtomicUsize);

impl InterruptSource for After {
    fn interrupt(&self) -> Option<Interrupt> {
        let left = self.0.fetch_sub(1, std::sync::atomic::Ordering::Relaxed);
        (left == 0).then_some(Interrupt::Suspend)
    }
}

#[test]
fn a_test_that_was_suspended_goes_on_to_the_same_bytes() {
    let body = made();
    let (report, whole) = go(&body, 1);
    for breaks in [0, 7] {
        let mut record = Record::default();
        let interrupt = After(breaks.into());
        let context = RunContext {
            threads: 1,
            interrupt: &interrupt,
            checkpoint: None,
        };
        let ending = run(&spec(&body), context, &mut record).unwrap();
        assert!(matches!(ending, Ending::Suspended));
        let checkpoint = std::mem::take(&mut record.checkpoint);
        let context = RunContext {
            threads: 2,
            interrupt: &Uninterrupted,
            checkpoint: Some(&checkpoint),
        };
        let Ending::Finished(again) = run(&spec(&body), context, &mut record).unwrap() else {
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
        assert!(files == expected, "after {breaks}");
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
