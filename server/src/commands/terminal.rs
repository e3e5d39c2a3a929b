//! The one way out to the terminal.
use std::io::{self, IsTerminal, Write};

use loadframe_api::printable;
use serde::Serialize;
use tracing_subscriber::EnvFilter;

use super::failure::Failure;

/// A line for people or scripts on standard output. A reader that went away is not an error.
pub(crate) fn print_line(line: &str) {
    let _ = writeln!(io::stdout(), "{}", safe(line));
}

/// A line on standard error.
pub(crate) fn print_error(line: &str) {
    let _ = writeln!(io::stderr(), "{}", safe(line));
}

/// Lines in which nothing acts on the terminal, whoever gave the names in them.
fn safe(lines: &str) -> String {
    let lines = lines.split('\n').map(|line| {
        let cells: Vec<_> = line.split('\t').map(printable).collect();
        cells.join("\t")
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// A value as JSON on standard output.
pub(crate) fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value).map_err(|error| Failure::of(&error))?;
    print_line(&text);
    Ok(())
}

/// A wire enum as its word: `queued`, `timed_out`.
pub(crate) fn wire_name(value: &impl Serialize) -> String {
    match serde_json::to_value(value) {
        Ok(serde_json::Value::String(word)) => word,
        _ => String::new(),
    }
}

/// Sends the log to standard error, filtered by `LOADFRAME_LOG`.
pub(crate) fn start_log(default: &str) {
    let filter =
        EnvFilter::try_from_env("LOADFRAME_LOG").unwrap_or_else(|_| EnvFilter::new(default));
    // a second subscriber in the same process is refused, and the first one serves both
    let _ = tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(io::stderr)
        .with_target(false)
        .with_ansi(io::stderr().is_terminal())
        .try_init();
}

/// A time span as people say it.
pub(crate) fn span(seconds: f64) -> String {
    match seconds {
        s if s < 0.0995 => format!("{:.0} ms", s * 1000.0),
        s if s < 9.95 => format!("{s:.1} s"),
        s if s < 99.5 => format!("{s:.0} s"),
        s if s < 99.5 * 60.0 => format!("{:.0} min", s / 60.0),
        s if s < 48.0 * 3600.0 => format!("{:.1} h", s / 3600.0),
        s => format!("{:.1} days", s / 86_400.0),
    }
}

/// A size in megabytes as people say it.
pub(crate) fn size(megabytes: f64) -> String {
    match megabytes {
        m if m < 0.9995 => format!("{:.0} kB", m * 1000.0),
        m if m < 99.95 => format!("{m:.1} MB"),
        m if m < 9995.0 => format!("{m:.0} MB"),
        m => format!("{:.1} GB", m / 1000.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_and_sizes_keep_two_or_three_digits() {
        let spans = [0.02, 3.21, 42.4, 600.0, 7200.0, 400_000.0].map(span);
        assert_eq!(
            spans,
            ["20 ms", "3.2 s", "42 s", "10 min", "2.0 h", "4.6 days"]
        );
        let sizes = [0.5, 12.34, 340.0, 20_000.0].map(size);
        assert_eq!(sizes, ["500 kB", "12.3 MB", "340 MB", "20.0 GB"]);
    }

    #[test]
    fn what_is_printed_moves_no_cursor_and_keeps_its_lines() {
        assert_eq!(safe("a\tb\n  c"), "a\tb\n  c");
        assert_eq!(
            safe("a\u{1b}]0;title\u{7}\nb"),
            "a\\u001b]0;title\\u0007\nb"
        );
    }

    #[test]
    fn enums_are_said_by_their_word() {
        assert_eq!(wire_name(&loadframe_api::JobOutcome::TimedOut), "timed_out");
    }
}
