//! How wrong results may be for how they were computed, from tables that were measured before.
//!
//! A table belongs to a sort of jobs and is shipped beside the code that computes them. It holds, for each
//! result, the relative error that jobs drawn at random from a stated range had at each level of each
//! knob, against the finest one. A job between two levels has the error of the coarser. Errors of several
//! knobs are taken as independent. What a job is compared by, and which of its results are proportional
//! to which measured one, its own code knows.
use indexmap::IndexMap;
use loadframe_api::{ErrorBasis, ErrorPart, Report, Warning};
use serde::Deserialize;

/// Outermost part of a range, in its logarithm, that counts as its edge.
const EDGE: f64 = 0.03;

/// What was measured of a sort of jobs.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ErrorTable {
    /// The command that prints it.
    pub measured_by: String,
    /// The least and the most of what the measured jobs had, by trait.
    range: IndexMap<String, [f64; 2]>,
    /// By source of error: levels of its knob, the coarsest first.
    sources: IndexMap<String, Vec<Level>>,
}

/// Errors at one value of a knob.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Level {
    at: f64,
    /// Over the value of the result, by result.
    errors: IndexMap<String, f64>,
}

/// What a job is compared with a table by.
#[derive(Clone, Copy, Debug)]
pub struct Likeness<'a> {
    /// What decides how such jobs err, by the names of the table's range.
    pub traits: &'a [(&'static str, f64)],
    /// Where its knobs are, by source of error.
    pub knobs: &'a [(&'static str, f64)],
    /// Its results, and the measured one that each is proportional to.
    pub results: &'a [(&'static str, &'static str)],
}

impl ErrorTable {
    /// Reads a table that is shipped with the engine.
    ///
    /// # Errors
    /// Why it is none.
    pub fn read(text: &str) -> Result<Self, serde_json::Error> {
        serde_json::from_str(text)
    }

    /// Reads tables of jobs that have more and more of a trait: the first whose range reaches as far as a job,
    /// or the last.
    ///
    /// # Errors
    /// Why one is none.
    pub fn first_reaching(
        texts: &[&str],
        name: &str,
        value: f64,
    ) -> Result<Self, serde_json::Error> {
        let mut table = Self::read(texts.first().unwrap_or(&""))?;
        for text in texts.iter().skip(1) {
            let reaches = |[_, most]: &[f64; 2]| value <= *most;
            if table.range.get(name).is_some_and(reaches) {
                break;
            }
            table = Self::read(text)?;
        }
        Ok(table)
    }

    /// Gives results the errors that are known of them, and warns where what was measured ends near this
    /// job. Returns why results have none, or some have none.
    pub fn add(&self, report: &mut Report, job: &Likeness<'_>) -> Option<String> {
        let beyond = job.traits.iter().find(|(name, value)| {
            let range = self.range.get(*name);
            range.is_none_or(|[least, most]| !(least..=most).contains(&value))
        });
        if let Some(beyond) = beyond {
            return Some(format!("results have no error: {}", self.place(*beyond)));
        }
        let mut has_any = false;
        for (name, base) in job.results {
            let Some(quantity) = report.summary.get_mut(*name) else {
                continue;
            };
            let parts = quantity
                .value
                .and_then(|value| self.parts(base, value.abs(), job));
            if let Some(parts) = parts {
                *quantity = quantity.clone().with_error(parts);
                has_any = true;
            }
        }
        let is_edge = |(name, value): &&(&str, f64)| {
            self.range.get(*name).is_some_and(|[least, most]| {
                let width = EDGE * (most / least).ln();
                (value / least).ln() < width || (most / value).ln() < width
            })
        };
        if let (true, Some(edge)) = (has_any, job.traits.iter().find(is_edge)) {
            report.warnings.push(Warning {
                code: "errors_at_edge".to_owned(),
                detail: format!(
                    "errors of results are of the edge of what was measured: {}",
                    self.place(*edge)
                ),
            });
        }
        let is_coarse = |(source, at): &&(&str, f64)| {
            let levels = self.sources.get(*source);
            levels.is_none_or(|levels| level(levels, *at).is_none())
        };
        let coarse = job.knobs.iter().filter(is_coarse);
        let coarse: Vec<&str> = coarse.map(|(source, _)| *source).collect();
        (!coarse.is_empty()).then(|| {
            format!(
                "results that depend on {} have no error: it is coarser than was measured",
                coarse.join(" and ")
            )
        })
    }

    /// What each source adds to the error of a result of this size; `None` where that of one of them is
    /// not known, for the others alone would say less than the error is.
    fn parts(&self, base: &str, size: f64, job: &Likeness<'_>) -> Option<Vec<ErrorPart>> {
        let mut parts = Vec::new();
        for (source, at) in job.knobs {
            let levels = self.sources.get(*source)?;
            let touches = levels.iter().any(|level| level.errors.contains_key(base));
            if touches {
                let error = level(levels, *at)?.errors.get(base)?;
                // nothing was found beyond what other sources are off
                if *error > 0.0 {
                    let basis = ErrorBasis::MeasuredTable;
                    parts.push(ErrorPart::new(source, error * size, basis));
                }
            }
        }
        (!parts.is_empty()).then_some(parts)
    }

