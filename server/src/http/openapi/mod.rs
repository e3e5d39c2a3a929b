//! The OpenAPI 3.1 document: paths from the handlers, schemas from the vocabulary's own types.
//!
//! Handlers name their bodies by reference and list the answers of their own. What is the same
//! for all is completed here: [`components`] fills in the schemas, [`answers`] gives every error the
//! one form all errors have, adds those that any route may answer, and links a submission to what
//! can be done with the job.
mod answers;
mod components;

use axum::Extension;
use axum::http::{HeaderMap, HeaderValue, header};
use axum::response::Response;
use serde_json::{Value, json};
use utoipa::openapi::OpenApi;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::AppState;
use super::conditional::EntityTag;
use super::problem::{ApiError, Result};

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default().routes(routes!(read))
}

/// This document
#[utoipa::path(get, operation_id = "read_openapi", path = "/openapi.json", tag = "Service",
    params(("If-None-Match" = Option<String>, Header, description = "`ETag` of the answer you have")),
    responses((status = 200, description = "OpenAPI 3.1", body = Object, headers(("ETag" = String))),
              (status = 304, description = "It has not changed")))]
async fn read(Extension(document): Extension<Document>, headers: HeaderMap) -> Result<Response> {
    let tag = EntityTag::weak(crate::VERSION);
    if tag.is_known(&headers) {
        return Ok(tag.not_modified());
    }
    let mut response = tag.json(document.get()?);
    let anybody = HeaderValue::from_static("no-cache");
    response
        .headers_mut()
        .insert(header::CACHE_CONTROL, anybody);
    Ok(response)
}

/// Where a handler finds the document, which is made of all routes, its own among them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Document(pub(super) fn() -> Result<&'static Value, &'static serde_json::Error>);

impl Document {
    /// The document.
    ///
    /// # Errors
    /// An internal one where it could not be written.
    pub(super) fn get(self) -> Result<&'static Value> {
        self.0().map_err(|error| ApiError::internal(error))
    }
}

/// The document of these routes.
///
/// # Errors
/// If the generated paths cannot be written as JSON, which a test rules out.
pub(super) fn complete(routes: OpenApi) -> serde_json::Result<Value> {
    let mut document = serde_json::to_value(routes)?;
    document["info"] = json!({
        "title": "loadframe",
        "version": crate::VERSION,
        "description": "The virtual load frame of a materials lab: post a test, watch its curve grow, fetch its results.",
        "license": { "name": "MIT", "identifier": "MIT" },
    });
    document["tags"] = json!([
        { "name": "Jobs", "description": "Submit tests and look after them" },
        { "name": "Results", "description": "Curves, outcomes, files, logs" },
        { "name": "Events", "description": "What happens, as it happens" },
        { "name": "Kinds", "description": "What can be tested" },
        { "name": "Workers", "description": "The machines that compute" },
        { "name": "Comparing", "description": "Curves, specs and results of many jobs side by side, and comparisons kept under a name" },
        { "name": "People", "description": "Accounts, tokens, groups, projects, share links, the audit log" },
        { "name": "Worker", "description": "A worker's own side: it claims a job under a lease and writes under it until it ends" },
        { "name": "Service", "description": "Health, metrics, this document" },
    ]);
    document["components"]["schemas"] = Value::Object(components::schemas());
    document["components"]["securitySchemes"] = json!({
        "token": {
            "type": "http", "scheme": "bearer",
            "description": "Demanded where the server listens beyond its own machine or has people. A person makes one on the page, `loadframe token create` on the server another.",
        },
        "session": {
            "type": "apiKey", "in": "cookie", "name": super::access::SECURE_COOKIE,
            "description": "Of a person who is signed in, for the server's own page.",
        },
    });
    let submission = &mut document["paths"]["/v1/jobs"]["post"]["requestBody"];
    submission["content"]["application/json"]["examples"] = Value::Object(components::examples());
    name_wildcards(&mut document);
    answers::complete(&mut document);
    answers::link_jobs(&mut document);
    Ok(document)
}

/// The router's `{*name}`, which takes slashes too, is `{name}` in OpenAPI.
fn name_wildcards(document: &mut Value) {
    if let Some(paths) = document["paths"].as_object_mut() {
        let named = std::mem::take(paths).into_iter();
        paths.extend(named.map(|(path, item)| (path.replace("{*", "{"), item)));
    }
}
