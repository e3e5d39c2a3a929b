//! `GET /v1/fields`: what lists can show, be sorted and be filtered by.
use axum::Json;
use axum::extract::{Query, State};
use indexmap::IndexMap;
use loadframe_api::{FieldView, JobKind, JobView, Page, unit_of_field};
use serde::Deserialize;
use utoipa::IntoParams;
use uuid::Uuid;

use super::super::AppState;
use super::super::compare::fields::Fields;
use super::super::permit::{Permit, Read};
use super::super::problem::{ApiError, Result};
use super::list::kind_schema;
use crate::store::JobFilter;
use crate::tasks::blocking;

/// Jobs that are looked at.
const LOOKED_AT: u32 = 100;
/// Fields told.
const MOST: usize = 2_000;

#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(in crate::http) struct FieldsQuery {
    /// Only jobs of this kind.
    #[param(schema_with = kind_schema, required = false)]
    kind: Option<JobKind>,
    /// Only jobs in this project.
    #[param(value_type = Uuid, required = false)]
    project: Option<Uuid>,
}

/// List fields of jobs
///
/// Results, and fields of specs, that the newest hundred jobs which you see have: a list can show them
/// (`show`), be sorted (`sort`) and be filtered (`where`) by them.
#[utoipa::path(get, operation_id = "list_fields", path = "/v1/fields", tag = "Jobs",
    params(FieldsQuery),
    responses((status = 200, description = "The results, then the fields of specs", body = ref("#/components/schemas/FieldViewPage"))))]
pub(super) async fn fields(
    State(state): State<AppState>,
    permit: Permit<Read>,
    Query(query): Query<FieldsQuery>,
) -> Result<Json<Page<FieldView>>> {
    let filter = JobFilter {
        kind: query.kind,
        project: query.project,
        sight: Some(permit.call.sight(&state.store).await?),
        ..JobFilter::default()
    };
    let jobs = state.store.jobs(&filter, None, LOOKED_AT).await?.items;
    let ids: Vec<Uuid> = jobs.iter().map(|job| job.id).collect();
    let specs = state.store.specs_looked_into(&ids).await?;
    let listed = blocking(move || {
        let mut listed = results(&jobs);
        let mut seen = Fields::default();
        for spec in specs {
            let spec = serde_json::from_str(&spec).map_err(|error| ApiError::internal(&error))?;
            seen.look_at(&spec);
        }
        listed.extend(seen.every().map(|(pointer, count)| {
            let unit = jobs
                .iter()
                .find_map(|job| unit_of_field(job.kind, &pointer));
            FieldView {
                unit: unit.map(str::to_owned),
                pointer: format!("/spec{pointer}"),
                jobs: count as u64,
            }
        }));
        listed.truncate(MOST);
        Ok::<_, ApiError>(listed)
    });
    let listed = listed.await?;
    Ok(Json(Page::whole(listed?)))
}

fn results(jobs: &[JobView]) -> Vec<FieldView> {
    let mut found: IndexMap<&str, FieldView> = IndexMap::new();
    let all = jobs.iter().filter_map(|job| job.summary.as_ref()).flatten();
    for (name, quantity) in all {
        let field = found.entry(name).or_insert_with(|| FieldView {
            pointer: format!("/summary/{}", name.replace('~', "~0").replace('/', "~1")),
            unit: Some(quantity.unit.clone()),
            jobs: 0,
        });
        field.jobs += 1;
    }
    found.into_values().collect()
}
