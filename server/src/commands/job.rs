//! `loadframe cancel`, `pause`, `resume`, `retry`
use clap::Args;
use loadframe_api::JobView;
use reqwest::Method;
use uuid::Uuid;

use super::connection::Connection;
use super::failure::Failure;
use super::terminal::{print_json, print_line, wire_name};

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Id of the job
    id: Uuid,
    /// Print the job as JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    connection: Connection,
}

pub(crate) async fn perform(arguments: Arguments, action: &str) -> Result<(), Failure> {
    let server = arguments.connection.client()?;
    let path = format!("/v1/jobs/{}/{action}", arguments.id);
    let job: JobView = server.json(server.request(Method::POST, &path)).await?;
    if arguments.json {
        return print_json(&job);
    }
    print_line(&format!(
        "{} is {}: {}",
        job.id,
        wire_name(&job.status),
        job.reason
    ));
    Ok(())
}
