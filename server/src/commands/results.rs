//! The result of a job as a table for people.
use loadframe_api::{Outcome, QualityCheck, Quantity, words};

use super::terminal::{print_line, size, span};

/// Digits shown; all are in `outcome.json`.
const DIGITS: usize = 4;

/// Prints results, quality, warnings and cost.
pub(crate) fn show(outcome: &Outcome) {
    print_line("\nResults");
    let rows = outcome.summary.iter();
    table(
        &rows
            .map(|(name, quantity)| result_row(name, quantity))
            .collect::<Vec<_>>(),
    );
    if let Some(words) = sign_of(outcome.summary.values()) {
        print_line(&format!("  {words}"));
    }
    print_line("\nQuality");
    let rows = outcome.quality.iter();
    table(
        &rows
            .map(|(name, check)| quality_row(name, check))
            .collect::<Vec<_>>(),
    );
    if !outcome.warnings.is_empty() {
        print_line("\nWarnings");
    }
    for warning in &outcome.warnings {
        print_line(&format!("  {}", warning.detail));
    }
    let cost = &outcome.cost;
    let tenths = tenths(outcome);
    if !tenths.is_empty() {
        print_line("\nWhat makes an error a tenth of what it is");
    }
    tenths.iter().for_each(|line| print_line(line));
    print_line(&format!(
        "\nThe test ended because of {}. It took {} on {} ({} of processor time, {} of memory).",
        words(&outcome.stop_reason),
        span(cost.wall_s),
        match cost.threads {
            1 => "one thread".to_owned(),
            threads => format!("{threads} threads"),
        },
        span(cost.cpu_s),
        size(cost.peak_memory_mb),
    ));
}

/// What stands beside these results; nothing where nothing does.
fn sign_of<'q>(mut results: impl Iterator<Item = &'q Quantity> + Clone) -> Option<&'static str> {
    let mut all = results.clone();
    let has_error = all.any(|quantity| known_error(quantity).is_some());
    match results.any(|quantity| deviation(quantity).is_some()) {
        true if has_error => Some(
            "± is one standard error, all parts together; a deviation is that of single repeats about their mean.",
        ),
        true => Some("A deviation is that of single repeats about their mean."),
        false => has_error.then_some("± is one standard error, all parts together."),
    }
}

/// Of repeats, where they scatter.
fn deviation(quantity: &Quantity) -> Option<f64> {
    quantity.deviation.filter(|deviation| *deviation > 0.0)
}

/// Of a value, all parts together.
fn known_error(quantity: &Quantity) -> Option<f64> {
    let error = quantity.error.as_ref().map(|error| error.value);
    error.filter(|error| *error > 0.0)
}

/// What buys a digit of results, each change once.
fn tenths(outcome: &Outcome) -> Vec<String> {
    let errors = outcome.summary.values().filter_map(|q| q.error.as_ref());
    let parts = errors.flat_map(|error| &error.parts);
    let lines = parts.filter_map(|part| {
        let tenth = part.tenth.as_ref()?;
        let time = span(tenth.time_factor * outcome.cost.wall_s);
        let source = words(&part.source);
        Some(format!("  {source}: {}, for about {time}", tenth.change))
    });
    let mut once: Vec<String> = Vec::new();
    for line in lines {
        if !once.contains(&line) {
            once.push(line);
        }
    }
    once
}

/// Name, value, unit, description.
fn result_row(name: &str, quantity: &Quantity) -> [String; 4] {
    [
        words(name),
        quantity.value.map_or("unknown".to_owned(), |value| {
            let error = known_error(quantity).map(|error| format!(" ± {}", rough(error)));
            let scatter = match (deviation(quantity), quantity.interval) {
                (Some(s), _) => format!(" (deviation {})", number(s)),
                // of a fitted value, which is no mean
                (None, Some([low, high])) if low < high => {
                    format!(" ({} … {})", number(low), number(high))
                }
                (None, _) => String::new(),
            };
            number(value) + &error.unwrap_or_default() + &scatter
        }),
        unit(&quantity.unit),
        match &quantity.reason {
            Some(reason) => format!("{} Unknown: {reason}.", quantity.description),
            None => quantity.description.clone(),
        },
    ]
}

fn quality_row(name: &str, check: &QualityCheck) -> [String; 4] {
    let verdict = if check.ok { "good" } else { "doubtful" };
    [
        words(name),
        number(check.value),
        unit(&check.unit),
        format!("{verdict} (at most {})", number(check.bound)),
    ]
}

fn unit(unit: &str) -> String {
    if unit == "1" {
        String::new()
    } else {
        unit.to_owned()
    }
}

/// A number with [`DIGITS`] significant digits, in powers of ten only where digits would hide it.
fn number(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 || (value.fract() == 0.0 && magnitude < 1e6) {
        return format!("{value}");
    }
    if !(1e-3..1e6).contains(&magnitude) {
        return format!("{value:.*e}", DIGITS - 1);
    }
    let before_the_point = magnitude.log10().floor() as i32 + 1;
    let decimals = (DIGITS as i32 - before_the_point).max(0);
    format!("{value:.*}", decimals as usize)
}

