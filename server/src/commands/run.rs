//! `loadframe run`: a job without a server.
use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use loadframe_api::Calibration;
use loadframe_run::{DirectoryEnd, DirectoryError, DirectoryOptions, RunUpdate, run_to_directory};

use super::engine::ENGINE;
use super::failure::{Code, Failure};
use super::memory::MemoryCheck;
use super::number::positive;
use super::progress::ProgressDisplay;
use super::results;
use super::signals::stop_switch;
use super::source::SpecArgument;
use super::terminal::{print_json, print_line};

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    spec: SpecArgument,
    /// Folder for the result files; an interrupted run goes on there
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Threads to use; the result does not depend on it
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=4096))]
    threads: u16,
    /// Seconds between checkpoints
    #[arg(long, value_name = "S", default_value_t = 20.0, value_parser = positive)]
    checkpoint_every: f64,
    #[command(flatten)]
    memory: MemoryCheck,
    /// Print outcome.json
    #[arg(long)]
    json: bool,
}

pub(crate) fn perform(arguments: Arguments) -> Result<(), Failure> {
    let source = arguments.spec.read()?;
    let submission = source.submission()?;
    let estimate = submission.spec.estimate(&Calibration::default());
    arguments.memory.admit(&estimate)?;
    let switch = stop_switch();
    let options = DirectoryOptions {
        engine: ENGINE,
        threads: arguments.threads.into(),
        checkpoint_every: Duration::from_secs_f64(arguments.checkpoint_every),
        switch: &switch,
    };
    let mut display = ProgressDisplay::start(&submission.name);
    let end = run_to_directory(
        &submission.spec,
        &arguments.out,
        options,
        &mut |update| match update {
            RunUpdate::Progress(progress) => display.show(&progress),
            RunUpdate::Log(message) => display.log(message),
        },
    );
    display.end();
    let folder = arguments.out.display();
    let outcome = match end {
        Ok(DirectoryEnd::Finished(outcome)) => outcome,
        Ok(DirectoryEnd::AlreadyThere(outcome)) => {
            if !arguments.json {
                print_line(&format!("{folder} held the result of this spec already."));
            }
            outcome
        }
        Ok(DirectoryEnd::Suspended) => {
            let message =
                format!("stopped; {folder} holds a checkpoint, and the same command goes on");
            return Err(Failure::new(Code::Interrupted, message));
        }
        Err(
            error @ (DirectoryError::Occupied(_)
            | DirectoryError::Stale { .. }
            | DirectoryError::InUse(_)),
        ) => {
            return Err(Failure::new(Code::Usage, error.to_string()));
        }
        Err(error) => return Err(Failure::of(&error)),
    };
    if arguments.json {
        return print_json(&outcome);
    }
    results::show(&outcome);
    print_line(&format!("\n{} files in {folder}", outcome.files.len() + 1));
    Ok(())
}
