//! The curve of a job, while it grows and after.
use axum::Json;
use axum::body::Body;
use axum::extract::Query;
use axum::http::{HeaderMap, HeaderValue, header};
use axum::response::{IntoResponse, Response};
use futures_util::stream::{self, StreamExt, TryStreamExt};
use loadframe_api::{CurveView, csv_cell};
use serde::Deserialize;
use utoipa::IntoParams;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

use super::AppState;
use super::bounded::Number;
use super::decimate::Decimation;
use super::permit::{JobPermit, Read};
use super::problem::{ApiError, Result};
use crate::store::{Store, StoreError};

/// Points read from the store at once, and most points in a JSON answer that does not thin out:
/// some MB.
const BLOCK: u64 = 20_000;

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(by_accept))
        .routes(routes!(as_json))
        .routes(routes!(as_csv))
}

#[derive(Clone, Copy, Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
struct CurveQuery {
    /// Index of the first point wanted: `next` of the answer before.
    #[serde(default = "start")]
    #[param(value_type = u64, required = false, minimum = 0, maximum = 9_007_199_254_740_991_u64)]
    since: Number<0, 9_007_199_254_740_991>,
    /// Thins the points out to at most so many, keeping the first and the last point, the largest
    /// and smallest value of every column, and the shape of the second column.
    #[param(value_type = u64, required = false, minimum = 10, maximum = 20_000)]
    max_points: Option<Number<10, 20_000>>,
}

fn start() -> Number<0, 9_007_199_254_740_991> {
    Number(0)
}

/// Read the curve
///
/// As JSON, or as CSV if `Accept` prefers `text/csv`. It grows while the job runs: ask again with
/// `since` set to `next`. A JSON answer that does not thin out holds at most 20 000 points; go on
/// at `next` until `points` is empty. CSV holds all of them.
#[utoipa::path(get, operation_id = "read_curve", path = "/v1/jobs/{id}/curve", tag = "Results",
    params(("id" = Uuid, Path, description = "Id of the job"), CurveQuery),
    responses((status = 200, description = "Points of the curve", headers(("Vary" = String)), content(
                  (ref("#/components/schemas/CurveView") = "application/json"),
                  (String = "text/csv"))),
              (status = 404, description = "There is no such job")))]
async fn by_accept(
    job: JobPermit<Read>,
    query: Query<CurveQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    let mut response = if prefers_csv(&headers) {
        as_csv(job, query).await?
    } else {
        as_json(job, query).await?
    };
    let vary = HeaderValue::from_static("accept");
    response.headers_mut().append(header::VARY, vary);
    Ok(response)
}

/// Read the curve as JSON
#[utoipa::path(get, operation_id = "read_curve_json", path = "/v1/jobs/{id}/curve.json", tag = "Results",
    params(("id" = Uuid, Path, description = "Id of the job"), CurveQuery),
    responses((status = 200, description = "Points of the curve", body = ref("#/components/schemas/CurveView")),
              (status = 404, description = "There is no such job")))]
async fn as_json(job: JobPermit<Read>, Query(query): Query<CurveQuery>) -> Result<Response> {
    let (store, id) = (job.store, job.id);
    let since = query.since.0;
    let curve = match query.max_points {
        None => store.curve(id, since, Some(BLOCK)).await?,
        Some(Number(most)) => thinned(&store, id, since, most as usize).await?,
    };
    Ok(Json(curve).into_response())
}

/// Read the curve as CSV
///
/// A row of column names with their units, then full digits.
#[utoipa::path(get, operation_id = "read_curve_csv", path = "/v1/jobs/{id}/curve.csv", tag = "Results",
    params(("id" = Uuid, Path, description = "Id of the job"), CurveQuery),
    responses((status = 200, description = "Points of the curve", body = String, content_type = "text/csv"),
              (status = 404, description = "There is no such job")))]
