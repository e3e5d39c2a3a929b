//! The commands of the `loadframe` executable, one file each.
//!
//! `lab`, `serve` and `worker` are the service; `run`, `study`, `validate`, `kinds`, `example` and `schema`
//! need no server; all others speak REST with one. What a command prints for people can be had as
//! JSON with `--json`; how it ended is its exit code ([`failure::Code`]).
mod autoscale;
mod backup;
mod connection;
mod database;
mod engine;
mod failure;
mod fetch;
mod files;
mod follow;
mod job;
mod kinds;
mod lab;
mod list;
mod memory;
mod move_store;
mod number;
mod people;
mod progress;
mod results;
mod run;
mod scrub;
mod secret;
mod serve;
mod signals;
mod source;
mod study;
mod submit;
mod terminal;
mod token;
mod validate;
mod watch;
mod worker;

use std::process::ExitCode;
use std::time::Duration;

use clap::{Parser, Subcommand};
use failure::{Code, Failure};

/// How long threads that still work may hold up the end of the process.
const LAST_MOMENTS: Duration = Duration::from_millis(100);

const AFTER_HELP: &str = "\
Exit codes: 0 done, 1 the job has no result or the server refused, 2 wrong usage or an invalid spec,
3 the server cannot be reached, 4 the job was cancelled, 5 interrupted (the same command goes on).

LOADFRAME_LOG sets what is logged to standard error: error, warn, info, debug, or per module.

The guide is served with the lab page, at http://127.0.0.1:8400/guide; its texts are in server/guide.";

/// The virtual load frame of a materials lab.
#[derive(Debug, Parser)]
#[command(name = "loadframe", version = engine::VERSION, after_help = AFTER_HELP, max_term_width = 100)]
struct CommandLine {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run everything on this machine: server, page and workers
    Lab(lab::Arguments),
    /// Run the server of a lab; workers come from other processes and machines
    Serve(serve::Arguments),
    /// Run jobs for a server
    Worker(worker::Arguments),
    /// Start workers on a batch system while jobs wait
    #[command(subcommand)]
    Autoscale(autoscale::Autoscale),
    #[command(flatten)]
    Here(Here),
    /// Submit a job
    Submit(submit::Arguments),
    /// Follow a job to its end
    Watch(watch::Arguments),
    /// Fetch the result files of a job
    Fetch(fetch::Arguments),
    /// Cancel a job
    Cancel(job::Arguments),
    /// Set a job aside with its checkpoint
    Pause(job::Arguments),
    /// Go on with a paused job
    Resume(job::Arguments),
    /// Run a job again that has no result
    Retry(job::Arguments),
    /// List jobs, newest first
    List(list::Arguments),
    /// Make a server a group's, beside it
    People(people::Arguments),
    /// Manage access tokens, beside the server
    Token(token::Arguments),
    /// Copy a server's database and files to an empty folder, while it may be running
    Backup(backup::BackupArguments),
    /// Bring a backup to an empty folder
    Restore(backup::RestoreArguments),
    /// Copy the database of a lab to PostgreSQL, or back, and compare every value
    MoveStore(move_store::Arguments),
    /// Hold every stored file against its SHA-256, beside a server that may be running
    Scrub(scrub::Arguments),
}

// What needs no server, and no threads that wait for one: to start these takes longer than a small job. No doc
// comment: it would be that of the whole command line.
#[derive(Debug, Subcommand)]
enum Here {
    /// Run a job here, without a server
    Run(run::Arguments),
    /// Find out what exactness costs, or what parameters do
    #[command(subcommand)]
    Study(study::Study),
    /// Check a spec, and estimate what it takes
    Validate(validate::Arguments),
    /// List the kinds of jobs
    Kinds(kinds::KindsArguments),
    /// Print an example job
    Example(kinds::ExampleArguments),
    /// Print the JSON Schema of a kind's spec
    Schema(kinds::SchemaArguments),
}

/// Runs the command this process was called with.
pub(crate) fn main() -> ExitCode {
    let command = match CommandLine::parse().command {
        Command::Here(command) => {
            return match perform_here(command) {
                Ok(()) => ExitCode::SUCCESS,
                Err(failure) => report(&failure),
            };
        }
        command => command,
    };
    let runtime = match tokio::runtime::Runtime::new() {
        Ok(runtime) => runtime,
        Err(error) => return report(&Failure::new(Code::Failed, error.to_string())),
    };
    let end = runtime.block_on(perform(command));
    // a simulation that does not stop in time is not waited for; its lease or checkpoint covers it
    runtime.shutdown_timeout(LAST_MOMENTS);
    match end {
        Ok(code) => code,
        Err(failure) => report(&failure),
    }
}

fn report(failure: &Failure) -> ExitCode {
    terminal::print_error(&failure.to_string());
    failure.exit_code()
}

fn perform_here(command: Here) -> Result<(), Failure> {
    match command {
        Here::Run(arguments) => run::perform(arguments),
        Here::Study(study) => study::perform(study),
        Here::Validate(arguments) => validate::perform(&arguments),
        Here::Kinds(arguments) => kinds::list(arguments),
        Here::Example(arguments) => kinds::example(&arguments),
        Here::Schema(arguments) => kinds::schema(arguments),
    }
}

async fn perform(command: Command) -> Result<ExitCode, Failure> {
    match command {
        Command::Here(command) => perform_here(command),
        Command::Worker(arguments) => return worker::perform(arguments).await,
        Command::Lab(arguments) => lab::perform(arguments).await,
        Command::Serve(arguments) => serve::perform(arguments).await,
        Command::Autoscale(autoscale) => autoscale::perform(autoscale).await,
        Command::Submit(arguments) => submit::perform(arguments).await,
        Command::Watch(arguments) => watch::perform(arguments).await,
        Command::Fetch(arguments) => fetch::perform(arguments).await,
        Command::Cancel(arguments) => job::perform(arguments, "cancel").await,
        Command::Pause(arguments) => job::perform(arguments, "pause").await,
        Command::Resume(arguments) => job::perform(arguments, "resume").await,
        Command::Retry(arguments) => job::perform(arguments, "retry").await,
        Command::List(arguments) => list::perform(arguments).await,
        Command::People(arguments) => people::perform(arguments).await,
        Command::Token(arguments) => token::perform(arguments).await,
        Command::Backup(arguments) => backup::back_up(arguments).await,
        Command::Restore(arguments) => backup::bring_back(arguments).await,
        Command::MoveStore(arguments) => move_store::perform(arguments).await,
        Command::Scrub(arguments) => scrub::perform(arguments).await,
    }?;
    Ok(ExitCode::SUCCESS)
}