    fn place(&self, (name, value): (&str, f64)) -> String {
        let [least, most] = self.range.get(name).copied().unwrap_or([f64::NAN; 2]);
        // four digits that tell something
        let told = |value: f64| {
            let before = if value > 0.0 {
                value.log10().floor() as i32 + 1
            } else {
                1
            };
            let digits = usize::try_from(4 - before).unwrap_or(0);
            format!("{value:.digits$}")
        };
        let [value, least, most] = [value, least, most].map(told);
        format!("{name} is {value}, and {least} to {most} was measured")
    }
}

/// The finest level among those that are as coarse as a value of the knob.
fn level(levels: &[Level], value: f64) -> Option<&Level> {
    let larger_is_coarser = levels.first()?.at > levels.last()?.at;
    let is_as_coarse = |level: &&Level| {
        if larger_is_coarser {
            level.at >= value
        } else {
            level.at <= value
        }
    };
    levels.iter().rev().find(is_as_coarse)
}

#[cfg(test)]
mod tests {
    use loadframe_api::Quantity;

    use super::*;

    const TABLE: &str = r#"{"measured_by": "hand", "range": {"bonds": [100, 10000]}, "sources": {
        "solver": [{"at": 5, "errors": {"strength": 0.3, "modulus": 0.1}},
            {"at": 100, "errors": {"strength": 0.03, "modulus": 0.01}}],
        "breaks": [{"at": 0.05, "errors": {"strength": 0.4}}, {"at": 0.01, "errors": {"strength": 0.04}}]}}"#;

    /// The errors of a strength of −2 and a modulus of 10, what is said, and the codes of warnings.
    fn told(bonds: f64, solver: f64, breaks: f64) -> ([Option<f64>; 2], Option<String>, usize) {
        let mut report = Report::default();
        for (name, value) in [("max_force", -2.0), ("modulus", 10.0), ("nodes", 7.0)] {
            let quantity = Quantity::new(value, "N", "");
            report.summary.insert(name.to_owned(), quantity);
        }
        let job = Likeness {
            traits: &[("bonds", bonds)],
            knobs: &[("solver", solver), ("breaks", breaks)],
            results: &[
                ("max_force", "strength"),
                ("modulus", "modulus"),
                ("absent", "strength"),
            ],
        };
        let words = ErrorTable::read(TABLE).unwrap().add(&mut report, &job);
        assert_eq!(report.summary["nodes"].error, None);
        let errors = ["max_force", "modulus"].map(|name| report.summary[name].error.clone());
        let errors = errors.map(|error| error.map(|error| error.value));
        (errors, words, report.warnings.len())
    }

    #[test]
    fn an_error_is_that_of_the_coarser_level_of_each_knob() {
        // √(0.3² + 0.4²)·2 = 1 and 0.1·10 = 1; √(0.03² + 0.04²)·2 = 0.1 and 0.01·10 = 0.1
        for (solver, breaks, expected) in [(5.0, 0.05, 1.0), (99.0, 0.02, 1.0), (1e6, 0.001, 0.1)] {
            let (errors, words, warnings) = told(1000.0, solver, breaks);
            for error in errors {
                assert!((error.unwrap() - expected).abs() < 1e-12, "{errors:?}");
            }
            assert_eq!((words, warnings), (None, 0));
        }
    }

    #[test]
    fn what_is_coarser_than_measured_leaves_results_that_depend_on_it_without_error() {
        let (errors, words, _) = told(1000.0, 100.0, f64::INFINITY);
        assert_eq!(errors, [None, Some(0.1)]);
        assert!(words.unwrap().contains("depend on breaks have no error"));
        assert_eq!(told(1000.0, 1.0, 0.01).0, [None, None]);
    }

    #[test]
    fn of_several_tables_the_first_that_reaches_far_enough_is_read() {
        let larger = TABLE.replace("[100, 10000]", "[5000, 1e6]");
        for (bonds, is_larger) in [(1.0, false), (1e4, false), (10_001.0, true), (1e9, true)] {
            let table = ErrorTable::first_reaching(&[TABLE, &larger], "bonds", bonds);
            assert_eq!(table.unwrap().range["bonds"][1] > 1e5, is_larger, "{bonds}");
        }
        assert!(ErrorTable::first_reaching(&[], "bonds", 1.0).is_err());
        assert!(ErrorTable::first_reaching(&[TABLE, "{}"], "bonds", 1e5).is_err());
    }

    #[test]
    fn a_job_outside_the_range_has_no_errors_and_one_at_its_edge_is_told() {
        for bonds in [99.0, 10_001.0, f64::NAN] {
            let (errors, words, warnings) = told(bonds, 100.0, 0.01);
            assert_eq!((errors, warnings), ([None, None], 0));
            assert!(words.unwrap().contains("100.0 to 10000 was measured"));
        }
        // 3 % of two decades is a factor of 1.15
        for (bonds, warnings) in [
            (101.0, 1),
            (114.0, 1),
            (116.0, 0),
            (8_600.0, 0),
            (9_000.0, 1),
        ] {
            assert_eq!(told(bonds, 100.0, 0.01).2, warnings, "{bonds}");
        }
    }
}
