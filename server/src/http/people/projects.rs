//! `/v1/projects`: jobs that belong together, and who sees them.
use std::collections::HashSet;

use axum::Json;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use loadframe_api::Page;
use loadframe_api::people::{NewProject, ProjectChanges, ProjectView};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

use super::super::AppState;
use super::super::body::{JsonBody, message};
use super::super::permit::{Change, Permit, Read};
use super::super::problem::{ApiError, INVALID, Result};
use crate::access::{Action, Object, ProjectFacts};

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(list, create))
        .routes(routes!(change, delete))
}

/// List the projects
///
/// Those you see, archived ones last; none on a server of one person.
#[utoipa::path(get, operation_id = "list_projects", path = "/v1/projects", tag = "People",
    responses((status = 200, description = "The projects", body = ref("#/components/schemas/ProjectViewPage"))))]
async fn list(permit: Permit<Read>) -> Result<Json<Page<ProjectView>>> {
    let facts = permit.store.project_facts().await?;
    let may_read = |of: &&ProjectFacts| permit.call.ask(Action::Read, Object::Project(of)).is_ok();
    let seen: HashSet<Uuid> = facts.iter().filter(may_read).map(|of| of.id).collect();
    let all = permit.store.projects().await?.into_iter();
    let items = all.filter(|project| seen.contains(&project.id)).collect();
    Ok(Json(Page::whole(items)))
}

/// Make a project
///
/// Your own, or one of a group that you are in.
#[utoipa::path(post, operation_id = "create_project", path = "/v1/projects", tag = "People",
    request_body(content = ref("#/components/schemas/NewProject"), description = "Name, group, and who sees it"),
    responses((status = 201, description = "The project", body = ref("#/components/schemas/ProjectView")),
              (status = 408, description = "The body did not arrive in time"),
              (status = 413, description = "The body is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "It cannot be made, see `violations`")))]
async fn create(
    State(state): State<AppState>,
    permit: Permit<Change>,
    body: JsonBody,
) -> Result<(StatusCode, Json<ProjectView>)> {
    let new: NewProject = message(&state, body).await?;
    let person = permit.call.person()?;
    if let Some(group) = new.group {
        check_membership(&permit, group)?;
    }
    let made = permit.store.create_project(person.id, new).await?;
    Ok((StatusCode::CREATED, Json(made)))
}

/// Change a project
///
/// Rename it, show it to others, archive it, or hand it over.
#[utoipa::path(patch, operation_id = "change_project", path = "/v1/projects/{id}", tag = "People",
    params(("id" = Uuid, Path, description = "Id of the project")),
    request_body(content = ref("#/components/schemas/ProjectChanges"), description = "What to change"),
    responses((status = 200, description = "The project", body = ref("#/components/schemas/ProjectView")),
              (status = 404, description = "There is no such project"),
              (status = 408, description = "The body did not arrive in time"),
              (status = 413, description = "The body is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "The changes cannot be made, see `violations`")))]
async fn change(
    State(state): State<AppState>,
    permit: Permit<Change>,
    Path(id): Path<Uuid>,
    body: JsonBody,
) -> Result<Json<ProjectView>> {
    let changes: ProjectChanges = message(&state, body).await?;
    let project = permit.call.ask_of_project(&state.store, Action::Change, id);
    let project = project.await?;
    if changes.person.is_some() || changes.group.is_some() {
        permit
            .call
            .ask(Action::HandOver, Object::Project(&project))?;
    }
    if let Some(group) = changes.group {
        check_membership(&permit, group)?;
    }
    Ok(Json(permit.store.change_project(id, changes).await?))
}

/// Delete a project
///
/// With all its jobs; its person and administrators do, and can bring it back for a while (`/v1/trash`).
#[utoipa::path(delete, operation_id = "delete_project", path = "/v1/projects/{id}", tag = "People",
    params(("id" = Uuid, Path, description = "Id of the project")),
    responses((status = 204, description = "It is in the trash"),
              (status = 404, description = "There is no such project"),
              (status = 409, description = "A job of it is running")))]
async fn delete(
    State(state): State<AppState>,
    permit: Permit<Change>,
    Path(id): Path<Uuid>,
) -> Result<StatusCode> {
    let project = permit
        .call
        .ask_of_project(&state.store, Action::HandOver, id);
    project.await?;
    permit.store.discard_project(id).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// A project is made for or given to a group by who is in it; to others no group shows whether it is there.
fn check_membership(permit: &Permit<Change>, group: Uuid) -> Result<()> {
    let person = permit.call.person()?;
    let is_administrator = permit.call.ask(Action::Administer, Object::Lab).is_ok();
    if person.groups.contains(&group) || is_administrator {
        return Ok(());
    }
    let violation = loadframe_api::Violation::new("/group", "unknown", "there is no such group")
        .value(group.to_string())
        .allowed("the id of a group of yours");
    let refusal = ApiError::new(INVALID, "see what is wrong with it");
    Err(refusal.violations(vec![violation]))
}
