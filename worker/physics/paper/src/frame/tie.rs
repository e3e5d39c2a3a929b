//! Points of fibres between nodes: how they move with the two nodes of their segment.
//!
//! Bonds inside a segment are held by the motion that the segment has between its nodes, never by the
//! nearest node. A bar is straight: displacements are linear. A beam under forces at its ends alone bends
//! as the exact solution of Timoshenko's equations, whose interpolation of displacement and rotation is
//! that of [Reddy1997]; without shear it is Hermite's cubic. With s the share of the length l, Φ and μ =
//! 1/(1 + Φ) of the segment, the parts across it are
//!
//! | of | displacement | rotation |
//! |---|---|---|
//! | first displacement | μ (1 - 3 s² + 2 s³ + Φ (1 - s)) | -g, g = 6 μ (s - s²)/l |
//! | first rotation | l μ (s - 2 s² + s³ + Φ (s - s²)/2) | μ (1 - 4 s + 3 s² + Φ (1 - s)) |
//! | second displacement | μ (3 s² - 2 s³ + Φ s) | g |
//! | second rotation | l μ (s³ - s² + Φ (s² - s)/2) | μ (3 s² - 2 s + Φ s) |
//!
//! and those along it are linear. What moves so can only be stiffer than what it stands for: the energy of a network
//! with bonds inside is above that with nodes at the bonds, and falls to it with the segment.
use nalgebra::{RealField, Vector3};

use super::element::Element;

/// A point that moves with two nodes of a fibre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Tie<T = f64> {
    /// The nodes; the same twice for a point that is a node.
    pub(crate) nodes: [u32; 2],
    /// Direction of the segment.
    along: Vector3<T>,
    /// Weight of the first node along the segment; that of the second is what is missing to 1.
    pub(crate) linear: T,
    /// How much more than that it weighs across.
    bulge: T,
    /// Displacement across by rotations of the nodes [µm].
    lift: [T; 2],
    /// Rotation across by displacements of the nodes [1/µm], and by their rotations.
    slope: T,
    turn: [T; 2],
}

impl Tie {
    /// A point that is a node.
    pub(crate) fn node(node: u32) -> Self {
        Self {
            nodes: [node; 2],
            along: Vector3::x(),
            linear: 1.0,
            bulge: 0.0,
            lift: [0.0; 2],
            slope: 0.0,
            turn: [1.0, 0.0],
        }
    }

    /// A point at the share `s` of a segment that joins nodes `apart` from one another [µm].
    pub(crate) fn inside(segment: &Element, apart: Vector3<f64>, s: f64) -> Self {
        let length = apart.norm();
        let rest = Self {
            nodes: segment.nodes,
            along: apart / length,
            linear: 1.0 - s,
            ..Self::node(0)
        };
        let Some(phi) = segment.shear_number() else {
            return Self {
                turn: [1.0 - s, s],
                ..rest
            };
        };
        let mu = 1.0 / (1.0 + phi);
        let (s2, s3) = (s * s, s * s * s);
        let first = mu * (1.0 - 3.0 * s2 + 2.0 * s3 + phi * (1.0 - s));
        let half = 0.5 * phi * (s - s2);
        Self {
            bulge: first - (1.0 - s),
            lift: [
                length * mu * (s - 2.0 * s2 + s3 + half),
                length * mu * (s3 - s2 - half),
            ],
            slope: 6.0 * mu * (s - s2) / length,
            turn: [
                mu * (1.0 - 4.0 * s + 3.0 * s2 + phi * (1.0 - s)),
                mu * (3.0 * s2 - 2.0 * s + phi * s),
            ],
            ..rest
        }
    }

    /// The same point when its segment is torn in the middle: it goes rigidly with the nearer node, for
    /// what is left between them is a stub.
    pub(crate) fn torn(segment: &Element, apart: Vector3<f64>, s: f64) -> Self {
        let length = apart.norm();
        let bends = segment.shear_number().is_some();
        let (linear, arm) = if s < 0.5 { (1.0, s) } else { (0.0, s - 1.0) };
        let arm = if bends { arm * length } else { 0.0 };
        Self {
            nodes: segment.nodes,
            along: apart / length,
            linear,
            bulge: 0.0,
            lift: [arm * linear, arm * (1.0 - linear)],
            slope: 0.0,
            turn: [linear, 1.0 - linear],
        }
    }

    /// The node that it goes with when its segment is torn.
    pub(crate) fn nearer(&self) -> u32 {
        self.nodes[usize::from(self.linear < 0.5)]
    }

    /// The same in other numbers.
    pub(crate) fn rounded<T>(&self, to: impl Fn(f64) -> T) -> Tie<T> {
        let [x, y, z] = self.along.into();
        Tie {
            nodes: self.nodes,
            along: Vector3::new(to(x), to(y), to(z)),
            linear: to(self.linear),
            bulge: to(self.bulge),
            lift: self.lift.map(&to),
            slope: to(self.slope),
            turn: self.turn.map(&to),
        }
    }
}

