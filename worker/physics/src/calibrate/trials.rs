//! Trials: sets of parameters, each tested on the same specimens, and what is remembered of them.
//!
//! The search asks for trials by their coordinates. What it asked for before is not tested again,
//! which is also how a resumed calibration goes on: the search is repeated from its start, and finds
//! all trials up to the checkpoint done. Trials asked for at once are tested side by side.
use std::borrow::Cow;

use indexmap::IndexMap;
use loadframe_api::Report;
use loadframe_harness::{
    Interrupt, Recorder, RunContext, SimulationError,
    checkpoint::{self, Fingerprint},
    plan::{Conclusion, Curve, Plan, SavedReport},
};
use serde::{Deserialize, Serialize};

use super::{
    batch::{Batch, BatchRecorder, Tested},
    misfit::means,
    setting::Setting,
};

/// Why a search is not gone on with.
#[derive(Debug)]
pub(super) enum Halt {
    /// The misfit is within the tolerance.
    Reached,
    /// The trials allowed are used up.
    UsedUp,
    Interrupted(Interrupt),
    Failed(SimulationError),
}

impl<E: Into<SimulationError>> From<E> for Halt {
    fn from(error: E) -> Self {
        Self::Failed(error.into())
    }
}

/// A set of parameters and what it gave.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Trial {
    pub(super) point: Vec<f64>,
    /// The numbers of each specimen.
    pub(super) values: Vec<Vec<f64>>,
}

/// The search's best trial.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Best {
    pub(super) trial: usize,
    pub(super) misfit: f64,
    reports: Vec<SavedReport>,
    /// Of the first specimen.
    pub(super) curve: Curve,
}

/// The content of a checkpoint.
#[derive(Serialize, Deserialize)]
struct Saved<'a> {
    job: Fingerprint,
    trials: Cow<'a, [Trial]>,
    best: Cow<'a, Option<Best>>,
    work: Cow<'a, IndexMap<String, u64>>,
    /// The plan of trials that were under way; empty without any.
    under_way: Cow<'a, [u8]>,
}

/// All trials so far, and the means for more.
pub(super) struct Trials<'a> {
    pub(super) setting: Setting<'a>,
    context: RunContext<'a>,
    recorder: &'a mut dyn Recorder,
    job: Fingerprint,
    trials: Vec<Trial>,
    best: Option<Best>,
    work: IndexMap<String, u64>,
    under_way: Option<Vec<u8>>,
    /// Trials asked for since this run began; all others are known from a checkpoint.
    asked: usize,
    /// Smallest misfit among those.
    smallest: f64,
    /// Trials that may be asked for.
    limit: usize,
    /// Whether the best is still sought.
    is_searching: bool,
}

impl<'a> Trials<'a> {
    /// No trials, or those of the checkpoint.
    pub(super) fn new(
        setting: Setting<'a>,
        context: RunContext<'a>,
        recorder: &'a mut dyn Recorder,
    ) -> Result<Self, SimulationError> {
        let job = Fingerprint::of(&serde_json::to_string(setting.spec).map_err(checkpoint::form)?)?;
        let saved = match context.checkpoint {
            Some(bytes) => {
                let saved: Saved<'static> = checkpoint::unpack(bytes)?;
                job.check(saved.job)?;
                Some(saved)
            }
            None => None,
        };
        let (trials, best, work, under_way) = match saved {
            Some(saved) => (
                saved.trials.into_owned(),
                saved.best.into_owned(),
                saved.work.into_owned(),
                Some(saved.under_way.into_owned()).filter(|bytes| !bytes.is_empty()),
            ),
            None => Default::default(),
        };
        let reserve = 2 * setting.coordinates.len();
        Ok(Self {
            setting,
            context,
            recorder,
            job,
            trials,
            best,
            work,
            under_way,
            asked: 0,
            smallest: f64::INFINITY,
            limit: (setting.spec.max_trials as usize).saturating_sub(reserve),
            is_searching: true,
        })
    }

