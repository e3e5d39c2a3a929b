//! `/v1/projects/{id}/retention` and `/v1/storage`: what of old jobs is removed, and what fills the disk.
use axum::Json;
use axum::extract::{Path, Query, State};
use axum::http::StatusCode;
use loadframe_api::people::{DiskUse, RetentionRule, RetentionView, Role};
use loadframe_api::{Page, Timestamp};
use serde::Deserialize;
use utoipa::IntoParams;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

use super::super::AppState;
use super::super::body::{JsonBody, message};
use super::super::bounded::Number;
use super::super::permit::{Change, ManageOwn, Permit};
use super::super::problem::Result;
use crate::access::{Action, Object};

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(read, set))
        .routes(routes!(undo))
        .routes(routes!(storage))
}

/// A rule to be looked at before it is set.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
struct Asked {
    /// Days that snapshots would be kept.
    #[param(value_type = u32, required = false, minimum = 1, maximum = 36500)]
    snapshots_days: Option<Number<1, 36_500>>,
    /// Days that curves and other tables would be kept.
    #[param(value_type = u32, required = false, minimum = 1, maximum = 36500)]
    curves_days: Option<Number<1, 36_500>>,
}

impl Asked {
    fn rule(&self) -> Option<RetentionRule> {
        let days = |of: &Option<Number<1, 36_500>>| of.map(|Number(days)| days as u32);
        let is_asked = self.snapshots_days.is_some() || self.curves_days.is_some();
        is_asked.then(|| RetentionRule {
            snapshots_days: days(&self.snapshots_days),
            curves_days: days(&self.curves_days),
        })
    }
}

/// What is kept of a project?
///
/// Its rule, what that removes, and what can be brought back; with days in the query, what such a rule
/// would remove.
#[utoipa::path(get, operation_id = "read_retention", path = "/v1/projects/{id}/retention", tag = "People",
    params(("id" = Uuid, Path, description = "Id of the project"), Asked),
    responses((status = 200, description = "Rule and preview", body = ref("#/components/schemas/RetentionView")),
              (status = 404, description = "There is no such project"),
              (status = 422, description = "Snapshots are removed before curves")))]
async fn read(
    State(state): State<AppState>,
    permit: Permit<Change>,
    Path(id): Path<Uuid>,
    Query(asked): Query<Asked>,
) -> Result<Json<RetentionView>> {
    permit
        .call
        .ask_of_project(&state.store, Action::Change, id)
        .await?;
    let view = permit.store.retention(id, asked.rule(), Timestamp::now());
    Ok(Json(view.await?))
}

/// Say what is kept of a project
///
/// In force a week later; left out is kept for ever. Snapshots go before curves, outcomes never. What was
/// removed can be brought back for two weeks.
#[utoipa::path(put, operation_id = "set_retention", path = "/v1/projects/{id}/retention", tag = "People",
    params(("id" = Uuid, Path, description = "Id of the project")),
    request_body(content = ref("#/components/schemas/RetentionRule"), description = "Days to keep"),
    responses((status = 200, description = "Rule and preview", body = ref("#/components/schemas/RetentionView")),
              (status = 404, description = "There is no such project"),
              (status = 408, description = "The body did not arrive in time"),
              (status = 413, description = "The body is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "The rule cannot be, see `violations`")))]
async fn set(
    State(state): State<AppState>,
    permit: Permit<Change>,
    Path(id): Path<Uuid>,
    body: JsonBody,
) -> Result<Json<RetentionView>> {
    // who does not see the project learns nothing of what its rule may be
    permit
        .call
        .ask_of_project(&state.store, Action::Change, id)
        .await?;
    let rule: RetentionRule = message(&state, body).await?;
    permit.store.set_retention(id, rule).await?;
    let view = permit.store.retention(id, None, Timestamp::now());
    Ok(Json(view.await?))
}

/// Bring back what was removed
///
/// Everything of the project that is not gone for good; its rule ends.
#[utoipa::path(post, operation_id = "undo_retention", path = "/v1/projects/{id}/retention/undo", tag = "People",
    params(("id" = Uuid, Path, description = "Id of the project")),
    responses((status = 204, description = "It is back"),
              (status = 404, description = "There is no such project")))]
async fn undo(
    State(state): State<AppState>,
    permit: Permit<Change>,
    Path(id): Path<Uuid>,
) -> Result<StatusCode> {
    permit
        .call
        .ask_of_project(&state.store, Action::Change, id)
        .await?;
    permit.store.undo_retention(id).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// What fills the disk?
///
/// By person, project and kind of file, the largest first: one's own and of one's projects;
/// administrators see all.
#[utoipa::path(get, operation_id = "read_storage", path = "/v1/storage", tag = "People",
    responses((status = 200, description = "What is stored", body = ref("#/components/schemas/DiskUsePage"))))]
async fn storage(permit: Permit<ManageOwn>) -> Result<Json<Page<DiskUse>>> {
    let person = permit.call.person()?;
    let projects = permit.store.project_facts().await?;
    let is_held = |id: Uuid| {
        let project = projects.iter().find(|of| of.id == id);
        project.is_some_and(|of| permit.call.ask(Action::Change, Object::Project(of)).is_ok())
    };
    let is_shown = |of: &DiskUse| {
        person.role == Role::Administrator
            || of
                .person
                .as_ref()
                .is_some_and(|owner| owner.id == person.id)
            || of
                .project
                .as_ref()
                .is_some_and(|project| is_held(project.id))
    };
    let all = permit.store.disk_use().await?.into_iter();
    Ok(Json(Page::whole(all.filter(is_shown).collect())))
}
