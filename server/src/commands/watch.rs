//! `loadframe watch`
use clap::Args;
use uuid::Uuid;

use super::connection::Connection;
use super::failure::Failure;
use super::follow::{conclude, follow};

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Id of the job
    id: Uuid,
    /// Print the finished job as JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    connection: Connection,
}

pub(crate) async fn perform(arguments: Arguments) -> Result<(), Failure> {
    let server = arguments.connection.client()?;
    let job = follow(&server, arguments.id).await?;
    conclude(&server, &job, arguments.json).await
}
