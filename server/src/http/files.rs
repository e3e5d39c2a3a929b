//! The files of a job, its outcome and its log.
use axum::Json;
use axum::body::Body;
use axum::extract::{Path, Query, Request};
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, header};
use axum::response::{IntoResponse, Response};
use loadframe_api::{FileEntry, LogLine, Page, check_file_name};
use serde::Deserialize;
use tower_http::services::ServeFile;
use utoipa::IntoParams;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

use super::AppState;
use super::bounded::Number;
use super::conditional::EntityTag;
use super::permit::{JobPermit, Read, ReadFiles};
use super::problem::{ApiError, RANGE, Result};
use crate::store::Content;

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(list))
        .routes(routes!(read))
        .routes(routes!(outcome))
        .routes(routes!(log))
}

/// List the result files
#[utoipa::path(get, operation_id = "list_files", path = "/v1/jobs/{id}/files", tag = "Results",
    params(("id" = Uuid, Path, description = "Id of the job")),
    responses((status = 200, description = "The files", body = ref("#/components/schemas/FileEntryPage")),
              (status = 404, description = "There is no such job")))]
async fn list(job: JobPermit<ReadFiles>) -> Result<Json<Page<FileEntry>>> {
    let items = job.store.files(job.id).await?;
    Ok(Json(Page::whole(items)))
}

/// Download a result file
///
/// Whole or by byte range. The `ETag` is the file's SHA-256, which never changes.
#[utoipa::path(get, operation_id = "download_file", path = "/v1/jobs/{id}/files/{*name}", tag = "Results",
    params(("id" = Uuid, Path, description = "Id of the job"),
           ("name" = String, Path, description = "Name of the file, slashes included", min_length = 1, max_length = 200),
           ("Range" = Option<String>, Header, description = "A byte range, such as `bytes=0-999` or `bytes=-500`"),
           ("If-Range" = Option<String>, Header, description = "`ETag` the range belongs to; of another file, all is sent"),
           ("If-None-Match" = Option<String>, Header, description = "`ETag` of the file you have")),
    responses((status = 200, description = "The file",
               headers(("ETag" = String), ("Content-Disposition" = String), ("Accept-Ranges" = String)), content(
                  (String = "application/octet-stream"), (serde_json::Value = "application/json"), (String = "application/jsonl"),
                  (String = "application/xml"), (String = "text/csv"), (String = "text/plain"))),
              (status = 206, description = "The range", headers(("ETag" = String), ("Content-Range" = String)), content(
                  (String = "application/octet-stream"), (serde_json::Value = "application/json"), (String = "application/jsonl"),
                  (String = "application/xml"), (String = "text/csv"), (String = "text/plain"))),
              (status = 304, description = "You have it"),
              (status = 307, description = "It is at this address, for some minutes: where files are in a bucket and the server is set so",
               headers(("Location" = String))),
              (status = 404, description = "There is no such job or file"),
              (status = 500, description = "What was stored is missing or has changed; `detail` names job and file"),
              (status = 416, description = "The file has no such range", headers(("Content-Range" = String)))))]
async fn read(
    job: JobPermit<ReadFiles>,
    Path((id, name)): Path<(Uuid, String)>,
    method: Method,
    headers: HeaderMap,
) -> Result<Response> {
    let unknown = || ApiError::not_found(format_args!("file {name:?}"));
    check_file_name(&name).map_err(|_| unknown())?;
    let entry = job.store.file(id, &name).await?;
    let tag = EntityTag::strong(&entry.sha256);
    if tag.is_known(&headers) {
        return Ok(tag.not_modified());
    }
    let content = job.store.content(id, &entry).await?;
    // a page may not follow to the bucket: it loads nothing from elsewhere
    if !is_of_a_page(&headers)
        && let Some(address) = content
            .address(media_type(&name), &attachment(&name))
            .await?
    {
        return elsewhere(&address);
    }
    let range = headers.get(header::RANGE);
    let range = range.filter(|_| tag.allows_range(&headers));
    let range = range.and_then(|range| byte_range(range, entry.bytes));
    let mut response = match content.path() {
        Some(path) => whole_or_part(path, method, range, &entry).await?,
        None => from_bucket(&content, &method, range.as_ref(), &entry).await?,
    };
    let answer = response.headers_mut();
    answer.remove(header::LAST_MODIFIED);
    answer.insert(header::ETAG, tag.header());
    answer.insert(
        header::CONTENT_TYPE,
        HeaderValue::from_static(media_type(&name)),
    );
    let attachment = HeaderValue::try_from(attachment(&name));
    let attachment = attachment.unwrap_or(HeaderValue::from_static("attachment"));
    answer.insert(header::CONTENT_DISPOSITION, attachment);
    answer.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-cache"));
    Ok(response)
}

