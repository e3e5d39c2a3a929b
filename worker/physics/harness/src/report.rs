//! A report in the making.
use loadframe_api::{ErrorPart, QualityCheck, Quantity, Report, Warning};

/// Takes in what a test found, in the order in which it is to be read: results with their units, what
/// tells whether to believe them, warnings, counters of work.
#[derive(Clone, Debug, Default)]
pub struct ReportBuilder(Report);

impl ReportBuilder {
    /// Of a test that ended for this reason, a word for programs.
    pub fn new(stop_reason: &str) -> Self {
        Self(Report {
            stop_reason: stop_reason.to_owned(),
            ..Report::default()
        })
    }

    /// A result; unknown where it is `None` or not a number.
    pub fn result(
        &mut self,
        name: &str,
        value: impl Into<Option<f64>>,
        unit: &str,
        description: &str,
    ) {
        self.result_with_error(name, value, unit, description, Vec::new());
    }

    /// A result, and how wrong it may be; of that, parts that are not numbers are left out.
    pub fn result_with_error(
        &mut self,
        name: &str,
        value: impl Into<Option<f64>>,
        unit: &str,
        description: &str,
        parts: Vec<ErrorPart>,
    ) {
        let value = value.into().unwrap_or(f64::NAN);
        let quantity = Quantity::new(value, unit, description).with_error(parts);
        self.insert(name, quantity);
    }

    /// A result that is a number of things.
    pub fn count(&mut self, name: &str, count: usize, description: &str) {
        self.result(name, count as f64, "1", description);
    }

    /// A result that is made already.
    pub fn insert(&mut self, name: &str, quantity: Quantity) {
        self.0.summary.insert(name.to_owned(), quantity);
    }

    /// What a result was found to be; `None` where it is unknown.
    pub fn value(&self, name: &str) -> Option<f64> {
        self.0.summary.get(name)?.value
    }

    /// A measure of quality that is good up to and including `bound`.
    pub fn check(&mut self, name: &str, value: f64, bound: f64, unit: &str, description: &str) {
        let check = QualityCheck::at_most(value, bound, unit, description);
        self.0.quality.insert(name.to_owned(), check);
    }

    /// The measures of quality so far.
    pub fn checks(&self) -> impl Iterator<Item = (&str, &QualityCheck)> {
        let checks = self.0.quality.iter();
        checks.map(|(name, check)| (name.as_str(), check))
    }

    /// A measure of quality that is beyond its bound.
    pub fn failed(&self, name: &str) -> Option<&QualityCheck> {
        self.0.quality.get(name).filter(|check| !check.ok)
    }

    /// Something a reader of the results should know.
    pub fn warn(&mut self, code: &str, detail: impl Into<String>) {
        self.0.warnings.push(Warning {
            code: code.to_owned(),
            detail: detail.into(),
        });
    }

    /// A counter of work.
    pub fn work(&mut self, name: &str, count: u64) {
        self.0.work.insert(name.to_owned(), count);
    }

    /// The report.
    pub fn finish(self) -> Report {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_says_what_it_was_told_in_that_order() {
        let mut report = ReportBuilder::new("max_strain");
        report.result("strength", 2.5, "N/m", "Largest force per width.");
        report.result("poisson_ratio", None, "1", "Nobody looked.");
        report.result("modulus", f64::INFINITY, "Pa", "Nothing is so stiff.");
        report.count("bonds", 3, "Bonds.");
        report.check("residual", 0.1, 0.1, "1", "Just good.");
        report.check("imbalance", f64::NAN, 1.0, "1", "Unknown is bad.");
        report.warn("imbalance", "it is not known");
        report.work("steps", 7);
        assert_eq!(report.value("strength"), Some(2.5));
        assert!(report.failed("residual").is_none());
        assert!(report.failed("imbalance").is_some());
        assert!(report.failed("never_looked").is_none());
        let report = report.finish();
        let values = report.summary.iter();
        let values: Vec<_> = values.map(|(name, q)| (name.as_str(), q.value)).collect();
        let expected = [
            ("strength", Some(2.5)),
            ("poisson_ratio", None),
            ("modulus", None),
            ("bonds", Some(3.0)),
        ];
        assert_eq!(values, expected);
        assert_eq!(report.stop_reason, "max_strain");
        assert_eq!(report.warnings[0].code, "imbalance");
        assert_eq!(report.work["steps"], 7);
    }

    #[test]
    fn an_error_is_told_where_it_is_known() {
        let part = |value| ErrorPart::new("grid", value, loadframe_api::ErrorBasis::TwoGrids);
        let mut report = ReportBuilder::new("solved");
        report.result_with_error("known", 1.0, "1", "", vec![part(3.0), part(4.0)]);
        report.result_with_error("unknown", 1.0, "1", "", vec![part(f64::NAN)]);
        let summary = report.finish().summary;
        let error = summary["known"].error.as_ref();
        // 3² + 4² = 5²
        assert_eq!(error.map(|error| error.value), Some(5.0));
        assert_eq!(summary["unknown"].error, None);
    }
}
