//! The lab page, built into the executable.
use axum::extract::Request;
use axum::http::{Extensions, HeaderMap, HeaderValue, Method, StatusCode, Version, header};
use axum::middleware::Next;
use axum::response::{Html, IntoResponse, Response};
use rust_embed::{Embed, EmbeddedFile};
use tower_http::compression::predicate::{Predicate, SizeAbove};

use super::conditional::EntityTag;
use super::problem::ApiError;

/// The built page; empty when it was not built.
#[derive(Embed)]
#[folder = "page/dist"]
#[allow_missing = true]
struct Built;

/// Said instead of a page that was not built into this executable.
const NOT_BUILT: &str = "<!doctype html><meta charset=\"utf-8\"><title>loadframe</title>\
    <p>This executable was built without the lab page. The service is documented at <a href=\"/docs\">/docs</a>.";

/// Everything that is no route: assets, and the page under each of its addresses.
pub(super) async fn serve(request: Request) -> Response {
    let path = request.uri().path();
    let unknown = || ApiError::not_found(format_args!("page or route {path}")).into_response();
    if !matches!(*request.method(), Method::GET | Method::HEAD) {
        return unknown();
    }
    let name = path.trim_start_matches('/');
    if let Some(file) = Built::get(name).filter(|_| !name.is_empty()) {
        // Vite puts a hash of the content into the names of assets
        let caching = match name.starts_with("assets/") {
            true => "public, max-age=31536000, immutable",
            false => "no-cache",
        };
        return embedded(name, &file, caching, request.headers());
    }
    let is_api = ["v1", "assets"].contains(&name.split('/').next().unwrap_or(""));
    if is_api || !accepts_html(request.headers()) {
        return unknown();
    }
    match Built::get("index.html") {
        Some(file) => embedded("index.html", &file, "no-cache", request.headers()),
        None => Html(NOT_BUILT).into_response(),
    }
}

fn embedded(name: &str, file: &EmbeddedFile, caching: &'static str, asked: &HeaderMap) -> Response {
    use std::fmt::Write;
    let hash = file.metadata.sha256_hash();
    let hash = hash.iter().take(16).fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    });
    let tag = EntityTag::weak(hash);
    let caching = (header::CACHE_CONTROL, HeaderValue::from_static(caching));
    if tag.is_known(asked) {
        return (
            StatusCode::NOT_MODIFIED,
            [(header::ETAG, tag.header()), caching],
        )
            .into_response();
    }
    let media_type = mime_guess::from_path(name).first_or_octet_stream();
    let media_type = match media_type.type_() {
        mime_guess::mime::TEXT => format!("{}; charset=utf-8", media_type.essence_str()),
        _ => media_type.essence_str().to_owned(),
    };
    let media_type = HeaderValue::try_from(media_type)
        .unwrap_or_else(|_| HeaderValue::from_static("application/octet-stream"));
    let headers = [
        (header::CONTENT_TYPE, media_type),
        (header::ETAG, tag.header()),
        caching,
    ];
    (headers, file.data.to_vec()).into_response()
}

fn accepts_html(headers: &HeaderMap) -> bool {
    let accept = headers
        .get(header::ACCEPT)
        .and_then(|value| value.to_str().ok());
    accept.is_some_and(|accept| accept.contains("text/html"))
}

/// Headers that keep browsers from mixing this service up with anything else.
pub(super) async fn protect(request: Request, next: Next) -> Response {
    const HEADERS: [(header::HeaderName, &str); 4] = [
        (
            header::CONTENT_SECURITY_POLICY,
            "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; \
             object-src 'none'; base-uri 'none'; form-action 'self'; frame-ancestors 'none'",
        ),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::X_FRAME_OPTIONS, "DENY"),
        (header::REFERRER_POLICY, "same-origin"),
    ];
    let mut response = next.run(request).await;
    for (name, value) in HEADERS {
        response
            .headers_mut()
            .insert(name, HeaderValue::from_static(value));
    }
    response
}

/// Answers that shrink and may: texts that are not streams or byte ranges of files.
pub(super) fn worth_compressing() -> impl Predicate {
    /// Smaller ones fit a packet anyway [bytes].
    const SMALL: u64 = 1024;
    SizeAbove::new(SMALL).and(is_compressible)
}

fn is_compressible(_: StatusCode, _: Version, headers: &HeaderMap, _: &Extensions) -> bool {
    let media_type = headers.get(header::CONTENT_TYPE);
    let media_type = media_type
        .and_then(|value| value.to_str().ok())
        .unwrap_or("");
    let essence = media_type.split(';').next().unwrap_or("");
    let is_text = essence.starts_with("text/")
        || essence.ends_with("json")
        || essence.ends_with("javascript")
        || essence == "image/svg+xml";
    is_text && essence != "text/event-stream" && !headers.contains_key(header::ACCEPT_RANGES)
}