/// Read the outcome
///
/// `outcome.json`: results with units, quality, cost, provenance, warnings, files.
#[utoipa::path(get, operation_id = "read_outcome", path = "/v1/jobs/{id}/outcome", tag = "Results",
    params(("id" = Uuid, Path, description = "Id of the job")),
    responses((status = 200, description = "The outcome", body = ref("#/components/schemas/Outcome")),
              (status = 404, description = "There is no such job, or it has not succeeded yet")))]
async fn outcome(job: JobPermit<Read>) -> Result<Response> {
    let text = job.store.outcome(job.id).await?;
    Ok(([(header::CONTENT_TYPE, "application/json")], text).into_response())
}

#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
struct LogQuery {
    /// Skips so many lines, counted from the job's first.
    #[param(value_type = u64, required = false, minimum = 0, maximum = 9_007_199_254_740_991_u64)]
    since: Option<Number<0, 9_007_199_254_740_991>>,
}

/// Read the log
#[utoipa::path(get, operation_id = "read_log", path = "/v1/jobs/{id}/log", tag = "Results",
    params(("id" = Uuid, Path, description = "Id of the job"), LogQuery),
    responses((status = 200, description = "Lines of the log", body = ref("#/components/schemas/LogLinePage")),
              (status = 404, description = "There is no such job")))]
async fn log(
    job: JobPermit<ReadFiles>,
    Query(query): Query<LogQuery>,
) -> Result<Json<Page<LogLine>>> {
    let since = query.since.map_or(0, |Number(since)| since);
    let items = job.store.log(job.id, since).await?;
    Ok(Json(Page::whole(items)))
}

/// A file of this machine's disk.
async fn whole_or_part(
    path: &std::path::Path,
    method: Method,
    range: Option<HeaderValue>,
    entry: &FileEntry,
) -> Result<Response> {
    // only what concerns the range goes on: the tag of the file's content is known better here
    let mut request = Request::new(Body::empty());
    *request.method_mut() = method;
    if let Some(range) = range {
        request.headers_mut().insert(header::RANGE, range);
    }
    let served = ServeFile::new(path)
        .ignore_multi_range_requests(true)
        .try_call(request)
        .await;
    let response = served.map_err(|error| ApiError::internal(&error))?;
    match response.status() {
        StatusCode::OK | StatusCode::PARTIAL_CONTENT => Ok(response.map(Body::new)),
        StatusCode::RANGE_NOT_SATISFIABLE => Err(no_such_range(entry)?),
        _ => Err(ApiError::not_found(format_args!("file {:?}", entry.name))),
    }
}

/// A file of a bucket.
async fn from_bucket(
    content: &Content,
    method: &Method,
    range: Option<&HeaderValue>,
    entry: &FileEntry,
) -> Result<Response> {
    let range = match range.map(|range| bounds(range, entry.bytes)) {
        Some(Bounds::Outside) => return Err(no_such_range(entry)?),
        Some(Bounds::Inside(range)) => Some(range),
        Some(Bounds::Ignored) | None => None,
    };
    let part = range.clone().unwrap_or(0..entry.bytes);
    let mut response = Response::builder()
        .header(header::ACCEPT_RANGES, "bytes")
        .header(header::CONTENT_LENGTH, part.end - part.start);
    if let Some(range) = range {
        let (first, last, all) = (range.start, range.end - 1, entry.bytes);
        response = response
            .status(StatusCode::PARTIAL_CONTENT)
            .header(header::CONTENT_RANGE, format!("bytes {first}-{last}/{all}"));
    }
    let body = match *method {
        Method::HEAD => Body::empty(),
        _ => Body::from_stream(content.read(part).await?),
    };
    response
        .body(body)
        .map_err(|error| ApiError::internal(&error))
}

