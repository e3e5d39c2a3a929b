//! `/guide`: what can be tested and how, for people, without scripts.
//!
//! [`source`] has the texts, which can be read in the repository as well; [`markdown`] makes them
//! HTML, each on its [`page`], [`fields`] writes a reference from the schemas and [`listed`] what goes over all kinds, [`search`] finds sections of both. All is
//! made once, when the guide is first asked for.
mod fields;
mod listed;
mod markdown;
mod page;
mod search;
mod source;

use std::sync::OnceLock;

use axum::Router;
use axum::extract::{Path, Query};
use axum::http::{HeaderMap, HeaderValue, header};
use axum::response::{Html, IntoResponse, Redirect, Response};
use axum::routing::get;
use loadframe_api::JobKind;

use super::AppState;
use super::conditional::EntityTag;
use super::problem::{ApiError, Result};
use super::sheet::{Content, Room, Sheet};
use super::text::text;
use markdown::{Rendered, Section};
use page::{Page, home_of};
use search::Entry;

/// Headings down to this level are in the table of contents.
const LOWEST_LEVEL: u8 = 4;

pub(super) fn router() -> Router<AppState> {
    Router::new()
        .route("/guide", get(index))
        .route("/guide/", get(|| async { Redirect::permanent("/guide") }))
        .route("/guide/search", get(find))
        .route("/guide/{page}", get(read))
        .route("/guide/{kind}/fields", get(read_fields))
        .route("/guide/pictures/{name}", get(picture))
}

#[derive(Debug)]
struct Guide {
    pages: Vec<Page>,
    entries: Vec<Entry>,
}

async fn index(headers: HeaderMap) -> Result<Response> {
    answer("/guide", &headers)
}

async fn read(Path(page): Path<String>, headers: HeaderMap) -> Result<Response> {
    if let Some(name) = page.strip_suffix(".md") {
        return match Guide::get().page(&format!("/guide/{name}")) {
            Some(page) => Ok(Redirect::permanent(&page.address).into_response()),
            None => answer(&format!("/guide/{page}"), &headers),
        };
    }
    let kind = page.parse::<JobKind>().map(home_of);
    match kind {
        Ok(home) if home != format!("/guide/{page}") => {
            Ok(Redirect::permanent(&home).into_response())
        }
        _ => answer(&format!("/guide/{page}"), &headers),
    }
}

async fn read_fields(Path(kind): Path<String>, headers: HeaderMap) -> Result<Response> {
    answer(&format!("/guide/{kind}/fields"), &headers)
}

fn answer(address: &str, headers: &HeaderMap) -> Result<Response> {
    let page = Guide::get().page(address);
    let page = page.ok_or_else(|| {
        let pages = "the pages are listed at /guide";
        ApiError::not_found(format_args!("page {address} in the guide; {pages}"))
    })?;
    Ok(page.sheet.answer(headers))
}

/// Searches; of several `q` the first counts.
async fn find(Query(asked): Query<Vec<(String, String)>>) -> Html<String> {
    let query = asked.iter().find(|(name, _)| name == "q");
    let query = search::bounded(query.map_or("", |(_, query)| query));
    let results = search::results(&Guide::get().entries, &query);
    let title = match query.as_str() {
        "" => "Search the guide".to_owned(),
        query => format!("Search: {query}"),
    };
    let sheet = Sheet::new(&Content {
        room: Room::Guide,
        title: &title,
        contents: "",
        main: &format!("<h1>{}</h1>\n{results}", text(&title)),
        query: &query,
    });
    Html(sheet.into_html())
}

