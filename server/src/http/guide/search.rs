//! Searching the guide by sections, rendered here so that it works without scripts.
use std::collections::HashSet;

use crate::http::sheet::LONGEST_QUERY;
use crate::http::text::text;

/// Words of a query that are looked for.
const MOST_WORDS: usize = 12;
/// Sections shown.
const MOST_FOUND: usize = 30;
/// Characters of a section that are shown before and after the first word found.
const BEFORE: usize = 60;
const AFTER: usize = 180;

/// How much a word found counts: in a heading, in the page's title, in the text.
const IN_HEADING: f64 = 8.0;
const IN_TITLE: f64 = 3.0;
const IN_TEXT: f64 = 1.0;
/// A beginning of a word counts less than the word.
const BEGINNING: f64 = 0.5;

/// A section that can be found.
#[derive(Debug)]
pub(super) struct Entry {
    pub(super) address: String,
    /// Of its page.
    pub(super) title: String,
    pub(super) heading: String,
    pub(super) text: String,
    title_words: Vec<String>,
    heading_words: Vec<String>,
    text_words: Vec<String>,
}

impl Entry {
    pub(super) fn new(address: String, title: &str, heading: &str, text: &str) -> Self {
        Self {
            address,
            title: title.to_owned(),
            heading: heading.to_owned(),
            text: text.split_whitespace().collect::<Vec<_>>().join(" "),
            title_words: words(title),
            heading_words: words(heading),
            text_words: words(text),
        }
    }

    /// How well `word` fits; 0 where it is not found.
    fn weight(&self, word: &str) -> f64 {
        let found = |among: &[String]| -> f64 {
            let fits = among.iter().map(|other| match other.strip_prefix(word) {
                Some("") => 1.0,
                Some(_) => BEGINNING,
                None => 0.0,
            });
            fits.sum()
        };
        // the tenth mention says less than the first
        let text = found(&self.text_words).ln_1p();
        IN_HEADING * found(&self.heading_words).min(1.0)
            + IN_TITLE * found(&self.title_words).min(1.0)
            + IN_TEXT * text
    }
}

/// The query as it is read: in one line, of a bounded length.
pub(super) fn bounded(query: &str) -> String {
    let line: String = query
        .chars()
        .take(LONGEST_QUERY)
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    line.trim().to_owned()
}

/// The results as HTML. Sections with all words come first; where there are none, those with some.
pub(super) fn results(entries: &[Entry], query: &str) -> String {
    let wanted = distinct(words(query));
    if wanted.is_empty() {
        return "<p>Write one or more words into the field above: a field's name, a warning's code, what you \
                want to do.</p>"
            .to_owned();
    }
    // a word that is in every second section tells sections apart less than a rare one
    let total = entries.len() as f64;
    let rarity = wanted.iter().map(|word| {
        let count = entries
            .iter()
            .filter(|entry| entry.weight(word) > 0.0)
            .count();
        (total / (1.0 + count as f64)).ln().max(0.1)
    });
    let rarity: Vec<f64> = rarity.collect();
    let mut found: Vec<(usize, f64, &Entry)> = Vec::new();
    for entry in entries {
        let weights = wanted.iter().map(|word| entry.weight(word));
        let weights: Vec<f64> = weights.collect();
        let hits = weights.iter().filter(|weight| **weight > 0.0).count();
        if hits > 0 {
            let score = weights
                .iter()
                .zip(&rarity)
                .map(|(weight, rarity)| weight * rarity);
            found.push((hits, score.sum(), entry));
        }
    }
    found.sort_by(|one, other| other.0.cmp(&one.0).then(other.1.total_cmp(&one.1)));
    let all = found
        .iter()
        .filter(|(hits, ..)| *hits == wanted.len())
        .count();
    let shown = match all {
        0 => &found[..],
        all => &found[..all],
    };
    let head = match (shown.len(), all) {
        (0, _) => {
            "<p role=\"status\">Nothing in the guide has these words. Routes and schemas are in the \
             <a href=\"/docs\">documentation of the service</a>.</p>"
                .to_owned()
        }
        (count, 0) => format!("<p role=\"status\">No section has all words; {} some.</p>", have(count)),
        (count, _) if wanted.len() == 1 => format!("<p role=\"status\">{} the word.</p>", capital(have(count))),
        (count, _) => format!("<p role=\"status\">{} all words.</p>", capital(have(count))),
    };
    let items = shown
        .iter()
        .take(MOST_FOUND)
        .map(|(_, _, entry)| item(entry, &wanted));
    let more = match shown.len().saturating_sub(MOST_FOUND) {
        0 => String::new(),
        more => format!("<p>{more} more are not shown; another word narrows it down.</p>"),
    };
    format!(
        "{head}<ol class=\"found\">{}</ol>{more}",
        items.collect::<String>()
    )
}

fn have(count: usize) -> String {
    match count {
        1 => "one section has".to_owned(),
        count => format!("{count} sections have"),
    }
}

fn capital(words: String) -> String {
    match words.starts_with("one") {
        true => format!("One{}", &words[3..]),
        false => words,
    }
}

