//! `loadframe study accuracy`: what exactness costs.
use std::path::PathBuf;

use clap::Args;
use loadframe_worker::available_threads;
use loadframe_worker::study::{
    CSV_FILE, Design, JSON_FILE, Request, SVG_FILE, StudyEnd, StudyOptions, run, words, write,
};

use crate::commands::failure::{Code, Failure};
use crate::commands::progress::ProgressDisplay;
use crate::commands::signals::stop_switch;
use crate::commands::source::SpecArgument;
use crate::commands::terminal::{say, say_json, span};

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    spec: SpecArgument,
    /// Folder for accuracy.csv, accuracy.json and accuracy.svg; an interrupted study goes on there
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Vary this knob only, over these values or its own; may be given several times. Without it,
    /// all knobs of the kind are varied, one at a time
    #[arg(long = "knob", value_name = "NAME[=V,V,...]", value_parser = request)]
    knobs: Vec<Request>,
    /// Specimens at each setting: the same seeds everywhere, from the spec's own on
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    seeds: u32,
    /// Tests side by side; all cores if left out
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    threads: Option<u16>,
    /// Print accuracy.json
    #[arg(long)]
    json: bool,
}

/// `force_accuracy=5,100` or `force_accuracy`.
fn request(text: &str) -> Result<Request, String> {
    let (knob, values) = text.split_once('=').unwrap_or((text, ""));
    let values: Vec<String> = values
        .split(',')
        .map(|value| value.trim().to_owned())
        .filter(|value| !value.is_empty())
        .collect();
    if text.contains('=') && values.is_empty() {
        return Err("there is no value after the =".to_owned());
    }
    Ok(Request {
        knob: knob.trim().to_owned(),
        values,
    })
}

pub(crate) async fn perform(arguments: Arguments) -> Result<(), Failure> {
    let submission = arguments.spec.read()?.submission()?;
    let design = Design::new(&submission.spec, &arguments.knobs, arguments.seeds)
        .map_err(|error| Failure::new(Code::Usage, error.to_string()))?;
    let switch = stop_switch();
    let out = arguments.out.clone();
    let threads = arguments
        .threads
        .map_or_else(available_threads, usize::from);
    let study = tokio::task::spawn_blocking(move || {
        let mut display = ProgressDisplay::start(&format!("Accuracy of {}", submission.name));
        let options = StudyOptions {
            threads,
            folder: &out,
            switch: &switch,
        };
        let end = run(&design, options, &mut |progress| display.show(&progress));
        display.end();
        end
    });
    let folder = arguments.out.display();
    let end = study.await.map_err(|error| Failure::of(&error))?;
    let StudyEnd::Finished(study) = end.map_err(|error| Failure::of(&error))? else {
        let message =
            format!("stopped; {folder} holds the finished tests, and the same command goes on");
        return Err(Failure::new(Code::Interrupted, message));
    };
    write(&study, &arguments.out).map_err(|error| Failure::of(&error))?;
    if arguments.json {
        return say_json(&study);
    }
    say(&words(&study));
    say(&format!(
        "{} of processor time. {CSV_FILE}, {JSON_FILE} and {SVG_FILE} are in {folder}",
        span(study.total_cpu_s)
    ));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn knobs_are_given_with_values_or_without() {
        let values = |text| request(text).map(|request| (request.knob, request.values.join("|")));
        let parsed = |knob: &str, values: &str| Ok((knob.to_owned(), values.to_owned()));
        assert_eq!(values("solver"), parsed("solver", ""));
        assert_eq!(values("a=5, 1e3,"), parsed("a", "5|1e3"));
        assert!(request("a=").is_err());
    }
}
