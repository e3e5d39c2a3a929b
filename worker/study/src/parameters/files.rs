//! `parameters.csv`, `parameters.json`, `parameters.md` and `parameters.svg`.
use std::io::{self, Write};

use loadframe_api::csv_cell;
use loadframe_physics::csv;

use super::analysis::Study;
use super::markdown::page;
use super::plot::plot;
use super::terminal::terminal_text;
use crate::design::Findings;

impl Findings for Study {
    const FILES: &[&str] = &[
        "parameters.csv",
        "parameters.json",
        "parameters.md",
        "parameters.svg",
    ];

    fn contents(&self) -> io::Result<Vec<Vec<u8>>> {
        let json = serde_json::to_vec_pretty(self)?;
        Ok(vec![
            table(self)?,
            json,
            page(self).into(),
            plot(self).into(),
        ])
    }

    fn text(&self) -> String {
        terminal_text(self)
    }

    fn total_cpu_s(&self) -> f64 {
        self.total_cpu_s
    }
}

/// A row for each test: case, seed, every result, how many warnings, processor time.
fn table(study: &Study) -> io::Result<Vec<u8>> {
    let mut out = Vec::new();
    let first = study.cases.first();
    let results = first.into_iter().flat_map(|case| &case.results);
    let results = results.map(|(name, result)| csv::column(name, &result.unit));
    let names: Vec<String> = ["case", "seed"]
        .map(str::to_owned)
        .into_iter()
        .chain(results)
        .chain(["warnings", "cpu_s"].map(str::to_owned))
        .collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    csv::header(&mut out, &names)?;
    for case in &study.cases {
        let label = csv_cell(&case.label);
        for test in &case.tests {
            write!(out, "{label},")?;
            let mut row = vec![test.seed as f64];
            row.extend(test.values.iter().map(|value| value.unwrap_or(f64::NAN)));
            row.extend([test.warnings.len() as f64, test.cpu_s]);
            csv::row(&mut out, &row)?;
        }
    }
    Ok(out)
}
