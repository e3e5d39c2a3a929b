//! `loadframe lab --demo`: the first example job, from submission to results.
use loadframe_api::{JobKind, JobStatus, JobView, Page, printable};
use loadframe_client::ServerClient;
use reqwest::Method;
use serde_json::Value;

use crate::commands::failure::{Code, Failure};
use crate::commands::follow::{conclude, follow};
use crate::commands::submit::submit;
use crate::commands::terminal::print_line;

/// Marks demo jobs, so that an unfinished one is found again.
const TAG: &str = "demo";

/// Submits the demo, or finds the one an earlier start left unfinished, and shows it to its end.
pub(super) async fn run(server: &ServerClient) -> Result<(), Failure> {
    let job = match unfinished(server).await? {
        Some(job) => job,
        None => submit(server, &body()?, None).await?,
    };
    print_line(&format!(
        "Demo: {}  {}{}\n",
        printable(&job.name),
        server.address(),
        job.links.page
    ));
    let job = follow(server, job.id).await?;
    conclude(server, &job, false).await
}

async fn unfinished(server: &ServerClient) -> Result<Option<JobView>, Failure> {
    let query = [("tag", TAG), ("limit", "50")];
    let request = server.request(Method::GET, "/v1/jobs").query(&query);
    let page: Page<JobView> = server.json(request).await?;
    let goes_on = |job: &JobView| matches!(job.status, JobStatus::Queued | JobStatus::Running);
    Ok(page.items.into_iter().find(goes_on))
}

/// The first example of the first kind, tagged.
fn body() -> Result<Vec<u8>, Failure> {
    let broken = || Failure::new(Code::Failed, "the example job is not as it should be");
    let example = JobKind::NonwovenTensile
        .examples()
        .first()
        .ok_or_else(broken)?;
    let mut body: Value =
        serde_json::from_str(example.body).map_err(|error| Failure::of(&error))?;
    let tags = body["tags"].as_array_mut().ok_or_else(broken)?;
    tags.push(TAG.into());
    Ok(body.to_string().into_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_demo_is_a_valid_job() {
        let body = body().expect("an example with tags");
        let submission = loadframe_api::Submission::from_slice(&body).expect("a valid job");
        assert!(submission.tags.contains(&TAG.to_owned()));
    }
}
