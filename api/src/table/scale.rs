//! What a title says beyond a name and a unit that makes its numbers others: `x10`, `per 15 mm`, `log`.
//!
//! Such words are not calculated with. `Load (mN) x10` may mean that the load is ten times the number,
//! or that the number is ten times the load; a force per 15 mm of width is a force only of a specimen
//! of that width.
use super::unit::of_symbol;

/// Words, in small letters without accents, after which a number of the unit is not the quantity.
const WORDS: [&str; 36] = [
    // over something else
    "per",
    "pro",
    "je",
    "par",
    "por",
    "width",
    "breite",
    "specific",
    "spezifisch",
    "spezifische",
    "normalized",
    "normalised",
    "normiert",
    "normierte",
    "rate",
    // in another measure: logarithmic strain is ln(1 + ε)
    "true",
    "wahre",
    "wahrer",
    "log",
    "log10",
    "ln",
    "lg",
    "logarithmic",
    "logarithmisch",
    "logarithmische",
    "hencky",
    "sqrt",
    "squared",
    "inverse",
    // times something
    "scaled",
    "times",
    "mal",
    "factor",
    "faktor",
    "inverted",
    "negative",
];

/// The first part of a title, without its unit, that makes its numbers others.
pub(super) fn beyond(rest: &str) -> Option<String> {
    if let Some(sign) = rest.chars().find(|c| is_sign(*c)) {
        return Some(sign.to_string());
    }
    let parts = |c: char| {
        c.is_whitespace()
            || matches!(
                c,
                '(' | ')' | '[' | ']' | '{' | '}' | '<' | '>' | ';' | ':' | '_'
            )
    };
    let tokens: Vec<&str> = rest
        .split(parts)
        .filter(|token| !token.is_empty())
        .collect();
    if let Some(minus) = tokens.iter().find(|token| is_negated(token)) {
        return Some((*minus).to_owned());
    }
    tokens.iter().enumerate().find_map(|(at, token)| {
        let next = tokens.get(at + 1).copied().unwrap_or_default();
        says_more(token, next).then(|| format!("{token} {next}").trim().to_owned())
    })
}

/// Signs of arithmetic that no name has, powers written above the line, shares of something.
fn is_sign(c: char) -> bool {
    matches!(c, '×' | '*' | '^' | '÷' | '⋅' | '·' | '√' | '%' | '‰' | '=')
        || c.is_numeric() && !c.is_ascii()
}

/// `-Load`, not the dash between two words.
fn is_negated(token: &str) -> bool {
    let mut letters = token.chars();
    matches!(letters.next(), Some('-' | '\u{2212}' | '–'))
        && letters.next().is_some_and(char::is_alphanumeric)
}

/// Whether a token, with the one after it, makes numbers others.
fn says_more(token: &str, next: &str) -> bool {
    let small = token.to_lowercase();
    let is_word = small
        .split(|c: char| !c.is_alphanumeric())
        .any(|word| WORDS.contains(&word) || word.ends_with("bezogene"));
    is_word || is_factor(&small, next) || is_over(token, next)
}

/// `x10`, `10x`, `x 10`, `1e3`, `0.1`, `1000`; a counter, as in `Strain 1`, is none.
fn is_factor(token: &str, next: &str) -> bool {
    let is_digits = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    let begins = |text: &str| text.starts_with(|c: char| c.is_ascii_digit());
    let token = token.trim_matches(',');
    let is_times = token.strip_prefix('x').is_some_and(begins)
        || token.strip_suffix('x').is_some_and(is_digits)
        || token == "x" && begins(next);
    let is_power =
        token.len() > 2 && token.starts_with('1') && token[1..].bytes().all(|b| b == b'0');
    let is_written = !is_digits(token) && token.parse::<f64>().is_ok_and(f64::is_finite)
        || token
            .strip_prefix('e')
            .is_some_and(|power| power.parse::<i32>().is_ok())
        || begins(token) && token.replacen(',', ".", 1).parse::<f64>().is_ok() && !is_digits(token);
    is_times || is_power || is_written
}

/// `15 mm`, `15mm`, `/mm`, `/10`: a length, or a division by something.
fn is_over(token: &str, next: &str) -> bool {
    let is_unit = |text: &str| {
        text.starts_with(char::is_alphabetic)
            && of_symbol(text.trim_end_matches([',', '.'])).is_some()
    };
    let digits = token.trim_start_matches(['@', '/']);
    let after = digits.trim_start_matches(|c: char| c.is_ascii_digit());
    let is_length = after.len() < digits.len()
        && (is_unit(after) || after.is_empty() && is_unit(next) && next != "in");
    let divided = token
        .split_once('/')
        .map(|(_, by)| if by.is_empty() { next } else { by });
    is_length
        || divided.is_some_and(|by| is_unit(by) || by.starts_with(|c: char| c.is_ascii_digit()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_changes_numbers_is_more_than_a_name() {
        for name in [
            "Load",
            "Strain 1",
            "Load (Channel 2)",
            "Tensile strain (Strain 1)",
            "Kraft / Force",
            "Force/Kraft",
            "Load - zeroed",
            "Load#2",
            "Load A-1",
            "Standardkraft",
            "Box",
            "Max. load",
            "Extension (Ext. 1)",
            "Load (filtered)",
            "F",
            "Weg (s)",
            "Specimen 12",
            "Load, corrected",
            "Poměrné prodloužení",
        ] {
            assert_eq!(beyond(name), None, "{name}");
        }
        for name in [
            "Load x10",
            "Load  x 10",
            "Load 10x",
            "Load*10",
            "Load ×10",
            "Load 10^3",
            "Load 10³",
            "Load 1e3",
            "Load 1E-3",
            "Load 0.1",
            "Load 0,1",
            "Load 1000",
            "Force (per 15 mm)",
            "Force per width",
            "Force /15 mm",
            "Force 15mm",
            "Force/mm",
            "Force / width",
            "Load/10",
            "True strain",
            "log strain",
            "Load (% of max)",
            "-Load",
            "Strain rate",
            "breitenbezogene Kraft",
            "Load_x10",
            "Load (x10)",
            "load @15mm",
            "Load = 2 F",
        ] {
            assert!(beyond(name).is_some(), "{name}");
        }
    }
}
