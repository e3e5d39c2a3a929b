//! `loadframe autoscale`: asks a batch system for machines while jobs wait.
//!
//! It reads the server's backlog and the batch system's list of allocations, submits what is short
//! ([`plan`], [`sbatch`]), tells the server what it sees, and begins again after a pause. It keeps nothing: two of them,
//! or one that was started again, see the same list.
mod plan;
mod sbatch;
mod slurm;

use clap::Subcommand;

use super::failure::Failure;

#[derive(Debug, Subcommand)]
pub(crate) enum Autoscale {
    /// Submit arrays of workers to Slurm for the jobs that wait
    Slurm(slurm::Arguments),
}

pub(crate) async fn perform(autoscale: Autoscale) -> Result<(), Failure> {
    match autoscale {
        Autoscale::Slurm(arguments) => slurm::perform(arguments).await,
    }
}
