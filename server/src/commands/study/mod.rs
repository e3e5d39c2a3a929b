//! `loadframe study`: many runs of one job, for what they say together.
mod accuracy;
mod carry_out;
mod parameters;

use clap::Subcommand;

use super::failure::Failure;

#[derive(Debug, Subcommand)]
pub(crate) enum Study {
    /// Run a spec at many settings: the error of each against the finest, and its price
    Accuracy(accuracy::Arguments),
    /// Run the cases of a study file: means, intervals and what differs between them
    Parameters(parameters::Arguments),
}

pub(crate) fn perform(study: Study) -> Result<(), Failure> {
    match study {
        Study::Accuracy(arguments) => accuracy::perform(arguments),
        Study::Parameters(arguments) => parameters::perform(arguments),
    }
}
