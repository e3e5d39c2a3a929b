//! Files and checkpoints under a lease, streamed to and from the disk.
use std::io;

use axum::Json;
use axum::body::Body;
use axum::extract::{DefaultBodyLimit, Path, Query, State};
use axum::http::header;
use axum::response::{IntoResponse, Response};
use futures_util::TryStreamExt;
use loadframe_api::FileEntry;
use loadframe_api::worker::{CheckpointInfo, CheckpointQuery, UploadQuery, UploadedPart};
use loadframe_client::direct::{DirectEnd, DirectRequest, DirectUpload};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use tokio::io::AsyncRead;
use tokio_util::io::StreamReader;
use utoipa::IntoParams;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::super::AppState;
use super::super::body::JsonBody;
use super::super::problem::{ApiError, INVALID, NOT_JSON, Result};
use super::request::{LeaseCredentials, counted};

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(upload))
        .routes(routes!(uploaded_part, end_direct))
        .routes(routes!(begin_direct))
        .routes(routes!(save_checkpoint, checkpoint))
        // the store bounds what it takes in, and keeps none of it in memory
        .layer(DefaultBodyLimit::disable())
}

/// Upload a file of the result
///
/// The body is the file. It is published with `complete`; uploading a name again replaces it. Of an
/// upload that broke off after a megabyte or more, what has arrived is kept for an hour: `from` names its
/// bytes, and the body is then the rest.
#[utoipa::path(put, path = "/v1/worker/leases/{id}/files/{*name}", tag = "Worker",
    params(("id" = Uuid, Path, description = "Id of the lease"),
           ("name" = String, Path, description = "Name of the file, which may contain `/`"),
           ("sha256" = String, Query, description = "SHA-256 of the body in hexadecimal digits", min_length = 64, max_length = 64),
           ("from" = Option<u64>, Query, description = "Bytes that have arrived before; the body is what follows them", minimum = 0),
           ("Loadframe-Lease-Token" = Uuid, Header, description = "Token of the lease")),
    request_body(content = Vec<u8>, content_type = "application/octet-stream", description = "The file"),
    responses((status = 200, description = "The file is stored", body = ref("#/components/schemas/FileEntry")),
              (status = 408, description = "The body did not go on in time"),
              (status = 409, description = "The lease is no longer held"),
              (status = 413, description = "The file is too large"),
              (status = 422, description = "The name is not allowed, or the content has another SHA-256")))]
async fn upload(
    State(state): State<AppState>,
    LeaseCredentials(key): LeaseCredentials,
    path: Path<(String, String)>,
    Query(query): Query<UploadQuery>,
    body: Body,
) -> Result<Json<FileEntry>> {
    let Path((_, name)) = path;
    let UploadQuery { sha256, from } = query;
    let uploaded = state
        .store
        .upload_rest(key, &name, &sha256, from, reader(body));
    Ok(Json(counted(uploaded.await)?))
}

/// How much of a file has arrived
///
/// Of an upload that broke off: its rest may be sent alone.
#[utoipa::path(get, path = "/v1/worker/leases/{id}/uploads/{sha256}", tag = "Worker",
    params(("id" = Uuid, Path, description = "Id of the lease"),
           ("sha256" = String, Path, description = "SHA-256 of the whole file in hexadecimal digits", min_length = 64, max_length = 64),
           ("Loadframe-Lease-Token" = Uuid, Header, description = "Token of the lease")),
    responses((status = 200, description = "Bytes that are kept, which may be none", body = ref("#/components/schemas/UploadedPart")),
              (status = 409, description = "The lease is no longer held")))]
async fn uploaded_part(
    State(state): State<AppState>,
    LeaseCredentials(key): LeaseCredentials,
    path: Path<(String, String)>,
) -> Result<Json<UploadedPart>> {
    let Path((_, sha256)) = path;
    let bytes = counted(state.store.uploaded_part(key, &sha256).await)?;
    Ok(Json(UploadedPart { bytes }))
}

