//! `loadframe worker`
use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use loadframe_run::host_name;
use loadframe_worker::{Worker, WorkerEnd, WorkerError, WorkerOptions};

use super::connection::Connection;
use super::engine::ENGINE;
use super::failure::{Code, Failure};
use super::serve::positive;
use super::signals::{end_of_input, stop_signal};
use super::terminal::start_log;

/// A worker told to stop has so long to save its job and give it back. What a batch system or a
/// container allows between its two signals is 10 s and more.
const GRACE: Duration = Duration::from_secs(9);

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    connection: Connection,
    /// Label of this worker; the machine's name when left out
    #[arg(long, value_name = "LABEL")]
    name: Option<String>,
    /// Threads for a job; one worker for each core does more than one worker on all
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=4096))]
    threads: u16,
    /// Folder for files on their way to the server; the system's temporary one when left out
    #[arg(long, value_name = "DIR")]
    scratch: Option<PathBuf>,
    /// Seconds between checkpoints
    #[arg(long, value_name = "S", default_value_t = 20.0, value_parser = positive)]
    checkpoint_every: f64,
    /// End when no job came for so many seconds
    #[arg(long, value_name = "S", value_parser = positive)]
    exit_when_idle: Option<f64>,
    /// Save the job, give it back and end after so many seconds
    #[arg(long, value_name = "S", value_parser = positive)]
    max_runtime: Option<f64>,
    /// End when standard input does, as it does for a child whose parent is gone
    #[arg(long)]
    exit_with_parent: bool,
}

pub(crate) async fn perform(arguments: Arguments) -> Result<(), Failure> {
    start_log("info");
    let options = WorkerOptions {
        engine: ENGINE,
        server: arguments.connection.client()?,
        heartbeat_server: arguments.connection.client()?,
        name: arguments.name.unwrap_or_else(host_name),
        threads: arguments.threads.into(),
        scratch: arguments.scratch.unwrap_or_else(std::env::temp_dir),
        checkpoint_every: Duration::from_secs_f64(arguments.checkpoint_every),
        exit_when_idle: arguments.exit_when_idle.map(Duration::from_secs_f64),
        max_runtime: arguments.max_runtime.map(Duration::from_secs_f64),
    };
    let stop = stop_signal();
    let worker = tokio::task::spawn_blocking(|| Worker::prepare(options));
    let worker = worker.await.map_err(|error| Failure::of(&error))?;
    let worker = worker.map_err(failure)?;
    let shutdown = worker.shutdown();
    tokio::spawn({
        let shutdown = shutdown.clone();
        async move {
            tokio::select! {
                () = stop => {}
                () = end_of_input(), if arguments.exit_with_parent => {}
            }
            shutdown.cancel();
        }
    });
    let too_late = async {
        shutdown.cancelled().await;
        tokio::time::sleep(GRACE).await;
    };
    tokio::select! {
        end = worker.work() => match end.map_err(failure)? {
            WorkerEnd::Idle => tracing::info!("no job came: ending"),
            WorkerEnd::Stopped => tracing::info!("stopped"),
        },
        () = too_late => tracing::warn!("the job could not be given back in time; its lease will end"),
    }
    Ok(())
}

fn failure(error: WorkerError) -> Failure {
    match error {
        WorkerError::Server(error) => error.into(),
        WorkerError::Scratch { .. } => Failure::new(
            Code::Usage,
            format!(
                "{}; choose another with --scratch",
                super::failure::chain(&error)
            ),
        ),
        error => Failure::of(&error),
    }
}
