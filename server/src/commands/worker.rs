//! `loadframe worker`
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::Args;
use loadframe_run::host_name;
use loadframe_worker::{Allocation, Worker, WorkerEnd, WorkerError, WorkerOptions};
use tokio_util::sync::CancellationToken;

use super::connection::Connection;
use super::engine::ENGINE;
use super::failure::{Code, Failure};
use super::number::positive;
use super::signals::{end_of_input, worker_stop_signal};
use super::terminal::start_log;

/// Of an allocation that is shorter than four times the stop margin, this share is the margin.
const LARGEST_MARGIN_SHARE: f64 = 0.25;

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
    /// Folder for files on their way to the server; $TMPDIR or else /tmp when left out
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
    /// In a Slurm allocation: seconds before its end by which the job is saved and given back; at most a
    /// quarter of the time that is left at the start
    #[arg(long, value_name = "S", default_value_t = 120.0, value_parser = positive)]
    stop_margin: f64,
    /// Seconds to save the job and give it back once a signal says so; a container is given 10 s, a Slurm
    /// job 30 s (KillWait)
    #[arg(long, value_name = "S", default_value_t = 9.0, value_parser = positive)]
    grace: f64,
    /// How long a server may be away before the job is dropped; the worker goes on computing meanwhile
    #[arg(long, value_name = "S", default_value_t = 3600.0, value_parser = positive)]
    server_away: f64,
    /// Exit code when it was stopped by a signal or by time, so that whoever starts it can run it again:
    /// 85 is what HTCondor and the guide's batch scripts use
    #[arg(long, value_name = "N", default_value_t = 0)]
    stopped_exit_code: u8,
    /// End when standard input does, as it does for a child whose parent is gone
    #[arg(long)]
    exit_with_parent: bool,
}

impl Arguments {
    /// How long this worker may run: what it is told, and what the allocation leaves but for the margin.
    fn time(&self, left: Option<Duration>) -> Option<Duration> {
        let told = self.max_runtime.map(Duration::from_secs_f64);
        let usable = left.map(|left| left - self.margin(left));
        told.into_iter().chain(usable).min()
    }

    /// How long before the end of an allocation the worker stops, of which so much is left.
    fn margin(&self, left: Duration) -> Duration {
        Duration::from_secs_f64(self.stop_margin).min(left.mul_f64(LARGEST_MARGIN_SHARE))
    }
}

pub(crate) async fn perform(arguments: Arguments) -> Result<ExitCode, Failure> {
    start_log("info");
    let allocation = Allocation::of_slurm();
    let left = allocation.as_ref().and_then(|allocation| allocation.left);
    let max_runtime = arguments.time(left);
    let grace = Duration::from_secs_f64(arguments.grace);
    // who stops by time has the margin for it, until a signal says otherwise
    let margin = left.map_or(grace, |left| arguments.margin(left).max(grace));
    if let Some(Allocation { id, left, .. }) = &allocation {
        let [left_s, runs_s] = [*left, max_runtime].map(|time| time.map(|time| time.as_secs()));
        tracing::info!(%id, ?left_s, ?runs_s, "in a Slurm allocation");
    }
    let options = WorkerOptions {
        engine: ENGINE,
        server: arguments.connection.client()?,
        heartbeat_server: arguments.connection.client()?,
        name: arguments.name.unwrap_or_else(host_name),
        threads: arguments.threads.into(),
        scratch: arguments.scratch.unwrap_or_else(std::env::temp_dir),
        checkpoint_every: Duration::from_secs_f64(arguments.checkpoint_every),
        exit_when_idle: arguments.exit_when_idle.map(Duration::from_secs_f64),
        max_runtime,
        server_away: Duration::from_secs_f64(arguments.server_away),
        memory_mb: allocation.and_then(|allocation| allocation.memory_mb),
    };
    let stop = worker_stop_signal();
    let worker = tokio::task::spawn_blocking(|| Worker::prepare(options));
    let worker = worker.await.map_err(|error| Failure::of(&error))?;
    let worker = worker.map_err(failure)?;
    let (shutdown, told) = (worker.shutdown(), CancellationToken::new());
    tokio::spawn({
        let (shutdown, told) = (shutdown.clone(), told.clone());
        async move {
            tokio::select! {
                () = stop => {}
                () = end_of_input(), if arguments.exit_with_parent => {}
            }
            told.cancel();
            shutdown.cancel();
        }
    });
    let too_late = async {
        shutdown.cancelled().await;
        let signalled = async {
            told.cancelled().await;
            tokio::time::sleep(grace).await;
        };
        tokio::select! {
            () = signalled => {}
            () = tokio::time::sleep(margin) => {}
        }
    };
    let stopped = ExitCode::from(arguments.stopped_exit_code);
    tokio::select! {
        end = worker.work() => Ok(match end.map_err(failure)? {
            WorkerEnd::Idle => {
                tracing::info!("no job came: ending");
                ExitCode::SUCCESS
            }
            WorkerEnd::TimeOver => {
                tracing::info!("its time is over");
                stopped
            }
            WorkerEnd::Stopped => {
                tracing::info!("stopped");
                stopped
            }
        }),
        () = too_late => {
            tracing::warn!("the job could not be given back in time; its lease will end");
            Ok(stopped)
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Debug, Parser)]
    struct Line {
        #[command(flatten)]
        arguments: Arguments,
    }

    fn runs(options: &[&str], left_s: Option<u64>) -> Option<u64> {
        let line = Line::parse_from(["worker"].iter().chain(options));
        let time = line.arguments.time(left_s.map(Duration::from_secs));
        time.map(|time| time.as_secs())
    }

    #[test]
    fn a_worker_ends_by_whatever_comes_first_and_leaves_the_margin() {
        assert_eq!(runs(&[], None), None);
        assert_eq!(runs(&["--max-runtime", "60"], None), Some(60));
        // 3600 - 120, 3600 - 300
        assert_eq!(runs(&[], Some(3600)), Some(3480));
        assert_eq!(runs(&["--stop-margin", "300"], Some(3600)), Some(3300));
        assert_eq!(runs(&["--max-runtime", "60"], Some(3600)), Some(60));
        // a quarter of a minute, not two minutes of it
        assert_eq!(runs(&[], Some(60)), Some(45));
    }
}
