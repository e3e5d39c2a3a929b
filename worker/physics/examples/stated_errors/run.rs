//! Running a job for its report alone.
use loadframe_api::{JobSpec, Report};
use loadframe_physics::{
    Decorator, Ending, Recorder, RunContext, Uninterrupted, Unrecorded, simulate,
};

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
        Ok(Ending::Finished(report)) => Some((report, log.lines)),
        _ => None,
    }
}

/// What a result was found to be.
pub(crate) fn value(report: &Report, name: &str) -> Option<f64> {
    report.summary.get(name)?.value
}

/// A recorder that keeps nothing but its log.
#[derive(Default)]
struct Log {
    lines: Vec<String>,
    rest: Unrecorded,
}

impl Decorator for Log {
    fn inner(&self) -> &dyn Recorder {
        &self.rest
    }

    fn inner_mut(&mut self) -> &mut dyn Recorder {
        &mut self.rest
    }

    fn log(&mut self, message: &str) {
        self.lines.push(message.to_owned());
    }
}
