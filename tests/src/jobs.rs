//! Jobs to submit, and what must hold for every job whatever happened to it.
use crate::{JobFiles, loadframe};
use loadframe_api::{AttemptEnd, AttemptView, JobOutcome, JobView};
use serde_json::{Value, json};
use std::path::Path;

/// Rows, strain step and snapshot interval of a small PET fabric, which set how long a job takes.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    pub points_per_row: u32,
    pub rows: u32,
    pub strain_step: f64,
    pub snapshot_every_steps: u32,
}

/// Done in hundredths of a second.
pub const TINY: Size = Size {
    points_per_row: 3,
    rows: 5,
    strain_step: 0.05,
    snapshot_every_steps: 10,
};

/// Done in about a second, with a dozen files.
pub const SMALL: Size = Size {
    points_per_row: 15,
    rows: 17,
    strain_step: 0.01,
    snapshot_every_steps: 10,
};

/// Takes several seconds, with snapshots, in thousands of steps: long enough to be stopped many
/// times.
pub const LONG: Size = Size {
    points_per_row: 49,
    rows: 51,
    strain_step: 0.0004,
    snapshot_every_steps: 250,
};

/// Takes a minute or so, in ten thousands of steps: not done before a test has had its way with it.
pub const SLOW: Size = Size {
    points_per_row: 49,
    rows: 51,
    strain_step: 0.00002,
    snapshot_every_steps: 0,
};

/// The POST body of a job of this size.
pub fn with_seed(size: Size, seed: u64) -> Value {
    json!({
        "kind": "nonwoven_tensile",
        "name": format!("seed {seed}"),
        "spec": {
            "version": 1,
            "seed": seed,
            "fabric": {"lattice": {
                "points_per_row": size.points_per_row, "rows": size.rows, "layers": 3,
                "spacing_mm": [20, 20, 10], "irregularity": [0.5, 0.5, 0.5],
            }},
            "bond": {
                "modulus_n": 0.399, "friction_modulus_n": 1.473, "compression_stiffness_n": 0.157,
                "mean_strength_n": 3.397, "strength_sigma": 0.365,
            },
            "test": {"strain_step": size.strain_step, "max_strain": 3.0},
            "output": {"snapshot_every_steps": size.snapshot_every_steps},
        },
    })
}

/// What `loadframe run` gives for `body`, undisturbed and without a server.
pub fn run_alone(body: &Value, threads: u32, folder: &Path) -> JobFiles {
    let spec = folder.with_extension("json");
    std::fs::write(&spec, body.to_string()).unwrap();
    let mut command = loadframe();
    command.arg("run").arg(&spec).arg("--out").arg(folder);
    command.args(["--threads", &threads.to_string()]);
    let output = command.output().unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    JobFiles::in_folder(folder)
}

/// How many workers the job has lost.
pub fn losses(job: &JobView) -> usize {
    let lost = |attempt: &&AttemptView| attempt.end_reason == Some(AttemptEnd::Lost);
    job.attempts.iter().filter(lost).count()
}

/// Checks what holds for every finished job: its attempts are numbered in order and follow one
/// another without overlap, all have ended, and a succeeded job was completed exactly once, last.
///
/// # Panics
/// When it does not hold.
#[track_caller]
pub fn is_sound(job: &JobView) {
    for (attempt, number) in job.attempts.iter().zip(1..) {
        assert_eq!(attempt.number, number, "{job:#?}");
        assert!(attempt.end_reason.is_some(), "{job:#?}");
        let Some(ended_at) = attempt.ended_at else {
            panic!("attempt {number} has not ended: {job:#?}")
        };
        assert!(attempt.started_at <= ended_at, "{job:#?}");
    }
    for pair in job.attempts.windows(2) {
        assert!(
            pair[0].ended_at <= Some(pair[1].started_at),
            "two workers held one job: {job:#?}"
        );
    }
    let completed = |attempt: &&AttemptView| attempt.end_reason == Some(AttemptEnd::Completed);
    let expected = usize::from(job.outcome == Some(JobOutcome::Succeeded));
    assert_eq!(
        job.attempts.iter().filter(completed).count(),
        expected,
        "{job:#?}"
    );
    if expected == 1 {
        let last = job.attempts.last().and_then(|attempt| attempt.end_reason);
        assert_eq!(last, Some(AttemptEnd::Completed), "{job:#?}");
    }
}
