//! `accuracy.csv`, `accuracy.json` and `accuracy.svg`.
use std::fmt::Write;
use std::io;

use super::analysis::Study;
use super::plot::plot;
use super::terminal::terminal_text;
use crate::design::Findings;

impl Findings for Study {
    const FILES: &[&str] = &["accuracy.csv", "accuracy.json", "accuracy.svg"];

    fn contents(&self) -> io::Result<Vec<Vec<u8>>> {
        let json = serde_json::to_vec_pretty(self)?;
        Ok(vec![csv(self).into(), json, plot(self).into()])
    }

    fn text(&self) -> String {
        terminal_text(self)
    }

    fn total_cpu_s(&self) -> f64 {
        self.total_cpu_s
    }
}

/// A row for each result at each setting; empty cells are unknown. Errors and scatter are relative.
fn csv(study: &Study) -> String {
    let mut text = "knob,value,is_present,is_reference,cpu_s,time_over_present,result,unit,\
                    mean_error,standard_error,rms_error,worst_error,seeds\n"
        .to_owned();
    let cell = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
    for knob in &study.knobs {
        for row in &knob.rows {
            for (name, error) in &row.errors {
                let unit = &study.scatter[name].unit;
                let [mean, rest] = [error.map(|e| e.mean), error.and_then(|e| e.standard_error)];
                let _ = writeln!(
                    text,
                    "{},\"{}\",{},{},{},{},{name},{unit},{},{},{},{},{}",
                    knob.knob,
                    row.value,
                    u8::from(row.is_present),
                    u8::from(row.is_reference),
                    row.cpu_s,
                    row.time,
                    cell(mean),
                    cell(rest),
                    cell(error.and_then(|error| error.rms)),
                    cell(error.and_then(|error| error.worst)),
                    error.map_or(0, |error| error.n),
                );
            }
        }
    }
    // the scatter of one test, and what remains of it in the mean of several
    for row in &study.repeats {
        for (name, error) in &row.errors {
            let unit = &study.scatter[name].unit;
            let _ = writeln!(
                text,
                "repeats,{},{},0,{},{},{name},{unit},,{},,,{}",
                row.repeats,
                u8::from(row.repeats == 1),
                f64::from(row.repeats) * study.cpu_s,
                row.repeats,
                cell(*error),
                study.seeds.len(),
            );
        }
    }
    text
}
