//! A page for reading, in the look of the lab page and without scripts: [`super::docs`] and
//! [`super::guide`] are made of these.
use axum::http::{HeaderMap, HeaderValue, header};
use axum::response::{Html, IntoResponse, Response};
use loadframe_api::sha256_hex;

use super::conditional::EntityTag;
use super::text::text;

const STYLE: &str = include_str!("sheet.css");

/// Most characters of a query that are read; a sentence is shorter.
pub(super) const LONGEST_QUERY: usize = 200;

/// Where a sheet belongs, for the links at its head.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Room {
    Guide,
    Service,
}

/// What a sheet is made of.
#[derive(Debug)]
pub(super) struct Content<'a> {
    pub(super) room: Room,
    /// Plain text, for the browser's window.
    pub(super) title: &'a str,
    /// HTML of a table of contents; empty for none.
    pub(super) contents: &'a str,
    /// HTML of the text itself, which begins with its `h1`.
    pub(super) main: &'a str,
    /// What stands in the field for searching.
    pub(super) query: &'a str,
}

/// A finished page.
#[derive(Clone, Debug)]
pub(super) struct Sheet {
    html: String,
    tag: EntityTag,
}

impl Sheet {
    pub(super) fn new(content: &Content<'_>) -> Self {
        let html = html(content);
        let tag = EntityTag::weak(sha256_hex(html.as_bytes()));
        Self { html, tag }
    }

    /// The page itself.
    pub(super) fn into_html(self) -> String {
        self.html
    }

    /// The page, or 304 for who has it.
    pub(super) fn answer(&self, headers: &HeaderMap) -> Response {
        if self.tag.is_known(headers) {
            return self.tag.not_modified();
        }
        let headers = [
            (header::ETAG, self.tag.header()),
            (header::CACHE_CONTROL, HeaderValue::from_static("no-cache")),
        ];
        (headers, Html(self.html.clone())).into_response()
    }
}

fn html(content: &Content<'_>) -> String {
    let here = |room: Room| match content.room == room {
        true => " aria-current=\"true\"",
        false => "",
    };
    let contents = match content.contents {
        "" => String::new(),
        contents => format!(
            "<aside><details class=\"contents\"><summary>On this page</summary>\
             <nav aria-label=\"On this page\">{contents}</nav></details></aside>\n"
        ),
    };
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <meta name=\"color-scheme\" content=\"light dark\">\
         <link rel=\"icon\" href=\"data:,\"><title>{title} · loadframe</title><style>{STYLE}</style></head><body>\n\
         <a class=\"skip\" href=\"#main\">Skip to the text</a>\n\
         <header class=\"top\"><a class=\"home\" href=\"/\">loadframe</a>\
         <nav aria-label=\"loadframe\"><a href=\"/guide\"{guide}>Guide</a> <a href=\"/docs\"{service}>REST</a> <a href=\"/\">Jobs</a></nav>\
         <form role=\"search\" action=\"/guide/search\"><input type=\"search\" name=\"q\" value=\"{query}\" \
         maxlength=\"{LONGEST_QUERY}\" aria-label=\"Search the guide\" placeholder=\"Search the guide\"><button>Search</button></form></header>\n\
         <div class=\"{columns}\">{contents}<main id=\"main\" tabindex=\"-1\">{main}</main></div>\n\
         <footer>loadframe {version}, {commit}</footer></body></html>\n",
        title = text(content.title),
        guide = here(Room::Guide),
        service = here(Room::Service),
        query = text(content.query),
        columns = if contents.is_empty() {
            "one column"
        } else {
            "columns"
        },
        main = content.main,
        version = crate::VERSION,
        commit = text(crate::COMMIT),
    )
}
