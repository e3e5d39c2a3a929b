//! `GET /v1/jobs`.
use std::fmt::Display;
use std::str::FromStr;

use axum::extract::{Query, State};
use axum::http::HeaderMap;
use axum::response::Response;
use loadframe_api::{JobKind, JobOutcome, JobStatus};
use serde::Deserialize;
use utoipa::IntoParams;
use utoipa::openapi::Ref;
use uuid::Uuid;

use super::super::AppState;
use super::super::bounded::{Moment, Number, Text};
use super::super::conditional::EntityTag;
use super::super::permit::{Permit, Read};
use super::super::problem::{ApiError, Result};
use crate::access::{Identity, Sight, Whose};
use crate::store::people::Versions;
use crate::store::{JobFilter, StoreError, Wanted};

/// Jobs on a page unless asked otherwise.
const PAGE: u32 = 50;
/// Conditions that hold together, at most, and values of specs shown.
const MOST_CONDITIONS: usize = 10;
const MOST_SHOWN: usize = 12;

#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(in crate::http) struct ListQuery {
    /// Most jobs on a page; 50 when left out.
    #[param(value_type = u32, required = false, minimum = 1, maximum = 200)]
    limit: Option<Number<1, 200>>,
    /// `next` of the page before.
    #[param(value_type = String, required = false, min_length = 1, max_length = 800)]
    cursor: Option<Text<1, 800>>,
    /// Only jobs in this status.
    #[param(schema_with = status_schema, required = false)]
    status: Option<JobStatus>,
    /// Only finished jobs that ended so.
    #[param(schema_with = outcome_schema, required = false)]
    outcome: Option<JobOutcome>,
    /// Only jobs of this kind.
    #[param(schema_with = kind_schema, required = false)]
    kind: Option<JobKind>,
    /// Only jobs with this tag.
    #[param(value_type = String, required = false, min_length = 1, max_length = 50)]
    tag: Option<Text<1, 50>>,
    /// Only jobs with this text in name, notes or tags, or whose id begins with it (eight digits or
    /// more); case does not matter.
    #[param(value_type = String, required = false, min_length = 1, max_length = 200)]
    q: Option<Text<1, 200>>,
    /// Only jobs submitted after this moment (RFC 3339).
    #[param(schema_with = moment_schema, required = false)]
    created_after: Option<Moment>,
    /// Only jobs submitted before this moment (RFC 3339).
    #[param(schema_with = moment_schema, required = false)]
    created_before: Option<Moment>,
    /// Only jobs in this project; those in archived ones are listed only so.
    #[param(value_type = Uuid, required = false)]
    project: Option<Uuid>,
    /// Only jobs for which these conditions hold, such as `/spec/seed=3,/summary/max_force>=1.5`: a
    /// pointer into the spec or to a result, a comparison, and a number, text, `true` or `false`. Values that
    /// lists were by before are found by an index; of others, and where very many jobs have them, some
    /// thousand jobs that pass the rest are looked at, and the answer says where it stopped.
    #[serde(rename = "where")]
    #[param(value_type = String, required = false, min_length = 1, max_length = 2000)]
    conditions: Option<Text<1, 2000>>,
    /// Sorts by a result (`/summary/max_force`) or a value of the spec (`/spec/seed`), falling with `-`
    /// before it. The first list by a value of more than 5 000 jobs sorts the newest of them and begins to
    /// gather that value from all (`gathering`).
    #[param(value_type = String, required = false, min_length = 1, max_length = 201)]
    sort: Option<Text<1, 201>>,
    /// Values of specs to show, such as `/spec/seed,/spec/test/max_strain`.
    #[param(value_type = String, required = false, min_length = 1, max_length = 2000)]
    show: Option<Text<1, 2000>>,
    /// Only your own jobs, those in projects of your groups, or what others share with you.
    #[param(schema_with = whose_schema, required = false)]
    whose: Option<Part>,
}

/// Which part of what one sees.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Part {
    Mine,
    Groups,
    Shared,
}

fn whose_schema() -> utoipa::openapi::schema::Object {
    use utoipa::openapi::schema::{ObjectBuilder, Type};
    ObjectBuilder::new()
        .schema_type(Type::String)
        .enum_values(Some(["mine", "groups", "shared"]))
        .build()
}

