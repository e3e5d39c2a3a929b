//! REST, server-sent events and the lab page.
//!
//! One file for each resource: [`jobs`], [`trash`], [`events`], [`curve`], [`compare`], [`files`] and [`archive`],
//! [`kinds`], [`workers`], [`people`], the [`worker`] side, [`health`] and [`metrics`]. Every handler carries its
//! part of the OpenAPI document, which [`openapi`] completes and [`docs`] shows to people. The [`guide`]
//! tells what the tests are; both are [`sheet`]s of [`text`].
//!
//! Around them, from the outside: tracing, security headers, [`metrics`], compression,
//! [`problem::only_problems`] (whatever goes wrong, the answer is `application/problem+json`),
//! panics caught, [`guard`], which finds out by [`access`] who asks. Every handler under `/v1` takes a
//! permit ([`permit`]), which asks the rules of [`crate::access`].
mod access;
mod archive;
mod body;
mod body_budget;
mod bounded;
mod checks;
mod compare;
mod conditional;
mod curve;
mod decimate;
mod docs;
mod events;
mod files;
mod guard;
mod guide;
mod health;
mod identify;
mod jobs;
mod kinds;
mod metrics;
mod openapi;
mod origin;
mod page;
mod people;
mod permit;
pub mod problem;
mod query;
mod schema;
mod sheet;
mod state;
mod text;
mod trash;
mod worker;
mod workers;

use std::sync::OnceLock;

use axum::middleware::{from_fn, from_fn_with_state};
use axum::{Extension, Router};
use serde_json::Value;
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::compression::CompressionLayer;
use tower_http::trace::TraceLayer;
use utoipa_axum::router::OpenApiRouter;

pub(crate) use metrics::keep_folded as keep_metrics_folded;
pub use state::AppState;

/// What the log calls a request: never by its query, in which a provider of single sign-on sends a code.
fn span(request: &axum::extract::Request) -> tracing::Span {
    tracing::debug_span!("request", method = %request.method(), path = request.uri().path())
}

/// Every documented route.
fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .merge(jobs::router())
        .merge(trash::router())
        .merge(events::router())
        .merge(curve::router())
        .merge(compare::router())
        .merge(files::router())
        .merge(archive::router())
        .merge(kinds::router())
        .merge(workers::router())
        .merge(people::router())
        .merge(worker::router())
        .merge(health::router())
        .merge(metrics::router())
        .merge(openapi::router())
}

/// The OpenAPI document of [`routes`], built on first use.
///
/// # Errors
/// If the generated paths cannot be written as JSON, which a test rules out.
pub fn document() -> Result<&'static Value, &'static serde_json::Error> {
    static DOCUMENT: OnceLock<serde_json::Result<Value>> = OnceLock::new();
    let build = || openapi::complete(routes().into_openapi());
    DOCUMENT.get_or_init(build).as_ref()
}

/// The whole service.
pub fn router(state: AppState) -> Router {
    let (router, _) = routes().split_for_parts();
    router
        .merge(docs::router())
        .merge(guide::router())
        .layer(Extension(openapi::Document(document)))
        .fallback(page::serve)
        .method_not_allowed_fallback(problem::method_not_allowed)
        .layer(from_fn_with_state(state.clone(), guard::guard))
        .layer(CatchPanicLayer::custom(problem::after_panic))
        .layer(from_fn(problem::only_problems))
        .layer(CompressionLayer::new().compress_when(page::worth_compressing()))
        .layer(from_fn(metrics::count))
        .layer(from_fn(page::protect))
        // who makes a 5xx says so in the log himself, with its cause
        .layer(
            TraceLayer::new_for_http()
                .make_span_with(span)
                .on_failure(()),
        )
        .with_state(state)
}
