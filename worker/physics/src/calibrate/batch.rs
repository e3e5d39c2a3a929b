//! New trials side by side: every specimen of each is a test of a [`Plan`](loadframe_harness::plan::Plan).
use std::io::{self, Write};

use indexmap::IndexMap;
use loadframe_api::JobSpec;
use loadframe_harness::{
    Decorator, Ending, Interrupt, Recorder, RunContext, SimulationError,
    checkpoint::CheckpointError,
    plan::{Conclusion, Curve, CurveKeeper, SavedReport, Share, Tests},
};
use serde::{Deserialize, Serialize};

use super::setting::{Setting, in_words};

/// What is kept of a specimen.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Tested {
    /// The numbers that were measured too, NaN where it does not know them.
    pub(super) values: Vec<f64>,
    pub(super) report: Option<SavedReport>,
    /// Of the first specimen of a trial, otherwise empty.
    pub(super) curve: Curve,
    pub(super) work: IndexMap<String, u64>,
    /// Why it has no result.
    pub(super) failure: Option<String>,
}

/// The tests of some trials: all specimens of the first, then of the second, ...
pub(super) struct Batch<'a> {
    setting: Setting<'a>,
    /// The parameters of each trial.
    parameters: Vec<Vec<(&'a str, f64)>>,
}

impl<'a> Batch<'a> {
    pub(super) fn new(setting: Setting<'a>, points: &[Vec<f64>]) -> Self {
        let parameters = points.iter().map(|point| setting.parameters(point));
        Self {
            setting,
            parameters: parameters.collect(),
        }
    }

    /// Number of tests.
    pub(super) fn tests(&self) -> usize {
        self.parameters.len() * self.specimens()
    }

    fn specimens(&self) -> usize {
        self.setting.spec.realisations as usize
    }

    /// The job of test number `test`.
    fn job(&self, test: usize) -> Result<JobSpec, String> {
        let (trial, specimen) = (test / self.specimens(), test % self.specimens());
        let job = self.setting.template.job(&self.parameters[trial]);
        let job = job.map_err(|violations| in_words(&violations))?;
        Ok(job.realisation(self.setting.spec.seed + specimen as u64))
    }

    /// A specimen without result.
    fn unknown(&self, failure: String) -> Conclusion<Tested> {
        Conclusion::Finished(Tested {
            values: vec![f64::NAN; self.setting.targets.all.len()],
            report: None,
            curve: Curve::default(),
            work: IndexMap::new(),
            failure: Some(failure),
        })
    }
}

impl Tests for Batch<'_> {
    type Result = Tested;

    fn share(&self, _test: usize) -> Share {
        Share::Nothing
    }

    fn run(
        &self,
        test: usize,
        context: RunContext<'_>,
        recorder: &mut dyn Recorder,
    ) -> Result<Conclusion<Tested>, SimulationError> {
        let job = match self.job(test) {
            Ok(job) => job,
            Err(violations) => return Ok(self.unknown(violations)),
        };
        let mut keeper = CurveKeeper::new(recorder, usize::MAX);
        let report = match (self.setting.simulate)(&job, context, &mut keeper) {
            Ok(Ending::Finished(report)) => report,
            Ok(Ending::Cancelled) => return Ok(Conclusion::Interrupted(Interrupt::Cancel)),
            Ok(Ending::Suspended) => return Ok(Conclusion::Interrupted(Interrupt::Suspend)),
            // what these parameters do to the job is no failure of the search
            Err(error) if error.is_of_the_spec() => return Ok(self.unknown(error.to_string())),
            Err(error) => return Err(error),
        };
        let curve = keeper.into_curve();
        let is_first = test.is_multiple_of(self.specimens());
        Ok(Conclusion::Finished(Tested {
            values: self.setting.targets.read(&report, &curve)?,
            report: Some(SavedReport::of(&report)?),
            curve: if is_first { curve } else { Curve::default() },
            work: report.work,
            failure: None,
        }))
    }
}

/// What turns the state of a plan into that of the calibration.
type Save<'a> = dyn Fn(&[u8]) -> Result<Vec<u8>, CheckpointError> + 'a;

/// The recorder of a batch: its state becomes part of the calibration's, as does its progress.
pub(super) struct BatchRecorder<'a> {
    pub(super) recorder: &'a mut dyn Recorder,
    pub(super) save: &'a Save<'a>,
    /// Trials before the batch, and in it.
    pub(super) trials: [usize; 2],
    /// Trials at most.
    pub(super) most: usize,
    /// How far the search had come before the batch, by its misfit.
    pub(super) descended: f64,
    pub(super) phase: String,
}

impl Decorator for BatchRecorder<'_> {
    fn inner(&self) -> &dyn Recorder {
        &*self.recorder
    }

    fn inner_mut(&mut self) -> &mut dyn Recorder {
        self.recorder
    }

    fn columns(&mut self, _names: &[&str]) -> io::Result<()> {
        Ok(())
    }

    fn point(&mut self, _values: &[f64]) -> io::Result<()> {
        Ok(())
    }

    fn file(
        &mut self,
        _name: &str,
        _write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        Ok(())
    }

    fn progress(&mut self, fraction: f64, _phase: &str) {
        let [before, within] = self.trials.map(|count| count as f64);
        let used = (before + fraction * within) / self.most as f64;
        let fraction = used.max(self.descended).min(1.0);
        self.recorder.progress(fraction, &self.phase);
    }

    fn checkpoint(&mut self, bytes: &[u8]) -> io::Result<()> {
        let bytes = (self.save)(bytes).map_err(io::Error::other)?;
        self.recorder.checkpoint(&bytes)
    }
}
