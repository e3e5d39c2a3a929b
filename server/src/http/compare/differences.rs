//! `GET /v1/differences`.
use axum::Json;
use axum::extract::{Query, State};
use indexmap::IndexMap;
use loadframe_api::comparison::{
    ComparedField, ComparedJob, ComparedResult, Differences, Dimensions,
};
use loadframe_api::{Quantity, unit_of_field};
use serde_json::{Value, json};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::super::AppState;
use super::super::permit::{Permit, Read};
use super::super::problem::{ApiError, Result};
use super::fields::{Fields, told};
use super::selection::comparing;
use crate::store::{Compared, Store};
use crate::tasks::blocking;

/// Longest spec that is looked at field by field [bytes].
const LONGEST_SPEC: u64 = 200_000;

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default().routes(routes!(differences))
}

comparing! {
    struct DifferencesQuery {}
}

/// Tell jobs apart
///
/// The fields in which the specs of up to 1000 jobs differ, and all of their results. Jobs that you do not
/// see are `missing`, like those that do not exist.
#[utoipa::path(get, operation_id = "read_differences", path = "/v1/differences", tag = "Comparing",
    params(DifferencesQuery),
    responses((status = 200, description = "What differs", body = ref("#/components/schemas/Differences")),
              (status = 404, description = "There is no such comparison"),
              (status = 422, description = "The jobs are chosen in no way or in several"),
              (status = 503, description = "Too many jobs are being compared")))]
async fn differences(
    State(state): State<AppState>,
    permit: Permit<Read>,
    Query(mut query): Query<DifferencesQuery>,
) -> Result<Json<Differences>> {
    let selected = query.selection().read(&state, &permit).await?;
    let jobs = &selected.jobs;
    let store = &permit.store;
    let is_large = |job: &Compared| job.spec_bytes > LONGEST_SPEC;

    let mut fields = Fields::default();
    for job in jobs.iter().filter(|job| !is_large(job)) {
        let spec = store.compared_spec(job).await?;
        fields = blocking(move || {
            fields.look_at(&parsed(&spec)?);
            Ok::<_, ApiError>(fields)
        })
        .await??;
    }
    let (pointers, fields_left_out) = fields.that_differ();

    let mut rows = Vec::with_capacity(jobs.len());
    let mut listed = Vec::with_capacity(jobs.len());
    for job in jobs {
        let (values, dimensions) = match is_large(job) {
            true => (vec![Value::Null; pointers.len()], sizes_alone(job)),
            false => values(store, job, pointers.clone()).await?,
        };
        rows.push(values);
        listed.push(entry(job, dimensions));
    }
    let mut fields = kinds_where_they_differ(jobs);
    for (place, pointer) in pointers.into_iter().enumerate() {
        let mut units = jobs.iter().map(|job| unit_of_field(job.kind, &pointer));
        fields.push(ComparedField {
            unit: units.find_map(|unit| unit).map(str::to_owned),
            values: rows.iter_mut().map(|row| row[place].take()).collect(),
            pointer: format!("/spec{pointer}"),
        });
    }
    let large = jobs.iter().filter(|job| is_large(job));
    Ok(Json(Differences {
        fields,
        fields_left_out,
        specs_left_out: large.map(|job| job.id).collect(),
        results: results(jobs),
        jobs: listed,
        missing: selected.missing,
        more: selected.more,
    }))
}

fn entry(job: &Compared, dimensions: Dimensions) -> ComparedJob {
    ComparedJob {
        id: job.id,
        kind: job.kind,
        name: job.name.clone(),
        tags: job.tags.clone(),
        status: job.status,
        outcome: job.outcome,
        created_at: job.created_at,
        spec_sha256: job.spec_sha256.clone(),
        columns: job.columns.clone(),
        points: job.points,
        dimensions,
    }
}

/// What results alone tell of a specimen's sizes.
fn sizes_alone(job: &Compared) -> Dimensions {
    Dimensions::of(&Value::Null, Some(&job.summary))
}

/// What a job has at these pointers, and the sizes of its specimen.
async fn values(
    store: &Store,
    job: &Compared,
    pointers: Vec<String>,
) -> Result<(Vec<Value>, Dimensions)> {
    let spec = store.compared_spec(job).await?;
    let results: IndexMap<String, Quantity> = job.summary.clone();
    blocking(move || {
        let spec = parsed(&spec)?;
        let at = |pointer: &String| spec.pointer(pointer).map_or(Value::Null, told);
        let values = pointers.iter().map(at).collect();
        Ok((values, Dimensions::of(&spec, Some(&results))))
    })
    .await?
}

fn kinds_where_they_differ(jobs: &[Compared]) -> Vec<ComparedField> {
    let kinds: Vec<Value> = jobs.iter().map(|job| json!(job.kind)).collect();
    let is_one = kinds.windows(2).all(|pair| pair[0] == pair[1]);
    let field = ComparedField {
        pointer: "/kind".to_owned(),
        unit: None,
        values: kinds,
    };
    (!is_one).then_some(field).into_iter().collect()
}

/// Every result that a job has; of one name in two units, each by itself.
fn results(jobs: &[Compared]) -> Vec<ComparedResult> {
    let mut found: IndexMap<(&str, &str), Vec<Option<f64>>> = IndexMap::new();
    for (place, job) in jobs.iter().enumerate() {
        for (name, quantity) in &job.summary {
            let values = found.entry((name, &quantity.unit));
            values.or_insert_with(|| vec![None; jobs.len()])[place] = quantity.value;
        }
    }
    let results = found
        .into_iter()
        .map(|((name, unit), values)| ComparedResult {
            name: name.to_owned(),
            unit: unit.to_owned(),
            values,
        });
    results.collect()
}

fn parsed(spec: &str) -> Result<Value> {
    serde_json::from_str(spec).map_err(|error| ApiError::internal(&error))
}