/// Ask where a large file is to be sent
///
/// Where files are in a bucket (header `Loadframe-Direct-From` of the claim's answer), a worker sends large ones there by itself, in
/// parts of `part_bytes`, one PUT to each address, which is signed and good for a while. Asking again with
/// the `upload` of the answer gives fresh addresses for the same upload.
#[utoipa::path(post, operation_id = "begin_direct", path = "/v1/worker/leases/{id}/uploads", tag = "Worker",
    params(("id" = Uuid, Path, description = "Id of the lease"),
           ("Loadframe-Lease-Token" = Uuid, Header, description = "Token of the lease")),
    request_body(content = ref("#/components/schemas/DirectRequest"), description = "What is to be sent"),
    responses((status = 200, description = "Where its parts go", body = ref("#/components/schemas/DirectUpload")),
              (status = 408, description = "The body did not arrive in time"),
              (status = 409, description = "The lease is no longer held"),
              (status = 413, description = "The file is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "The message does not fit its schema, or such a file is sent through the server")))]
async fn begin_direct(
    State(state): State<AppState>,
    LeaseCredentials(key): LeaseCredentials,
    body: JsonBody,
) -> Result<Json<DirectUpload>> {
    let request: DirectRequest = read(&body)?;
    let begun = state.store.begin_direct(key, request).await;
    Ok(Json(counted(begun)?))
}

/// Say that all parts have been sent
///
/// `parts` are the `ETag`s that the bucket answered, in order. The server puts them together, reads the whole
/// back, holds it against the SHA-256, and then takes it for what `becomes` says: a file of the result, or a
/// checkpoint. The same message may be repeated.
#[utoipa::path(post, operation_id = "end_direct", path = "/v1/worker/leases/{id}/uploads/{sha256}", tag = "Worker",
    params(("id" = Uuid, Path, description = "Id of the lease"),
           ("sha256" = String, Path, description = "SHA-256 of the whole file in hexadecimal digits", min_length = 64, max_length = 64),
           ("Loadframe-Lease-Token" = Uuid, Header, description = "Token of the lease")),
    request_body(content = ref("#/components/schemas/DirectEnd"), description = "The parts, and what they become"),
    responses((status = 200, description = "Its bytes when it is stored; none when it has to be sent anew", body = ref("#/components/schemas/UploadedPart")),
              (status = 408, description = "The body did not arrive in time"),
              (status = 409, description = "The lease is no longer held"),
              (status = 413, description = "The file is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "The message does not fit its schema, the name is not allowed, or the content has another SHA-256")))]
async fn end_direct(
    State(state): State<AppState>,
    LeaseCredentials(key): LeaseCredentials,
    path: Path<(String, String)>,
    body: JsonBody,
) -> Result<Json<UploadedPart>> {
    let Path((_, sha256)) = path;
    let end: DirectEnd = read(&body)?;
    let ended = state.store.end_direct(key, &sha256, end).await;
    Ok(Json(counted(ended)?))
}

/// Store a checkpoint
///
/// The body is the checkpoint. All files uploaded so far by this attempt belong to it. The one before it
/// is kept as well.
#[utoipa::path(put, path = "/v1/worker/leases/{id}/checkpoint", tag = "Worker",
    params(("id" = Uuid, Path, description = "Id of the lease"),
           ("sha256" = String, Query, description = "SHA-256 of the body in hexadecimal digits", min_length = 64, max_length = 64),
           ("wall_s" = f64, Query, description = "Wall time [s] of the work up to it", minimum = 0),
           ("cpu_s" = f64, Query, description = "Processor time [s] of the work up to it", minimum = 0),
           ("Loadframe-Lease-Token" = Uuid, Header, description = "Token of the lease")),
    request_body(content = Vec<u8>, content_type = "application/octet-stream", description = "The checkpoint"),
    responses((status = 200, description = "The checkpoint is stored", body = ref("#/components/schemas/CheckpointInfo")),
              (status = 409, description = "The lease is no longer held"),
              (status = 413, description = "The checkpoint is too large"),
              (status = 422, description = "The content has another SHA-256, or a time is negative")))]
async fn save_checkpoint(
    State(state): State<AppState>,
    LeaseCredentials(key): LeaseCredentials,
    Query(query): Query<CheckpointQuery>,
    body: Body,
) -> Result<Json<CheckpointInfo>> {
    let saved = state.store.save_checkpoint(key, &query, reader(body));
    Ok(Json(counted(saved.await)?))
}

#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
struct CheckpointRead {
    /// SHA-256 of a checkpoint that could not be used: the one before it is wanted.
    #[param(required = false, min_length = 64, max_length = 64)]
    before: Option<String>,
}

/// Fetch the checkpoint to go on from
///
/// The newest of this worker's build of which nothing is missing.
#[utoipa::path(get, path = "/v1/worker/leases/{id}/checkpoint", tag = "Worker",
    params(("id" = Uuid, Path, description = "Id of the lease"),
           CheckpointRead,
           ("Loadframe-Lease-Token" = Uuid, Header, description = "Token of the lease")),
    responses((status = 200, description = "The checkpoint", body = Vec<u8>, content_type = "application/octet-stream"),
              (status = 404, description = "The job has no checkpoint"),
              (status = 409, description = "The lease is no longer held")))]
async fn checkpoint(
    State(state): State<AppState>,
    LeaseCredentials(key): LeaseCredentials,
    Query(query): Query<CheckpointRead>,
) -> Result<Response> {
    let found = state.store.checkpoint(key, query.before.as_deref()).await;
    let (info, content) = counted(found)?;
    let bytes = content.read(0..info.bytes).await?;
    let headers = [
        (header::CONTENT_TYPE, "application/octet-stream".to_owned()),
        (header::CONTENT_LENGTH, info.bytes.to_string()),
    ];
    Ok((headers, Body::from_stream(bytes)).into_response())
}

/// Reads a message about a direct upload; what its values may be is the store's to say.
fn read<T: DeserializeOwned>(body: &JsonBody) -> Result<T> {
    serde_json::from_slice(&body.bytes).map_err(|error| {
        let kind = if error.is_data() { INVALID } else { NOT_JSON };
        ApiError::new(
            kind,
            format!("the message does not fit its schema: {error}"),
        )
    })
}

/// A body as something to read from.
fn reader(body: Body) -> impl AsyncRead + Send + Unpin {
    StreamReader::new(body.into_data_stream().map_err(io::Error::other))
}