/// What a range of bytes means for a file.
enum Bounds {
    Inside(std::ops::Range<u64>),
    /// It begins after the file's end.
    Outside,
    /// Several, or none that can be read (RFC 9110, 14.2).
    Ignored,
}

fn bounds(range: &HeaderValue, size: u64) -> Bounds {
    let text = range
        .to_str()
        .ok()
        .and_then(|range| range.strip_prefix("bytes="));
    let Some((first, last)) = text.and_then(|range| range.split_once('-')) else {
        return Bounds::Ignored;
    };
    let range = match (first.parse::<u64>(), last.parse::<u64>()) {
        (Ok(first), Ok(last)) if first <= last => first..size.min(last.saturating_add(1)),
        (Ok(first), Err(_)) if last.is_empty() => first..size,
        (Err(_), Ok(last)) if first.is_empty() => size.saturating_sub(last)..size,
        _ => return Bounds::Ignored,
    };
    if range.is_empty() {
        Bounds::Outside
    } else {
        Bounds::Inside(range)
    }
}

fn no_such_range(entry: &FileEntry) -> Result<ApiError> {
    let detail = format!("{} has {} bytes", entry.name, entry.bytes);
    let all = HeaderValue::try_from(format!("bytes */{}", entry.bytes));
    let all = all.map_err(|error| ApiError::internal(&error))?;
    Ok(ApiError::new(RANGE, detail).with(header::CONTENT_RANGE, all))
}

/// Whether a page asks for the file, to show what is in it (Fetch Metadata, `Sec-Fetch-Mode`); a link that is
/// followed is a `navigate`.
fn is_of_a_page(headers: &HeaderMap) -> bool {
    let mode = headers.get("sec-fetch-mode");
    mode.is_some_and(|mode| mode != "navigate")
}

/// A redirect to a signed address, which nobody keeps.
fn elsewhere(address: &str) -> Result<Response> {
    let address = HeaderValue::try_from(address).map_err(|error| ApiError::internal(&error))?;
    let headers = [
        (header::LOCATION, address),
        (header::CACHE_CONTROL, HeaderValue::from_static("no-store")),
    ];
    Ok((StatusCode::TEMPORARY_REDIRECT, headers).into_response())
}

/// The range as far as it is one of bytes; others are to be ignored (RFC 9110, 14.2). The last
/// bytes of a file that has fewer are the whole file (14.1.2), which `ServeFile` would refuse.
fn byte_range(range: &HeaderValue, size: u64) -> Option<HeaderValue> {
    let bytes = range.to_str().ok()?.strip_prefix("bytes=")?;
    let last = bytes.strip_prefix('-').and_then(|last| last.parse().ok());
    match last {
        Some(last) if size < last => Some(HeaderValue::from_static("bytes=0-")),
        _ => Some(range.clone()),
    }
}

fn media_type(name: &str) -> &'static str {
    let extension = name.rsplit_once('.').map_or("", |(_, extension)| extension);
    match extension {
        "json" => "application/json",
        "jsonl" => "application/jsonl",
        "csv" => "text/csv; charset=utf-8",
        "txt" | "log" => "text/plain; charset=utf-8",
        "pvd" => "application/xml",
        // `.vtp` and `.vtu` are XML with raw binary appended: no XML parser reads them whole
        _ => "application/octet-stream",
    }
}

/// `Content-Disposition` for a file's own name: its characters need no quoting.
fn attachment(name: &str) -> String {
    let base = name.rsplit_once('/').map_or(name, |(_, base)| base);
    format!("attachment; filename=\"{base}\"")
}