/// An error with two digits: more would say that it is known.
fn rough(error: f64) -> String {
    let step = 10_f64.powf(error.log10().floor() - 1.0);
    let rounded = (error / step).round() * step;
    if (1e-3..1e6).contains(&rounded) {
        let decimals = (-step.log10().floor()).max(0.0) as usize;
        format!("{rounded:.decimals$}")
    } else {
        format!("{rounded:.1e}")
    }
}

/// Columns aligned: text to the left, the second column (numbers) to the right.
fn table(rows: &[[String; 4]]) {
    let width = |column: usize| {
        rows.iter()
            .map(|row| row[column].chars().count())
            .max()
            .unwrap_or(0)
    };
    let (name, value, unit) = (width(0), width(1), width(2));
    let columns = terminal_columns();
    for row in rows {
        let line = format!(
            "  {:name$}  {:>value$} {:unit$}  {}",
            row[0], row[1], row[2], row[3]
        );
        print_line(&shortened(line.trim_end(), columns));
    }
}

/// Columns of the terminal, `None` when output goes elsewhere.
fn terminal_columns() -> Option<usize> {
    let (_, columns) = console::Term::stdout().size_checked()?;
    Some(columns.into())
}

/// A line cut so that it does not wrap: a wrapped table is no table. All words are in the file.
fn shortened(line: &str, columns: Option<usize>) -> String {
    match columns {
        Some(columns) if line.chars().count() > columns => {
            let kept: String = line.chars().take(columns.saturating_sub(1)).collect();
            format!("{}…", kept.trim_end())
        }
        _ => line.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use loadframe_api::{ErrorBasis, ErrorPart};

    #[test]
    fn numbers_are_short_but_not_hidden() {
        let cases = [
            (0.0, "0"),
            (12.0, "12"),
            (388.2345, "388.2"),
            (1.18349, "1.183"),
            (0.98765, "0.9877"),
            (0.0012345, "0.001234"),
            (1.5e-7, "1.500e-7"),
            (123_456.7, "123457"),
        ];
        for (value, text) in cases {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn errors_have_two_digits() {
        let cases = [
            (0.001_234, "0.0012"),
            (0.0996, "0.100"),
            (3.26, "3.3"),
            (123.4, "120"),
            (8.06e-5, "8.1e-5"),
        ];
        for (error, text) in cases {
            assert_eq!(rough(error), text);
        }
    }

    #[test]
    fn lines_fit_the_terminal_and_stay_whole_elsewhere() {
        assert_eq!(shortened("a long line", Some(7)), "a long…");
        assert_eq!(shortened("a long line", Some(11)), "a long line");
        assert_eq!(shortened("a long line", None), "a long line");
    }

    #[test]
    fn what_the_sign_means_is_said_where_there_is_one() {
        let plain = Quantity::new(1.0, "N", "");
        let part = ErrorPart::new("grid", 0.1, ErrorBasis::TwoGrids);
        let wrong = plain.clone().with_error(vec![part]);
        let mean = Quantity {
            deviation: Some(0.5),
            ..plain.clone()
        };
        let said = |quantities: &[&Quantity]| sign_of(quantities.iter().copied());
        assert_eq!(said(&[&plain]), None);
        let error = "± is one standard error, all parts together.";
        assert_eq!(said(&[&plain, &wrong]), Some(error));
        let alone = said(&[&mean]).expect("there is one");
        assert!(alone.contains("deviation") && !alone.contains('±'));
        let both = said(&[&mean, &wrong]).expect("there are two");
        assert!(both.contains("± is one standard error") && both.contains("deviation"));
    }

    #[test]
    fn an_unknown_value_and_a_bad_check_are_said_in_words() {
        let unknown = Quantity::new(f64::NAN, "N", "largest force");
        assert_eq!(
            result_row("max_force", &unknown)[..3],
            ["max force", "unknown", "N"]
        );
        let parted = unknown.or_because("it had parted before");
        assert_eq!(
            result_row("max_force", &parted)[3],
            "largest force Unknown: it had parted before."
        );
        let repeated = Quantity {
            deviation: Some(7.25),
            ..Quantity::new(403.27, "N", "")
        };
        assert_eq!(
            result_row("max_force", &repeated)[1],
            "403.3 (deviation 7.250)"
        );
        let part = ErrorPart::new("grid", 2.345, ErrorBasis::TwoGrids);
        let known = Quantity::new(403.27, "N", "").with_error(vec![part.clone()]);
        assert_eq!(result_row("max_force", &known)[1], "403.3 ± 2.3");
        let both = repeated.with_error(vec![part]);
        assert_eq!(
            result_row("max_force", &both)[1],
            "403.3 ± 2.3 (deviation 7.250)"
        );
        let bad = QualityCheck::at_most(3.0, 1.0, "1", "");
        assert_eq!(
            quality_row("residual_ratio", &bad)[3],
            "doubtful (at most 1)"
        );
    }
}