fn item(entry: &Entry, wanted: &[String]) -> String {
    let of = match entry.heading == entry.title {
        true => String::new(),
        false => format!(" <small>{}</small>", text(&entry.title)),
    };
    format!(
        "<li><a href=\"{}\">{}</a>{of}<p>{}</p></li>\n",
        text(&entry.address),
        marked(&entry.heading, wanted),
        excerpt(&entry.text, wanted),
    )
}

/// A piece of the text around the first of the words.
fn excerpt(plain: &str, wanted: &[String]) -> String {
    let at = spans(plain, wanted).first().map_or(0, |(start, _)| *start);
    let before = plain[..at].char_indices().rev().take(BEFORE).last();
    let start = match before.map_or(0, |(start, _)| start) {
        0 => 0,
        // not in the middle of a word
        cut => plain[cut..at].find(' ').map_or(at, |space| cut + space + 1),
    };
    let after = plain[at..].char_indices().nth(AFTER);
    let end = match after {
        None => plain.len(),
        Some((cut, _)) => plain[at..at + cut]
            .rfind(' ')
            .map_or(at + cut, |space| at + space),
    };
    let [begin, finish] = [start > 0, end < plain.len()].map(|cut| if cut { " … " } else { "" });
    format!("{begin}{}{finish}", marked(&plain[start..end], wanted))
}

/// The text with the words wanted marked.
fn marked(plain: &str, wanted: &[String]) -> String {
    let mut html = String::new();
    let mut done = 0;
    for (start, end) in spans(plain, wanted) {
        html += &text(&plain[done..start]);
        html += &format!("<mark>{}</mark>", text(&plain[start..end]));
        done = end;
    }
    html + &text(&plain[done..])
}

/// Where words are that begin with one of those wanted.
fn spans(plain: &str, wanted: &[String]) -> Vec<(usize, usize)> {
    let mut spans = Vec::new();
    let mut at = 0;
    for piece in plain.split_inclusive(|c: char| !is_of_word(c)) {
        let word = piece.trim_end_matches(|c: char| !is_of_word(c));
        let lower = word.to_lowercase();
        let fits = |part: &String| {
            lower.starts_with(part.as_str())
                || lower.split('_').any(|p| p.starts_with(part.as_str()))
        };
        if !word.is_empty() && wanted.iter().any(fits) {
            spans.push((at, at + word.len()));
        }
        at += piece.len();
    }
    spans
}

fn is_of_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The words of a text in lower case; names such as `strain_step` are words, and so are their parts.
fn words(text: &str) -> Vec<String> {
    let mut words = Vec::new();
    for word in text
        .split(|c: char| !is_of_word(c))
        .filter(|word| !word.is_empty())
    {
        let word = word.to_lowercase();
        if word.contains('_') {
            words.extend(
                word.split('_')
                    .filter(|part| !part.is_empty())
                    .map(str::to_owned),
            );
        }
        words.push(word);
    }
    words
}

fn distinct(words: Vec<String>) -> Vec<String> {
    let mut seen = HashSet::new();
    let new = words.into_iter().filter(|word| seen.insert(word.clone()));
    new.take(MOST_WORDS).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries() -> Vec<Entry> {
        [
            (
                "/guide/a#one",
                "Nonwovens",
                "Strain step",
                "How large a step is.",
            ),
            (
                "/guide/a#two",
                "Nonwovens",
                "Breaking",
                "Bonds break when a strain step is over.",
            ),
            (
                "/guide/b#three",
                "Ballast",
                "Period",
                "The period of a cycle, a < b & c.",
            ),
        ]
        .map(|(address, title, heading, text)| Entry::new(address.to_owned(), title, heading, text))
        .into()
    }

    #[test]
    fn a_heading_comes_before_a_mention() {
        let html = results(&entries(), "STRAIN step");
        let places = ["#one", "#two"].map(|anchor| html.find(anchor));
        assert!(places[0].is_some() && places[0] < places[1], "{html}");
        assert!(!html.contains("#three"));
        assert!(html.contains("<mark>Strain</mark>"));
        assert!(html.contains("2 sections have all words"));
    }

    #[test]
    fn beginnings_are_found_and_some_words_where_no_section_has_all() {
        assert!(results(&entries(), "break").contains("#two"));
        let html = results(&entries(), "period nowhere");
        assert!(
            html.contains("No section has all words") && html.contains("#three"),
            "{html}"
        );
        assert!(results(&entries(), "nowhere").contains("Nothing in the guide"));
    }

    #[test]
    fn whatever_is_asked_is_text() {
        let html = results(&entries(), "period <script>alert('x')</script>");
        assert!(!html.contains("<script"));
        assert!(html.contains("a &lt; b &amp; c"));
        for empty in ["", "  ", "<>&\"'", "\0\n"] {
            assert!(results(&entries(), &bounded(empty)).contains("Write one or more words"));
        }
        assert_eq!(bounded(&"é".repeat(10_000)).chars().count(), LONGEST_QUERY);
    }

    #[test]
    fn an_excerpt_is_cut_between_words() {
        let long = format!("{}needle {}", "before ".repeat(50), "after ".repeat(50));
        let html = excerpt(&long, &["needle".to_owned()]);
        assert!(
            html.starts_with(" … before ") && html.ends_with("after … "),
            "{html}"
        );
        let wide = "ü".repeat(500);
        assert_eq!(
            excerpt(&wide, &["needle".to_owned()]).chars().count(),
            AFTER + 3
        );
    }
}
