//! `POST /v1/jobs`.
use axum::Json;
use axum::extract::{Query, State};
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use loadframe_api::people::Allowance;
use loadframe_api::{
    Calibration, Earlier, Estimate, JobLimits, Submission, SubmissionError, Warning,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use utoipa::IntoParams;
use uuid::Uuid;

use super::super::AppState;
use super::super::body::JsonBody;
use super::super::permit::{Call, Permit, Submit};
use super::super::problem::{ApiError, INVALID, INVALID_JOB, Result};
use crate::access::Action;
use crate::store::{CheckedSubmission, Enqueued, IdempotencyKey, StoreError};

/// Longest idempotency key [characters].
const LONGEST_KEY: usize = 200;
/// So many earlier jobs of one spec are looked up.
const MOST_REFERRED: usize = 100;

#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(in crate::http) struct SubmitQuery {
    /// Only check the job and say what it would take; nothing is stored.
    #[serde(default)]
    #[param(value_type = bool, required = false)]
    dry_run: bool,
    /// The project the job goes to; left out, the oldest that you made and that is not archived. Only where the server has accounts.
    #[param(value_type = Uuid, required = false)]
    project: Option<Uuid>,
}

/// What a job would be and take.
#[derive(Debug, Serialize, JsonSchema)]
pub(in crate::http) struct DryRun {
    /// The normalised spec, all defaults written out.
    #[schemars(with = "serde_json::Map<String, serde_json::Value>")]
    spec: Box<RawValue>,
    spec_sha256: String,
    estimate: Estimate,
    /// What the job may take before it is paused: its estimate, `overrun_factor` times.
    limits: JobLimits,
    /// What you may use, and what of it is left before this job; `null` where the server has no accounts.
    allowance: Option<Allowance>,
    warnings: Vec<Warning>,
}

/// Submit a job
///
/// The body is checked completely; everything wrong with it is answered at once, each thing with
/// its JSON pointer, the value given, what is allowed, and the unit. A job whose estimate exceeds
/// the server's limits is refused with the numbers.
///
/// Send an `Idempotency-Key` to be able to repeat a submission whose answer was lost: the same key
/// with the same body and project answers the same job, whatever limits say by then; with another 422.
#[utoipa::path(post, operation_id = "submit_job", path = "/v1/jobs", tag = "Jobs",
    params(SubmitQuery,
           ("Idempotency-Key" = Option<String>, Header, min_length = 1, max_length = 200, pattern = "^[!-~]+$",
            description = "Your name for this submission: printable ASCII without spaces")),
    request_body(content = ref("#/components/schemas/Submission"), description = "The job"),
    responses((status = 200, description = "Dry run: the job could be accepted", body = ref("#/components/schemas/DryRun")),
              (status = 201, description = "The job was stored and waits for a worker", body = ref("#/components/schemas/JobView"),
               headers(("Location" = String, description = "Address of the job"),
                       ("Idempotency-Replayed" = bool, description = "`true` if this key was answered before"))),
              (status = 404, description = "There is no such project"),
              (status = 408, description = "The body did not arrive in time"),
              (status = 409, description = "The job of this key was deleted, or no project of yours takes jobs"),
              (status = 413, description = "The body is larger than 32 MB"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "The job cannot be accepted, see `violations`; or the key belongs to another body or project")))]
pub(super) async fn create(
    State(state): State<AppState>,
    permit: Permit<Submit>,
    Query(SubmitQuery { dry_run, project }): Query<SubmitQuery>,
    headers: HeaderMap,
    body: JsonBody,
) -> Result<Response> {
    let name = idempotency_key(&headers)?;
    let (key, body) = match name {
        Some(name) if !dry_run => named(&state, &permit.call, name, project, body).await?,
        _ => (None, body),
    };
    if let Some(key) = &key
        && let Some(before) = state.store.enqueued(key).await?
    {
        return answer(before);
    }
    let project = match project {
        Some(id) => {
            let of = permit.call.ask_of_project(&state.store, Action::Submit, id);
            Some(of.await?.id)
        }
        None => None,
    };
    let measured = state.store.calibration().await?;
    let (mut checked, _body) = read(&state, &permit.call, body, measured).await?;
    checked.project = project;
    let violations = state.limits.violations(&checked.estimate);
    if !violations.is_empty() {
        let detail = "its estimate exceeds what this server gives a single job";
        return Err(ApiError::new(INVALID_JOB, detail).violations(violations));
    }
    if dry_run {
        let allowance = allowance_for(&state, &permit.call, &checked).await?;
        return Ok(Json(dry_run_of(checked, measured, allowance)?).into_response());
    }
    let kind = checked.submission.spec.kind();
    let enqueued = permit.store.enqueue_checked(checked, key).await;
    let enqueued = enqueued.map_err(beyond_limits)?;
    metrics::counter!("loadframe_submissions_total", "kind" => kind.name())
        .increment(u64::from(!enqueued.replayed));
    answer(enqueued)
}