async fn picture(Path(name): Path<String>, headers: HeaderMap) -> Result<Response> {
    let file = source::picture(&name);
    let file =
        file.ok_or_else(|| ApiError::not_found(format_args!("picture {name:?} in the guide")))?;
    let tag = EntityTag::weak(loadframe_api::sha256_hex(&file.data));
    if tag.is_known(&headers) {
        return Ok(tag.not_modified());
    }
    let media_type = mime_guess::from_path(&name).first_or_octet_stream();
    let media_type = HeaderValue::try_from(media_type.essence_str())
        .map_err(|error| ApiError::internal(&error))?;
    let headers = [
        (header::CONTENT_TYPE, media_type),
        (header::ETAG, tag.header()),
        (header::CACHE_CONTROL, HeaderValue::from_static("no-cache")),
    ];
    Ok((headers, file.data.into_owned()).into_response())
}

/// A text that has been rendered.
struct Text {
    address: String,
    rendered: Rendered,
}

impl Text {
    fn title(&self) -> &str {
        self.rendered
            .sections
            .first()
            .map_or("", |section| &section.heading)
    }
}

impl Guide {
    fn get() -> &'static Self {
        static GUIDE: OnceLock<Guide> = OnceLock::new();
        GUIDE.get_or_init(Self::make)
    }

    fn page(&self, address: &str) -> Option<&Page> {
        self.pages.iter().find(|page| page.address == address)
    }

    fn make() -> Self {
        let sources = source::all();
        let served = sources
            .iter()
            .map(|source| (source.path.clone(), source.name.clone()));
        let served: Vec<(String, String)> = served.collect();
        let render = |source: &source::Source| Text {
            address: match source.name.as_str() {
                "" => "/guide".to_owned(),
                name => format!("/guide/{name}"),
            },
            rendered: markdown::render(&source.markdown, &|link| {
                source::lead(&source.path, link, &served)
            }),
        };
        let texts: Vec<Text> = sources.iter().map(render).collect();
        let mut guide = Self {
            pages: Vec::new(),
            entries: Vec::new(),
        };
        for (place, own) in texts.iter().enumerate() {
            let before = place.checked_sub(1).and_then(|place| texts.get(place));
            guide.pages.push(Page {
                address: own.address.clone(),
                sheet: sheet(own, before, texts.get(place + 1)),
            });
            for section in &own.rendered.sections {
                let address = match section.level {
                    1 => own.address.clone(),
                    _ => format!("{}#{}", own.address, section.anchor),
                };
                let entry = Entry::new(address, own.title(), &section.heading, &section.text);
                guide.entries.push(entry);
            }
        }
        for kind in JobKind::ALL {
            let (page, entries) = fields::page(*kind);
            guide.pages.push(page);
            guide.entries.extend(entries);
        }
        guide
    }
}

fn sheet(own: &Text, before: Option<&Text>, after: Option<&Text>) -> Sheet {
    let link = |rel: &str, word: &str, to: Option<&Text>| {
        to.map_or(String::new(), |to| {
            let title = text(to.title());
            format!(
                "<a rel=\"{rel}\" href=\"{}\"><small>{word}</small> {title}</a>",
                to.address
            )
        })
    };
    let main = format!(
        "{}<nav class=\"turn\" aria-label=\"Pages before and after\">{}{}</nav>",
        own.rendered.html,
        link("prev", "Before", before),
        link("next", "Next", after),
    );
    Sheet::new(&Content {
        room: Room::Guide,
        title: own.title(),
        contents: &contents(&own.rendered.sections),
        main: &main,
        query: "",
    })
}

/// The table of contents; none for a page of few sections.
fn contents(sections: &[Section]) -> String {
    let listed = sections
        .iter()
        .filter(|section| (2..=LOWEST_LEVEL).contains(&section.level));
    let items: Vec<String> = listed
        .map(|section| {
            let Section {
                level,
                anchor,
                heading,
                ..
            } = section;
            format!(
                "<li class=\"level{level}\"><a href=\"#{}\">{}</a></li>",
                text(anchor),
                text(heading)
            )
        })
        .collect();
    match items.len() {
        0 | 1 => String::new(),
        _ => format!("<ul>{}</ul>", items.concat()),
    }
}
