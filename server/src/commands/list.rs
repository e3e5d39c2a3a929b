//! `loadframe list`
use clap::Args;
use loadframe_api::{JobKind, JobOutcome, JobStatus, JobView, Page, printable};
use reqwest::Method;

use super::connection::Connection;
use super::failure::Failure;
use super::terminal::{print_json, print_line, span, wire_name};

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// At most so many jobs
    #[arg(long, default_value_t = 20, value_name = "N")]
    limit: u32,
    /// Only queued, running, paused or finished jobs
    #[arg(long, value_parser = parse_wire_name::<JobStatus>)]
    status: Option<JobStatus>,
    /// Only jobs that ended so: succeeded, failed, cancelled, timed_out, quarantined
    #[arg(long, value_parser = parse_wire_name::<JobOutcome>)]
    outcome: Option<JobOutcome>,
    /// Only jobs of this kind
    #[arg(long)]
    kind: Option<JobKind>,
    /// Only jobs with this tag
    #[arg(long)]
    tag: Option<String>,
    /// Only jobs with this text in their name, notes or tags
    #[arg(long, value_name = "TEXT")]
    q: Option<String>,
    /// Print the jobs as JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    connection: Connection,
}

fn parse_wire_name<T: serde::de::DeserializeOwned>(word: &str) -> Result<T, String> {
    serde_json::from_value(word.into()).map_err(|error| error.to_string())
}

pub(crate) async fn perform(arguments: Arguments) -> Result<(), Failure> {
    let server = arguments.connection.client()?;
    let query = [
        ("limit", Some(arguments.limit.to_string())),
        ("status", arguments.status.as_ref().map(wire_name)),
        ("outcome", arguments.outcome.as_ref().map(wire_name)),
        ("kind", arguments.kind.map(|kind| kind.name().to_owned())),
        ("tag", arguments.tag),
        ("q", arguments.q),
    ];
    let query: Vec<_> = query.iter().filter(|(_, value)| value.is_some()).collect();
    let request = server.request(Method::GET, "/v1/jobs").query(&query);
    let page: Page<JobView> = server.json(request).await?;
    if arguments.json {
        return print_json(&page);
    }
    if page.items.is_empty() {
        print_line("no jobs");
    }
    for job in &page.items {
        print_line(&line(job));
    }
    if page.next.is_some() {
        print_line(&format!(
            "… and older ones; --limit shows more than {}",
            arguments.limit
        ));
    }
    Ok(())
}

fn line(job: &JobView) -> String {
    let state = job
        .outcome
        .as_ref()
        .map_or_else(|| wire_name(&job.status), wire_name);
    let share = match job.status {
        JobStatus::Running | JobStatus::Paused => {
            format!("{:3.0} %", (100.0 * job.progress).floor())
        }
        JobStatus::Queued | JobStatus::Finished => String::new(),
    };
    let left = job
        .eta_s
        .map_or(String::new(), |left| format!("  ({} to go)", span(left)));
    format!(
        "{}  {state:11} {share:5}  {:18}  {}{left}",
        job.id,
        job.kind.name(),
        printable(&job.name)
    )
}
