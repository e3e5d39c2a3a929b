//! `GET /v1/workers`: the machines.
use axum::Json;
use axum::extract::State;
use loadframe_api::{Page, WorkerView};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::AppState;
use super::problem::Result;

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default().routes(routes!(list))
}

/// List the workers
///
/// Every worker process heard of lately, and what it is doing.
#[utoipa::path(get, operation_id = "list_workers", path = "/v1/workers", tag = "Workers",
    responses((status = 200, description = "The workers", body = ref("#/components/schemas/WorkerViewPage"))))]
async fn list(State(state): State<AppState>) -> Result<Json<Page<WorkerView>>> {
    Ok(Json(Page::whole(state.store.workers().await?)))
}
