//! `loadframe study parameters`: what a file's cases do to the results of a job.
use std::path::PathBuf;

use clap::Args;
use loadframe_api::Message;
use loadframe_api::study::ParameterStudy;
use loadframe_study::parameters::Design;

use super::carry_out::{Options, carry_out};
use crate::commands::failure::{Code, Failure};
use crate::commands::source::Source;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The study as JSON: a job, its cases, the results to be shown; - reads standard input
    #[arg(value_name = "STUDY.json")]
    study: PathBuf,
    /// Specimens of each case, instead of as many as the file says
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    seeds: Option<u32>,
    #[command(flatten)]
    options: Options,
}

pub(crate) fn perform(arguments: Arguments) -> Result<(), Failure> {
    let source = Source::read(&arguments.study)?;
    let study = ParameterStudy::from_slice(&source.text);
    let mut study = study.map_err(|error| source.refusal(&error))?;
    study.seeds = arguments.seeds.unwrap_or(study.seeds);
    let design = Design::new(&study)
        .map_err(|violations| Failure::new(Code::Usage, source.findings(&violations)))?;
    carry_out(design, &study.title, arguments.options)
}
