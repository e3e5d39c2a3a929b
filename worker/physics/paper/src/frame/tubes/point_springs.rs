//! Springs over points, each of which feels a weighted sum of their displacements.
use nalgebra::{Matrix3, Vector3};

use super::super::balance::{Forces, Motion};
use super::super::element::{Matrix12, PARTS};

/// Round-off of a spring, over what it is of an element of beams: it feels differences of near points, and what is
/// left is the last bits of their displacements, 1e-14 of stiffness times displacement where that is 1e-11.
const NEAR_POINTS: f64 = 1e-3;

/// A spring to be.
#[derive(Debug, Clone)]
pub(crate) struct PointSpring {
    /// Points, and what of their displacement it feels.
    pub(crate) entries: Vec<(u32, Vector3<f64>)>,
    /// [mN/µm], or [mN µm] where it feels a rotation.
    pub(crate) stiffness: f64,
    /// Its share in the loads of its part, for a unit of its force.
    pub(crate) loads: [f64; PARTS],
}

/// The springs of a part of a tube, or of a bond.
#[derive(Debug, Clone)]
pub(crate) struct PointSprings {
    pairs: Vec<[u32; 2]>,
    /// Of all springs, one after the other, each by point, and where each spring's end.
    entries: Vec<(u32, Vector3<f64>)>,
    ends: Vec<usize>,
    stiffness: Vec<f64>,
    loads: Vec<[f64; PARTS]>,
}

impl PointSprings {
    pub(crate) fn new(springs: Vec<PointSpring>) -> Self {
        let mut all = Self {
            pairs: Vec::new(),
            entries: Vec::new(),
            ends: Vec::new(),
            stiffness: Vec::with_capacity(springs.len()),
            loads: Vec::with_capacity(springs.len()),
        };
        for mut spring in springs {
            // both sides of a bond of a fibre with itself may hold the same point
            spring.entries.sort_by_key(|(point, _)| *point);
            let start = all.entries.len();
            for (point, weight) in spring.entries {
                match all.entries[start..].last_mut() {
                    Some(last) if last.0 == point => last.1 += weight,
                    _ => all.entries.push((point, weight)),
                }
            }
            let points = || all.entries[start..].iter().map(|(point, _)| *point);
            let pairs =
                points().flat_map(|a| points().filter(move |&b| a < b).map(move |b| [a, b]));
            let pairs: Vec<[u32; 2]> = pairs.collect();
            all.pairs.extend(pairs);
            all.ends.push(all.entries.len());
            all.stiffness.push(spring.stiffness);
            all.loads.push(spring.loads);
        }
        all.pairs.sort_unstable();
        all.pairs.dedup();
        all
    }

    /// Points that a spring feels, and what of their displacement.
    pub(crate) fn spring(&self, spring: usize) -> &[(u32, Vector3<f64>)] {
        let start = spring.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.entries[start..self.ends[spring]]
    }

    fn deformation(&self, spring: usize, motion: &Motion) -> f64 {
        if let [(low, _), (high, along)] = self.spring(spring) {
            // a difference first: what both points go together is not rounded
            let [from, to] = [low, high].map(|point| motion.nodes[*point as usize][0]);
            return along.dot(&(to - from));
        }
        let parts = self.spring(spring).iter();
        parts
            .map(|(point, weight)| weight.dot(&motion.nodes[*point as usize][0]))
            .sum()
    }

    /// Springs from `first` on that feel the same points.
    fn alike(&self, first: usize) -> usize {
        let points = |spring: usize| self.spring(spring).iter().map(|(point, _)| *point);
        let others = first + 1..self.stiffness.len();
        1 + others
            .take_while(|&other| points(other).eq(points(first)))
            .count()
    }

    /// A node that they join.
    pub(crate) fn first_node(&self) -> u32 {
        self.entries[0].0
    }

    /// Nodes that have a block of the matrix with one another.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = [u32; 2]> + Clone {
        self.pairs.iter().copied()
    }

    /// Gives their matrix, by pairs of nodes.
    pub(crate) fn matrices(&self, add: &mut dyn FnMut([u32; 2], &Matrix12)) {
        let mut first = 0;
        while first < self.stiffness.len() {
            let springs = first..first + self.alike(first);
            first = springs.end;
            let points = self.spring(springs.start);
            for (row, &(a, _)) in points.iter().enumerate() {
                for (column, &(b, _)) in points.iter().enumerate().skip(row) {
                    let block: Matrix3<f64> = springs
                        .clone()
                        .map(|spring| {
                            let entries = self.spring(spring);
                            entries[row].1 * entries[column].1.transpose() * self.stiffness[spring]
                        })
                        .sum();
                    let mut matrix = [[0.0; 12]; 12];
                    for i in 0..3 {
                        for j in 0..3 {
                            if row == column {
                                matrix[i][j] = block[(i, j)];
                            } else {
                                matrix[i][6 + j] = block[(i, j)];
                                matrix[6 + j][i] = block[(i, j)];
                            }
                        }
                    }
                    add([a, b], &matrix);
                }
            }
        }
    }

    /// c of every spring [mN/µm or mN µm].
    pub(crate) fn stiffness(&self) -> &[f64] {
        &self.stiffness
    }

    /// d of every spring.
    pub(crate) fn deformations(&self, motion: &Motion) -> Vec<f64> {
        let springs = 0..self.stiffness.len();
        springs
            .map(|spring| self.deformation(spring, motion))
            .collect()
    }

    /// Loads q of the part.
    pub(crate) fn loads(&self, motion: &Motion) -> [f64; PARTS] {
        let mut loads = [0.0; PARTS];
        for spring in 0..self.stiffness.len() {
            let force = self.stiffness[spring] * self.deformation(spring, motion);
            for (load, share) in loads.iter_mut().zip(&self.loads[spring]) {
                *load += force * share;
            }
        }
        loads
    }

    /// Adds what they do to their nodes; gives the loads q of the part.
    pub(crate) fn push(&self, motion: &Motion, forces: &mut Forces) -> [f64; PARTS] {
        let mut loads = [0.0; PARTS];
        for spring in 0..self.stiffness.len() {
            let deformation = self.deformation(spring, motion);
            let force = self.stiffness[spring] * deformation;
            forces.energy += 0.5 * force * deformation;
            for (point, weight) in self.spring(spring) {
                let pull = weight * force;
                forces.nodes[*point as usize][0] += pull;
                forces.scale = forces.scale.max(pull.amax());
                let farthest = motion.nodes[*point as usize][0].amax() * weight.amax();
                let round_off = NEAR_POINTS * self.stiffness[spring] * farthest;
                forces.round_off = forces.round_off.max(round_off);
            }
            for (load, share) in loads.iter_mut().zip(&self.loads[spring]) {
                *load += force * share;
            }
        }
        loads
    }
}
