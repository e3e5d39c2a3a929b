//! `outcome.json`: the simulation's report with cost, provenance and the list of files.
use loadframe_api::{Cost, FileEntry, JobSpec, Outcome, OutcomeStatus, Provenance, Report};

use super::cost::Spent;
use super::engine::Engine;
use super::machine::{host_name, peak_memory_mb};

/// Name of the file that describes all others.
pub const OUTCOME_FILE: &str = "outcome.json";

/// Where and when a run took place.
#[derive(Clone, Debug)]
pub struct Circumstances {
    /// What computed.
    pub engine: Engine,
    pub threads: usize,
    /// RFC 3339.
    pub started_at: String,
    /// Over all attempts.
    pub spent: Spent,
}

/// The outcome of a run of `spec` that gave `report` and `files`. Public for those who stand in for a run.
pub fn assemble(
    spec: &JobSpec,
    report: Report,
    circumstances: Circumstances,
    files: Vec<FileEntry>,
) -> Outcome {
    let threads = u32::try_from(circumstances.threads).unwrap_or(u32::MAX);
    Outcome {
        kind: spec.kind(),
        status: OutcomeStatus::Succeeded,
        stop_reason: report.stop_reason,
        summary: report.summary,
        quality: report.quality,
        cost: Cost {
            wall_s: circumstances.spent.wall_s,
            cpu_s: circumstances.spent.cpu_s,
            threads,
            peak_memory_mb: peak_memory_mb(),
            work: report.work,
        },
        provenance: Provenance {
            spec_sha256: spec.sha256(),
            engine_version: circumstances.engine.version.to_owned(),
            engine_commit: circumstances.engine.commit.to_owned(),
            seed: spec.seed(),
            threads,
            started_at: circumstances.started_at,
            host: host_name(),
        },
        warnings: report.warnings,
        bodies: report.bodies,
        files,
    }
}
