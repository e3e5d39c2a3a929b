//! Texts of people and programs where something else would act on them: terminals, spreadsheets.
use std::borrow::Cow;

/// A text on one line of a terminal: what would move its cursor, colour it or turn its direction is
/// written as in JSON (`\u001b`).
pub fn printable(text: &str) -> Cow<'_, str> {
    if !text.contains(acts_on_terminals) {
        return Cow::Borrowed(text);
    }
    let mut safe = String::with_capacity(text.len() + 8);
    for letter in text.chars() {
        if acts_on_terminals(letter) {
            safe.push_str(&format!("\\u{:04x}", u32::from(letter)));
        } else {
            safe.push(letter);
        }
    }
    Cow::Owned(safe)
}

/// Control characters, and those that turn the direction of what follows them.
fn acts_on_terminals(letter: char) -> bool {
    letter.is_control() || matches!(letter, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// A text as a cell of a CSV table: in quotes where it has to be, without control characters, and never a
/// formula (a spreadsheet takes what begins with `=`, `+`, `-` or `@` for one, so those follow a `'`).
/// Numbers are not texts.
pub fn csv_cell(text: &str) -> Cow<'_, str> {
    let is_formula = text.trim_start().starts_with(['=', '+', '-', '@']);
    let needs_quotes = text.contains([',', '"', ';', '\n', '\r']);
    if !is_formula && !needs_quotes && !text.contains(char::is_control) {
        return Cow::Borrowed(text);
    }
    let mark = if is_formula { "'" } else { "" };
    let plain = text.replace(char::is_control, " ").replace('"', "\"\"");
    Cow::Owned(format!("\"{mark}{plain}\""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_in_a_text_acts_on_a_terminal() {
        assert_eq!(printable("Gras ☘ 5 µm"), "Gras ☘ 5 µm");
        let attack = "a\u{1b}[2Jb\r\nc\u{9b}31m\u{7f}\u{202e}d";
        let safe = r"a\u001b[2Jb\u000d\u000ac\u009b31m\u007f\u202ed";
        assert_eq!(printable(attack), safe);
        // in JSON it is the same text still
        let read: String = serde_json::from_str(&format!("\"{safe}\"")).expect("JSON");
        assert_eq!(read, attack);
    }

    #[test]
    fn no_cell_is_a_formula_or_breaks_its_row() {
        for (text, cell) in [
            ("max_force_n", "max_force_n"),
            ("=HYPERLINK(\"x\")", "\"'=HYPERLINK(\"\"x\"\")\""),
            (" @sum", "\"' @sum\""),
            ("-1+2", "\"'-1+2\""),
            ("a,b", "\"a,b\""),
            ("a\r\nb", "\"a  b\""),
            ("\t=1", "\"' =1\""),
        ] {
            assert_eq!(csv_cell(text), cell);
        }
    }
}
