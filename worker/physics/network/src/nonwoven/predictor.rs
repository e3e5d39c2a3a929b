//! Where the nodes are expected after the jaw moved.
use super::state::Increment;
use crate::{Network, Vector, boundary::free_part, load_path::Part};

/// A move of the top jaw, whose way is the load parameter.
#[derive(Clone, Copy, Debug)]
pub(super) struct JawMove {
    /// Displacement of the jaw before and after [mm].
    pub(super) from: f64,
    pub(super) to: f64,
    /// Height of the bottom jaw, and initial distance of the jaws [mm].
    pub(super) bottom: f64,
    pub(super) gauge_length: f64,
}

impl JawMove {
    /// Stretches what is between the jaws evenly along y.
    pub(super) fn stretch(
        &self,
        network: &Network,
        parts: &[Part],
        displacements: &[Vector],
    ) -> Vec<Vector> {
        let distance = self.gauge_length + self.from;
        let share = |node: usize| {
            let height = network.positions[node].y + displacements[node].y - self.bottom;
            Vector::new(0.0, (height / distance).clamp(0.0, 1.0), 0.0) * (self.to - self.from)
        };
        self.apply(network, parts, displacements, share)
    }

    /// Repeats the last increment in proportion.
    pub(super) fn repeat(
        &self,
        last: &Increment,
        network: &Network,
        parts: &[Part],
        displacements: &[Vector],
    ) -> Vec<Vector> {
        let scale = (self.to - self.from) / last.jaw;
        let share = |node: usize| last.displacements[node] * scale;
        self.apply(network, parts, displacements, share)
    }

    /// Moves the jaw and what is held, what hangs on one of these, and every loaded free node by `share`.
    fn apply(
        &self,
        network: &Network,
        parts: &[Part],
        displacements: &[Vector],
        share: impl Fn(usize) -> Vector,
    ) -> Vec<Vector> {
        let way = self.to - self.from;
        let moved = |(node, displacement): (usize, &Vector)| {
            let moved = match parts[node] {
                Part::Loaded => displacement + share(node),
                Part::With(set) => displacement + network.sets[usize::from(set)].displacement(way),
                Part::AtRest => *displacement,
            };
            match network.set_of(node as u32) {
                // set, not accumulated: what is held is exactly where the nominal strain puts it
                Some(set) => free_part(set.held(), &moved) + set.displacement(self.to),
                None => moved,
            }
        };
        displacements.iter().enumerate().map(moved).collect()
    }
}
