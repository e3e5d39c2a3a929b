//! A study as a table and sentences for a terminal.
use std::fmt::Write;

use loadframe_api::words;

use super::analysis::Study;
use super::case::{CaseResult, CaseRow};
use super::labels::Labels;
use crate::text::{Digits, digits, table};

/// What is shown of a result that no test got to.
const UNKNOWN: &str = "?";

impl CaseResult {
    fn digits(&self) -> Option<(Digits, f64)> {
        let mean = self.mean?;
        Some((Digits::of(mean, self.deviation), mean))
    }

    pub(super) fn mean_in_words(&self) -> String {
        self.digits()
            .map_or_else(|| UNKNOWN.to_owned(), |(digits, mean)| digits.show(mean))
    }

    /// `403.3 ± 7.2`, and after how many tests where that is not `n`.
    pub(super) fn in_words(&self, n: usize) -> String {
        let deviation = self.digits().zip(self.deviation);
        let deviation = deviation.map(|((digits, _), deviation)| digits.show(deviation));
        let scatter = deviation.map_or_else(String::new, |deviation| format!(" ± {deviation}"));
        let fewer = match self.n {
            known if known == 0 || known as usize == n => String::new(),
            known => format!(" [n = {known}]"),
        };
        format!("{}{scatter}{fewer}", self.mean_in_words())
    }

    /// `(394.3 … 412.2)`.
    pub(super) fn interval_in_words(&self) -> Option<String> {
        let (digits, _) = self.digits()?;
        let [low, high] = self.interval?.map(|end| digits.show(end));
        Some(format!("({low} … {high})"))
    }
}

impl CaseRow {
    /// `2 of 5: not settled (2), inertial number (1)`, or nothing.
    pub(super) fn warnings_in_words(&self) -> String {
        if self.doubtful == 0 {
            return String::new();
        }
        let codes = self.warnings.iter();
        let codes: Vec<String> = codes
            .map(|(code, count)| format!("{} ({count})", words(code)))
            .collect();
        format!(
            "{} of {}: {}",
            self.doubtful,
            self.tests.len(),
            codes.join(", ")
        )
    }
}

impl Study {
    /// The name of a result with its unit.
    pub(super) fn head(&self, name: &str) -> String {
        match self.findings[name].unit.as_str() {
            "1" | "" => words(name),
            unit => format!("{} [{unit}]", words(name)),
        }
    }

    /// What is to be said of results that were asked for in vain.
    pub(super) fn unknown_in_words(&self) -> Option<String> {
        let names = self.cases.first()?.results.keys();
        let known: Vec<&str> = names.map(String::as_str).collect();
        (!self.unknown_results.is_empty()).then(|| {
            format!(
                "No test told {}; there are: {}.",
                self.unknown_results.join(", "),
                known.join(", ")
            )
        })
    }
}

/// The cases as a table, beneath it what follows.
pub(super) fn terminal_text(study: &Study) -> String {
    let seeds = study.seeds.len();
    let labels = Labels::of(&study.cases);
    let mut heads = vec![words(labels.name())];
    heads.extend(study.findings.keys().map(|name| study.head(name)));
    heads.extend(["cpu s", "warnings"].map(str::to_owned));
    let rows = study.cases.iter().map(|case| {
        let mut cells = vec![labels.short(&case.label).to_owned()];
        let results = study.findings.keys().map(|name| &case.results[name]);
        cells.extend(results.map(|result| result.in_words(seeds)));
        cells.extend([digits(case.cpu_s), case.warnings_in_words()]);
        cells
    });
    let mut text = format!("{}\n", study.title);
    if !study.statement.is_empty() {
        let _ = writeln!(text, "  {}: {}", study.source_in_words(), study.statement);
    }
    let _ = writeln!(
        text,
        "  mean ± standard deviation over {seeds} specimens of each case"
    );
    text += &table(&heads, rows.collect());
    for sentence in study.sentences() {
        let _ = writeln!(text, "  {sentence}");
    }
    text
}

impl Study {
    pub(super) fn source_in_words(&self) -> &str {
        match self.source.as_str() {
            "" => "the source",
            source => source,
        }
    }

    /// All that is said beneath the table.
    pub(super) fn sentences(&self) -> impl Iterator<Item = String> {
        let findings = self.findings.values().map(|finding| finding.words.clone());
        findings.chain(self.unknown_in_words())
    }
}
