//! `/v1/kinds`: what can be tested, with schema and examples.
use axum::Json;
use axum::extract::Path;
use axum::http::{HeaderMap, HeaderValue, header};
use axum::response::{IntoResponse, Response};
use loadframe_api::{Envelope, Example, JobKind, Page, kind_schema};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use utoipa::IntoParams;
use utoipa::openapi::Ref;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::AppState;
use super::conditional::EntityTag;
use super::permit::{Permit, Read};
use super::problem::{ApiError, Result};

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(list))
        .routes(routes!(read))
        .routes(routes!(schema))
        .routes(routes!(examples))
}

#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Path)]
struct KindPath {
    /// Name of the kind.
    #[param(schema_with = kind_name_schema)]
    kind: String,
}

fn kind_name_schema() -> Ref {
    Ref::from_schema_name("JobKind")
}

/// A kind of job.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct KindView {
    kind: JobKind,
    title: &'static str,
    description: &'static str,
    links: KindLinks,
}

/// Where to go on from a kind.
#[derive(Debug, Serialize, JsonSchema)]
struct KindLinks {
    #[serde(rename = "self")]
    this: String,
    schema: String,
    examples: String,
}

/// A job to start from.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct ExampleView {
    name: &'static str,
    title: String,
    description: String,
    /// The body to post.
    #[schemars(schema_with = "submission")]
    job: Box<RawValue>,
}

fn submission(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "$ref": "#/components/schemas/Submission" })
}

impl KindView {
    fn of(kind: JobKind) -> Self {
        let this = format!("/v1/kinds/{kind}");
        Self {
            kind,
            title: kind.title(),
            description: kind.description(),
            links: KindLinks {
                schema: format!("{this}/schema"),
                examples: format!("{this}/examples"),
                this,
            },
        }
    }
}

impl ExampleView {
    fn of(example: &Example) -> serde_json::Result<Self> {
        let envelope: Envelope = serde_json::from_str(example.body)?;
        Ok(Self {
            name: example.name,
            title: envelope.name,
            description: envelope.notes,
            job: serde_json::from_str(example.body)?,
        })
    }
}

/// List the kinds of jobs
#[utoipa::path(get, operation_id = "list_kinds", path = "/v1/kinds", tag = "Kinds",
    responses((status = 200, description = "Every kind", body = ref("#/components/schemas/KindViewPage"))))]
async fn list(_: Permit<Read>) -> Json<Page<KindView>> {
    let items = JobKind::ALL.iter().map(|kind| KindView::of(*kind));
    Json(Page::whole(items.collect()))
}

/// Read a kind
#[utoipa::path(get, operation_id = "read_kind", path = "/v1/kinds/{kind}", tag = "Kinds",
    params(KindPath),
    responses((status = 200, description = "The kind", body = ref("#/components/schemas/KindView")),
              (status = 404, description = "There is no such kind")))]
async fn read(_: Permit<Read>, Path(KindPath { kind }): Path<KindPath>) -> Result<Json<KindView>> {
    Ok(Json(KindView::of(known(&kind)?)))
}

/// Read the JSON Schema of a kind's spec
///
/// JSON Schema 2020-12 with limits, defaults, descriptions and units (`x-unit`): the very one that
/// submissions are checked against.
#[utoipa::path(get, operation_id = "read_kind_schema", path = "/v1/kinds/{kind}/schema", tag = "Kinds",
    params(KindPath,
           ("If-None-Match" = Option<String>, Header, description = "`ETag` of the answer you have")),
    responses((status = 200, description = "The schema", body = Object, content_type = "application/schema+json", headers(("ETag" = String))),
              (status = 304, description = "It has not changed"),
              (status = 404, description = "There is no such kind")))]
async fn schema(
    _: Permit<Read>,
    Path(KindPath { kind }): Path<KindPath>,
    headers: HeaderMap,
) -> Result<Response> {
    let kind = known(&kind)?;
    let tag = EntityTag::weak(crate::VERSION);
    if tag.is_known(&headers) {
        return Ok(tag.not_modified());
    }
    let media_type = HeaderValue::from_static("application/schema+json");
    let mut response = tag.json(kind_schema(kind)).into_response();
    response
        .headers_mut()
        .insert(header::CONTENT_TYPE, media_type);
    Ok(response)
}

/// List example jobs of a kind
#[utoipa::path(get, operation_id = "list_examples", path = "/v1/kinds/{kind}/examples", tag = "Kinds",
    params(KindPath),
    responses((status = 200, description = "Examples, the one to start from first", body = ref("#/components/schemas/ExampleViewPage")),
              (status = 404, description = "There is no such kind")))]
async fn examples(
    _: Permit<Read>,
    Path(KindPath { kind }): Path<KindPath>,
) -> Result<Json<Page<ExampleView>>> {
    let items = known(&kind)?.examples().iter().map(ExampleView::of);
    let items = items.collect::<Result<_, _>>();
    let items = items.map_err(|error| ApiError::internal(&error))?;
    Ok(Json(Page::whole(items)))
}

fn known(name: &str) -> Result<JobKind> {
    name.parse()
        .map_err(|unknown: loadframe_api::kinds::UnknownKind| {
            ApiError::new(super::problem::NOT_FOUND, unknown.to_string())
        })
}
