//! Numbers as machines and spreadsheets of several countries write them.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What stands before decimals.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DecimalMark {
    /// `1.027`; thousands may be parted by commas.
    Point,
    /// `1,027`; thousands may be parted by points.
    Comma,
}

/// What a cell says about the mark of decimals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Evidence {
    /// Nothing: it has no mark, or is no number.
    Silent,
    /// It is a number with this mark only.
    For(DecimalMark),
    /// It is one number with the one mark, and a thousand times that with the other: `1,027`.
    Either,
}

/// The number in a cell. Thousands are parted in groups of three by the other mark, spaces or
/// apostrophes, the first group not beginning with 0.
pub(super) fn parse(cell: &str, decimal: DecimalMark) -> Option<f64> {
    let cell = cell.trim();
    if !cell.bytes().any(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let (mark, other) = match decimal {
        DecimalMark::Point => ('.', ','),
        DecimalMark::Comma => (',', '.'),
    };
    let (sign, unsigned) = match cell.strip_prefix(['-', '\u{2212}']) {
        Some(rest) => ("-", rest),
        None => ("", cell.strip_prefix('+').unwrap_or(cell)),
    };
    let (mantissa, exponent) = match unsigned.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, Some(exponent)),
        None => (unsigned, None),
    };
    let (whole, part) = mantissa.split_once(mark).unwrap_or((mantissa, ""));
    let whole = ungrouped(whole, other)?;
    let are_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    if !are_digits(part) || whole.is_empty() && part.is_empty() {
        return None;
    }
    if let Some(exponent) = exponent {
        let digits = exponent.strip_prefix(['-', '+']).unwrap_or(exponent);
        if digits.is_empty() || !are_digits(digits) {
            return None;
        }
    }
    let number = format!("{sign}{whole}.{part}0e{}", exponent.unwrap_or("0"));
    number
        .parse()
        .ok()
        .filter(|number: &f64| number.is_finite())
}

/// Digits without what parts thousands; `None` where they are not parted in threes.
fn ungrouped(whole: &str, other: char) -> Option<String> {
    let is_mark = |c: char| {
        c == other
            || matches!(
                c,
                ' ' | '\u{a0}' | '\u{2009}' | '\u{202f}' | '\'' | '\u{2019}'
            )
    };
    let Some(mark) = whole.chars().find(|c| is_mark(*c)) else {
        return whole
            .bytes()
            .all(|byte| byte.is_ascii_digit())
            .then(|| whole.to_owned());
    };
    let groups: Vec<&str> = whole.split(mark).collect();
    let (first, rest) = groups.split_first()?;
    let fits = (1..=3).contains(&first.len())
        && !first.starts_with('0')
        && rest.iter().all(|group| group.len() == 3);
    let digits: String = groups.concat();
    (fits && digits.bytes().all(|byte| byte.is_ascii_digit())).then_some(digits)
}

/// Whether a cell is a number with either mark.
pub(super) fn is_number(cell: &str) -> bool {
    parse(cell, DecimalMark::Point).is_some() || parse(cell, DecimalMark::Comma).is_some()
}

/// What a cell says about the mark of decimals.
pub(super) fn evidence(cell: &str) -> Evidence {
    if !cell.contains(['.', ',']) {
        return Evidence::Silent;
    }
    let point = parse(cell, DecimalMark::Point);
    let comma = parse(cell, DecimalMark::Comma);
    match (point, comma) {
        (None, None) => Evidence::Silent,
        (Some(_), None) => Evidence::For(DecimalMark::Point),
        (None, Some(_)) => Evidence::For(DecimalMark::Comma),
        (Some(_), Some(_)) => Evidence::Either,
    }
}

impl DecimalMark {
    /// Its character.
    pub(super) fn character(self) -> char {
        match self {
            Self::Point => '.',
            Self::Comma => ',',
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_with_either_mark() {
        let point = |cell| parse(cell, DecimalMark::Point);
        let comma = |cell| parse(cell, DecimalMark::Comma);
        assert_eq!(point("1,027.5"), Some(1027.5));
        assert_eq!(comma("1.027,5"), Some(1027.5));
        assert_eq!(point("-1.2E+03"), Some(-1200.0));
        assert_eq!(comma("\u{2212}1,2e-3"), Some(-0.0012));
        assert_eq!(point("12\u{a0}345.5"), Some(12345.5));
        assert_eq!(point("1'027"), Some(1027.0));
        assert_eq!(point(".5"), Some(0.5));
        assert_eq!(point("5."), Some(5.0));
        for wrong in [
            "", "-", ".", "1.2.3", "0,5", "12,34", "1,0275", "1e", "x1", "inf", "1e400",
        ] {
            assert_eq!(point(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn only_three_digits_after_a_whole_number_leave_the_mark_open() {
        use DecimalMark::{Comma, Point};
        for (cell, says) in [
            ("1,027", Evidence::Either),
            ("12.345", Evidence::Either),
            ("0,041", Evidence::For(Comma)),
            ("0.041", Evidence::For(Point)),
            ("1,5", Evidence::For(Comma)),
            ("1,027,500", Evidence::For(Point)),
            ("1.027,5", Evidence::For(Comma)),
            ("1234,567", Evidence::For(Comma)),
            ("1027", Evidence::Silent),
            ("a,b", Evidence::Silent),
        ] {
            assert_eq!(evidence(cell), says, "{cell}");
        }
    }
}
