//! Whether the service is well, and which one it is.
use std::time::Duration;

use axum::Json;
use axum::extract::State;
use schemars::JsonSchema;
use serde::Serialize;
use tokio::time::timeout;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::AppState;
use super::problem::{ApiError, Result};
use crate::store::StoreError;

/// A store that takes longer to write is not ready.
const LONGEST_WRITE: Duration = Duration::from_secs(2);

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
    /// Commit it was built from; without one, a hash of its sources.
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
/// 503 while it stops, or when a write to the database or the folder of files does not work within 2 s;
/// `detail` says why.
#[utoipa::path(get, operation_id = "check_ready", path = "/readyz", tag = "Service",
    responses((status = 200, description = "It does", body = ref("#/components/schemas/Health"))))]
async fn ready(State(state): State<AppState>) -> Result<Json<Health>> {
    if state.stopping.is_cancelled() {
        return Err(ApiError::busy("the server is stopping", 5));
    }
    let refuse = |why: String| {
        tracing::error!(%why, "the store takes no writes");
        let detail = format!("the store takes no writes: {why}");
        Err(ApiError::busy(&detail, 5))
    };
    match timeout(LONGEST_WRITE, state.store.try_write()).await {
        Ok(Ok(())) => Ok(Json(Health { status: "ready" })),
        Ok(Err(StoreError::Full)) => refuse(StoreError::Full.to_string()),
        Ok(Err(error)) => {
            tracing::error!(%error, "a trial to write failed");
            refuse("the server's log says more".to_owned())
        }
        Err(_) => refuse(format!("none was done in {LONGEST_WRITE:?}")),
    }
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
