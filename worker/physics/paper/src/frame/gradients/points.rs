//! Points of bonds as iterations see them: how each moves with the nodes of its segment, and what its bond resists.
//!
//! Points are in the order of fibres, so that what is read is read in a row, but for the motion of the other point
//! of a bond. Bars neither bend nor turn: a point of theirs goes by one weight, and its bond resists displacement
//! alone. Passes take as long as it takes to read, and these points are a fourth of those of beams.
use loadframe_numerics::Team;
use nalgebra::{RealField, Vector3};

use super::super::tie::Tie;
use super::scalar::Scalar;

/// Motions of a node of bars: they only shift.
pub(super) const OF_BARS: usize = 3;

/// All points, with M motions each.
#[derive(Debug)]
pub(super) struct Points<T, const M: usize> {
    /// Of beams; none of bars.
    ties: Vec<Tie<T>>,
    /// Of bars: nodes of the segment, and the share that moves with the first; none of beams.
    weights: Vec<([u32; 2], T)>,
    /// The other point of each one's bond.
    others: Vec<u32>,
    /// Stiffness of the bond against displacement, the same in all directions; 0 when it is not active.
    stiffness: Vec<T>,
    /// The same against rotation, of beams.
    turning: Vec<T>,
    /// How points moved with their nodes last.
    moved: Vec<[T; M]>,
}

impl<T: Scalar, const M: usize> Points<T, M> {
    /// Points by how they are tied and the other of their bond; of no stiffness yet.
    pub(super) fn new(ties: impl ExactSizeIterator<Item = (Tie<T>, u32)>) -> Self {
        let count = ties.len();
        let of_beams = if M == OF_BARS { 0 } else { count };
        let mut points = Self {
            ties: Vec::with_capacity(of_beams),
            weights: Vec::with_capacity(count - of_beams),
            others: Vec::with_capacity(count),
            stiffness: vec![T::zero(); count],
            turning: vec![T::zero(); of_beams],
            moved: vec![[T::zero(); M]; count],
        };
        for (tie, other) in ties {
            points.others.push(other);
            if M == OF_BARS {
                points.weights.push((tie.nodes, tie.linear));
            } else {
                points.ties.push(tie);
            }
        }
        points
    }

    pub(super) fn len(&self) -> usize {
        self.others.len()
    }

    pub(super) fn other(&self, at: usize) -> u32 {
        self.others[at]
    }

    pub(super) fn tie(&self, at: usize) -> Tie<T> {
        if M == OF_BARS {
            let (nodes, linear) = self.weights[at];
            Tie::by_weight(nodes, linear)
        } else {
            self.ties[at]
        }
    }

    pub(super) fn set_tie(&mut self, at: usize, tie: Tie<T>) {
        if M == OF_BARS {
            self.weights[at] = (tie.nodes, tie.linear);
        } else {
            self.ties[at] = tie;
        }
    }

    /// Stiffness against displacement and rotation.
    pub(super) fn stiffness(&self, at: usize) -> [T; 2] {
        let turning = self.turning.get(at).copied();
        [self.stiffness[at], turning.unwrap_or_else(T::zero)]
    }

    pub(super) fn set_stiffness(&mut self, at: usize, [stiffness, turning]: [T; 2]) {
        self.stiffness[at] = stiffness;
        if let Some(own) = self.turning.get_mut(at) {
            *own = turning;
        }
    }

    /// Moves all points with their nodes.
    pub(super) fn follow(&mut self, team: &Team, motion: &[[T; M]]) {
        let (ties, weights) = (&self.ties, &self.weights);
        team.fill(&mut self.moved, |start, moved| {
            if M == OF_BARS {
                for (&(nodes, first), moved) in weights[start..].iter().zip(moved) {
                    let [from, to] = nodes.map(|node| &motion[node as usize]);
                    *moved = std::array::from_fn(|axis| to[axis] + (from[axis] - to[axis]) * first);
                }
            } else {
                for (tie, moved) in ties[start..].iter().zip(moved) {
                    *moved = flat(tie.motion(&ends_of(motion, tie.nodes)));
                }
            }
            0.0
        });
    }

    /// What an active bond pulls with at a point, as the other of its points moved.
    #[inline]
    pub(super) fn pulled(&self, at: usize) -> Option<[T; M]> {
        self.resisted(at, |_, there| there)
    }

    /// What an active bond resists at a point, as both of its points moved.
    #[inline]
    pub(super) fn held(&self, at: usize) -> Option<[T; M]> {
        self.resisted(at, |here, there| here - there)
    }

    #[inline]
    fn resisted(&self, at: usize, motion: impl Fn(T, T) -> T) -> Option<[T; M]> {
        let stiffness = self.stiffness[at];
        (stiffness > T::zero()).then(|| {
            let (here, there) = (&self.moved[at], &self.moved[self.others[at] as usize]);
            let turning = if M == OF_BARS {
                stiffness
            } else {
                self.turning[at]
            };
            std::array::from_fn(|part| {
                let stiffness = if part < 3 { stiffness } else { turning };
                motion(here[part], there[part]) * stiffness
            })
        })
    }

    /// Adds what acts on a point to the nodes of its fibre, whose first is `first`.
    #[inline]
    pub(super) fn add(&self, at: usize, load: &[T; M], own: &mut [[T; M]], first: u32) {
        if M == OF_BARS {
            let (nodes, weight) = self.weights[at];
            for (node, share) in nodes.into_iter().zip([weight, T::one() - weight]) {
                for (own, load) in own[(node - first) as usize].iter_mut().zip(load) {
                    *own += *load * share;
                }
            }
            return;
        }
        let tie = &self.ties[at];
        let forces = tie.spread(parts(load));
        let [at, next] = tie.nodes.map(|node| (node - first) as usize);
        add(&mut own[at], forces[0], forces[1]);
        if next != at {
            add(&mut own[next], forces[2], forces[3]);
        }
    }
}

/// Motion of two nodes.
#[inline]
pub(super) fn ends_of<T: RealField + Copy, const M: usize>(
    motion: &[[T; M]],
    nodes: [u32; 2],
) -> [Vector3<T>; 4] {
    let [first, second] = nodes.map(|node| parts(&motion[node as usize]));
    [first[0], first[1], second[0], second[1]]
}

/// Displacement and rotation of a node or point.
#[inline]
pub(super) fn parts<T: RealField + Copy, const M: usize>(motion: &[T; M]) -> [Vector3<T>; 2] {
    let mut parts = [Vector3::zeros(); 2];
    for (index, value) in motion.iter().enumerate() {
        parts[index / 3][index % 3] = *value;
    }
    parts
}

/// The same in a row.
#[inline]
pub(super) fn flat<T: Copy, const M: usize>(parts: [Vector3<T>; 2]) -> [T; M] {
    std::array::from_fn(|index| parts[index / 3][index % 3])
}

/// Adds a force and a moment on a node.
#[inline]
pub(super) fn add<T: RealField + Copy, const M: usize>(
    to: &mut [T; M],
    force: Vector3<T>,
    moment: Vector3<T>,
) {
    for (index, value) in to.iter_mut().enumerate() {
        *value += if index < 3 {
            force[index]
        } else {
            moment[index - 3]
        };
    }
}
