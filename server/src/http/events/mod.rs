//! Server-sent events: what happens to jobs, as it happens and again after a broken connection.
//!
//! The store numbers and keeps every event. One task reads new ones once and announces them to all
//! connections ([`announcements`]); a connection that starts with `Last-Event-ID`, or could not
//! keep up, reads what it missed from the store ([`Follower`]).
pub(super) mod announcements;
mod follower;

use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;

use axum::extract::{Query, State};
use axum::http::HeaderMap;
use axum::response::IntoResponse;
use axum::response::sse::{self, KeepAlive, Sse};
use futures_util::stream::{self, StreamExt};
use serde::Deserialize;
use utoipa::IntoParams;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

use super::AppState;
use super::bounded::{Listed, Number};
use super::permit::{Call, JobPermit, Permit, Read};
use super::problem::{ApiError, BAD_REQUEST, Result};
use announcements::Announced;
use follower::Follower;

/// Jobs one connection can ask for by name.
const MOST_JOBS: usize = 100;
/// How long a client waits before it connects again.
const RETRY: Duration = Duration::from_secs(2);
/// A comment this often keeps proxies from closing the connection.
const KEEP_ALIVE: Duration = Duration::from_secs(15);
/// Largest event number: what a JSON number holds exactly.
const LAST_NUMBER: u64 = 9_007_199_254_740_991;

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(of_job))
        .routes(routes!(of_jobs))
}

#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
struct JobEventsQuery {
    /// As the header `Last-Event-ID`, for clients that cannot set it.
    #[param(value_type = u64, required = false, minimum = 0, maximum = 9_007_199_254_740_991_u64)]
    last_event_id: Option<Number<0, LAST_NUMBER>>,
}

#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
struct EventsQuery {
    /// Ids of up to 100 jobs, separated by commas; left out, all jobs.
    #[param(schema_with = jobs_schema, required = false)]
    jobs: Option<Listed<Uuid, MOST_JOBS>>,
    /// As the header `Last-Event-ID`, for clients that cannot set it.
    #[param(value_type = u64, required = false, minimum = 0, maximum = 9_007_199_254_740_991_u64)]
    last_event_id: Option<Number<0, LAST_NUMBER>>,
}

fn jobs_schema() -> utoipa::openapi::schema::Object {
    use utoipa::openapi::schema::{ObjectBuilder, Type};
    let id = "[0-9a-fA-F]{8}(-[0-9a-fA-F]{4}){3}-[0-9a-fA-F]{12}";
    ObjectBuilder::new()
        .schema_type(Type::String)
        .pattern(Some(format!("^{id}(,{id}){{0,99}}$")))
        .build()
}

/// Follow a job
///
/// A stream of server-sent events: `job` (it changed), `progress`, `points` (there are new curve
/// points to fetch), `deleted`. It begins with a `job` event of the present state; with
/// `Last-Event-ID`, it goes on after that event instead. The server ends it when it stops, or when the
/// token or session ends that it was opened with.
#[utoipa::path(get, operation_id = "follow_job", path = "/v1/jobs/{id}/events", tag = "Events",
    params(("id" = Uuid, Path, description = "Id of the job"), JobEventsQuery,
           ("Last-Event-ID" = Option<u64>, Header, description = "`id` of the last event received", minimum = 0, maximum = 9_007_199_254_740_991_u64)),
    responses((status = 200, description = "Events; `data` is as in the schema `Event`", body = String, content_type = "text/event-stream"),
              (status = 404, description = "There is no such job")))]
async fn of_job(
    State(state): State<AppState>,
    job: JobPermit<Read>,
    Query(query): Query<JobEventsQuery>,
    headers: HeaderMap,
) -> Result<impl IntoResponse> {
    state.store.job_version(job.id).await?;
    let last = last_event(&headers, query.last_event_id)?;
    follow(&state, &job.call, Some(vec![job.id]), last).await
}

/// Follow many jobs
///
/// As following one job. Jobs named in `jobs` are each given once at the beginning; for all jobs,
/// read the list after the stream has opened.
#[utoipa::path(get, operation_id = "follow_jobs", path = "/v1/events", tag = "Events",
    params(EventsQuery,
           ("Last-Event-ID" = Option<u64>, Header, description = "`id` of the last event received", minimum = 0, maximum = 9_007_199_254_740_991_u64)),
    responses((status = 200, description = "Events; `data` is as in the schema `Event`", body = String, content_type = "text/event-stream")))]
async fn of_jobs(
    State(state): State<AppState>,
    permit: Permit<Read>,
    Query(query): Query<EventsQuery>,
    headers: HeaderMap,
) -> Result<impl IntoResponse> {
    let last = last_event(&headers, query.last_event_id)?;
    follow(
        &state,
        &permit.call,
        query.jobs.map(|Listed(jobs)| jobs),
        last,
    )
    .await
}

async fn follow(
    state: &AppState,
    call: &Arc<Call>,
    jobs: Option<Vec<Uuid>>,
    last: Option<u64>,
) -> Result<impl IntoResponse + use<>> {
    let follower = Follower::start(state, call, jobs, last).await?;
    let opening = sse::Event::default().comment("events follow").retry(RETRY);
    let events = stream::unfold(follower, |mut follower| async {
        let event = follower.next().await?;
        Some((Ok::<_, Infallible>(on_the_wire(&event)), follower))
    });
    let events = stream::once(async { Ok(opening) }).chain(events);
    // a proxy that gathers a stream, or packs it, delivers events when they are no news
    let headers = [
        ("x-accel-buffering", "no"),
        ("cache-control", "no-cache, no-transform"),
    ];
    let events = Sse::new(events).keep_alive(KeepAlive::new().interval(KEEP_ALIVE));
    Ok((headers, events))
}

fn on_the_wire(event: &Announced) -> sse::Event {
    sse::Event::default()
        .id(event.number.to_string())
        .event(event.name)
        .data(&event.data)
}

fn last_event(headers: &HeaderMap, query: Option<Number<0, LAST_NUMBER>>) -> Result<Option<u64>> {
    let Some(value) = headers.get("last-event-id") else {
        return Ok(query.map(|Number(last)| last));
    };
    let number = value
        .to_str()
        .ok()
        .and_then(|text| text.trim().parse().ok());
    match number {
        Some(number) if number <= LAST_NUMBER => Ok(Some(number)),
        _ => Err(ApiError::new(
            BAD_REQUEST,
            "Last-Event-ID is the number of an event",
        )),
    }
}
