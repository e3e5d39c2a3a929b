//! The joint result of repeats: means with their scatter, the worst quality, all warnings.
use std::io;

use indexmap::IndexMap;
use loadframe_api::{
    QualityCheck, Quantity, Report, Warning, spec::nonwoven_tensile::NonwovenTensile,
};

use super::relay::Curve;
use crate::{Recorder, csv, statistics::Sample};

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

/// The worst value of each check, whose bound is that of the first report.
pub(super) fn worst_quality(reports: &[Report], words: &str) -> IndexMap<String, QualityCheck> {
    let mut quality = reports
        .first()
        .map_or_else(IndexMap::new, |r| r.quality.clone());
    for (name, check) in &mut quality {
        let found = reports.iter().filter_map(|report| report.quality.get(name));
        let worst = found.map(|check| check.value).fold(0.0, f64::max);
        let description = format!("{} {words}", check.description);
        *check = QualityCheck::at_most(worst, check.bound, &check.unit, &description);
    }
    quality
}

/// The sum of each work counter.
pub(super) fn total_work(reports: &[Report]) -> IndexMap<String, u64> {
    let mut work = IndexMap::new();
    for (name, count) in reports.iter().flat_map(|report| &report.work) {
        *work.entry(name.clone()).or_default() += count;
    }
    work
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
        let results = results.map(|(name, quantity)| column(name, &quantity.unit));
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
            for [strain, force] in curve {
                csv::row(out, &[(index + 1) as f64, *strain, *force])?;
            }
        }
        Ok(())
    })
}

/// The known values of a result, in the order of the repeats.
fn values(reports: &[Report], name: &str) -> Vec<f64> {
    let found = reports.iter().filter_map(|report| report.summary.get(name));
    found.filter_map(|quantity| quantity.value).collect()
}

/// The mean of a result's values with their scatter.
fn mean(quantity: &Quantity, values: &[f64]) -> Quantity {
    let sample = Sample::of(values);
    Quantity {
        value: sample.map(|sample| sample.mean),
        deviation: sample.and_then(|sample| sample.deviation),
        interval: sample.and_then(|sample| sample.interval),
        n: Some(sample.map_or(0, |sample| sample.count)),
        ..quantity.clone()
    }
}

/// Each sort of warning once, in the words of the first repeat that has it.
fn warnings(spec: &NonwovenTensile, reports: &[Report]) -> Vec<Warning> {
    let mut sorts = IndexMap::<&str, (u64, &str, usize)>::new();
    for (seed, report) in (spec.seed..).zip(reports) {
        for warning in &report.warnings {
            let first = (seed, warning.detail.as_str(), 0);
            sorts.entry(&warning.code).or_insert(first).2 += 1;
        }
    }
    let total = reports.len();
    let joint = sorts
        .into_iter()
        .map(|(code, (seed, detail, count))| Warning {
            code: code.to_owned(),
            detail: format!("in {count} of {total} repeats, first with seed {seed}: {detail}"),
        });
    let mut warnings: Vec<Warning> = joint.collect();
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

/// The name of a result with its unit, as a column: `max_force` and N give `max_force_n`.
fn column(name: &str, unit: &str) -> String {
    let suffix = unit.to_lowercase().replace('/', "_per_").replace(' ', "_");
    let (quantity, _) = name.split_once("_along_").unwrap_or((name, ""));
    if unit == "1" || quantity.ends_with(&format!("_{suffix}")) {
        return name.to_owned();
    }
    format!("{name}_{suffix}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_carry_their_unit_once() {
        assert_eq!(column("max_force", "N"), "max_force_n");
        assert_eq!(column("strength", "N/m"), "strength_n_per_m");
        assert_eq!(column("strength_pa", "Pa"), "strength_pa");
        assert_eq!(column("poisson_ratio", "1"), "poisson_ratio");
        assert_eq!(column("strength_pa_along_x", "Pa"), "strength_pa_along_x");
        assert_eq!(column("max_force_along_x", "N"), "max_force_along_x_n");
    }
}
