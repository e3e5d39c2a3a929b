//! Whether the service is well, and which one it is.
use axum::Json;
use axum::extract::State;
use schemars::JsonSchema;
use serde::Serialize;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::AppState;
use super::problem::{ApiError, Result};

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(alive))
        .routes(routes!(ready))
        .routes(routes!(version))
}

/// How the service is.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Health {
    status: &'static str,
}

/// Which service this is.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct VersionView {
    version: &'static str,
    /// Commit it was built from, or `unknown`.
    commit: &'static str,
}

/// Is the process alive?
#[utoipa::path(get, operation_id = "check_alive", path = "/healthz", tag = "Service",
    responses((status = 200, description = "It is", body = ref("#/components/schemas/Health"))))]
async fn alive() -> Json<Health> {
    Json(Health { status: "ok" })
}

/// Does the service take requests?
///
/// 503 while it stops, or when the store does not answer.
#[utoipa::path(get, operation_id = "check_ready", path = "/readyz", tag = "Service",
    responses((status = 200, description = "It does", body = ref("#/components/schemas/Health"))))]
async fn ready(State(state): State<AppState>) -> Result<Json<Health>> {
    if state.stopping.is_cancelled() {
        return Err(ApiError::busy("the server is stopping", 5));
    }
    if let Err(error) = state.store.jobs_version().await {
        tracing::error!(%error, "the store does not answer");
        return Err(ApiError::busy("the store does not answer", 5));
    }
    Ok(Json(Health { status: "ready" }))
}

/// Which version is this?
#[utoipa::path(get, operation_id = "read_version", path = "/version", tag = "Service",
    responses((status = 200, description = "Version and commit", body = ref("#/components/schemas/VersionView"))))]
async fn version() -> Json<VersionView> {
    Json(VersionView {
        version: crate::VERSION,
        commit: crate::COMMIT,
    })
}
