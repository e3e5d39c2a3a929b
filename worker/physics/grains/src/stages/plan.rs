//! The stages of a run: when each is done, how far the run is.
use loadframe_api::spec::granular_scene::{Drive, Stage};
use loadframe_harness::{Recorder, SimulationError};

use super::runner::Runner;
use crate::numbers::Vector;

/// A hair of a step is round-off.
const HAIR: f64 = 1e-6;

impl Runner<'_> {
    pub(crate) fn is_stage_done(&self, stage: &Stage) -> bool {
        self.journal.is_settled || self.is_force_met(stage) || self.steps_left(stage) <= 0.0
    }

    /// Whether the force that ends the stage acted in its last step.
    fn is_force_met(&self, stage: &Stage) -> bool {
        let Stage::Drive(Drive {
            until: Some(until), ..
        }) = stage
        else {
            return false;
        };
        let wall = self.engine.wall(&until.wall);
        let wall = wall.filter(|_| self.journal.stage_steps > 0);
        wall.is_some_and(|wall| {
            let force = self.engine.wall_force(wall);
            until.is_met(force[until.axis.index()])
        })
    }

    /// Makes the row of the end of a stage that a force ended: nobody knew before that step that it would
    /// be the last.
    pub(crate) fn tell_end(
        &mut self,
        stage: &Stage,
        recorder: &mut dyn Recorder,
    ) -> Result<(), SimulationError> {
        let columns = self.spec.curve_columns().len();
        let told = self.journal.curve.rchunks(columns).next();
        let told = told.and_then(|row| row.first());
        let is_told = told.is_some_and(|step| *step as u64 == self.engine.state.step);
        if self.is_force_met(stage) && !is_told && (self.records_ends() || self.is_last_stage()) {
            self.observe_still(recorder)?;
        }
        Ok(())
    }

    pub(crate) fn is_last_stage(&self) -> bool {
        self.journal.stage + 1 == self.spec.stages.len()
    }

    pub(crate) fn is_last_step(&self) -> bool {
        let last = self.spec.stages.last();
        self.is_last_stage() && last.is_some_and(|stage| self.steps_left(stage) <= 1.0)
    }

    /// Time that a stage still takes [s], if it is told by a time.
    fn time_left(&self, stage: &Stage) -> Option<f64> {
        let time = stage.duration().time_s?;
        Some(self.journal.stage_start + time - self.engine.state.time)
    }

    /// Δt of the next step [s]: a stage ends at its time, so that its last step may be shorter.
    pub(crate) fn next_step(&self, stage: &Stage) -> f64 {
        let step = self.journal.time_step;
        match self.time_left(stage) {
            Some(left) if left < step * (1.0 + HAIR) => left,
            _ => step,
        }
    }

    /// Steps that a stage still takes with the present time step.
    fn steps_left(&self, stage: &Stage) -> f64 {
        let steps_of = |time: f64| (time / self.journal.time_step - HAIR).ceil();
        let latest = match (stage.duration().steps, self.time_left(stage)) {
            (Some(steps), _) => steps.saturating_sub(self.journal.stage_steps) as f64,
            (None, Some(time)) => steps_of(time),
            (None, None) => 0.0,
        };
        match stage {
            Stage::Insert(insert) => self
                .time_after_last_batch(insert)
                .map_or(latest, |time| latest.min(steps_of(time))),
            _ => latest,
        }
    }

    /// Friction during a stage; to be called as it begins.
    pub(crate) fn rub(&mut self, stage: &Stage) {
        self.engine.rub(match stage {
            Stage::Vibrate(vibrate) => vibrate.friction_factor,
            Stage::Drive(drive) => drive.friction_factor,
            _ => 1.0,
        });
    }

    /// Gravity of this moment, for plates too.
    pub(crate) fn shake(&mut self, stage: &Stage) {
        let engine = &mut self.engine;
        engine.gravity = engine.model.gravity;
        if let Stage::Vibrate(vibrate) = stage {
            let time = engine.state.time - self.journal.stage_start;
            engine.gravity += Vector::from(vibrate.acceleration_at(time));
            let gravity = engine.gravity;
            for wall in 0..engine.wall_count() {
                // in such a stage the only loads are weights of plates that were set down
                if let Some(load) = &mut engine.wall_motion(wall).load {
                    for axis in (0..3).filter(|axis| load.free[*axis]) {
                        load.force[axis] = load.mass * gravity[axis];
                    }
                }
            }
        }
    }

    /// Whether the next step ends the present stage, as far as that is known before it.
    pub(crate) fn ends_stage(&self) -> bool {
        let stage = self.spec.stages.get(self.journal.stage);
        stage.is_some_and(|stage| self.steps_left(stage) <= 1.0)
    }

    pub(crate) fn tell_progress(&self, recorder: &mut dyn Recorder) {
        let steps = |stage: &Stage| {
            let duration = stage.duration();
            let by_time = duration.time_s.map(|time| time / self.journal.time_step);
            duration
                .steps
                .map(|steps| steps as f64)
                .or(by_time)
                .unwrap_or(0.0)
        };
        let all: f64 = self.spec.stages.iter().map(steps).sum();
        let before: f64 = self.spec.stages[..self.journal.stage]
            .iter()
            .map(steps)
            .sum();
        let fraction = (before + self.journal.stage_steps as f64) / all.max(1.0);
        let stage = self
            .spec
            .stages
            .get(self.journal.stage)
            .map_or("", Stage::name);
        let phase = format!(
            "stage {} of {}, {stage}, step {}, {:.6} s",
            self.journal.stage + 1,
            self.spec.stages.len(),
            self.engine.state.step,
            self.engine.state.time
        );
        recorder.progress(fraction.clamp(0.0, 0.999), &phase);
    }
}
