//! `/v1/comparisons`: jobs that are looked at side by side, under a name.
use axum::Json;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use loadframe_api::comparison::{ComparisonChanges, ComparisonView, NewComparison};
use loadframe_api::{Page, Violation};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

use super::super::AppState;
use super::super::body::{JsonBody, message};
use super::super::permit::{Change, Permit, Read};
use super::super::problem::{ApiError, INVALID, Result};
use crate::access::{Action, Identity};

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(list, create))
        .routes(routes!(read, change, delete))
}

/// List comparisons
///
/// Those that you see, the newest first, without their jobs.
#[utoipa::path(get, operation_id = "list_comparisons", path = "/v1/comparisons", tag = "Comparing",
    responses((status = 200, description = "The comparisons", body = ref("#/components/schemas/ComparisonViewPage"))))]
async fn list(permit: Permit<Read>) -> Result<Json<Page<ComparisonView>>> {
    let sight = permit.call.sight(&permit.store).await?;
    Ok(Json(Page::whole(permit.store.comparisons(&sight).await?)))
}

/// Keep a comparison
///
/// Of jobs that you see, under a name; it gets a permanent address, and links can show it. Its jobs never
/// change: another choice is another comparison.
#[utoipa::path(post, operation_id = "create_comparison", path = "/v1/comparisons", tag = "Comparing",
    request_body(content = ref("#/components/schemas/NewComparison"), description = "Name and jobs"),
    responses((status = 201, description = "The comparison", body = ref("#/components/schemas/ComparisonView")),
              (status = 404, description = "There is no such project"),
              (status = 408, description = "The body did not arrive in time"),
              (status = 413, description = "The body is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "It cannot be made, see `violations`")))]
async fn create(
    State(state): State<AppState>,
    permit: Permit<Change>,
    body: JsonBody,
) -> Result<(StatusCode, Json<ComparisonView>)> {
    let new: NewComparison = message(&state, body).await?;
    let call = &permit.call;
    let owner = match call.caller.identity {
        Identity::Sole => None,
        _ => Some(call.person()?.id),
    };
    if let Some(project) = new.project {
        call.ask_of_project(&state.store, Action::Submit, project)
            .await?;
    }
    let sight = call.sight(&state.store).await?;
    let seen = state.store.compared(&new.jobs, &sight).await?;
    let is_seen = |id: &Uuid| seen.iter().any(|job| job.id == *id);
    let mut violations = Vec::new();
    for (place, id) in new.jobs.iter().enumerate() {
        let pointer = format!("/jobs/{place}");
        if !is_seen(id) {
            let violation = Violation::new(pointer, "unknown", "there is no such job");
            violations.push(
                violation
                    .value(id.to_string())
                    .allowed("the id of a job that you see"),
            );
        } else if new.jobs[..place].contains(id) {
            let violation = Violation::new(pointer, "twice", "the job stands in the list already");
            violations.push(violation.value(id.to_string()).allowed("every job once"));
        }
    }
    if !violations.is_empty() {
        violations.truncate(100);
        let refusal = ApiError::new(INVALID, "see what is wrong with it");
        return Err(refusal.violations(violations));
    }
    let made = permit.store.create_comparison(owner, new).await?;
    Ok((StatusCode::CREATED, Json(made)))
}

/// Read a comparison
///
/// With the ids of its jobs, as far as you see them.
#[utoipa::path(get, operation_id = "read_comparison", path = "/v1/comparisons/{id}", tag = "Comparing",
    params(("id" = Uuid, Path, description = "Id of the comparison")),
    responses((status = 200, description = "The comparison", body = ref("#/components/schemas/ComparisonView")),
              (status = 404, description = "There is no such comparison")))]
async fn read(permit: Permit<Read>, Path(id): Path<Uuid>) -> Result<Json<ComparisonView>> {
    let (call, store) = (&permit.call, &permit.store);
    call.ask_of_comparison(store, Action::Read, id).await?;
    let mut comparison = store.comparison(id).await?;
    let sight = call.sight(store).await?;
    let jobs = store.comparison_jobs(id).await?;
    let seen = store.compared(&jobs, &sight).await?;
    comparison.jobs = Some(seen.into_iter().map(|job| job.id).collect());
    Ok(Json(comparison))
}

/// Change a comparison
///
/// Its name, or how the page shows it; never its jobs.
#[utoipa::path(patch, operation_id = "change_comparison", path = "/v1/comparisons/{id}", tag = "Comparing",
    params(("id" = Uuid, Path, description = "Id of the comparison")),
    request_body(content = ref("#/components/schemas/ComparisonChanges"), description = "What to change"),
    responses((status = 200, description = "The comparison", body = ref("#/components/schemas/ComparisonView")),
              (status = 404, description = "There is no such comparison"),
              (status = 408, description = "The body did not arrive in time"),
              (status = 413, description = "The body is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "The changes cannot be made, see `violations`")))]
async fn change(
    State(state): State<AppState>,
    permit: Permit<Change>,
    Path(id): Path<Uuid>,
    body: JsonBody,
) -> Result<Json<ComparisonView>> {
    let changes: ComparisonChanges = message(&state, body).await?;
    let call = &permit.call;
    call.ask_of_comparison(&state.store, Action::Change, id)
        .await?;
    Ok(Json(permit.store.change_comparison(id, changes).await?))
}

/// Delete a comparison
///
/// Its links show nothing any more; its jobs stay.
#[utoipa::path(delete, operation_id = "delete_comparison", path = "/v1/comparisons/{id}", tag = "Comparing",
    params(("id" = Uuid, Path, description = "Id of the comparison")),
    responses((status = 204, description = "It is gone"),
              (status = 404, description = "There is no such comparison")))]
async fn delete(permit: Permit<Change>, Path(id): Path<Uuid>) -> Result<StatusCode> {
    let (call, store) = (&permit.call, &permit.store);
    call.ask_of_comparison(store, Action::Change, id).await?;
    store.delete_comparison(id).await?;
    Ok(StatusCode::NO_CONTENT)
}