/// List jobs
///
/// Newest first, in pages: give `next` as `cursor` for the following one. Cheap to ask again: send
/// the `ETag` back as `If-None-Match`.
#[utoipa::path(get, operation_id = "list_jobs", path = "/v1/jobs", tag = "Jobs",
    params(ListQuery,
           ("If-None-Match" = Option<String>, Header, description = "`ETag` of the answer you have")),
    responses((status = 200, description = "A page of jobs, without their specs",
               body = ref("#/components/schemas/JobViewPage"), headers(("ETag" = String))),
              (status = 304, description = "No job has changed"),
              (status = 422, description = "The cursor is not one of this server; what `where`, `sort` or `show` ask for is no value of a job")))]
pub(super) async fn list(
    State(state): State<AppState>,
    permit: Permit<Read>,
    Query(query): Query<ListQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    let versions = permit.call.versions(&state.store).await?;
    let (sight, version) = seen(&state, &permit, &query, versions).await?;
    let tag = EntityTag::weak(version);
    if tag.is_known(&headers) {
        return Ok(tag.not_modified());
    }
    let limit = query.limit.map_or(PAGE, |Number(limit)| limit as u32);
    let cursor = query.cursor.map(|Text(cursor)| cursor);
    let filter = JobFilter {
        status: query.status,
        outcome: query.outcome,
        kind: query.kind,
        tag: query.tag.map(|Text(tag)| tag),
        q: query.q.map(|Text(text)| text),
        created_after: query.created_after.map(|Moment(at)| at),
        created_before: query.created_before.map(|Moment(at)| at),
        sight,
        project: query.project,
        access: Some(versions.access),
    };
    let wanted = Wanted {
        conditions: listed(
            "where",
            query.conditions.map(|Text(text)| text),
            MOST_CONDITIONS,
        )?,
        order: listed("sort", query.sort.map(|Text(text)| text), 1)?.pop(),
        shown: listed("show", query.show.map(|Text(text)| text), MOST_SHOWN)?,
    };
    let page = state
        .store
        .jobs_wanted(&filter, &wanted, cursor.as_deref(), limit);
    Ok(tag.json(&page.await?))
}

/// Values of a parameter, separated by commas.
fn listed<T: FromStr<Err: Display>>(
    name: &str,
    text: Option<String>,
    most: usize,
) -> Result<Vec<T>> {
    let refused = |why: String| ApiError::from(StoreError::Invalid(format!("{name}: {why}")));
    let Some(text) = text else {
        return Ok(Vec::new());
    };
    let values = text.split(',').map(|part| part.trim().parse::<T>());
    let values: Vec<T> = values
        .collect::<std::result::Result<_, _>>()
        .map_err(|error| refused(error.to_string()))?;
    if values.len() > most {
        let count = values.len();
        return Err(refused(format!("{count} values, of at most {most}")));
    }
    Ok(values)
}

/// What the caller sees of what it asks for, and what names the state of the list for it.
async fn seen(
    state: &AppState,
    permit: &Permit<Read>,
    query: &ListQuery,
    Versions { access, jobs }: Versions,
) -> Result<(Option<Sight>, String)> {
    let caller = &permit.call.caller;
    if caller.identity == Identity::Sole {
        return Ok((None, jobs.to_string()));
    }
    // the same jobs are another list for somebody else, and after a change of who sees what
    let who = match (caller.person(), caller.credential.id()) {
        (Some(person), _) => person.id,
        (None, id) => id.unwrap_or_default(),
    };
    let projects = state.store.project_facts_of(access).await?;
    let mut sight = Sight::of(caller, &projects);
    if query.project.is_none() {
        sight = sight.without_archived(&projects);
    }
    if let Some(part) = query.whose {
        let whose = match part {
            Part::Mine => Whose::Mine,
            Part::Groups => Whose::Groups,
            Part::Shared => Whose::Shared,
        };
        sight = sight.only(whose, caller, &projects);
    }
    Ok((Some(sight), format!("{jobs}-{access}-{}", who.simple())))
}

pub(in crate::http) fn status_schema() -> Ref {
    Ref::from_schema_name("JobStatus")
}

pub(in crate::http) fn outcome_schema() -> Ref {
    Ref::from_schema_name("JobOutcome")
}

pub(in crate::http) fn kind_schema() -> Ref {
    Ref::from_schema_name("JobKind")
}

fn moment_schema() -> Ref {
    Ref::from_schema_name("Timestamp")
}
