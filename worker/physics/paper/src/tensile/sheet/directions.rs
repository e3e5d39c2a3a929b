//! Sheets of one seed pulled along and across the machine: both results, and how they compare.
use indexmap::IndexMap;
use loadframe_api::spec::paper_tensile::Direction;
use loadframe_api::{Quantity, Report, Warning};
use loadframe_harness::plan::{total_work, worst_quality};

/// Results compared between directions.
const COMPARED: [&str; 6] = [
    "tensile_index",
    "zero_span_index",
    "stretch",
    "energy_absorption_index",
    "tensile_stiffness_index",
    "cox_stiffness_index",
];

/// What the names of the second direction's results end in, and the folder of its files.
pub(super) fn suffix(direction: Direction) -> String {
    format!("along_{}", direction.name())
}

/// Joins the reports of one seed, in the order of the directions. The first keeps its names.
pub(super) fn join(directions: &[Direction], reports: &[Report]) -> Report {
    let ([first, second], [one, other]) = (directions, reports) else {
        return reports.first().cloned().unwrap_or_default();
    };
    let mut summary = one.summary.clone();
    for (name, quantity) in &other.summary {
        let along = Quantity {
            description: format!("Along {}: {}", second.name(), quantity.description),
            ..quantity.clone()
        };
        summary.insert(format!("{name}_{}", suffix(*second)), along);
    }
    summary.extend(ratios([*first, *second], [one, other]));
    let named = [(first, one), (second, other)];
    let warnings = named.iter().flat_map(|(direction, report)| {
        report.warnings.iter().map(|warning| Warning {
            code: warning.code.clone(),
            detail: format!("along {}: {}", direction.name(), warning.detail),
        })
    });
    Report {
        stop_reason: one.stop_reason.clone(),
        summary,
        quality: worst_quality(reports, "The worse of both directions."),
        warnings: warnings.collect(),
        work: total_work(reports),
        bodies: Vec::new(),
    }
}

/// Results of the first direction, of those that the test has, over those of the second; unknown where
/// one of them is.
fn ratios([first, second]: [Direction; 2], reports: [&Report; 2]) -> IndexMap<String, Quantity> {
    let ratio = |name: &str| {
        let [over, under] = reports.map(|report| {
            let value = report.summary.get(name).and_then(|quantity| quantity.value);
            value.unwrap_or(f64::NAN)
        });
        let about = format!(
            "`{name}` along {} over that along {}.",
            first.name(),
            second.name()
        );
        Quantity::new(over / under, "1", &about)
    };
    let known = COMPARED
        .iter()
        .filter(|name| reports[0].summary.contains_key(**name));
    let named = known.map(|name| (format!("anisotropy_of_{name}"), ratio(name)));
    named.collect()
}
