//! `/docs`: the OpenAPI document as a page for people, without scripts.
mod html;
mod operation;
mod schema;

use std::sync::OnceLock;

use axum::Router;
use axum::extract::Path;
use axum::http::{HeaderMap, header};
use axum::response::{Html, IntoResponse, Redirect, Response};
use axum::routing::get;
use serde_json::Value;

use super::AppState;
use super::conditional::EntityTag;
use super::problem::{self, ApiError, Result};
use html::{prose, text};

const STYLE: &str = include_str!("style.css");

const INTRODUCTION: &str = "\
JSON goes in and out. Every error is `application/problem+json` (RFC 9457): `title` and `detail` are for people, \
`type` and the `code` of each of the `violations` for programs, `pointer` leads to the place in the body.\n\n\
On its own machine the server is open; elsewhere it demands `Authorization: Bearer TOKEN` under `/v1` and for `/metrics`. \
Units are in the names: `gauge_length_mm`, `youngs_modulus_pa`. Lists are `{\"items\": [...], \"next\": cursor or null}`. \
Fields may be added to answers at any time; unknown fields in requests are refused.";

pub(super) fn router() -> Router<AppState> {
    Router::new()
        .route("/docs", get(read))
        .route("/problems/{kind}", get(explain))
}

async fn read(headers: HeaderMap) -> Result<Response> {
    static PAGE: OnceLock<String> = OnceLock::new();
    let tag = EntityTag::weak(crate::VERSION);
    if tag.is_known(&headers) {
        return Ok(tag.not_modified());
    }
    let document = super::document().map_err(|error| ApiError::internal(error))?;
    let page = PAGE.get_or_init(|| page(document));
    let headers = [(header::ETAG, tag.header())];
    Ok((headers, Html(page.as_str())).into_response())
}

/// The `type` of a problem leads to its line in the page.
async fn explain(Path(kind): Path<String>) -> Result<Redirect> {
    let known = problem::ALL.iter().find(|known| known.slug == kind);
    let known = known.ok_or_else(|| ApiError::not_found(format_args!("problem {kind:?}")))?;
    Ok(Redirect::to(&format!("/docs#problem-{}", known.slug)))
}

fn page(document: &Value) -> String {
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
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <meta name=\"color-scheme\" content=\"light dark\">\
         <title>loadframe: the service</title><style>{STYLE}</style></head><body>\n\
         <header><h1><a href=\"/\">loadframe</a> <small>the service, {version}</small></h1>\
         <nav>{index}<a href=\"#schemas\">Schemas</a><a href=\"#problems\">Problems</a><a href=\"/openapi.json\">openapi.json</a></nav></header>\n\
         <main><section>{introduction}</section>\n{body}\
         <section id=\"schemas\"><h2>Schemas</h2>{schemas}</section>\n\
         <section id=\"problems\"><h2>Problems</h2><table><thead><tr><th>Status<th>Type<th>Title</thead><tbody>{problems}</tbody></table></section>\
         </main></body></html>\n",
        version = crate::VERSION,
        introduction = prose(INTRODUCTION),
        schemas = schema::all(document),
    )
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