    /// Ends the search: trials from now on do not seek the best, and may use what was kept back.
    pub(super) fn end_search(&mut self) {
        self.is_searching = false;
        self.limit = usize::MAX;
    }

    pub(super) fn recorder(&mut self) -> &mut dyn Recorder {
        self.recorder
    }

    /// All trials, in the order in which they were asked for.
    pub(super) fn all(&self) -> &[Trial] {
        &self.trials
    }

    pub(super) fn best(&self) -> Option<&Best> {
        self.best.as_ref()
    }

    /// Work of all tests, by name.
    pub(super) fn work(&self) -> &IndexMap<String, u64> {
        &self.work
    }

    /// The residuals of a trial; not all are numbers where a specimen does not know a result.
    pub(super) fn residuals(&self, trial: usize) -> Vec<f64> {
        let targets = self.setting.targets;
        targets.residuals(&means(&self.trials[trial].values))
    }

    /// Makes sure that there are trials at all of these points; returns their numbers.
    ///
    /// # Errors
    /// [`Halt`] when the search need not, or cannot, go on.
    pub(super) fn at(&mut self, points: &[Vec<f64>]) -> Result<Vec<usize>, Halt> {
        let mut new: Vec<&Vec<f64>> = Vec::new();
        for point in points {
            let is_known = self.number(point).is_some_and(|trial| trial < self.asked);
            if !is_known && !new.iter().any(|other| same(other, point)) {
                new.push(point);
            }
        }
        if self.asked + new.len() > self.limit {
            return Err(Halt::UsedUp);
        }
        let untested = new.iter().filter(|point| self.number(point).is_none());
        let untested: Vec<Vec<f64>> = untested.map(|point| (*point).clone()).collect();
        if !untested.is_empty() {
            self.test(&untested)?;
        }
        self.asked += new.len();
        let trials = points.iter().filter_map(|point| self.number(point));
        let trials: Vec<usize> = trials.collect();
        if self.is_searching {
            for trial in &trials {
                self.smallest = self.smallest.min(self.misfit(*trial));
            }
            if self.smallest <= self.setting.spec.tolerance {
                return Err(Halt::Reached);
            }
        }
        Ok(trials)
    }

    /// The misfit of a trial, NaN where it is unknown.
    pub(super) fn misfit(&self, trial: usize) -> f64 {
        self.setting.targets.misfit(&self.residuals(trial))
    }

    fn number(&self, point: &[f64]) -> Option<usize> {
        self.trials
            .iter()
            .position(|trial| same(&trial.point, point))
    }

    /// Tests new points on all specimens.
    fn test(&mut self, points: &[Vec<f64>]) -> Result<(), Halt> {
        let batch = Batch::new(self.setting, points);
        let fingerprint = Fingerprint::of(&(self.job, points))?;
        let best = self.best.as_ref().map(|best| best.misfit);
        let best = best.map_or(String::new(), |misfit| {
            format!(", best misfit {}", self.setting.targets.words(misfit))
        });
        let descended = self.descended();
        let (trials, kept, work, job) = (&self.trials, &self.best, &self.work, self.job);
        let save = |under_way: &[u8]| {
            checkpoint::pack(&Saved {
                job,
                trials: Cow::Borrowed(trials),
                best: Cow::Borrowed(kept),
                work: Cow::Borrowed(work),
                under_way: Cow::Borrowed(under_way),
            })
        };
        let mut recorder = BatchRecorder {
            recorder: &mut *self.recorder,
            save: &save,
            trials: [trials.len(), points.len()],
            most: self.setting.spec.max_trials as usize,
            descended,
            phase: format!("trial {}{best}", trials.len() + 1),
        };
        let plan = match self.under_way.take() {
            Some(bytes) => Plan::resume(fingerprint, &bytes, &mut recorder)?,
            None => Plan::new(fingerprint, batch.tests()),
        };
        let tested = match plan.carry_out(&batch, self.context, &mut recorder)? {
            Conclusion::Finished(tested) => tested,
            Conclusion::Interrupted(interrupt) => return Err(Halt::Interrupted(interrupt)),
        };
        let specimens = self.setting.spec.realisations as usize;
        for (point, tests) in points.iter().zip(tested.chunks(specimens)) {
            self.take(point, tests)?;
        }
        if self.recorder.checkpoint_due() {
            let bytes = checkpoint::pack(&Saved {
                job: self.job,
                trials: Cow::Borrowed(&self.trials),
                best: Cow::Borrowed(&self.best),
                work: Cow::Borrowed(&self.work),
                under_way: Cow::Borrowed(&[]),
            })?;
            self.recorder.checkpoint(&bytes)?;
        }
        Ok(())
    }

