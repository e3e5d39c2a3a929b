//! How large a step may be, and what must not become of bodies.
use loadframe_api::spec::granular_scene::{ContactLaw, GranularScene, LARGEST_WAY, Stage};
use loadframe_harness::SimulationError;

use super::{runner::Runner, stepping::STEPS_PER_LOOK};
use crate::{motion::critical_step, observe::time_step::Critical};

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
        // half the way that is allowed, so that a body may gain speed before the next look
        let walls = self.engine.moving_walls().map(|(_, speed, _)| speed);
        let speed = speed + walls.fold(0.0, f64::max);
        let way = 0.5 * self.longest_way() / speed;
        let step = stable.min(self.step_at_plates(speed));
        way.min(if step.is_finite() { step } else { FREE_STEP })
    }

    /// Way in a step, at most [m].
    fn longest_way(&self) -> f64 {
        LARGEST_WAY * self.smallest_radius
    }

    /// Automatic step [s] that plates allow, if they met everything at once that is near them.
    fn step_at_plates(&self, speed: f64) -> f64 {
        let [square, damped] = self.engine.plate_that_meets();
        if square > 0.0 {
            let alone = 2.0 / self.foreseen_with(speed, 1, &[]);
            self.automatic.unwrap_or(1.0) * critical_step(square + alone * alone, damped)
        } else {
            f64::INFINITY
        }
    }

    /// What a stage that begins changes in the steps it may take.
    pub(super) fn begin_step(&mut self) {
        let speed = GranularScene::first_speed(&self.bodies);
        let plates = self.engine.plates();
        let foreseen =
            |plates: &[f64]| (self.engine).foreseen(self.spec, &self.bodies, speed, plates);
        self.foreseen = [foreseen(&plates), foreseen(&[])];
        if self.journal.stage_steps == 0 {
            self.limit_step();
        }
    }

    /// Makes an automatic step small enough for plates that come near other bodies.
    pub(super) fn meet_plates(&mut self) {
        if self.engine.state.is_listed {
            return;
        }
        self.engine.list();
        if self.automatic.is_some() && self.engine.plate_that_meets()[0] > 0.0 {
            let step = self.step_at_plates(self.engine.state.speed_bound);
            self.journal.time_step = self.journal.time_step.min(step);
        }
    }

    /// Makes an automatic step small enough for walls that move, and refuses a given one that is not;
    /// whether the step changed.
    pub(super) fn limit_walls(&mut self) -> Result<bool, SimulationError> {
        let (time_step, allowed) = (self.journal.time_step, self.longest_way());
        let is_far = |&(_, speed, acceleration): &(usize, f64, f64)| {
            (speed + time_step * acceleration) * time_step > allowed
        };
        let Some((wall, ..)) = self.engine.moving_walls().find(is_far) else {
            return Ok(false);
        };
        let step_of = |(_, speed, acceleration): (usize, f64, f64)| {
            // each of both may take half of it
            (0.5 * allowed / speed).min((0.5 * allowed / acceleration).sqrt())
        };
        let walls = self.engine.moving_walls().map(step_of);
        let step = walls.fold(f64::INFINITY, f64::min);
        if self.automatic.is_some() {
            // half the way, as of bodies
            self.journal.time_step = 0.5 * step;
            return Ok(true);
        }
        if self.spec.allow_unstable {
            return Ok(false);
        }
        Err(SimulationError::WallTooFast {
            wall: self.engine.wall_name(wall).to_owned(),
            step: self.engine.state.step,
            largest_step_s: step,
        })
    }

    /// Whether a given step has come to be beyond the critical one.
    pub(super) fn check_step(&self) -> Result<(), SimulationError> {
        let seen = &self.engine.state.seen;
        if self.automatic.is_some() || self.spec.allow_unstable || seen.step_ratio <= BEYOND {
            return Ok(());
        }
        match seen.critical {
            Some((step, [body, partner])) => Err(self.unstable(step, [body, partner])),
            None => Ok(()),
        }
    }

    /// A given step that these two do not allow.
    pub(super) fn unstable(&self, critical_s: f64, [body, partner]: [u32; 2]) -> SimulationError {
        SimulationError::Unstable {
            given_s: self.journal.time_step,
            critical_s,
            step: self.engine.state.step,
            body: self.engine.name_of(body),
            partner: self.engine.name_of(partner),
        }
    }

    /// Whether the step follows the stiffness of the contacts.
    pub(crate) fn has_automatic_step(&self) -> bool {
        self.automatic.is_some()
    }

    /// Critical step of contacts that may come before the next look [s], at this speed [m/s].
    pub(super) fn foreseen_at(&self, speed: f64) -> f64 {
        self.foreseen_with(speed, 0, &self.engine.plates())
    }

    /// The same with these plates, which `known` is the place of.
    fn foreseen_with(&self, speed: f64, known: usize, plates: &[f64]) -> f64 {
        let factor = self.engine.state.stiffness_factor;
        if self.spec.laws.contact != ContactLaw::HertzMindlin {
            return self.foreseen[known] / factor.sqrt();
        }
        let walls = self.engine.moving_walls().map(|(_, speed, _)| speed);
        let wall = walls.fold(0.0, f64::max);
        let shaking = match self.spec.stages.get(self.journal.stage) {
            Some(Stage::Vibrate(vibrate)) => vibrate.acceleration_m_per_s2,
            _ => 0.0,
        };
        let gained = (self.engine.model.gravity.norm() + shaking)
            * STEPS_PER_LOOK as f64
            * self.journal.time_step;
        let speed = 2.0 * (speed + gained) + wall;
        // the tangent where an impact stops grows less than the modulus, and is counted as if it did not
        let first = self.engine.foreseen(self.spec, &self.bodies, speed, plates);
        first / factor.max(1.0).sqrt()
    }

    /// Makes an automatic step small enough for bodies that came in.
    pub(crate) fn limit_step(&mut self) {
        if self.automatic.is_some() {
            let step = self.automatic_step(None);
            self.journal.time_step = self.journal.time_step.min(step);
        }
    }

    pub(super) fn check_speed(&mut self) -> Result<(), SimulationError> {
        let time_step = self.journal.time_step;
        let speed = self.engine.state.speed_bound;
        if speed * time_step <= self.longest_way() {
            return Ok(());
        }
        if self.automatic.is_some() {
            self.journal.time_step = 0.5 * self.longest_way() / speed;
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

/// Step over critical one beyond which it is too large: two ways to reckon it differ by round-off.
const BEYOND: f64 = 1.0 + 1e-9;
