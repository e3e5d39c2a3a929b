//! `GET /v1/workers`: the machines.
use axum::Json;
use loadframe_api::{Page, WorkerView};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::AppState;
use super::permit::{Permit, ReadWorkers};
use super::problem::Result;
use crate::access::Action;

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default().routes(routes!(list))
}

/// List the workers
///
/// Every worker process heard of lately, and what it is doing.
#[utoipa::path(get, operation_id = "list_workers", path = "/v1/workers", tag = "Workers",
    responses((status = 200, description = "The workers", body = ref("#/components/schemas/WorkerViewPage"))))]
async fn list(permit: Permit<ReadWorkers>) -> Result<Json<Page<WorkerView>>> {
    let mut items = permit.store.workers().await?;
    // that a machine is busy is no secret, with whose job is
    for worker in &mut items {
        if let Some(id) = worker.job_id
            && let Err(refusal) = permit
                .call
                .ask_of_job(&permit.store, Action::Read, id)
                .await
        {
            match refusal.status() {
                404 => worker.job_id = None,
                _ => return Err(refusal),
            }
        }
    }
    Ok(Json(Page::whole(items)))
}
