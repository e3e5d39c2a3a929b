//! The stages of a run: when each is done, what it does to the planes, how far the run is.
use loadframe_api::spec::granular_scene::{MovePlane, Stage};

use super::{
    contact::{law::Law, walls::Load},
    run::Runner,
};
use crate::Recorder;

impl<F: Law> Runner<'_, F> {
    pub(super) fn is_stage_done(&self, stage: &Stage) -> bool {
        self.journal.is_settled || self.steps_left(stage) <= 0.0
    }

    pub(super) fn is_last_stage(&self) -> bool {
        self.journal.stage + 1 == self.spec.stages.len()
    }

    pub(super) fn is_last_step(&self) -> bool {
        let last = self.spec.stages.last();
        self.is_last_stage() && last.is_some_and(|stage| self.steps_left(stage) <= 1.0)
    }

    /// Steps that a stage still takes with the present time step.
    fn steps_left(&self, stage: &Stage) -> f64 {
        let duration = stage.duration();
        match (duration.steps, duration.time_s) {
            (Some(steps), _) => steps.saturating_sub(self.journal.stage_steps) as f64,
            (None, Some(time)) => {
                let left = self.journal.stage_start + time - self.engine.state.time;
                // a hair of a step is round-off
                (left / self.journal.time_step - 1e-6).ceil()
            }
            (None, None) => 0.0,
        }
    }

    pub(super) fn drive_planes(&mut self, stage: &Stage) {
        for (plane, face) in self
            .engine
            .model
            .planes
            .iter()
            .zip(&mut self.engine.state.faces)
        {
            face.load = None;
            face.velocity = match stage {
                Stage::MovePlane(MovePlane {
                    name,
                    velocity_m_per_s,
                    ..
                }) if *name == plane.name => *velocity_m_per_s,
                Stage::LoadPlane(load) if load.name == plane.name => {
                    face.load = Some(Load {
                        force: load.force_n,
                        mass: load.mass_kg,
                    });
                    // a stage that was begun goes on at the speed it had
                    if self.journal.stage_steps > 0 {
                        face.velocity
                    } else {
                        0.0
                    }
                }
                _ => 0.0,
            };
        }
    }

    /// The force of this moment on the planes that are under one.
    pub(super) fn load_planes(&mut self, stage: &Stage) {
        if let Stage::LoadPlane(load) = stage {
            let time = self.engine.state.time - self.journal.stage_start;
            for face in &mut self.engine.state.faces {
                if let Some(on_face) = &mut face.load {
                    on_face.force = load.force_at(time);
                }
            }
        }
    }

    pub(super) fn tell_progress(&self, recorder: &mut dyn Recorder) {
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
