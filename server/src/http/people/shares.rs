//! `/v1/shares`: links that show one job, one project or one comparison to whoever has them.
use axum::Json;
use axum::extract::{Path, Query, State};
use axum::http::StatusCode;
use loadframe_api::people::{NewShare, Role, ShareMade, ShareView};
use loadframe_api::{Page, Violation};
use serde::Deserialize;
use utoipa::IntoParams;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

use super::super::AppState;
use super::super::body::{JsonBody, message};
use super::super::bounded::{Number, Text};
use super::super::permit::{Change, ManageOwn, Permit};
use super::super::problem::{ApiError, FORBIDDEN, INVALID, Result};
use crate::access::Action;
use crate::store::people::ShareFilter;

/// Links on a page unless asked otherwise.
const PAGE: u32 = 1000;

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(list, create))
        .routes(routes!(revoke))
}

#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
struct ShareQuery {
    /// Only links to this job.
    #[param(value_type = Uuid, required = false)]
    job: Option<Uuid>,
    /// Only links to this comparison.
    #[param(value_type = Uuid, required = false)]
    comparison: Option<Uuid>,
    /// Most links on a page; 1000 when left out.
    #[param(value_type = u32, required = false, minimum = 1, maximum = 1000)]
    limit: Option<Number<1, 1000>>,
    /// `next` of the page before.
    #[param(value_type = String, required = false, min_length = 1, max_length = 200)]
    cursor: Option<Text<1, 200>>,
}

/// List share links
///
/// One's own and those to jobs, projects and comparisons that one may change; administrators see all.
#[utoipa::path(get, operation_id = "list_shares", path = "/v1/shares", tag = "People",
    params(ShareQuery),
    responses((status = 200, description = "The newest first, without their secrets", body = ref("#/components/schemas/ShareViewPage")),
              (status = 422, description = "The cursor is not one of this server")))]
async fn list(
    permit: Permit<ManageOwn>,
    Query(query): Query<ShareQuery>,
) -> Result<Json<Page<ShareView>>> {
    let person = permit.call.person()?;
    let is_administrator = person.role == Role::Administrator;
    let filter = ShareFilter {
        job: query.job,
        comparison: query.comparison,
        cursor: query.cursor.map(|Text(cursor)| cursor),
        limit: query.limit.map_or(PAGE, |Number(limit)| limit as u32),
    };
    let page = permit.store.shares(person.id, is_administrator, &filter);
    Ok(Json(page.await?))
}

/// Make a share link
///
/// Whoever has it reads that job, the jobs of that project or those of that comparison, and nothing else, without an
/// account. Only what you may change can be shared: of a comparison, every job.
#[utoipa::path(post, operation_id = "create_share", path = "/v1/shares", tag = "People",
    request_body(content = ref("#/components/schemas/NewShare"), description = "What it shows, and for how long"),
    responses((status = 201, description = "The link", body = ref("#/components/schemas/ShareMade")),
              (status = 404, description = "There is no such job, project or comparison"),
              (status = 408, description = "The body did not arrive in time"),
              (status = 413, description = "The body is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "It cannot be made, see `violations`")))]
async fn create(
    State(state): State<AppState>,
    permit: Permit<Change>,
    body: JsonBody,
) -> Result<(StatusCode, Json<ShareMade>)> {
    let new: NewShare = message(&state, body).await?;
    let person = permit.call.person()?.id;
    match (new.job, new.project, new.comparison) {
        (Some(job), None, None) => {
            permit
                .call
                .ask_of_job(&state.store, Action::Change, job)
                .await?;
        }
        (None, Some(project), None) => {
            permit
                .call
                .ask_of_project(&state.store, Action::Change, project)
                .await?;
        }
        (None, None, Some(comparison)) => ask_of_all(&state, &permit, comparison).await?,
        _ => {
            let detail = "a link shows one job, one project or one comparison";
            let violation = Violation::new("", "one_object", detail)
                .allowed("one of: job, project, comparison");
            let refusal = ApiError::new(INVALID, "see what is wrong with it");
            return Err(refusal.violations(vec![violation]));
        }
    }
    let made = permit.store.create_share(person, new).await?;
    Ok((StatusCode::CREATED, Json(made)))
}

/// Whether the person may share the comparison: it is theirs to change, and so is every job in it.
async fn ask_of_all(state: &AppState, permit: &Permit<Change>, comparison: Uuid) -> Result<()> {
    let (call, store) = (&permit.call, &state.store);
    call.ask_of_comparison(store, Action::Change, comparison)
        .await?;
    let mut foreign = 0_usize;
    let jobs = store.comparison_jobs(comparison).await?;
    for job in &jobs {
        match call.ask_of_job(store, Action::Change, *job).await {
            // one that is deleted shows nothing to anybody
            Err(refusal) if refusal.is_missing() => {}
            Err(_) => foreign += 1,
            Ok(()) => {}
        }
    }
    if foreign == 0 {
        return Ok(());
    }
    let count = jobs.len();
    let detail = format!(
        "{foreign} of the {count} jobs of this comparison are shared with you to read; who may change them can share it"
    );
    Err(ApiError::new(FORBIDDEN, detail))
}

/// Take a share link back
#[utoipa::path(delete, operation_id = "revoke_share", path = "/v1/shares/{id}", tag = "People",
    params(("id" = Uuid, Path, description = "Id of the link")),
    responses((status = 204, description = "It shows nothing any more"),
              (status = 404, description = "You have no such link")))]
async fn revoke(permit: Permit<ManageOwn>, Path(id): Path<Uuid>) -> Result<StatusCode> {
    let person = permit.call.person()?;
    let is_administrator = person.role == Role::Administrator;
    permit
        .store
        .revoke_share(person.id, is_administrator, id)
        .await?;
    Ok(StatusCode::NO_CONTENT)
}
