//! Numbers, names and tables of studies as people read them.
use std::fmt::Write;

use loadframe_api::words;

/// Letters in a line of a column's head.
const HEAD: usize = 11;
/// A name as the beginning of a sentence.
pub(super) fn sentence(name: &str) -> String {
    let words = words(name);
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

/// Rows under the names of their columns, all aligned to the right.
pub(super) fn table(heads: &[String], rows: Vec<Vec<String>>) -> String {
    let heads: Vec<Vec<String>> = heads.iter().map(|head| wrapped(head)).collect();
    let lines = heads.iter().map(Vec::len).max().unwrap_or(0);
    let head = |line: usize| {
        let column = |head: &Vec<String>| {
            let above = lines - head.len();
            line.checked_sub(above)
                .map_or(String::new(), |line| head[line].clone())
        };
        heads.iter().map(column).collect::<Vec<String>>()
    };
    let all: Vec<Vec<String>> = (0..lines).map(head).chain(rows).collect();
    let columns = all.iter().map(Vec::len).max().unwrap_or(0);
    let length = |cell: &String| cell.chars().count();
    let width = |column: usize| {
        all.iter()
            .filter_map(|row| row.get(column))
            .map(length)
            .max()
    };
    let widths: Vec<usize> = (0..columns)
        .map(|column| width(column).unwrap_or(0))
        .collect();
    let mut text = String::new();
    for row in &all {
        let cells = row
            .iter()
            .zip(&widths)
            .map(|(cell, width)| format!("{cell:>width$}"));
        let line = cells.collect::<Vec<String>>().join("  ");
        let _ = writeln!(text, "  {}", line.trim_end());
    }
    text
}

/// Words in lines of about [`HEAD`] letters.
fn wrapped(text: &str) -> Vec<String> {
    let mut lines = Vec::<String>::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if line.len() + word.len() < HEAD => *line = format!("{line} {word}"),
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Two significant digits in %, and nothing below a millionth of one.
pub(super) fn percent(error: f64) -> String {
    let value = 100.0 * error.abs();
    match value {
        v if v < 1e-6 => "0 %".to_owned(),
        v if v < 1e-3 => format!("{v:.0e} %"),
        v => format!("{} %", digits(v)),
    }
}

/// Two significant digits at least.
pub(super) fn digits(value: f64) -> String {
    match value {
        v if v <= 0.0 => "0".to_owned(),
        v if v >= 10.0 => format!("{v:.0}"),
        v => {
            let decimals = 1 - v.log10().floor() as i32;
            format!("{v:.*}", decimals.clamp(0, 6) as usize)
        }
    }
}

/// How a mean and what belongs to it are written: to the second digit of its deviation, or to four
/// digits of its own where it has none; in powers of ten where digits would hide it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Digits {
    exponent: i32,
    decimals: usize,
}

impl Digits {
    pub(super) fn of(mean: f64, deviation: Option<f64>) -> Self {
        let place = |value: f64| value.abs().log10().floor() as i32;
        let deviation = deviation.filter(|deviation| *deviation > 0.0);
        let size = mean.abs().max(deviation.unwrap_or(0.0));
        if size == 0.0 {
            return Self {
                exponent: 0,
                decimals: 0,
            };
        }
        let exponent = if (1e-3..1e6).contains(&size) {
            0
        } else {
            place(size)
        };
        let last = match deviation {
            Some(deviation) => place(deviation) - 1,
            // counts are shown as such
            None if exponent == 0 && mean.fract() == 0.0 => 0,
            None => place(mean) - 3,
        };
        let decimals = (exponent - last).clamp(0, 15) as usize;
        Self { exponent, decimals }
    }

    pub(super) fn show(self, value: f64) -> String {
        let decimals = self.decimals;
        match self.exponent {
            0 => format!("{value:.decimals$}"),
            exponent => format!("{:.decimals$}e{exponent}", value / 10_f64.powi(exponent)),
        }
    }
}

/// A probability to two digits.
pub(super) fn probability(p: f64) -> String {
    match p {
        p if p < 1e-4 => "p < 0.0001".to_owned(),
        p => format!("p = {}", digits(p)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_told_to_the_second_digit_of_their_deviation() {
        let shown = |mean, deviation| {
            let digits = Digits::of(mean, deviation);
            let deviation = deviation.unwrap_or(0.0);
            format!("{} ± {}", digits.show(mean), digits.show(deviation))
        };
        assert_eq!(shown(403.271, Some(7.26)), "403.3 ± 7.3");
        assert_eq!(shown(0.5612, Some(0.0123)), "0.561 ± 0.012");
        assert_eq!(shown(123_456.0, Some(789.0)), "123456 ± 789");
        assert_eq!(shown(1.2347e8, Some(2.1e6)), "1.235e8 ± 0.021e8");
        assert_eq!(shown(-1.5e-7, Some(3e-8)), "-1.50e-7 ± 0.30e-7");
        assert_eq!(shown(0.0, Some(0.5)), "0.00 ± 0.50");
        assert_eq!(shown(17.0, None), "17 ± 0");
        assert_eq!(shown(0.123_456, Some(0.0)), "0.1235 ± 0.0000");
        assert_eq!(shown(0.0, None), "0 ± 0");
        assert_eq!([0.034, 3e-7].map(probability), ["p = 0.034", "p < 0.0001"]);
    }

    #[test]
    fn numbers_keep_two_digits() {
        let shown = [0.0, 0.0312, 0.995, 7.65, 34.2, 1234.0].map(digits);
        assert_eq!(shown, ["0", "0.031", "0.99", "7.7", "34", "1234"]);
        let shown = [0.0, 3e-7, 0.000_31, -0.0178, 0.26].map(percent);
        assert_eq!(shown, ["0 %", "3e-5 %", "0.031 %", "1.8 %", "26 %"]);
    }

    #[test]
    fn heads_are_cut_between_words() {
        assert_eq!(
            wrapped("modulus at 10 percent"),
            ["modulus at", "10 percent"]
        );
        assert_eq!(wrapped("strength"), ["strength"]);
    }
}
