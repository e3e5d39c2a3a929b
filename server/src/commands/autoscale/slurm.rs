//! `loadframe autoscale slurm`
use std::time::Duration;

use clap::Args;
use loadframe_api::allocations::{AllocationReport, AllocationView, Backlog, MOST_ALLOCATIONS};
use loadframe_client::{ServerClient, ServerError};
use loadframe_run::host_name;
use reqwest::Method;

use super::super::connection::Connection;
use super::super::failure::{Code, Failure};
use super::super::number::positive;
use super::super::signals::stop_signal;
use super::super::terminal::{print_line, start_log};
use super::plan::{Allocation, requests};
use super::sbatch::{self, Submission};

/// Refusals in a row after which nothing more is asked for.
const REFUSALS: u32 = 3;
/// Longest text that the server takes of a trouble and of a reason [characters].
const LONGEST_TROUBLE: usize = 2000;
const LONGEST_REASON: usize = 500;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    connection: Connection,
    /// Partition to submit to; Slurm's default one when left out
    #[arg(long, value_name = "NAME")]
    partition: Option<String>,
    /// Account to charge
    #[arg(long, value_name = "NAME")]
    account: Option<String>,
    /// Allocations at once, those that wait for nodes included
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=1000))]
    max_workers: u32,
    /// Longest time of an allocation in seconds; shorter ones are asked for where estimates allow
    #[arg(long, value_name = "S", default_value_t = 3600.0, value_parser = positive)]
    time: f64,
    /// Cores and threads of each worker
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=4096))]
    threads: u16,
    /// Seconds between two looks
    #[arg(long, value_name = "S", default_value_t = 30.0, value_parser = positive)]
    every: f64,
    /// Name of the Slurm jobs, by which this command knows its own
    #[arg(long, value_name = "NAME", default_value = "loadframe")]
    job_name: String,
    /// What runs a worker on a node, as in a shell, such as "apptainer exec loadframe.sif loadframe"; this
    /// executable when left out
    #[arg(long, value_name = "COMMAND")]
    program: Option<String>,
    /// Where Slurm writes what a worker says
    #[arg(long, value_name = "PATTERN", default_value = "loadframe-%A_%a.log")]
    output: String,
    /// A further option for sbatch, such as --sbatch=--qos=low; may be repeated
    #[arg(long, value_name = "OPTION", allow_hyphen_values = true)]
    sbatch: Vec<String>,
    /// Print what would be submitted now, and end
    #[arg(long)]
    dry_run: bool,
    /// Look once, submit, and end
    #[arg(long)]
    once: bool,
    /// Options for the workers, after --
    #[arg(last = true, value_name = "WORKER OPTIONS")]
    worker: Vec<String>,
}

pub(crate) async fn perform(arguments: Arguments) -> Result<(), Failure> {
    start_log("info");
    let server = arguments.connection.client()?;
    let mut scaler = Scaler {
        source: arguments.source(),
        server,
        submission: arguments.submission()?,
        limit: arguments.max_workers,
        longest: Duration::from_secs_f64(arguments.time),
        refusals: 0,
    };
    if arguments.dry_run {
        return scaler.show().await;
    }
    let stop = stop_signal();
    tokio::pin!(stop);
    loop {
        scaler.look().await?;
        if arguments.once {
            return Ok(());
        }
        tokio::select! {
            () = &mut stop => return Ok(()),
            () = tokio::time::sleep(Duration::from_secs_f64(arguments.every)) => {}
        }
    }
}

impl Arguments {
    fn source(&self) -> String {
        let host = host_name();
        let partition = self.partition.as_ref();
        let partition = partition.map_or_else(String::new, |name| format!(", partition {name}"));
        let source = format!("{} in Slurm on {host}{partition}", self.job_name);
        source.chars().take(200).collect()
    }

    fn submission(&self) -> Result<Submission, Failure> {
        let program = match &self.program {
            Some(program) => program.clone(),
            None => {
                let path = std::env::current_exe().map_err(|error| Failure::of(&error))?;
                sbatch::quoted(&path.display().to_string())
            }
        };
        let mut options = self.connection.options_elsewhere()?;
        options.extend(["--threads".to_owned(), self.threads.to_string()]);
        options.extend(self.worker.iter().cloned());
        Ok(Submission {
            job_name: self.job_name.clone(),
            partition: self.partition.clone(),
            account: self.account.clone(),
            threads: self.threads,
            output: self.output.clone(),
            further: self.sbatch.clone(),
            program,
            worker: options,
        })
    }
}

