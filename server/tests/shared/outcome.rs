//! What a worker played by hand says of a run.
use loadframe_api::worker::Lease;
use loadframe_api::{FileEntry, JobSpec, Outcome, Quantity, Report};
use loadframe_run::{Circumstances, Engine, Spent, assemble};

/// What a worker says of a run that found one result.
pub(crate) fn outcome(lease: &Lease, files: &[FileEntry]) -> Outcome {
    let spec = JobSpec::from_json(lease.kind, lease.spec.get()).expect("a checked spec");
    let force = Quantity::new(12.5, "N", "largest force");
    let report = Report {
        stop_reason: "max_strain".to_owned(),
        summary: [("max_force".to_owned(), force)].into_iter().collect(),
        ..Report::default()
    };
    let circumstances = Circumstances {
        engine: Engine {
            version: "1",
            commit: "unknown",
        },
        threads: 1,
        started_at: "2026-11-21T09:00:00Z".to_owned(),
        spent: Spent::default(),
    };
    let mut outcome = assemble(&spec, report, circumstances, files.to_vec());
    // that of this process grows from test to test; outcomes of equal runs have equal bytes here
    outcome.cost.peak_memory_mb = Default::default();
    outcome
}