    /// How far the search has come on its way to the tolerance, in orders of magnitude of the misfit:
    /// most of its steps gain about as much of them.
    fn descended(&self) -> f64 {
        /// What is left for the derivatives around the best trial.
        const RESERVE: f64 = 0.1;
        let Some(best) = &self.best else {
            return 0.0;
        };
        let start = self.misfit(0);
        let part = (start / best.misfit).ln() / (start / self.setting.spec.tolerance).ln();
        // a start within the tolerance has nothing to descend
        let part = if part.is_finite() { part } else { 0.0 };
        (1.0 - RESERVE) * part.clamp(0.0, 1.0)
    }

    /// Takes in what the specimens of a trial gave.
    fn take(&mut self, point: &[f64], tests: &[Tested]) -> Result<(), SimulationError> {
        let trial = self.trials.len();
        self.trials.push(Trial {
            point: point.to_vec(),
            values: tests.iter().map(|test| test.values.clone()).collect(),
        });
        for (name, count) in tests.iter().flat_map(|test| &test.work) {
            *self.work.entry(name.clone()).or_default() += count;
        }
        let misfit = self.misfit(trial);
        if trial == 0 && misfit.is_nan() {
            return Err(SimulationError::Calibration(self.why_unknown(tests)));
        }
        let smallest = self.best.as_ref().map_or(f64::INFINITY, |best| best.misfit);
        if self.is_searching && misfit < smallest {
            self.best = Some(Best {
                trial,
                misfit,
                reports: tests
                    .iter()
                    .filter_map(|test| test.report.clone())
                    .collect(),
                curve: tests
                    .first()
                    .map(|test| test.curve.clone())
                    .unwrap_or_default(),
            });
            let free = self.setting.spec.free.iter();
            let values = free.zip(self.setting.coordinates).zip(point);
            let values = values.map(|((free, coordinate), x)| {
                format!("{} {:.5}", free.parameter, coordinate.value(*x))
            });
            let values: Vec<String> = values.collect();
            let words = self.setting.targets.words(misfit);
            let line = format!(
                "trial {}: misfit {words} at {}",
                trial + 1,
                values.join(", ")
            );
            self.recorder.log(&line);
        }
        Ok(())
    }

    /// Why the start gives no residuals.
    fn why_unknown(&self, tests: &[Tested]) -> String {
        let seeds = self.setting.spec.seed..;
        for (seed, test) in seeds.zip(tests) {
            if let Some(failure) = &test.failure {
                return format!("the start with seed {seed} has no result: {failure}");
            }
            let unknown = test.values.iter().position(|value| value.is_nan());
            if let Some(index) = unknown {
                let results = &self.setting.spec.measured.results;
                let name = results
                    .get(index)
                    .map_or("the curve", |r| r.result.as_str());
                return format!(
                    "the start with seed {seed} gives no value for {name}: its test does not get \
                     that far"
                );
            }
        }
        "the start has no result".to_owned()
    }
}

impl Best {
    /// The reports of its specimens.
    pub(super) fn reports(&self) -> Result<Vec<Report>, SimulationError> {
        let reports = self.reports.iter().map(SavedReport::read);
        Ok(reports.collect::<Result<_, _>>()?)
    }
}

/// Whether two points have the same bits.
fn same(one: &[f64], other: &[f64]) -> bool {
    let bits = |point: &[f64]| point.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    bits(one) == bits(other)
}
