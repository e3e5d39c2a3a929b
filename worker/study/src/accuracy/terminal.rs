//! A study as tables and sentences for a terminal.
use std::fmt::Write;

use loadframe_api::words;

use super::analysis::{KnobStudy, Row, Study};
use crate::text::{digits, percent, table};

/// An error is small beside a scatter of three times its size: it adds a twentieth to it.
const SMALL: f64 = 1.0 / 3.0;

/// Tables of all knobs, each with what follows from it.
pub(super) fn terminal_text(study: &Study) -> String {
    let mut text = String::new();
    for knob in &study.knobs {
        let statistic = if knob.keeps_specimen {
            "root mean square of the errors over seeds"
        } else {
            "difference of the means over seeds"
        };
        let _ = writeln!(text, "{}, {}\n  {statistic}", knob.knob, knob.description);
        let rows = knob
            .rows
            .iter()
            .map(|row| row_of(row, study, knob.keeps_specimen));
        text += &table(&heads(study), rows.collect());
        let _ = writeln!(text, "  {}\n", advice(knob, study));
    }
    let _ = writeln!(
        text,
        "repeats, tests of so many specimens\n  standard error of their mean, from the scatter \
         between {} seeds",
        study.seeds.len()
    );
    let rows = study.repeats.iter().map(|row| {
        let cost = [study.cpu_s * f64::from(row.repeats), f64::from(row.repeats)];
        let mut cells = head_cells(row.repeats == 1, &row.repeats.to_string(), cost);
        cells.extend(
            row.errors
                .values()
                .map(|error| error.map_or("?".to_owned(), percent)),
        );
        cells
    });
    text += &table(&heads(study), rows.collect());
    text
}

/// Names of the columns: the first has the mark of the spec's own setting.
fn heads(study: &Study) -> Vec<String> {
    let own = ["", "value", "cpu s", "times"].map(str::to_owned);
    let results = study.scatter.keys().map(|name| words(name));
    own.into_iter().chain(results).collect()
}

/// Mark, value, seconds, times.
fn head_cells(is_present: bool, value: &str, [cpu_s, time]: [f64; 2]) -> Vec<String> {
    let mark = if is_present { ">" } else { "" };
    vec![
        mark.to_owned(),
        value.to_owned(),
        digits(cpu_s),
        digits(time),
    ]
}

fn row_of(row: &Row, study: &Study, keeps_specimen: bool) -> Vec<String> {
    let mut cells = head_cells(row.is_present, &row.value, [row.cpu_s, row.time]);
    cells.extend(study.scatter.keys().map(|name| match row.errors[name] {
        None => "?".to_owned(),
        Some(_) if row.is_reference => "0".to_owned(),
        Some(error) if keeps_specimen => percent(error.size()),
        Some(error) => format!(
            "{}{}",
            if error.mean < 0.0 { "−" } else { "+" },
            percent(error.size())
        ),
    }));
    if row.is_reference {
        cells.push("reference".to_owned());
    }
    if row.doubtful > 0 {
        cells.push(format!(
            "{} of {} tests doubtful",
            row.doubtful,
            study.seeds.len()
        ));
    }
    cells
}

/// What a user can do with a knob.
fn advice(knob: &KnobStudy, study: &Study) -> String {
    let (Some(present), Some(reference)) = (
        knob.rows.iter().find(|row| row.is_present),
        knob.rows.last(),
    ) else {
        return "The spec's own setting is not among these.".to_owned();
    };
    let mut errors: Vec<(&str, f64)> = present
        .errors
        .iter()
        .filter_map(|(name, error)| Some((name.as_str(), error.as_ref()?.size())))
        .collect();
    errors.sort_by(|a, b| b.1.total_cmp(&a.1));
    let Some(&(name, error)) = errors.first() else {
        return "No result is known.".to_owned();
    };
    if present.is_reference {
        return format!(
            "The spec is at the finest setting.{}",
            cheapest(knob, study)
        );
    }
    if !knob.keeps_specimen {
        let shift = present.errors[name].as_ref();
        let uncertain = shift.and_then(|error| error.standard_error);
        let uncertain = uncertain.map_or(String::new(), |s| {
            format!(" (standard error {})", percent(s))
        });
        return format!(
            "Against {}, {} is {} off{uncertain}, the others less.",
            reference.value,
            words(name),
            percent(error)
        );
    }
    let mut text = format!(
        "{} times the time ({}) takes an error of {} from {}",
        digits(reference.time),
        reference.value,
        percent(error),
        words(name)
    );
    if let Some((second, error)) = errors.get(1) {
        let _ = write!(text, " and {} from {}", percent(*error), words(second));
    }
    if let Some((_, error)) = errors.get(2) {
        let _ = write!(text, ", at most {} from all others", percent(*error));
    }
    text += ".";
    if let Some(scatter) = study.scatter[name].relative_deviation {
        let compared = if error < scatter { "more" } else { "less" };
        let _ = write!(
            text,
            " Specimens differ by {compared} ({}).",
            percent(scatter)
        );
    }
    if reference.doubtful > 0 {
        text += " The reference is doubtful itself: read the errors as differences.";
    }
    text + &cheapest(knob, study)
}

/// The cheapest value whose errors all drown in the scatter.
fn cheapest(knob: &KnobStudy, study: &Study) -> String {
    let drowns = |row: &&Row| {
        row.doubtful == 0
            && row.errors.iter().all(|(name, error)| {
                let scatter = study.scatter[name].relative_deviation;
                let pair = error.as_ref().zip(scatter);
                pair.is_some_and(|(error, scatter)| error.size() <= SMALL * scatter)
            })
    };
    let mut good: Vec<&Row> = knob.rows.iter().filter(drowns).collect();
    good.sort_by(|a, b| a.cpu_s.total_cmp(&b.cpu_s));
    match good.first() {
        Some(row) if knob.keeps_specimen && !row.is_present => format!(
            " The cheapest with all errors below a third of the scatter is {}, at {} times the time.",
            row.value,
            digits(row.time)
        ),
        _ => String::new(),
    }
}
