//! One specimen pulled in two directions: both results, and how they compare.
use indexmap::IndexMap;
use loadframe_api::{Quantity, Report, Warning, spec::nonwoven_tensile::Direction};
use loadframe_harness::plan::{total_work, worst_quality};

/// Results compared between directions, in units that do not depend on the specimen's size.
const COMPARED: [&str; 4] = [
    "strength",
    "strain_at_max_force",
    "modulus_at_10_percent",
    "poisson_ratio",
];

/// What the names of the second direction's results end in, and the folder of its files.
pub(super) fn suffix(direction: Direction) -> String {
    format!("along_{}", direction.name())
}

/// Joins the reports of one specimen, in the order of the directions. The first keeps its names.
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
    summary.extend(anisotropy([*first, *second], [one, other]));
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

/// Results of the first direction over those of the second, unknown where one of them is.
fn anisotropy(
    [first, second]: [Direction; 2],
    reports: [&Report; 2],
) -> IndexMap<String, Quantity> {
    let ratio = |name: &str| {
        let [over, under] = reports.map(|report| {
            let value = report.summary.get(name).and_then(|quantity| quantity.value);
            value.unwrap_or(f64::NAN)
        });
        let words = format!(
            "{} along {} over that along {}.",
            name.replace('_', " "),
            first.name(),
            second.name()
        );
        let (initial, rest) = words.split_at(1);
        let description = format!("{}{rest}", initial.to_uppercase());
        Quantity::new(over / under, "1", &description)
    };
    let named = COMPARED
        .iter()
        .map(|name| (format!("anisotropy_of_{name}"), ratio(name)));
    named.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(strength: f64, warning: &str) -> Report {
        Report {
            summary: IndexMap::from([(
                "strength".to_owned(),
                Quantity::new(strength, "N/m", "Largest force per width of the specimen."),
            )]),
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
        let joint = join(&[Direction::Y, Direction::X], &reports);
        let value = |name: &str| joint.summary[name].value;
        assert_eq!(value("strength"), Some(6.0));
        assert_eq!(value("strength_along_x"), Some(4.0));
        assert_eq!(value("anisotropy_of_strength"), Some(1.5));
        // neither direction knows it
        assert_eq!(value("anisotropy_of_poisson_ratio"), None);
        assert_eq!(
            joint.summary["anisotropy_of_strength"].description,
            "Strength along y over that along x."
        );
        let details: Vec<&str> = joint.warnings.iter().map(|w| w.detail.as_str()).collect();
        assert_eq!(details, ["along y: a", "along x: b"]);
        assert_eq!(joint.work["sweeps"], 4);
    }

    #[test]
    fn one_direction_is_itself() {
        let report = report(6.0, "a");
        assert_eq!(join(&[Direction::X], std::slice::from_ref(&report)), report);
    }

    #[test]
    fn nothing_is_compared_with_nothing() {
        let reports = [report(6.0, "a"), report(0.0, "b")];
        let joint = join(&[Direction::X, Direction::Y], &reports);
        assert_eq!(joint.summary["anisotropy_of_strength"].value, None);
    }
}
