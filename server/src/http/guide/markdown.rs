//! Markdown as HTML: tables, anchors at headings, links that lead on within the guide.
//!
//! Raw HTML in a text is shown, not passed on; only `<a id="name"></a>` in a heading is understood,
//! which names the heading here as it does where the repository is read.
use std::collections::HashSet;

use pulldown_cmark::{CowStr, Event, HeadingLevel, Options, Parser, Tag, TagEnd, html};

use crate::http::text::text;

/// A text, and what is known of it.
#[derive(Debug, Default)]
pub(super) struct Rendered {
    pub(super) html: String,
    /// In the order of the text, the title first.
    pub(super) sections: Vec<Section>,
}

/// A heading and what stands beneath it, up to the next one.
#[derive(Debug, Default)]
pub(super) struct Section {
    pub(super) level: u8,
    pub(super) anchor: String,
    pub(super) heading: String,
    /// Plain text.
    pub(super) text: String,
}

/// Renders `source`; `lead` says where a link goes, `None` for what is not served here.
pub(super) fn render(source: &str, lead: &dyn Fn(&str) -> Option<String>) -> Rendered {
    let mut writer = Writer {
        lead,
        events: Vec::new(),
        sections: Vec::new(),
        anchors: HashSet::new(),
        tables: 0,
        in_head: false,
        unserved: Vec::new(),
    };
    let mut events = Parser::new_ext(source, Options::ENABLE_TABLES);
    while let Some(event) = events.next() {
        match event {
            Event::Start(Tag::Heading { level, .. }) => writer.heading(level, &mut events),
            event => writer.take(event),
        }
    }
    let mut rendered = Rendered {
        html: String::with_capacity(source.len() * 2),
        sections: writer.sections,
    };
    html::push_html(&mut rendered.html, writer.events.into_iter());
    rendered
}

struct Writer<'a, 'b> {
    lead: &'b dyn Fn(&str) -> Option<String>,
    events: Vec<Event<'a>>,
    sections: Vec<Section>,
    anchors: HashSet<String>,
    /// Tables so far.
    tables: usize,
    /// Whether cells are those of a table's head.
    in_head: bool,
    /// For each open link, whether it is left out.
    unserved: Vec<bool>,
}

impl<'a> Writer<'a, '_> {
    fn html(&mut self, html: impl Into<CowStr<'a>>) {
        self.events.push(Event::Html(html.into()));
    }

    /// Adds to the plain text of the section.
    fn note(&mut self, words: &str) {
        if let Some(section) = self.sections.last_mut() {
            section.text.push_str(words);
        }
    }

    /// A heading with its anchor, up to its end.
    fn heading(&mut self, level: HeadingLevel, events: &mut Parser<'a>) {
        let mut inner = Vec::new();
        let mut words = String::new();
        let mut given = None;
        for event in events {
            match event {
                Event::End(TagEnd::Heading(_)) => break,
                Event::InlineHtml(raw) => match named_anchor(&raw) {
                    Some(name) => given = Some(name.to_owned()),
                    None if raw.as_ref() == "</a>" && given.is_some() => {}
                    None => inner.push(Event::Text(raw)),
                },
                event => {
                    if let Event::Text(part) | Event::Code(part) = &event {
                        words.push_str(part);
                    }
                    inner.push(event);
                }
            }
        }
        let anchor = self.free_anchor(given.unwrap_or_else(|| slug(&words)));
        self.html(format!("<{level} id=\"{}\">", text(&anchor)));
        self.sections.push(Section {
            level: level as u8,
            anchor,
            heading: words,
            text: String::new(),
        });
        for event in inner {
            self.take(event);
        }
        // a heading is found by its own words
        if let Some(section) = self.sections.last_mut() {
            section.text.clear();
        }
        self.html(format!("</{level}>\n"));
    }

    /// The anchor, or with a number where there is one already.
    fn free_anchor(&mut self, wanted: String) -> String {
        let numbered = (1..).map(|number| format!("{wanted}-{number}"));
        let mut names = std::iter::once(wanted.clone()).chain(numbered);
        let free = names.find(|name| !self.anchors.contains(name));
        let free = free.unwrap_or(wanted);
        self.anchors.insert(free.clone());
        free
    }

    fn take(&mut self, event: Event<'a>) {
        match event {
            Event::Html(raw) | Event::InlineHtml(raw) => {
                self.note(&raw);
                self.events.push(Event::Text(raw));
            }
            Event::Text(words) => {
                self.note(&words);
                self.events.push(Event::Text(words));
            }
            Event::Code(words) => {
                self.note(&words);
                self.events.push(Event::Code(words));
            }
            Event::SoftBreak | Event::HardBreak => {
                self.note(" ");
                self.events.push(event);
            }
            Event::Start(tag) => self.start(tag),
            Event::End(tag) => self.end(tag),
            event => self.events.push(event),
        }
    }

    fn start(&mut self, tag: Tag<'a>) {
        match tag {
            Tag::Table(_) => {
                self.tables += 1;
                let of = self.sections.last().map_or("", |section| &section.heading);
                let label = text(&format!("Table {}: {of}", self.tables));
                self.html(format!(
                    "<div class=\"wide\" role=\"region\" aria-label=\"{label}\" tabindex=\"0\"><table>"
                ));
            }
            Tag::TableHead => {
                self.in_head = true;
                self.html("<thead><tr>");
            }
            Tag::TableRow => self.html("<tr>"),
            Tag::TableCell if self.in_head => self.html("<th scope=\"col\">"),
            Tag::TableCell => self.html("<td>"),
            Tag::CodeBlock(_) => self.html("<pre tabindex=\"0\"><code>"),
            Tag::Link {
                link_type,
                dest_url,
                title,
                id,
            } => {
                let target = (self.lead)(&dest_url);
                self.unserved.push(target.is_none());
                if let Some(target) = target {
                    self.events.push(Event::Start(Tag::Link {
                        link_type,
                        dest_url: target.into(),
                        title,
                        id,
                    }));
                }
            }
            Tag::Image {
                link_type,
                dest_url,
                title,
                id,
            } => {
                let dest_url = (self.lead)(&dest_url).map_or(dest_url, CowStr::from);
                self.events.push(Event::Start(Tag::Image {
                    link_type,
                    dest_url,
                    title,
                    id,
                }));
            }
            tag => self.events.push(Event::Start(tag)),
        }
    }

    fn end(&mut self, tag: TagEnd) {
        self.note(match tag {
            TagEnd::Paragraph | TagEnd::Item | TagEnd::TableRow | TagEnd::CodeBlock => "\n",
            TagEnd::TableCell => " ",
            _ => "",
        });
        match tag {
            TagEnd::Table => self.html("</tbody></table></div>\n"),
            TagEnd::TableHead => {
                self.in_head = false;
                self.html("</tr></thead><tbody>\n");
            }
            TagEnd::TableRow => self.html("</tr>\n"),
            TagEnd::TableCell if self.in_head => self.html("</th>"),
            TagEnd::TableCell => self.html("</td>"),
            TagEnd::CodeBlock => self.html("</code></pre>\n"),
            TagEnd::Link if self.unserved.pop() == Some(true) => {}
            tag => self.events.push(Event::End(tag)),
        }
    }
}

