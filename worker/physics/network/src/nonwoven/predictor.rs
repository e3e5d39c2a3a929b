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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Bonds,
        boundary::{BOTTOM, Set, TOP},
    };

    #[test]
    fn what_is_held_goes_where_its_set_says_and_what_hangs_on_it_goes_with_it() {
        let mut sets = Set::jaws();
        let guide = sets.len() as u16;
        sets.push(Set {
            name: "guide".to_owned(),
            ways: [None, Some(0.5), Some(0.0)],
        });
        let network = Network {
            positions: [0.0, 10.0, 4.0, 7.0]
                .map(|y| Vector::new(0.0, y, 0.0))
                .into(),
            holds: vec![Some(BOTTOM), Some(TOP), Some(guide), None],
            sets,
            bonds: Bonds::default(),
            rows: Vec::new(),
        };
        let parts = [
            Part::With(BOTTOM),
            Part::With(TOP),
            Part::Loaded,
            Part::With(guide),
        ];
        let displacements = [[0.0, 0.0], [0.0, 1.0], [0.3, 0.5], [0.1, 0.2]];
        let displacements = displacements.map(|[x, y]| Vector::new(x, y, 0.0));
        let jaw = JawMove {
            from: 1.0,
            to: 2.0,
            bottom: 0.0,
            gauge_length: 10.0,
        };
        // the guided node keeps its own x and has half the way of the jaw along y
        let hanging = displacements[3] + Vector::new(0.0, 0.5, 0.0);
        let expected = [
            Vector::zeros(),
            Vector::new(0.0, 2.0, 0.0),
            Vector::new(0.3, 1.0, 0.0),
            hanging,
        ];
        assert_eq!(jaw.stretch(&network, &parts, &displacements), expected);
        let last = Increment {
            jaw: 0.5,
            displacements: vec![Vector::new(0.25, 0.25, 0.0); 4],
        };
        let repeated = jaw.repeat(&last, &network, &parts, &displacements);
        assert_eq!(repeated[2], Vector::new(0.3 + 0.5, 1.0, 0.0));
        assert_eq!((repeated[1], repeated[3]), (expected[1], hanging));
    }
}