impl<T: RealField + Copy> Tie<T> {
    /// A point of a bar, which moves by one weight and does not turn.
    pub(crate) fn by_weight(nodes: [u32; 2], linear: T) -> Self {
        let zero = T::zero;
        Self {
            nodes,
            along: Vector3::zeros(),
            linear,
            bulge: zero(),
            lift: [zero(); 2],
            slope: zero(),
            turn: [zero(); 2],
        }
    }

    /// Displacement and rotation of the point, by those of its nodes.
    #[inline]
    pub(crate) fn motion(&self, ends: &[Vector3<T>; 4]) -> [Vector3<T>; 2] {
        let along = self.along;
        let back = ends[0] - ends[2];
        let lift = (ends[1] * self.lift[0] + ends[3] * self.lift[1]).cross(&along);
        let across = back - along * along.dot(&back);
        let shift = ends[2] + back * self.linear + across * self.bulge + lift;
        let bent = ends[1] * self.turn[0] + ends[3] * self.turn[1];
        let twisted = ends[1] * self.linear + ends[3] * (T::one() - self.linear);
        let turn = bent + along * along.dot(&(twisted - bent)) - along.cross(&back) * self.slope;
        [shift, turn]
    }

    /// Forces and moments on the nodes that a force and a moment on the point are worth: the transpose of
    /// [`Tie::motion`].
    #[inline]
    pub(crate) fn spread(&self, [force, moment]: [Vector3<T>; 2]) -> [Vector3<T>; 4] {
        let along = self.along;
        let across = (force - along * along.dot(&force)) * self.bulge;
        let back = force * self.linear + across - moment.cross(&along) * self.slope;
        let lift = along.cross(&force);
        let twist = along * along.dot(&moment);
        let bend = moment - twist;
        [
            back,
            lift * self.lift[0] + bend * self.turn[0] + twist * self.linear,
            force - back,
            lift * self.lift[1] + bend * self.turn[1] + twist * (T::one() - self.linear),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::element::Ends;
    use crate::frame::input::Level;
    use crate::frame::tests::{close, tube};

    fn segment(level: Level) -> (Element, Vector3<f64>) {
        let apart = Vector3::new(30.0, -40.0, 120.0);
        (Element::segment([3, 4], apart, &tube(), level), apart)
    }

    fn ends() -> Ends {
        [
            Vector3::new(0.3, -1.0, 0.2),
            Vector3::new(0.01, 0.02, -0.03),
            Vector3::new(-0.7, 0.4, 0.9),
            Vector3::new(-0.02, 0.05, 0.01),
        ]
    }

    #[test]
    fn spreading_is_the_transpose_of_moving() {
        let loads = [
            Vector3::new(1.0, -2.0, 0.5),
            Vector3::new(30.0, 10.0, -20.0),
        ];
        for level in [Level::Beam, Level::Truss] {
            let (element, apart) = segment(level);
            for tie in [
                Tie::inside(&element, apart, 0.3),
                Tie::torn(&element, apart, 0.3),
                Tie::torn(&element, apart, 0.8),
                Tie::node(3),
            ] {
                let motion = tie.motion(&ends());
                let work = motion[0].dot(&loads[0]) + motion[1].dot(&loads[1]);
                let spread = tie.spread(loads);
                let other: f64 = spread.iter().zip(ends()).map(|(f, u)| f.dot(&u)).sum();
                close(other, work, 1e-13);
            }
        }
    }

    #[test]
    fn a_rigid_motion_takes_the_point_along() {
        let turn = Vector3::new(0.1, 0.5, -0.2);
        let shift = Vector3::new(5.0, 6.0, 7.0);
        let (element, apart) = segment(Level::Beam);
        let rigid = [shift, turn, shift + turn.cross(&apart), turn];
        for s in [0.0, 0.3, 0.5, 0.9, 1.0] {
            for tie in [
                Tie::inside(&element, apart, s),
                Tie::torn(&element, apart, s),
            ] {
                let [moved, turned] = tie.motion(&rigid);
                let expected = shift + turn.cross(&(apart * s));
                assert!((moved - expected).norm() < 1e-13);
                assert!((turned - turn).norm() < 1e-15);
            }
        }
    }

    #[test]
    fn a_beam_moves_inside_as_if_it_had_a_node_there() {
        // the node between two halves, without a load, rests where the interpolation says
        let (whole, apart) = segment(Level::Beam);
        let s = 0.3;
        let parts = [
            Element::segment([0, 1], apart * s, &tube(), Level::Beam),
            Element::segment([1, 2], apart * (1.0 - s), &tube(), Level::Beam),
        ];
        let [shift, turn] = Tie::inside(&whole, apart, s).motion(&ends());
        let [a, b, c, d] = ends();
        let of = |part: usize, ends: &Ends| {
            let loads = parts[part].loads(&parts[part].deformation(ends));
            parts[part].forces(&loads)
        };
        let left = of(0, &[a, b, shift, turn]);
        let right = of(1, &[shift, turn, c, d]);
        assert!((left[2] + right[0]).norm() < 1e-10 * left[2].norm());
        assert!((left[3] + right[1]).norm() < 1e-10 * left[3].norm());
    }
}
