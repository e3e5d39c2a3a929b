//! `results.csv`: the results in a table, with how wrong each may be and what would make it less.
use std::io::{self, Write};

use loadframe_api::{Report, csv_cell, words};
use loadframe_physics::csv::{self, Number};

/// Name of the file.
pub(crate) const RESULTS_FILE: &str = "results.csv";

/// What stands in a row. The last four are of the largest part of the error: its source, its size in the
/// unit of the value, the change of the spec that makes it a tenth, and the time of the job over its own
/// for that.
const COLUMNS: [&str; 14] = [
    "result",
    "label",
    "value",
    "unit",
    "error",
    "deviation",
    "interval_low",
    "interval_high",
    "n",
    "reason",
    "largest_part",
    "part_error",
    "change_for_a_tenth",
    "time_factor",
];

pub(crate) fn write(out: &mut dyn Write, report: &Report) -> io::Result<()> {
    csv::header(out, &COLUMNS)?;
    for (name, quantity) in &report.summary {
        let number = |value: Option<f64>| Number(value.unwrap_or(f64::NAN)).to_string();
        let parts = quantity.error.iter().flat_map(|error| &error.parts);
        let largest = parts.max_by(|one, other| one.value.total_cmp(&other.value));
        let tenth = largest.and_then(|part| part.tenth.as_ref());
        let [low, high] = quantity.interval.map_or([None; 2], |ends| ends.map(Some));
        let row = [
            csv_cell(name).into_owned(),
            csv_cell(&words(name)).into_owned(),
            number(quantity.value),
            csv_cell(&quantity.unit).into_owned(),
            number(quantity.error.as_ref().map(|error| error.value)),
            number(quantity.deviation),
            number(low),
            number(high),
            quantity.n.map_or_else(String::new, |n| n.to_string()),
            csv_cell(quantity.reason.as_deref().unwrap_or("")).into_owned(),
            csv_cell(largest.map_or("", |part| &part.source)).into_owned(),
            number(largest.map(|part| part.value)),
            csv_cell(tenth.map_or("", |tenth| &tenth.change)).into_owned(),
            number(tenth.map(|tenth| tenth.time_factor)),
        ];
        writeln!(out, "{}", row.join(","))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use loadframe_api::{ErrorBasis, ErrorPart, Quantity, Tenth};

    /// The table of these results.
    fn written(summary: impl IntoIterator<Item = (String, Quantity)>) -> String {
        let report = Report {
            summary: summary.into_iter().collect(),
            ..Report::default()
        };
        let mut bytes = Vec::new();
        write(&mut bytes, &report).expect("a Vec takes everything");
        String::from_utf8(bytes).expect("text")
    }

    #[test]
    fn a_row_has_value_and_error_and_what_buys_a_digit() {
        let part = |source, value| ErrorPart::new(source, value, ErrorBasis::TwoGrids);
        let tenth = Tenth {
            change: "grid.cells [800, 400]".to_owned(),
            time_factor: 240.0,
        };
        let deflection = Quantity::new(12.5, "mm", "How far it gives way.");
        let parts = vec![
            part("solver", 3.0),
            part("grid", 4.0).with_tenth(Some(tenth)),
        ];
        let modulus = Quantity::new(f64::NAN, "N/m", "").or_because("it had parted before");
        let summary = [
            ("deflection".to_owned(), deflection.with_error(parts)),
            ("modulus_at_2_5_percent".to_owned(), modulus),
        ];
        let text = written(summary);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], COLUMNS.join(","));
        // 3² + 4² = 5²
        let row = "deflection,deflection,12.5,mm,5,,,,,,grid,4,\"grid.cells [800, 400]\",240";
        assert_eq!(lines[1], row);
        assert_eq!(
            lines[2],
            "modulus_at_2_5_percent,modulus at 2.5 %,,N/m,,,,,,it had parted before,,,,"
        );
    }

    #[test]
    fn no_text_of_a_row_is_a_formula_and_numbers_stay_numbers() {
        // names of scenes are people's
        let force = Quantity::new(-2.5, "@N", "");
        let torn = Quantity::new(f64::NAN, "N", "").or_because("+1 was torn");
        let summary = [("=plate".to_owned(), force), ("torn".to_owned(), torn)];
        let text = written(summary);
        let rows: Vec<Vec<&str>> = text.lines().map(|row| row.split(',').collect()).collect();
        assert_eq!(rows[1][0], "\"'=plate\"");
        assert_eq!((rows[1][2], rows[1][3]), ("-2.5", "\"'@N\""));
        assert_eq!(rows[2][9], "\"'+1 was torn\"");
        let is_formula = |cell: &&str| cell.starts_with(['=', '+', '@']);
        assert!(!rows.iter().flatten().any(is_formula), "{text}");
    }
}