/// Looks and submits.
struct Scaler {
    source: String,
    server: ServerClient,
    submission: Submission,
    limit: u32,
    longest: Duration,
    /// Refusals in a row.
    refusals: u32,
}

impl Scaler {
    /// Prints what would be submitted.
    async fn show(&self) -> Result<(), Failure> {
        let backlog = self.backlog().await?;
        let allocations = match self.allocations().await {
            Ok(allocations) => allocations,
            Err(why) => {
                tracing::warn!(%why, "taken as if there were no allocations");
                Vec::new()
            }
        };
        let wanted = requests(&backlog, &allocations, self.limit, self.longest);
        if wanted.is_empty() {
            let (waiting, held) = (backlog.waiting, allocations.len());
            print_line(&format!(
                "nothing to submit: {waiting} jobs wait, {held} allocations"
            ));
        }
        for request in wanted {
            print_line(&self.submission.shown(&request));
        }
        Ok(())
    }

    /// One look, and what follows from it.
    async fn look(&mut self) -> Result<(), Failure> {
        let backlog = match self.backlog().await {
            Ok(backlog) => backlog,
            Err(error) if error.is_transient() => {
                tracing::warn!(%error, "the server is away");
                return Ok(());
            }
            Err(error) => return Err(error.into()),
        };
        let mut allocations = match self.allocations().await {
            Ok(allocations) => allocations,
            Err(why) => {
                tracing::warn!(%why, "nothing is submitted without knowing what is there");
                return self.report(&[], Some(why)).await;
            }
        };
        let mut trouble = None;
        for request in requests(&backlog, &allocations, self.limit, self.longest) {
            let submission = self.submission.clone();
            match blocking(move || submission.submit(&request)).await {
                Ok(id) => {
                    self.refusals = 0;
                    tracing::info!(%id, count = request.count, memory_mb = request.memory_mb,
                        time_s = request.time.as_secs(), waiting = backlog.waiting, "submitted");
                    // the list of the next look has them; until then the page should, too
                    allocations.extend((0..request.count).map(|task| Allocation {
                        id: format!("{id}_{task}"),
                        state: "PENDING".to_owned(),
                        reason: None,
                        ran: Duration::ZERO,
                        memory_mb: request.memory_mb,
                    }));
                }
                Err(why) => {
                    self.refusals += 1;
                    tracing::warn!(%why, refusals = self.refusals, "sbatch refused");
                    trouble = Some(why);
                    break;
                }
            }
        }
        let stops = self.refusals >= REFUSALS;
        let said = trouble.map(|why| match stops {
            true => format!(
                "sbatch refused {REFUSALS} times in a row, so nothing more is submitted: {why}"
            ),
            false => format!("sbatch refused: {why}"),
        });
        self.report(&allocations, said.clone()).await?;
        match said {
            Some(said) if stops => Err(Failure::new(Code::Failed, said)),
            _ => Ok(()),
        }
    }

    async fn backlog(&self) -> Result<Backlog, ServerError> {
        let request = self.server.request(Method::GET, "/v1/worker/backlog");
        self.server.json(request).await
    }

    async fn allocations(&self) -> Result<Vec<Allocation>, String> {
        let name = self.submission.job_name.clone();
        blocking(move || sbatch::allocations(&name)).await
    }

    /// Tells the server; it may be away.
    async fn report(
        &self,
        allocations: &[Allocation],
        trouble: Option<String>,
    ) -> Result<(), Failure> {
        let view = |allocation: &Allocation| AllocationView {
            id: allocation.id.clone(),
            state: allocation.state.clone(),
            reason: allocation
                .reason
                .as_deref()
                .map(|text| cut(text, LONGEST_REASON)),
        };
        let report = AllocationReport {
            source: self.source.clone(),
            allocations: allocations
                .iter()
                .take(MOST_ALLOCATIONS)
                .map(view)
                .collect(),
            trouble: trouble.map(|text| cut(&text, LONGEST_TROUBLE)),
        };
        let request = self.server.request(Method::PUT, "/v1/worker/allocations");
        match self.server.send(request.json(&report)).await {
            Ok(_) => Ok(()),
            Err(error) if error.is_transient() => {
                tracing::warn!(%error, "the server is away");
                Ok(())
            }
            Err(error) => Err(error.into()),
        }
    }
}

fn cut(text: &str, longest: usize) -> String {
    text.chars().take(longest).collect()
}

/// Runs a command of Slurm beside the others.
async fn blocking<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, String> + Send + 'static,
) -> Result<T, String> {
    let done = tokio::task::spawn_blocking(work).await;
    done.unwrap_or_else(|error| Err(error.to_string()))
}
