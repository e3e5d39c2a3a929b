//! Text as HTML.

/// Text with what HTML would take for its own replaced.
pub(super) fn text(plain: &str) -> String {
    let mut safe = String::with_capacity(plain.len());
    for c in plain.chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            _ => safe.push(c),
        }
    }
    safe
}

/// A line of prose, in which backquotes mark code.
pub(super) fn line(prose: &str) -> String {
    let parts = prose.split('`').enumerate();
    parts.fold(String::new(), |html, (index, part)| {
        html + &if index % 2 == 1 {
            format!("<code>{}</code>", text(part))
        } else {
            text(part)
        }
    })
}

/// Paragraphs of prose, separated by empty lines.
pub(super) fn prose(paragraphs: &str) -> String {
    let paragraphs = paragraphs
        .split("\n\n")
        .filter(|text| !text.trim().is_empty());
    paragraphs
        .map(|text| format!("<p>{}</p>", line(text)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_of_a_text_is_taken_for_markup() {
        assert_eq!(
            prose("a `b<c>` & \"d\"\n\ne"),
            "<p>a <code>b&lt;c&gt;</code> &amp; &quot;d&quot;</p><p>e</p>"
        );
    }
}