/// The name in `<a id="name">`.
fn named_anchor(raw: &str) -> Option<&str> {
    let name = raw.strip_prefix("<a id=\"")?.strip_suffix("\">")?;
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    name.chars().all(is_plain).then_some(name)
}

/// The anchor of a heading as GitHub makes it.
fn slug(heading: &str) -> String {
    let kept = heading.trim().chars().filter_map(|c| match c {
        ' ' => Some('-'),
        c if c.is_alphanumeric() || c == '-' || c == '_' => Some(c),
        _ => None,
    });
    kept.flat_map(char::to_lowercase).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn html(source: &str) -> String {
        render(source, &|link| {
            link.strip_suffix(".md")
                .map(|page| format!("/guide/{page}"))
        })
        .html
    }

    #[test]
    fn headings_have_the_anchors_of_the_repository() {
        let source = "# Speed & `A_cc`\n\none\n\n## <a id=\"own\"></a>Given\n\ntwo\n\n## Given\n\n## Given\n";
        let rendered = render(source, &|_| None);
        let anchors: Vec<_> = rendered
            .sections
            .iter()
            .map(|s| s.anchor.as_str())
            .collect();
        assert_eq!(anchors, ["speed--a_cc", "own", "given", "given-1"]);
        assert_eq!(rendered.sections[1].text, "two\n");
        assert!(rendered.html.contains("<h2 id=\"own\">Given</h2>"));
        assert!(
            rendered
                .html
                .contains("<h1 id=\"speed--a_cc\">Speed &amp; <code>A_cc</code></h1>")
        );
    }

    #[test]
    fn raw_html_is_shown_and_never_passed_on() {
        let html = html(
            "# A <a id=\"x\" onclick=\"y\"></a>\n\n<script>alert(1)</script>\n\nin <b onclick=\"a\">line</b>\n\n| a |\n|-|\n| <img src=x onerror=y> |\n",
        );
        for tag in ["<script", "<b ", "<img", "<a "] {
            assert!(!html.contains(tag), "{tag} in {html}");
        }
        assert!(html.contains("&lt;script&gt;"));
    }

    #[test]
    fn links_lead_on_or_are_left_out() {
        assert_eq!(
            html("[a](start.md) [b](../src/x.rs)"),
            "<p><a href=\"/guide/start\">a</a> b</p>\n"
        );
    }

    #[test]
    fn tables_have_scopes_and_scroll_in_their_own_box() {
        let html = html("# T\n\n| a | b |\n|---|---|\n| 1 | 2 |\n");
        assert!(html.contains(
            "<div class=\"wide\" role=\"region\" aria-label=\"Table 1: T\" tabindex=\"0\"><table><thead><tr>\
             <th scope=\"col\">a</th><th scope=\"col\">b</th></tr></thead><tbody>\n<tr><td>1</td><td>2</td></tr>\n</tbody></table></div>"
        ), "{html}");
    }
}
