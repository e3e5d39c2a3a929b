//! `/v1/trash`: what was deleted and can be brought back.
use axum::Json;
use axum::extract::{Path, Query, State};
use axum::http::StatusCode;
use loadframe_api::people::{Role, TrashView};
use loadframe_api::{Page, Timestamp};
use serde::Deserialize;
use utoipa::IntoParams;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

use super::AppState;
use super::bounded::{Number, Text};
use super::permit::{Change, Permit, Read};
use super::problem::Result;
use crate::access::{Action, DeletedFacts, Identity, Object};
use crate::store::trash::TrashSight;

/// Entries on a page unless asked otherwise.
const PAGE: u32 = 50;

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(list))
        .routes(routes!(erase))
        .routes(routes!(restore))
}

#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
struct ListQuery {
    /// Most entries on a page; 50 when left out.
    #[param(value_type = u32, required = false, minimum = 1, maximum = 200)]
    limit: Option<Number<1, 200>>,
    /// `next` of the page before.
    #[param(value_type = String, required = false, min_length = 1, max_length = 200)]
    cursor: Option<Text<1, 200>>,
}

/// List what was deleted
///
/// Your jobs and projects that can be brought back, and files of your projects that their rules removed;
/// administrators see all. The last deleted first.
#[utoipa::path(get, operation_id = "list_trash", path = "/v1/trash", tag = "Jobs",
    params(ListQuery),
    responses((status = 200, description = "What can be brought back", body = ref("#/components/schemas/TrashViewPage")),
              (status = 422, description = "The cursor is not one of this server")))]
async fn list(
    permit: Permit<Read>,
    Query(query): Query<ListQuery>,
) -> Result<Json<Page<TrashView>>> {
    let sight = match &permit.call.caller.identity {
        Identity::Sole => TrashSight::Everything,
        Identity::Person(person) if person.role == Role::Administrator => TrashSight::Everything,
        Identity::Person(person) => TrashSight::Of(person.id),
        // a link shows nothing that is deleted
        Identity::Worker | Identity::Link(_) => return Ok(Json(Page::whole(Vec::new()))),
    };
    let limit = query.limit.map_or(PAGE, |Number(limit)| limit as u32);
    let cursor = query.cursor.map(|Text(cursor)| cursor);
    let page = permit
        .store
        .trash(sight, cursor.as_deref(), limit, Timestamp::now());
    Ok(Json(page.await?))
}

/// Bring back what was deleted
///
/// A job, a project with its jobs, or (by the id of the project) files that its rule removed, which ends
/// the rule. Its owner and administrators do.
#[utoipa::path(post, operation_id = "restore_deleted", path = "/v1/trash/{id}/restore", tag = "Jobs",
    params(("id" = Uuid, Path, description = "Id of the job or project")),
    responses((status = 204, description = "It is back"),
              (status = 404, description = "It is not in the trash"),
              (status = 409, description = "The project of the job is deleted, too")))]
async fn restore(
    State(state): State<AppState>,
    permit: Permit<Change>,
    Path(id): Path<Uuid>,
) -> Result<StatusCode> {
    ask(&state, &permit, id).await?;
    permit.store.bring_back(id).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Delete for good
///
/// Frees the files of a deleted job or project before its time.
#[utoipa::path(delete, operation_id = "erase_deleted", path = "/v1/trash/{id}", tag = "Jobs",
    params(("id" = Uuid, Path, description = "Id of the job or project")),
    responses((status = 204, description = "It is gone for good"),
              (status = 404, description = "It is not in the trash"),
              (status = 409, description = "What a rule removed goes when its time is over")))]
async fn erase(
    State(state): State<AppState>,
    permit: Permit<Change>,
    Path(id): Path<Uuid>,
) -> Result<StatusCode> {
    ask(&state, &permit, id).await?;
    permit.store.erase(id).await?;
    Ok(StatusCode::NO_CONTENT)
}

async fn ask(state: &AppState, permit: &Permit<Change>, id: Uuid) -> Result<()> {
    let (_, owner) = state.store.in_trash(id).await?;
    permit
        .call
        .ask(Action::Change, Object::Deleted(DeletedFacts { id, owner }))
}