/// The body under the name that its client gave it, hashed where that holds up nobody.
async fn named(
    state: &AppState,
    call: &Call,
    name: String,
    project: Option<Uuid>,
    body: JsonBody,
) -> Result<(Option<IdempotencyKey>, JsonBody)> {
    let person = call.caller.person().map(|person| person.id);
    let client = body.client;
    let hash = move || {
        let key = IdempotencyKey::new(person, &name, project, &body.bytes);
        (Some(key), body)
    };
    state.checks.run(client, hash).await
}

/// The answer to a submission that was stored, now or before.
fn answer(enqueued: Enqueued) -> Result<Response> {
    let location = HeaderValue::try_from(&enqueued.job.links.this)
        .map_err(|error| ApiError::internal(&error))?;
    let mut response = (StatusCode::CREATED, Json(enqueued.job)).into_response();
    response.headers_mut().insert(header::LOCATION, location);
    if enqueued.replayed {
        let replayed = HeaderValue::from_static("true");
        response
            .headers_mut()
            .insert("idempotency-replayed", replayed);
    }
    Ok(response)
}

/// What the caller may use, where the job would be taken; none where there are no people.
async fn allowance_for(
    state: &AppState,
    call: &Call,
    checked: &CheckedSubmission,
) -> Result<Option<Allowance>> {
    let Some(person) = call.caller.person() else {
        return Ok(None);
    };
    if checked.project.is_none() {
        state.store.project_of(person.id).await?;
    }
    let allowance = state.store.allowance(person.id).await?;
    let violations = allowance.violations(checked.submission.priority, &checked.estimate);
    match violations.is_empty() {
        true => Ok(Some(allowance)),
        false => Err(beyond_limits(StoreError::Refused(violations))),
    }
}

/// A job that its person may not submit is an invalid one.
fn beyond_limits(error: StoreError) -> ApiError {
    match error {
        StoreError::Refused(violations) => {
            let detail = violations.first().map(|first| first.detail.clone());
            ApiError::new(INVALID_JOB, detail.unwrap_or_default()).violations(violations)
        }
        error => error.into(),
    }
}

/// Checks the body, with the results of the jobs that it refers to.
pub(super) async fn read(
    state: &AppState,
    call: &Call,
    body: JsonBody,
    measured: Option<Calibration>,
) -> Result<(CheckedSubmission, JsonBody)> {
    let (first, body) = check(state, body, Earlier::default(), measured).await?;
    let wanted = match &first {
        Ok(_) => Vec::new(),
        Err(error) => error.wanted_jobs(),
    };
    if wanted.is_empty() {
        return Ok((first?, body));
    }
    let mut earlier = Earlier::default();
    for id in wanted.into_iter().take(MOST_REFERRED) {
        // one that the caller does not see is not there
        let view = match call.ask_of_job(&state.store, Action::Read, id).await {
            Ok(()) => match state.store.job(id).await {
                Ok(view) => Some(view),
                Err(StoreError::NotFound(_)) => None,
                Err(error) => return Err(error.into()),
            },
            Err(refusal) if refusal.status() == 404 => None,
            Err(refusal) => return Err(refusal),
        };
        earlier.insert(id, view);
    }
    let (second, body) = check(state, body, earlier, measured).await?;
    Ok((second?, body))
}

type Checked = std::result::Result<CheckedSubmission, SubmissionError>;

/// Checks the body where it holds up nobody, and what the job would take.
async fn check(
    state: &AppState,
    body: JsonBody,
    earlier: Earlier,
    measured: Option<Calibration>,
) -> Result<(Checked, JsonBody)> {
    let client = body.client;
    let check = move || {
        let submission = Submission::from_slice_after(&body.bytes, &earlier);
        let checked = submission.map(|submission| CheckedSubmission::new(submission, measured));
        (checked, body)
    };
    state.checks.run(client, check).await
}

fn dry_run_of(
    checked: CheckedSubmission,
    measured: Option<Calibration>,
    allowance: Option<Allowance>,
) -> Result<DryRun> {
    let mut warnings = Vec::new();
    if measured.is_none() {
        warnings.push(Warning {
            code: "not_calibrated".to_owned(),
            detail: "no worker has measured its speed yet; the time is that of a typical core"
                .to_owned(),
        });
    }
    let spec = RawValue::from_string(checked.spec);
    Ok(DryRun {
        spec: spec.map_err(|error| ApiError::internal(&error))?,
        spec_sha256: checked.spec_sha256,
        limits: JobLimits::beyond(&checked.estimate, checked.submission.overrun_factor),
        estimate: checked.estimate,
        allowance,
        warnings,
    })
}

fn idempotency_key(headers: &HeaderMap) -> Result<Option<String>> {
    let Some(value) = headers.get("idempotency-key") else {
        return Ok(None);
    };
    let key = value.to_str().unwrap_or("");
    if (1..=LONGEST_KEY).contains(&key.len()) && key.bytes().all(|byte| byte.is_ascii_graphic()) {
        return Ok(Some(key.to_owned()));
    }
    let detail = "the Idempotency-Key must be 1 to 200 printable ASCII characters without spaces";
    Err(ApiError::new(INVALID, detail))
}
