//! A `loadframe worker` process.
use crate::{Client, Process, Server, loadframe, until};
use loadframe_api::JobView;
use nix::sys::signal::Signal;

/// A worker process with a label of its own, by which the server's records name it.
#[derive(Debug)]
pub struct Worker {
    pub process: Process,
    pub name: String,
}

impl Worker {
    pub fn start(server: &Server, name: &str) -> Self {
        Self::start_through(server, &server.url, name)
    }

    /// Starts a worker that reaches the server at `url`, such as a [`crate::Relay`]'s.
    pub fn start_through(server: &Server, url: &str, name: &str) -> Self {
        Self::start_with(server, url, name, &[])
    }

    /// Starts a worker with further options of `worker`.
    pub fn start_with(server: &Server, url: &str, name: &str, options: &[&str]) -> Self {
        let mut command = loadframe();
        command.args(["worker", "--server", url, "--name", name, "--threads", "1"]);
        // several checkpoints even in jobs of a second
        command.args(["--checkpoint-every", "0.2"]).args(options);
        let process = Process::start(command, server.folder().join(format!("{name}.log")));
        Self {
            process,
            name: name.to_owned(),
        }
    }

    /// Stops it by plan, and waits until it has handed back what it held.
    pub fn retire(mut self) {
        self.process.signal(Signal::SIGTERM);
        until("the worker has ended", || self.process.ended());
    }

    /// The job this worker holds, by the server's records.
    pub fn job(&self, client: &Client) -> Option<JobView> {
        let running = client.jobs("status=running");
        running.into_iter().find(|job| self.holds(job))
    }

    /// Whether the job's current attempt is this worker's.
    pub fn holds(&self, job: &JobView) -> bool {
        let last = job.attempts.last();
        last.is_some_and(|attempt| attempt.worker == self.name && attempt.ended_at.is_none())
    }
}
