//! Running a job for its report alone.
use std::io::{self, Write};

use loadframe_api::{JobSpec, Report};
use loadframe_physics::{Ending, Recorder, RunContext, Uninterrupted, simulate};

/// The report of a job, `None` where it has none.
pub(crate) fn report(job: &JobSpec) -> Option<Report> {
    told(job).map(|(report, _)| report)
}

/// The report of a job and what it said to its log.
pub(crate) fn told(job: &JobSpec) -> Option<(Report, Vec<String>)> {
    let mut log = Log::default();
    let context = RunContext {
        threads: 1,
        interrupt: &Uninterrupted,
        checkpoint: None,
    };
    match simulate(job, context, &mut log) {
        Ok(Ending::Finished(report)) => Some((report, log.0)),
        _ => None,
    }
}

/// What a result was found to be.
pub(crate) fn value(report: &Report, name: &str) -> Option<f64> {
    report.summary.get(name)?.value
}

/// A recorder that keeps nothing but its log.
#[derive(Default)]
struct Log(Vec<String>);

impl Recorder for Log {
    fn columns(&mut self, _: &[&str]) -> io::Result<()> {
        Ok(())
    }

    fn point(&mut self, _: &[f64]) -> io::Result<()> {
        Ok(())
    }

    fn file(
        &mut self,
        _: &str,
        write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        write(&mut io::sink())
    }

    fn progress(&mut self, _: f64, _: &str) {}

    fn log(&mut self, message: &str) {
        self.0.push(message.to_owned());
    }

    fn checkpoint_due(&self) -> bool {
        false
    }

    fn checkpoint(&mut self, _: &[u8]) -> io::Result<()> {
        Ok(())
    }
}
