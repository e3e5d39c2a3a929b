//! The worker processes of a lab.
use std::io;
use std::path::PathBuf;
use std::process::Stdio;
use std::time::{Duration, Instant};

use tokio::process::{Child, Command};
use tokio::task::JoinSet;
use tokio_util::sync::CancellationToken;

use super::super::secret::TOKEN;

/// Pause before a worker that died is started again, doubled each time up to the longest.
const FIRST_PAUSE: Duration = Duration::from_millis(500);
const LONGEST_PAUSE: Duration = Duration::from_secs(30);
/// A worker that lived so long was healthy: the next pause is short again.
const HEALTHY: Duration = Duration::from_secs(60);
/// A worker told to stop has so long to save its job.
const GRACE: Duration = Duration::from_secs(12);

/// Worker processes, kept alive until stopped.
#[derive(Debug)]
pub(super) struct Children {
    supervisors: JoinSet<()>,
    stop: CancellationToken,
}

/// What a worker process is started with.
#[derive(Clone, Debug)]
struct WorkerCommand {
    executable: PathBuf,
    name: String,
    threads: u16,
    server: String,
    token: String,
}

impl Children {
    /// # Errors
    /// When this process's own executable cannot be found.
    pub(super) fn start(
        count: usize,
        threads: u16,
        server: &str,
        token: String,
    ) -> io::Result<Self> {
        // asked once: after an update of the file its name would no longer be known
        let executable = std::env::current_exe()?;
        let stop = CancellationToken::new();
        let mut supervisors = JoinSet::new();
        for number in 1..=count {
            let command = WorkerCommand {
                executable: executable.clone(),
                name: format!("lab-{number}"),
                threads,
                server: server.to_owned(),
                token: token.clone(),
            };
            supervisors.spawn(supervise(command, stop.clone()));
        }
        Ok(Self { supervisors, stop })
    }

    /// Lets all workers save their jobs and end.
    pub(super) async fn stop(self) {
        self.stop.cancel();
        self.supervisors.join_all().await;
    }
}

async fn supervise(command: WorkerCommand, stop: CancellationToken) {
    let mut pause = FIRST_PAUSE;
    while !stop.is_cancelled() {
        let started = Instant::now();
        match command.start() {
            Ok(mut child) => {
                // `wait` would close the child's input, which tells it to stop
                let lifeline = child.stdin.take();
                tokio::select! {
                    end = child.wait() => match end {
                        // told to stop by the terminal, like this process
                        Ok(status) if status.success() => {}
                        end => tracing::warn!(worker = %command.name, ?end, "a worker died and is started again"),
                    },
                    () = stop.cancelled() => {
                        drop(lifeline);
                        return end(child).await;
                    }
                }
            }
            Err(error) => {
                tracing::error!(worker = %command.name, %error, "a worker could not be started");
            }
        }
        if started.elapsed() >= HEALTHY {
            pause = FIRST_PAUSE;
        }
        tokio::select! {
            () = tokio::time::sleep(pause) => {}
            () = stop.cancelled() => return,
        }
        pause = (2 * pause).min(LONGEST_PAUSE);
    }
}

/// Waits for a worker that has been told to stop by the end of its input.
async fn end(mut child: Child) {
    if tokio::time::timeout(GRACE, child.wait()).await.is_err() {
        let _ = child.kill().await;
    }
}

impl WorkerCommand {
    fn start(&self) -> io::Result<Child> {
        let mut process = Command::new(&self.executable);
        process
            .args(["worker", "--exit-with-parent"])
            .args(["--server", &self.server])
            .args(["--name", &self.name])
            .args(["--threads", &self.threads.to_string()])
            // held open by this process: when it dies, however it dies, its workers see the end
            .stdin(Stdio::piped());
        if std::env::var_os("LOADFRAME_LOG").is_none() {
            process.env("LOADFRAME_LOG", "warn");
        }
        process.env(TOKEN, &self.token);
        process.spawn()
    }
}
