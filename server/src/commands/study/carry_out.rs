//! What all studies have in common: options, progress, files, words.
use std::path::PathBuf;

use clap::Args;
use loadframe_run::available_threads;
use loadframe_study::{Design, Findings, StudyEnd, StudyOptions, run};

use crate::commands::engine::ENGINE;
use crate::commands::failure::{Code, Failure};
use crate::commands::memory::MemoryCheck;
use crate::commands::progress::ProgressDisplay;
use crate::commands::signals::stop_switch;
use crate::commands::terminal::{print_json, print_line, span};

#[derive(Debug, Args)]
pub(super) struct Options {
    /// Folder for tables and plot; an interrupted study goes on there
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Tests side by side; all cores if left out
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    threads: Option<u16>,
    #[command(flatten)]
    memory: MemoryCheck,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// Runs a study, writes its files and says what it found.
pub(super) fn carry_out<D>(design: D, title: &str, options: Options) -> Result<(), Failure>
where
    D: Design,
{
    let switch = stop_switch();
    let threads = options.threads.map_or_else(available_threads, usize::from);
    options.memory.admit(&design.settings().estimate(threads))?;
    let how = StudyOptions {
        engine: ENGINE,
        threads,
        folder: &options.out,
        switch: &switch,
    };
    let mut display = ProgressDisplay::start(title);
    let end = run(&design, how, &mut |progress| display.show(&progress));
    display.end();
    let folder = options.out.display();
    let StudyEnd::Finished(study) = end.map_err(|error| Failure::of(&error))? else {
        let message = format!("stopped; {folder} holds what is done, and the same command goes on");
        return Err(Failure::new(Code::Interrupted, message));
    };
    study
        .write(&options.out)
        .map_err(|error| Failure::of(&error))?;
    if options.json {
        return print_json(&study);
    }
    print_line(&study.text());
    let files = match D::Findings::FILES {
        [others @ .., last] => format!("{} and {last}", others.join(", ")),
        [] => String::new(),
    };
    let cost = span(study.total_cpu_s());
    print_line(&format!(
        "{cost} of processor time. {files} are in {folder}"
    ));
    Ok(())
}
