//! The joint result of repeats: means with their scatter, the worst quality, all warnings.
use std::io;

use loadframe_api::{Report, Warning, spec::nonwoven_tensile::NonwovenTensile};
use loadframe_harness::{
    Recorder, csv,
    plan::{Curve, joint_warnings, mean, total_work, values, worst_quality},
};

/// Joins the reports of all repeats, the first of which gives the words.
pub(super) fn join(spec: &NonwovenTensile, reports: &[Report]) -> Report {
    let mut joint = reports.first().cloned().unwrap_or_default();
    for (name, quantity) in &mut joint.summary {
        *quantity = mean(quantity, &values(reports, name));
    }
    joint.quality = worst_quality(reports, "The worst of all repeats.");
    joint.warnings = warnings(spec, reports);
    joint.work = total_work(reports);
    joint
}

/// `repeats.csv`, seed and results of every repeat.
pub(super) fn write(
    spec: &NonwovenTensile,
    reports: &[Report],
    recorder: &mut dyn Recorder,
) -> io::Result<()> {
    recorder.file("repeats.csv", &mut |out| {
        let Some(first) = reports.first() else {
            return Ok(());
        };
        let results = first.summary.iter();
        let results = results.map(|(name, quantity)| csv::column(name, &quantity.unit));
        let names: Vec<String> = ["repeat".to_owned(), "seed".to_owned()]
            .into_iter()
            .chain(results)
            .collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        csv::header(out, &names)?;
        for (index, report) in reports.iter().enumerate() {
            let mut row = vec![(index + 1) as f64, (spec.seed + index as u64) as f64];
            let results = first.summary.keys().map(|name| report.summary.get(name));
            row.extend(results.map(|found| found.and_then(|q| q.value).unwrap_or(f64::NAN)));
            csv::row(out, &row)?;
        }
        Ok(())
    })
}

/// The curves of all repeats in one direction.
pub(super) fn write_curves<'a>(
    name: &str,
    curves: impl Iterator<Item = &'a Curve> + Clone,
    recorder: &mut dyn Recorder,
) -> io::Result<()> {
    recorder.file(name, &mut |out| {
        csv::header(out, &["repeat", "nominal_strain", "force_n"])?;
        for (index, curve) in curves.clone().enumerate() {
            for point in curve.rows() {
                let mut row = vec![(index + 1) as f64];
                row.extend(point);
                csv::row(out, &row)?;
            }
        }
        Ok(())
    })
}

/// The warnings of all repeats, and one where they teach no more than one.
fn warnings(spec: &NonwovenTensile, reports: &[Report]) -> Vec<Warning> {
    let mut warnings = joint_warnings(spec.seed, "repeats", reports);
    let mut others = reports.iter().skip(1);
    if reports.len() > 1 && others.all(|report| report.summary == reports[0].summary) {
        warnings.push(Warning {
            code: "repeats_alike".to_owned(),
            detail: "all repeats gave the same: nothing that counts in this test is drawn at \
                     random, and one repeat says as much"
                .to_owned(),
        });
    }
    warnings
}
