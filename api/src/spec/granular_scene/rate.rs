//! The same test, faster or slower: what moves walls and bodies, and how long it does.
use super::{Drive, GranularScene, LoadPlane, MovePlane, Stage};

impl GranularScene {
    /// Drives all walls and bodies `factor` times as fast, over the same ways and the same swings.
    /// Stages in which only gravity moves the bodies stay as they are.
    pub(super) fn hasten(&mut self, factor: f64) {
        for stage in &mut self.stages {
            stage.hasten(factor);
        }
    }
}

impl Stage {
    fn hasten(&mut self, factor: f64) {
        match self {
            Self::MovePlane(MovePlane {
                velocity_m_per_s,
                steps,
                time_s,
                ..
            }) => {
                *velocity_m_per_s *= factor;
                shorten(steps, time_s, factor);
            }
            Self::LoadPlane(LoadPlane {
                period_s,
                steps,
                time_s,
                ..
            }) => {
                divide(period_s, factor);
                shorten(steps, time_s, factor);
            }
            Self::Drive(drive) => drive.hasten(factor),
            _ => {}
        }
    }
}

impl Drive {
    fn hasten(&mut self, factor: f64) {
        for wall in &mut self.walls {
            for velocity in wall.velocity_m_per_s.iter_mut().flatten() {
                *velocity *= factor;
            }
            if let Some(sine) = &mut wall.sine {
                sine.frequency_hz *= factor;
            }
            let turn = wall.turn.iter_mut();
            for spin in turn.flat_map(|turn| &mut turn.angular_velocity_rad_per_s) {
                *spin *= factor;
            }
            if let Some(servo) = &mut wall.servo {
                servo.largest_velocity_m_per_s *= factor;
            }
            if let Some(force) = &mut wall.force {
                divide(&mut force.period_s, factor);
            }
        }
        for body in &mut self.bodies {
            let velocity = body.velocity.iter_mut();
            for velocity in velocity.flat_map(|velocity| &mut velocity.velocity_m_per_s) {
                *velocity *= factor;
            }
            if let Some(force) = &mut body.force {
                divide(&mut force.period_s, factor);
            }
        }
        shorten(&mut self.steps, &mut self.time_s, factor);
    }
}

fn divide(time: &mut Option<f64>, factor: f64) {
    if let Some(time) = time {
        *time /= factor;
    }
}

fn shorten(steps: &mut Option<u64>, time: &mut Option<f64>, factor: f64) {
    if let Some(steps) = steps {
        *steps = (*steps as f64 / factor).round().max(1.0) as u64;
    }
    divide(time, factor);
}
