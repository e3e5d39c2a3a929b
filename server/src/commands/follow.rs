//! Following a job to its end.
use std::time::{Duration, Instant};

use loadframe_api::{JobStatus, JobView, Outcome};
use loadframe_client::{ServerClient, ServerError};
use loadframe_run::Progress;
use reqwest::{Method, StatusCode, header};
use uuid::Uuid;

use super::failure::{Code, Failure};
use super::progress::ProgressDisplay;
use super::results;
use super::signals::stop_signal;
use super::terminal::{print_json, print_line};

/// Time between looks; an unchanged job answers 304 and costs nothing.
const LOOK_EVERY: Duration = Duration::from_millis(250);
/// How long a server may be away before a follower gives up: a restart takes seconds.
const LONGEST_SILENCE: Duration = Duration::from_secs(60);

/// Shows the progress of a job until it is finished.
pub(crate) async fn follow(server: &ServerClient, id: Uuid) -> Result<JobView, Failure> {
    let stopped = || {
        Failure::new(
            Code::Interrupted,
            format!("the job goes on; `loadframe watch {id}` shows it again"),
        )
    };
    tokio::select! {
        end = watch(server, id) => end,
        () = stop_signal() => Err(stopped()),
    }
}

async fn watch(server: &ServerClient, id: Uuid) -> Result<JobView, Failure> {
    let mut display: Option<ProgressDisplay> = None;
    let mut tag = None;
    let mut last_answer = Instant::now();
    loop {
        match look(server, id, &mut tag).await {
            Ok(job) => {
                last_answer = Instant::now();
                if let Some(job) = job {
                    let shown = display.get_or_insert_with(|| ProgressDisplay::start(&job.name));
                    shown.show(&progress(&job));
                    if job.status == JobStatus::Finished {
                        display.into_iter().for_each(ProgressDisplay::end);
                        return Ok(job);
                    }
                }
            }
            Err(error) if error.is_transient() && last_answer.elapsed() < LONGEST_SILENCE => {}
            Err(error) => return Err(error.into()),
        }
        tokio::time::sleep(LOOK_EVERY).await;
    }
}

/// The job, unless it is as it was under `tag`.
async fn look(
    server: &ServerClient,
    id: Uuid,
    tag: &mut Option<header::HeaderValue>,
) -> Result<Option<JobView>, ServerError> {
    let mut request = server.request(Method::GET, &format!("/v1/jobs/{id}"));
    if let Some(tag) = tag.as_ref() {
        request = request.header(header::IF_NONE_MATCH, tag);
    }
    let answer = server.send(request).await?;
    if answer.status() == StatusCode::NOT_MODIFIED {
        return Ok(None);
    }
    *tag = answer.headers().get(header::ETAG).cloned();
    let job = answer.json().await;
    job.map(Some).map_err(|error| server.unreachable(&error))
}

fn progress(job: &JobView) -> Progress {
    let phase = match job.status {
        JobStatus::Running if !job.phase.is_empty() => job.phase.clone(),
        JobStatus::Queued => match job.position {
            Some(position) if position > 1 => format!("queued, {} before it", position - 1),
            _ => "queued, next".to_owned(),
        },
        _ => job.reason.clone(),
    };
    Progress {
        fraction: job.progress,
        phase,
        eta_s: job.eta_s,
    }
}

/// Says how a finished job ended, with its results when it has some.
pub(crate) async fn conclude(
    server: &ServerClient,
    job: &JobView,
    as_json: bool,
) -> Result<(), Failure> {
    if as_json {
        print_json(job)?;
    } else if Failure::of_job(job).is_none() {
        let request = server.request(Method::GET, &job.links.outcome);
        let outcome: Outcome = server.json(request).await?;
        results::show(&outcome);
        print_line(&format!(
            "\nCurve, files and pictures: {}{}",
            server.address(),
            job.links.page
        ));
    }
    Failure::of_job(job).map_or(Ok(()), Err)
}
