//! How large a step may be, and what must not become of bodies.
use loadframe_api::spec::granular_scene::{ContactLaw, LARGEST_WAY, Stage};
use loadframe_harness::SimulationError;

use super::{runner::Runner, stepping::STEPS_PER_LOOK};
use crate::observe::time_step::Critical;

impl Runner<'_> {
    /// The part of the critical step that was asked for, and none that lets a body jump.
    pub(super) fn automatic_step(&self, critical: Option<Critical>) -> f64 {
        let speed = self
            .engine
            .state
            .speed_bound
            .max(self.engine.largest_speed());
        let critical = critical
            .map_or(f64::INFINITY, |critical| critical.step)
            .min(self.foreseen_at(speed));
        let stable = self.automatic.unwrap_or(1.0) * critical;
        // half the way that is allowed, so that a body may gain speed before the next look; a plane
        // that comes along catches what it passed, facets do not
        let speed = speed + self.engine.fastest_mesh();
        let way = 0.5 * LARGEST_WAY * self.smallest_radius / speed;
        let step = stable.min(way);
        if step.is_finite() { step } else { FREE_STEP }
    }

    /// Whether the step follows the stiffness of the contacts.
    pub(crate) fn has_automatic_step(&self) -> bool {
        self.automatic.is_some()
    }

    /// Critical step of contacts that may come before the next look [s], at this speed [m/s].
    pub(super) fn foreseen_at(&self, speed: f64) -> f64 {
        if self.spec.laws.contact != ContactLaw::HertzMindlin {
            return self.foreseen / self.engine.state.stiffness_factor.sqrt();
        }
        let wall = self.engine.fastest_plane().max(self.engine.fastest_mesh());
        let shaking = match self.spec.stages.get(self.journal.stage) {
            Some(Stage::Vibrate(vibrate)) => vibrate.acceleration_m_per_s2,
            _ => 0.0,
        };
        let gained = (self.engine.model.gravity.norm() + shaking)
            * STEPS_PER_LOOK as f64
            * self.journal.time_step;
        let speed = 2.0 * (speed + gained) + wall;
        self.engine.foreseen(self.spec, &self.bodies, speed)
    }

    /// Makes an automatic step small enough for bodies that came in.
    pub(crate) fn limit_step(&mut self) {
        if self.automatic.is_some() {
            let step = self.automatic_step(None);
            self.journal.time_step = self.journal.time_step.min(step);
        }
    }

    pub(super) fn check_speed(&self) -> Result<(), SimulationError> {
        let time_step = self.journal.time_step;
        let allowed = LARGEST_WAY * self.smallest_radius;
        if self.engine.state.speed_bound * time_step <= allowed || self.automatic.is_some() {
            return Ok(());
        }
        match self.engine.first_jump(time_step, LARGEST_WAY) {
            Some((body, speed, radius)) if !self.spec.allow_unstable => {
                Err(SimulationError::TooFast {
                    body,
                    step: self.engine.state.step,
                    speed_m_per_s: speed,
                    largest_step_s: LARGEST_WAY * radius / speed,
                })
            }
            _ => Ok(()),
        }
    }

    pub(super) fn check_finite(&self) -> Result<(), SimulationError> {
        match self.engine.first_not_finite() {
            Some((body, quantity)) => Err(SimulationError::BodyNotFinite {
                body,
                step: self.engine.state.step,
                quantity,
            }),
            None => Ok(()),
        }
    }
}

/// Step of a scene in which nothing can touch [s].
const FREE_STEP: f64 = 1e-3;

pub(super) fn unstable(step: f64, critical: Critical) -> SimulationError {
    SimulationError::Unstable {
        given_s: step,
        critical_s: critical.step,
        body: critical.body as usize,
        partner: critical.partner as usize,
    }
}
