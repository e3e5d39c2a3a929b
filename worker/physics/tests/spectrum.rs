//! Tables derived from breaking events, lateral contraction and bond forces agree with what they
//! are derived from.
#![allow(clippy::float_cmp, reason = "counts and copied numbers are exact")]
mod scene;

use loadframe_api::spec::nonwoven_tensile::{Accuracy, Breaking, Jaw, NonwovenTensile};
use scene::{Record, bond, explicit, polyester, run};

/// Additions of a few hundred numbers of order one.
const ROUND_OFF: f64 = 1e-12;

fn torn() -> (NonwovenTensile, Record) {
    let mut spec = polyester(9, 11, 2);
    spec.test.strain_step = 0.05;
    let (_, record) = run(&spec);
    (spec, record)
}

#[test]
fn every_event_is_counted_once_in_every_table() {
    let (_, record) = torn();
    let events = record.table("events.csv");
    let energy: f64 = events.iter().map(|event| event[5]).sum();
    for table in ["breaking_by_force.csv", "breaking_by_strain.csv"] {
        let bins = record.table(table);
        let counted: f64 = bins.iter().map(|bin| bin[2]).sum();
        assert_eq!(counted, events.len() as f64, "{table}");
        let released: f64 = bins.iter().map(|bin| bin[3]).sum();
        assert!((released - energy).abs() < ROUND_OFF * energy, "{table}");
        assert!(
            bins.windows(2).all(|pair| pair[0][1] == pair[1][0]),
            "{table}"
        );
    }
    let avalanches = record.table("avalanches.csv");
    for column in [1, 2] {
        let counted: f64 = avalanches.iter().map(|row| row[0] * row[column]).sum();
        assert_eq!(counted, events.len() as f64);
    }
    let drops = record.table("force_drops.csv");
    assert_eq!(
        drops.iter().map(|drop| drop[3]).sum::<f64>(),
        events.len() as f64
    );
    // as many steps with breaks as avalanches of steps
    let steps: f64 = avalanches.iter().map(|row| row[1]).sum();
    let mut in_steps: Vec<f64> = drops.iter().map(|drop| drop[0]).collect();
    // a step has a row for each fall that was found in it
    in_steps.dedup();
    assert_eq!(in_steps.len() as f64, steps);
}

#[test]
fn a_bond_that_breaks_beside_another_takes_its_force_away() {
    // two bonds of 10 mm side by side, T = u (1 N) and T = 3 u, the second breaks at 0.5 N:
    // at u = 0.2 it carries 0.6 N, so the force falls from 0.8 N to 0.2 N
    let mut strong = bond(0, 1);
    strong.modulus_n = Some(1.0);
    strong.strength_n = Some(10.0);
    let mut weak = bond(2, 3);
    weak.modulus_n = Some(3.0);
    weak.strength_n = Some(0.5);
    let nodes = [
        ([0.0, 0.0, 0.0], Jaw::Bottom),
        ([0.0, 10.0, 0.0], Jaw::Top),
        ([5.0, 0.0, 0.0], Jaw::Bottom),
        ([5.0, 10.0, 0.0], Jaw::Top),
    ];
    let mut spec = explicit(&nodes, vec![strong, weak], Default::default());
    spec.test.breaking = Breaking::AllOverStrength;
    spec.test.strain_step = 0.1;
    spec.test.max_strain = 0.3;
    let mut knobs = spec.accuracy.knobs();
    knobs.break_precision = None;
    spec.accuracy = Accuracy::Knobs(knobs);
    let (_, record) = run(&spec);
    let drops = record.table("force_drops.csv");
    let expected = [2.0, 0.2, 1.0, 1.0, 0.8, 0.2, 0.6];
    assert_eq!(drops.len(), 1);
    let pairs = drops[0].iter().zip(expected);
    assert!(
        pairs
            .into_iter()
            .all(|(found, is)| (found - is).abs() < ROUND_OFF),
        "{drops:?}"
    );
    assert_eq!(record.table("avalanches.csv"), [[1.0, 1.0, 1.0]]);
}

#[test]
fn the_poisson_ratio_is_contraction_over_strain_along_the_whole_curve() {
    let (_, record) = torn();
    let strains = record.column("nominal_strain");
    let widths = record.column("width_strain");
    let ratios = record.column("poisson_ratio");
    assert_eq!(ratios[0], 0.0);
    // of the two points of a fall, at one strain, the later has no row
    let risen: Vec<usize> = (1..strains.len())
        .filter(|point| strains[*point] > strains[point - 1])
        .collect();
    let rows = record.table("poisson_ratio.csv");
    assert_eq!(rows.len(), risen.len());
    for (row, point) in rows.iter().zip(risen) {
        assert_eq!(row[..3], [strains[point], widths[point], ratios[point]]);
        assert!((ratios[point] * strains[point] + widths[point]).abs() < ROUND_OFF);
        let tangent = -(widths[point] - widths[point - 1]) / (strains[point] - strains[point - 1]);
        assert!((row[3] - tangent).abs() < ROUND_OFF * tangent.abs().max(1.0));
    }
}

#[test]
fn bond_forces_are_distributed_at_the_steps_nearest_to_the_strains_asked_for() {
    let mut spec = polyester(5, 7, 2);
    spec.test.strain_step = 0.1;
    spec.test.max_strain = 0.5;
    spec.test.breaking = Breaking::None;
    spec.output.histogram_bins = 7;
    spec.output.force_distribution_strains = vec![0.32, 0.1];
    let (report, record) = run(&spec);
    let bins = record.table("force_distribution.csv");
    assert_eq!(bins.len(), 14);
    for (strain, bins) in [0.1, 3.0 * 0.1].into_iter().zip(bins.chunks(7)) {
        assert!(bins.iter().all(|bin| bin[0] == strain));
        let counted: f64 = bins.iter().map(|bin| bin[3]).sum();
        assert_eq!(Some(counted), report.summary["bonds"].value);
    }
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
}

#[test]
fn strains_beyond_the_end_of_the_test_are_named() {
    let mut spec = polyester(5, 7, 2);
    spec.test.strain_step = 0.1;
    spec.output.force_distribution_strains = vec![0.2, 2.9];
    let (report, record) = run(&spec);
    let warning = report
        .warnings
        .iter()
        .find(|warning| warning.code == "strain_not_reached");
    let detail = &warning.expect("the fabric is torn before 290 %").detail;
    assert!(
        detail.contains("2.9") && !detail.contains("0.2"),
        "{detail}"
    );
    assert_eq!(record.table("force_distribution.csv").len(), 40);
}
