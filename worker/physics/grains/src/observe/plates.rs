//! Whether plates, walls that follow forces, are at rest.
use super::time_step::Plates;
use crate::{numbers::Vector, step::engine::Engine};

impl Engine {
    /// How far the plates are from rest: the largest, over all of them, of the resultant force along what is
    /// free and of the force m v ω_p with which the contacts that it has would stop it at its speed v, over
    /// the larger one of its load and their force. 1 for a plate that flies; `None` without plates.
    pub(crate) fn unrest_of_plates(&self, plates: &Plates) -> Option<f64> {
        let ratios = (0..self.wall_count()).filter_map(|wall| {
            let motion = self.motion_of(wall);
            let load = motion.load?;
            let free = |vector: [f64; 3]| {
                Vector::from_fn(|axis, _| if load.free[axis] { vector[axis] } else { 0.0 })
            };
            let [pushed, carried, velocity] =
                [load.force, self.wall_force(wall), motion.velocity].map(free);
            let swing = load.mass * velocity.norm() * plates.square(wall).sqrt();
            let unrest = (pushed + carried).norm().max(swing);
            let scale = pushed.norm().max(carried.norm());
            Some(match (unrest > 0.0, scale > 0.0) {
                (_, true) => unrest / scale,
                // nothing acts on it
                (_, false) if velocity.norm() > 0.0 => f64::INFINITY,
                _ => 0.0,
            })
        });
        ratios.reduce(f64::max)
    }
}
