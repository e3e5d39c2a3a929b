//! `loadframe study`: many runs of one spec, for what they say together.
mod accuracy;

use clap::Subcommand;

use super::failure::Failure;

#[derive(Debug, Subcommand)]
pub(crate) enum Study {
    /// Run a spec at many settings: the error of each against the finest, and its price
    Accuracy(accuracy::Arguments),
}

pub(crate) async fn perform(study: Study) -> Result<(), Failure> {
    match study {
        Study::Accuracy(arguments) => accuracy::perform(arguments).await,
    }
}
