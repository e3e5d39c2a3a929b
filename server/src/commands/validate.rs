//! `loadframe validate`
use clap::Args;
use loadframe_api::Submission;
use loadframe_run::calibrate;
use serde_json::{Value, json};

use super::failure::Failure;
use super::source::SpecArgument;
use super::terminal::{print_json, print_line, size, span};

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    spec: SpecArgument,
    /// Print what was found as JSON
    #[arg(long)]
    json: bool,
}

pub(crate) fn perform(arguments: &Arguments) -> Result<(), Failure> {
    let source = arguments.spec.read()?;
    let submission = match Submission::from_slice(&source.text) {
        Ok(submission) => submission,
        Err(error) => {
            let failure = source.refusal(&error);
            if arguments.json {
                print_json(&error.into_problem())?;
            }
            return Err(failure);
        }
    };
    // a spec is checked in a moment, so a moment more is spent on an estimate that holds here
    let calibration = calibrate();
    let estimate = submission.estimate(calibration);
    if arguments.json {
        let spec: Value = serde_json::from_str(&submission.spec.to_json()).unwrap_or_default();
        return print_json(&json!({"valid": true, "spec": spec,
            "spec_sha256": submission.spec.sha256(), "estimate": estimate, "calibration": calibration}));
    }
    print_line(&format!(
        "{} is a valid {} job.",
        submission.name,
        submission.spec.kind()
    ));
    let on_threads = (estimate.threads_wall_s.zip(submission.threads))
        .map(|(time, threads)| format!(", {} on {threads}", span(time)))
        .unwrap_or_default();
    print_line(&format!(
        "About {} on one core{}{on_threads}, {} of memory, {} of files.",
        span(estimate.wall_s),
        if calibration.is_some() {
            " of this machine"
        } else {
            ""
        },
        size(estimate.memory_mb),
        size(estimate.disk_mb),
    ));
    Ok(())
}
