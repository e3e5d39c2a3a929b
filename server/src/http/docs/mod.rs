//! `/docs`: the OpenAPI document as a page for people, without scripts.
mod operation;
mod schema;

use std::sync::OnceLock;

use axum::extract::Path;
use axum::http::HeaderMap;
use axum::response::{Redirect, Response};
use axum::routing::get;
use axum::{Extension, Router};
use serde_json::Value;

use super::AppState;
use super::openapi::Document;
use super::problem::{self, ApiError, Result};
use super::sheet::{Content, Room, Sheet};
use super::text::{prose, text};

const INTRODUCTION: &str = "\
JSON goes in and out. Every error is `application/problem+json` (RFC 9457): `title` and `detail` are for people, \
`type` and the `code` of each of the `violations` for programs, `pointer` leads to the place in the body.\n\n\
On its own machine the server is open; elsewhere it demands `Authorization: Bearer TOKEN` under `/v1` and for `/metrics`. \
Units are in the names: `gauge_length_mm`, `youngs_modulus_pa`. Lists are `{\"items\": [...], \"next\": cursor or null}`. \
Fields may be added to answers at any time; unknown fields in requests are refused.";

/// Stands under the introduction.
const TO_THE_GUIDE: &str = "<p>What can be tested, and what the results mean, is told in the <a href=\"/guide\">guide</a>: \
     <a href=\"/guide/start\">start</a>, <a href=\"/guide/write-a-spec\">write a spec</a>, \
     <a href=\"/guide/quality\">quality and warnings</a>.</p>";

pub(super) fn router() -> Router<AppState> {
    Router::new()
        .route("/docs", get(read))
        .route("/problems/{kind}", get(explain))
}

async fn read(Extension(document): Extension<Document>, headers: HeaderMap) -> Result<Response> {
    static SHEET: OnceLock<Sheet> = OnceLock::new();
    let document = document.get()?;
    Ok(SHEET.get_or_init(|| sheet(document)).answer(&headers))
}

/// The `type` of a problem leads to its line in the page.
async fn explain(Path(kind): Path<String>) -> Result<Redirect> {
    let known = problem::ALL.iter().find(|known| known.slug == kind);
    let known = known.ok_or_else(|| ApiError::not_found(format_args!("problem {kind:?}")))?;
    Ok(Redirect::to(&format!("/docs#problem-{}", known.slug)))
}

fn sheet(document: &Value) -> Sheet {
    let operations = operation::all(document);
    let mut index = String::new();
    let mut body = String::new();
    for tag in document["tags"].as_array().into_iter().flatten() {
        let name = tag["name"].as_str().unwrap_or("");
        let id = name.to_lowercase();
        index += &format!("<a href=\"#{id}\">{}</a>\n", text(name));
        body += &format!("<section id=\"{id}\"><h2>{}</h2>", text(name));
        body += &prose(tag["description"].as_str().unwrap_or(""));
        let of_tag = operations.iter().filter(|operation| operation.tag == name);
        of_tag.for_each(|operation| body += &operation.html());
        body += "</section>\n";
    }
    let problems: String = problem::ALL.iter().map(problem_row).collect();
    let main = format!(
        "<h1>The service <small>REST, version {version}</small></h1>\n\
         <section>{introduction}{TO_THE_GUIDE}</section>\n{body}\
         <section id=\"schemas\"><h2>Schemas</h2>{schemas}</section>\n\
         <section id=\"problems\"><h2>Problems</h2><div class=\"wide\" tabindex=\"0\"><table><thead><tr>\
         <th scope=\"col\">Status<th scope=\"col\">Type<th scope=\"col\">Title</thead><tbody>{problems}</tbody></table></div></section>",
        version = crate::VERSION,
        introduction = prose(INTRODUCTION),
        schemas = schema::all(document),
    );
    index += "<a href=\"#schemas\">Schemas</a>\n<a href=\"#problems\">Problems</a>\n\
              <a href=\"/openapi.json\">openapi.json</a>\n";
    Sheet::new(&Content {
        room: Room::Service,
        title: "The service",
        contents: &index,
        main: &main,
        query: "",
    })
}

fn problem_row(kind: &problem::ProblemKind) -> String {
    let problem::ProblemKind {
        status,
        slug,
        title,
    } = kind;
    format!(
        "<tr id=\"problem-{slug}\"><td>{status}<td><code>/problems/{slug}</code><td>{}</tr>",
        text(title)
    )
}
