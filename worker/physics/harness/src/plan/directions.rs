//! One specimen tested in two directions: both results, and how they compare.
use indexmap::IndexMap;
use loadframe_api::{Quantity, Report, Warning};

use super::reports::{total_work, worst_quality};

/// A result that is compared between directions, and what a sentence that begins with it calls it.
pub type Compared = (&'static str, &'static str);

/// What the names of the second direction's results end in, and the folder of its files.
pub(super) fn suffix(direction: &str) -> String {
    format!("along_{direction}")
}

/// Joins the reports of one specimen, in the order of the directions. The first keeps its names; after
/// both follow the ratios of what is `compared`.
pub(super) fn join(directions: &[&str], compared: &[Compared], reports: &[Report]) -> Report {
    let ([first, second], [one, other]) = (directions, reports) else {
        return reports.first().cloned().unwrap_or_default();
    };
    let mut summary = one.summary.clone();
    for (name, quantity) in &other.summary {
        let along = Quantity {
            description: format!("Along {second}: {}", quantity.description),
            ..quantity.clone()
        };
        summary.insert(format!("{name}_{}", suffix(second)), along);
    }
    summary.extend(anisotropy([first, second], compared, [one, other]));
    let named = [(first, one), (second, other)];
    let warnings = named.iter().flat_map(|(direction, report)| {
        report.warnings.iter().map(move |warning| Warning {
            code: warning.code.clone(),
            detail: format!("along {direction}: {}", warning.detail),
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

/// Results of the first direction, of those that the test has, over those of the second; unknown where one
/// of them is.
fn anisotropy(
    [first, second]: [&str; 2],
    compared: &[Compared],
    reports: [&Report; 2],
) -> IndexMap<String, Quantity> {
    let ratio = |name: &str, words: &str| {
        let [over, under] = reports.map(|report| {
            let value = report.summary.get(name).and_then(|quantity| quantity.value);
            value.unwrap_or(f64::NAN)
        });
        let about = format!("{words} along {first} over that along {second}.");
        Quantity::new(over / under, "1", &about)
    };
    let known = compared
        .iter()
        .filter(|(name, _)| reports[0].summary.contains_key(*name));
    let named = known.map(|(name, words)| (format!("anisotropy_of_{name}"), ratio(name, words)));
    named.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const COMPARED: [Compared; 2] = [
        ("strength", "Strength"),
        ("poisson_ratio", "`poisson_ratio`"),
    ];

    fn report(strength: f64, warning: &str) -> Report {
        Report {
            summary: IndexMap::from([
                (
                    "strength".to_owned(),
                    Quantity::new(strength, "N/m", "Largest force per width of the specimen."),
                ),
                (
                    "poisson_ratio".to_owned(),
                    Quantity::new(f64::NAN, "1", "Lateral contraction over strain."),
                ),
            ]),
            warnings: vec![Warning {
                code: "w".to_owned(),
                detail: warning.to_owned(),
            }],
            work: IndexMap::from([("sweeps".to_owned(), 2)]),
            ..Report::default()
        }
    }

    #[test]
    fn the_second_direction_is_named_and_compared() {
        let reports = [report(6.0, "a"), report(4.0, "b")];
        let joint = join(&["y", "x"], &COMPARED, &reports);
        let value = |name: &str| joint.summary[name].value;
        assert_eq!(value("strength"), Some(6.0));
        assert_eq!(value("strength_along_x"), Some(4.0));
        assert_eq!(value("anisotropy_of_strength"), Some(1.5));
        // neither direction knows it
        assert_eq!(value("anisotropy_of_poisson_ratio"), None);
        let about = |name: &str| joint.summary[name].description.as_str();
        assert_eq!(
            about("anisotropy_of_strength"),
            "Strength along y over that along x."
        );
        assert_eq!(
            about("anisotropy_of_poisson_ratio"),
            "`poisson_ratio` along y over that along x."
        );
        let details: Vec<&str> = joint.warnings.iter().map(|w| w.detail.as_str()).collect();
        assert_eq!(details, ["along y: a", "along x: b"]);
        assert_eq!(joint.work["sweeps"], 4);
    }

    #[test]
    fn one_direction_is_itself() {
        let report = report(6.0, "a");
        let reports = std::slice::from_ref(&report);
        assert_eq!(join(&["x"], &COMPARED, reports), report);
    }

    #[test]
    fn nothing_is_compared_with_nothing() {
        let reports = [report(6.0, "a"), report(0.0, "b")];
        let joint = join(&["x", "y"], &COMPARED, &reports);
        assert_eq!(joint.summary["anisotropy_of_strength"].value, None);
    }
}
