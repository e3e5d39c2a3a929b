//! The recorder of a run: physics speaks to it, a [`Destination`] hears of it.
use std::io::{self, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use loadframe_api::{FileEntry, JobSpec, Outcome, Report, Timestamp};
use loadframe_physics::{InterruptSource, Recorder};

use super::cost::CostClock;
use super::engine::Engine;
use super::eta::TimeToGo;
use super::outcome::{Circumstances, OUTCOME_FILE, assemble};
use super::plan::Plan;
use super::result_files::ResultFiles;
use super::results_table::{self, RESULTS_FILE};
use super::saved_run::SavedRun;
use super::spool::Spool;

/// Name of the file that keeps the log.
const LOG_FILE: &str = "log.jsonl";
/// Name of the curve's file, as engines write it at the end.
const CURVE_FILE: &str = "curve.csv";
/// Name of the file that marks the others as those of a run without result.
pub(crate) const FAILURE_FILE: &str = "failure.json";

/// How far a run is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Progress {
    /// Part of the work done, 0 to 1.
    pub fraction: f64,
    pub phase: String,
    /// Estimated time to the end [s].
    pub eta_s: Option<f64>,
}

/// Where a run's results go as they appear. Its calls may wait, and so hold the simulation back.
pub trait Destination {
    /// A curve begins, or begins anew: its points come again from the first.
    fn columns(&mut self, names: &[&str]) -> io::Result<()>;
    fn point(&mut self, values: &[f64]) -> io::Result<()>;
    /// The file at `path` is whole, and now the destination's to keep or move.
    fn file(&mut self, entry: &FileEntry, path: &Path) -> io::Result<()>;
    fn progress(&mut self, progress: Progress);
    fn log(&mut self, message: &str);
    /// Keeps `saved` together with all files so far.
    fn checkpoint(&mut self, saved: SavedRun) -> io::Result<()>;
    /// Whether an earlier checkpoint has been kept, so that another one would not pile up.
    fn takes_checkpoint(&self) -> bool {
        true
    }
}

/// Records a run in a folder.
pub(crate) struct Recording<'a, D> {
    engine: Engine,
    spec_sha256: String,
    started_at: Timestamp,
    clock: CostClock,
    time_to_go: TimeToGo,
    files: ResultFiles,
    log: Vec<String>,
    curve: Option<Spool>,
    checkpoint_every: Duration,
    last_checkpoint: Instant,
    interrupt: &'a dyn InterruptSource,
    destination: &'a mut D,
}

impl<'a, D: Destination> Recording<'a, D> {
    /// A recording by `plan` that goes on from `saved`.
    pub(crate) fn start(plan: Plan<'a>, saved: &SavedRun, destination: &'a mut D) -> Self {
        Self {
            engine: plan.engine,
            spec_sha256: saved.spec_sha256().to_owned(),
            started_at: Timestamp::now(),
            clock: CostClock::start(saved.spent()),
            time_to_go: TimeToGo::default(),
            files: ResultFiles::open(plan.folder, saved.files()),
            log: saved.log().to_vec(),
            curve: None,
            checkpoint_every: plan.checkpoint_every,
            last_checkpoint: Instant::now(),
            interrupt: plan.switch,
            destination,
        }
    }

    /// Writes the last files, `outcome.json` being the very last, and returns the outcome with the
    /// entries of all files.
    pub(crate) fn finish(
        mut self,
        spec: &JobSpec,
        threads: usize,
        report: Report,
    ) -> io::Result<(Outcome, Vec<FileEntry>)> {
        self.file(RESULTS_FILE, &mut |out| results_table::write(out, &report))?;
        self.write_log()?;
        let circumstances = Circumstances {
            engine: self.engine,
            threads,
            started_at: self.started_at.to_string(),
            spent: self.clock.spent(),
        };
        let outcome = assemble(spec, report, circumstances, self.files.entries());
        self.file(OUTCOME_FILE, &mut |out| {
            serde_json::to_writer_pretty(&mut *out, &outcome)?;
            writeln!(out)
        })?;
        Ok((outcome, self.files.entries()))
    }

    /// Writes what a run that failed had until then, beside the files it has written: the curve, the
    /// log, and a file that says why there is no result.
    pub(crate) fn fail(mut self, spec: &JobSpec, reason: &str) -> io::Result<()> {
        let is_written = |file: &FileEntry| file.name == CURVE_FILE;
        if let Some(mut curve) = self.curve.take()
            && !self.files.entries().iter().any(is_written)
        {
            self.file(CURVE_FILE, &mut |out| curve.write(out))?;
        }
        self.log.push(format!("failed: {reason}"));
        self.write_log()?;
        let failure = serde_json::json!({
            "kind": spec.kind(),
            "status": "failed",
            "reason": reason,
            "files": self.files.entries(),
            "spec_sha256": self.spec_sha256,
            "engine_version": self.engine.version,
            "note": "These files are what the run had until it failed; they are no result.",
        });
        self.file(FAILURE_FILE, &mut |out| {
            serde_json::to_writer_pretty(&mut *out, &failure)?;
            writeln!(out)
        })
    }

    fn write_log(&mut self) -> io::Result<()> {
        let log = std::mem::take(&mut self.log);
        self.file(LOG_FILE, &mut |out| {
            for message in &log {
                let line = serde_json::json!({ "message": message });
                writeln!(out, "{line}")?;
            }
            Ok(())
        })
    }
}

impl<D: Destination> Recorder for Recording<'_, D> {
    fn columns(&mut self, names: &[&str]) -> io::Result<()> {
        self.curve = Some(Spool::begin(self.files.folder(), names));
        self.destination.columns(names)
    }

    fn point(&mut self, values: &[f64]) -> io::Result<()> {
        if self
            .curve
            .as_mut()
            .is_some_and(|curve| curve.point(values).is_err())
        {
            // without room for it the run can still come to its end
            self.curve = None;
        }
        self.destination.point(values)
    }

    fn file(
        &mut self,
        name: &str,
        write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        let entry = self.files.write(name, self.interrupt, write)?;
        self.destination.file(&entry, &self.files.path(name))
    }

    fn progress(&mut self, fraction: f64, phase: &str) {
        let fraction = fraction.clamp(0.0, 1.0);
        self.destination.progress(Progress {
            fraction,
            phase: phase.to_owned(),
            eta_s: self.time_to_go.update(self.clock.elapsed(), fraction),
        });
    }

    fn log(&mut self, message: &str) {
        self.log.push(message.to_owned());
        self.destination.log(message);
    }

    fn checkpoint_due(&self) -> bool {
        self.last_checkpoint.elapsed() >= self.checkpoint_every
            && self.destination.takes_checkpoint()
    }

    fn checkpoint(&mut self, bytes: &[u8]) -> io::Result<()> {
        let saved = SavedRun::new(
            self.engine,
            &self.spec_sha256,
            self.clock.spent(),
            self.files.entries(),
            self.log.clone(),
            bytes.to_vec(),
        );
        self.destination.checkpoint(saved)?;
        self.last_checkpoint = Instant::now();
        Ok(())
    }
}