async fn as_csv(job: JobPermit<Read>, Query(query): Query<CurveQuery>) -> Result<Response> {
    let (store, id) = (job.store, job.id);
    let since = query.since.0;
    let body = match query.max_points {
        Some(Number(most)) => {
            let curve = thinned(&store, id, since, most as usize).await?;
            Body::from(heading(&curve) + &rows(&curve))
        }
        // block after block, for a curve can be longer than memory should be
        None => {
            let first = store.curve(id, since, Some(BLOCK)).await?;
            let head = heading(&first);
            let blocks = stream::try_unfold(Some(first), move |block| {
                next_block(store.clone(), id, block)
            });
            let rows = blocks.map_ok(|block| rows(&block));
            let head = stream::once(async { Ok::<_, StoreError>(head) });
            Body::from_stream(head.chain(rows))
        }
    };
    let kind = HeaderValue::from_static("text/csv; charset=utf-8");
    Ok(([(header::CONTENT_TYPE, kind)], body).into_response())
}

/// Passes `block` on and reads the one after it.
async fn next_block(
    store: Store,
    id: Uuid,
    block: Option<CurveView>,
) -> Result<Option<(CurveView, Option<CurveView>)>, StoreError> {
    let Some(block) = block.filter(|block| !block.points.is_empty()) else {
        return Ok(None);
    };
    let next = store.curve(id, block.next, Some(BLOCK)).await?;
    if next.attempt != block.attempt {
        let retried = "the job was run again while its curve was read";
        return Err(StoreError::Conflict(retried.to_owned()));
    }
    Ok(Some((block, Some(next))))
}

async fn thinned(store: &Store, id: Uuid, since: u64, most: usize) -> Result<CurveView> {
    let mut block = store.curve(id, since, Some(BLOCK)).await?;
    let mut decimation = Decimation::new(most);
    while !block.points.is_empty() {
        block
            .points
            .drain(..)
            .for_each(|point| decimation.add(point));
        let next = store.curve(id, block.next, Some(BLOCK)).await?;
        if next.attempt != block.attempt {
            return Err(ApiError::busy("the job has just been run again", 1));
        }
        block = next;
    }
    Ok(CurveView {
        points: decimation.finish(),
        ..block
    })
}

/// The row of column names; nothing as long as there is no point.
fn heading(curve: &CurveView) -> String {
    match curve.columns.as_slice() {
        [] => String::new(),
        columns => {
            let cells: Vec<_> = columns.iter().map(|name| csv_cell(name)).collect();
            cells.join(",") + "\n"
        }
    }
}

fn rows(curve: &CurveView) -> String {
    let mut text = String::with_capacity(curve.points.len() * curve.columns.len() * 20);
    for point in &curve.points {
        for (column, value) in point.iter().enumerate() {
            if column > 0 {
                text.push(',');
            }
            push_number(&mut text, *value);
        }
        text.push('\n');
    }
    text
}

/// The shortest digits that read back as the same number, as in the files of a job.
pub(super) fn push_number(text: &mut String, value: f64) {
    use std::fmt::Write;
    let magnitude = value.abs();
    let written = if magnitude != 0.0 && !(1e-5..1e15).contains(&magnitude) {
        write!(text, "{value:e}")
    } else {
        write!(text, "{value}")
    };
    // writing to memory does not fail
    debug_assert!(written.is_ok());
}

/// Whether `Accept` names CSV with a higher weight than JSON.
fn prefers_csv(headers: &HeaderMap) -> bool {
    let accept = headers
        .get(header::ACCEPT)
        .and_then(|value| value.to_str().ok());
    let weight = |wanted: &str| {
        accept.unwrap_or("").split(',').find_map(|range| {
            let mut parts = range.split(';').map(str::trim);
            let is_wanted = parts.next()?.eq_ignore_ascii_case(wanted);
            let weight = parts.find_map(|part| part.strip_prefix("q="));
            is_wanted.then(|| {
                weight
                    .and_then(|text| text.parse::<f32>().ok())
                    .unwrap_or(1.0)
            })
        })
    };
    weight("text/csv").unwrap_or(0.0) > weight("application/json").unwrap_or(0.0)
}
