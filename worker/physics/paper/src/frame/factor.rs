//! The stiffness of the nodes that are free, and its Cholesky factor.
//!
//! A node is free in all its motions or held in all. The pattern is that of nodes, so that every entry
//! is a dense block; the order of elimination is ours.
use loadframe_numerics::{NoFactor, SparseCholesky};
use nalgebra::Vector3;

use super::element::{Element, Ends, Matrix12};
use super::error::FrameError;
use super::network::Network;
use super::order::{Graph, nested_dissection};

/// Place of a node that is not free.
const HELD: u32 = u32::MAX;

/// The free nodes' matrix: its pattern, made once, its values and their factor.
#[derive(Debug)]
pub(crate) struct Factor {
    motions: usize,
    /// Place of each node in the order of elimination.
    place: Vec<u32>,
    /// Free nodes in that order.
    free: Vec<u32>,
    /// Places before a node's own that it has a block with, ascending: `blocks[first[p]..first[p + 1]]`.
    first: Vec<u32>,
    blocks: Vec<u32>,
    /// The same by motions: the upper half by columns.
    cholesky: SparseCholesky,
}

impl Factor {
    /// Analyses the pattern of these elements between the nodes that are free.
    pub(crate) fn new<'e>(
        network: &Network,
        is_free: impl Fn(usize) -> bool,
        elements: impl Iterator<Item = &'e Element> + Clone,
    ) -> Result<Self, FrameError> {
        let pairs = elements.map(|element| element.nodes);
        Self::of_pairs(network.motions(), network.positions(), is_free, pairs)
    }

    /// Of no nodes at all.
    pub(crate) fn empty(network: &Network) -> Result<Self, FrameError> {
        Self::new(network, |_| false, [].iter())
    }

    /// The same of nodes with so many motions at these positions, by which pairs have a block.
    pub(crate) fn of_pairs(
        motions: usize,
        positions: &[Vector3<f64>],
        is_free: impl Fn(usize) -> bool,
        elements: impl Iterator<Item = [u32; 2]> + Clone,
    ) -> Result<Self, FrameError> {
        let (place, free) = ordered(positions, is_free, elements.clone());
        let mut pairs: Vec<[u32; 2]> = joined(&place, elements)
            .map(|[a, b]| [a.max(b), a.min(b)])
            .collect();
        pairs.sort_unstable();
        pairs.dedup();
        let mut first = vec![0; free.len() + 1];
        for pair in &pairs {
            first[pair[0] as usize + 1] += 1;
        }
        for at in 0..free.len() {
            first[at + 1] += first[at];
        }
        let blocks: Vec<u32> = pairs.iter().map(|pair| pair[1]).collect();

        let size = free.len() * motions;
        let mut starts = Vec::with_capacity(size + 1);
        let mut rows: Vec<u32> = Vec::new();
        for at in 0..free.len() {
            for motion in 0..motions {
                starts.push(rows.len() as u32);
                for &block in &blocks[first[at] as usize..first[at + 1] as usize] {
                    rows.extend((0..motions).map(|row| (block as usize * motions + row) as u32));
                }
                rows.extend((0..=motion).map(|row| (at * motions + row) as u32));
            }
        }
        starts.push(rows.len() as u32);
        let unknowns = (0..size as u32).collect();
        let cholesky = SparseCholesky::new(unknowns, starts, rows)
            .map_err(|_| FrameError::TooLarge { unknowns: size })?;
        Ok(Self {
            motions,
            place,
            free,
            first,
            blocks,
            cholesky,
        })
    }

    /// Number of unknowns.
    pub(crate) fn size(&self) -> usize {
        self.free.len() * self.motions
    }

    /// Stored entries of the factor.
    pub(crate) fn stored(&self) -> usize {
        self.cholesky.stored()
    }

    /// Multiplications that a factor takes.
    pub(crate) fn multiplications(&self) -> f64 {
        self.cholesky.multiplications()
    }

    /// Place of the first entry of a motion's column: before it come those of all nodes with earlier places,
    /// and of the node's own motions before.
    fn start(&self, place: usize, motion: usize) -> usize {
        let each = self.motions;
        let [first, next] = [self.first[place], self.first[place + 1]].map(|at| at as usize);
        let above = each * (next - first);
        each * each * first
            + place * (each * (each + 1) / 2)
            + motion * above
            + motion * (motion + 1) / 2
    }

    /// Place of a diagonal entry.
    fn diagonal(&self, unknown: usize) -> usize {
        let (place, motion) = (unknown / self.motions, unknown % self.motions);
        self.start(place, motion)
            + self.motions * (self.first[place + 1] - self.first[place]) as usize
            + motion
    }

    /// Sums the matrices of elements and factors.
    ///
    /// # Errors
    /// [`FrameError::GivesWay`] when it is not positive definite.
    pub(crate) fn factor(
        &mut self,
        network: &Network,
        elements: impl Iterator<Item = ([u32; 2], Matrix12)>,
    ) -> Result<(), FrameError> {
        self.sum(elements);
        self.factor_entries(network.positions())
    }

    /// Sums the matrices of elements.
    pub(crate) fn sum(&mut self, elements: impl Iterator<Item = ([u32; 2], Matrix12)>) {
        self.clear();
        for (nodes, matrix) in elements {
            self.add(nodes, &matrix);
        }
    }

    /// Forgets what was summed.
    pub(crate) fn clear(&mut self) {
        self.cholesky.entries_mut().fill(0.0);
    }

    /// Raises the diagonal by a share of its mean, displacements and rotations each of theirs, and factors
    /// what is summed.
    pub(crate) fn factor_shifted(
        &mut self,
        positions: &[Vector3<f64>],
        share: f64,
    ) -> Result<(), FrameError> {
        let mut sums = [0.0; 2];
        for column in 0..self.size() {
            let own = self.diagonal(column);
            sums[usize::from(column % self.motions > 2)] += self.cholesky.entries_mut()[own].abs();
        }
        let each = 3.0 * self.free.len() as f64;
        for column in 0..self.size() {
            let own = self.diagonal(column);
            self.cholesky.entries_mut()[own] +=
                share * sums[usize::from(column % self.motions > 2)] / each;
        }
        self.factor_entries(positions)
    }

    /// Factors what is summed.
    pub(crate) fn factor_entries(&mut self, positions: &[Vector3<f64>]) -> Result<(), FrameError> {
        self.cholesky.factor_entries().map_err(|error| match error {
            NoFactor::Indefinite { unknown } => {
                let node = self.free[unknown / self.motions] as usize;
                let [x, y, z] = positions[node].into();
                FrameError::GivesWay { node, x, y, z }
            }
            NoFactor::TooLarge => FrameError::TooLarge {
                unknowns: self.size(),
            },
        })
    }

    /// Adds a matrix over the motions of two nodes; of one, given twice, both its diagonal blocks.
    pub(crate) fn add(&mut self, nodes: [u32; 2], matrix: &Matrix12) {
        let places = nodes.map(|node| self.place[node as usize]);
        for (end, &place) in places.iter().enumerate() {
            if place != HELD {
                let place = place as usize;
                let before = self.motions * (self.first[place + 1] - self.first[place]) as usize;
                for column in 0..self.motions {
                    let start = self.start(place, column) + before;
                    for row in 0..=column {
                        self.cholesky.entries_mut()[start + row] +=
                            matrix[6 * end + row][6 * end + column];
                    }
                }
            }
        }
        if places.contains(&HELD) || places[0] == places[1] {
            return;
        }
        // columns of the later node, rows of the earlier one
        let (later, earlier) = if places[0] > places[1] {
            (0, 1)
        } else {
            (1, 0)
        };
        let place = places[later] as usize;
        let range = self.first[place] as usize..self.first[place + 1] as usize;
        let rank = self.blocks[range].partition_point(|&block| block < places[earlier]);
        for column in 0..self.motions {
            let start = self.start(place, column) + rank * self.motions;
            for row in 0..self.motions {
                self.cholesky.entries_mut()[start + row] +=
                    matrix[6 * earlier + row][6 * later + column];
            }
        }
    }

    /// Unknown of a node's first motion; none when the node is held.
    pub(crate) fn unknown(&self, node: u32) -> Option<usize> {
        let place = self.place[node as usize];
        (place != HELD).then(|| place as usize * self.motions)
    }

    /// Entries of a vector that acts on two nodes.
    pub(crate) fn column(&self, nodes: [u32; 2], ends: &Ends) -> Vec<(u32, f64)> {
        let mut column = Vec::with_capacity(2 * self.motions);
        for (end, node) in nodes.into_iter().enumerate() {
            if let Some(first) = self.unknown(node) {
                for motion in 0..self.motions {
                    let value = ends[2 * end + motion / 3][motion % 3];
                    if value != 0.0 {
                        column.push(((first + motion) as u32, value));
                    }
                }
            }
        }
        column
    }

    /// Free nodes in order of elimination.
    pub(crate) fn free(&self) -> &[u32] {
        &self.free
    }

    /// Solves for `count` right sides, one after the other in `columns`, in place.
    pub(crate) fn solve(&self, columns: &mut [f64], count: usize) {
        self.cholesky.solve_free(columns, count);
    }
}

/// Pairs of free nodes that an element joins, as places.
fn joined(
    place: &[u32],
    elements: impl Iterator<Item = [u32; 2]>,
) -> impl Iterator<Item = [u32; 2]> {
    elements
        .map(|nodes| nodes.map(|node| place[node as usize]))
        .filter(|[a, b]| *a != HELD && *b != HELD && a != b)
}

/// Place of each node, and the free nodes in order of elimination.
fn ordered(
    positions: &[Vector3<f64>],
    is_free: impl Fn(usize) -> bool,
    elements: impl Iterator<Item = [u32; 2]> + Clone,
) -> (Vec<u32>, Vec<u32>) {
    let numbered: Vec<u32> = (0..positions.len() as u32)
        .filter(|&node| is_free(node as usize))
        .collect();
    let mut place = vec![HELD; positions.len()];
    for (at, &node) in numbered.iter().enumerate() {
        place[node as usize] = at as u32;
    }
    let mut starts = vec![0_u32; numbered.len() + 1];
    for [a, b] in joined(&place, elements.clone()) {
        starts[a as usize + 1] += 1;
        starts[b as usize + 1] += 1;
    }
    for at in 0..numbered.len() {
        starts[at + 1] += starts[at];
    }
    let mut next = starts.clone();
    let mut neighbours = vec![0; starts[numbered.len()] as usize];
    for [a, b] in joined(&place, elements) {
        for (own, other) in [(a, b), (b, a)] {
            neighbours[next[own as usize] as usize] = other;
            next[own as usize] += 1;
        }
    }
    let places: Vec<[f64; 2]> = numbered
        .iter()
        .map(|&node| {
            let at = &positions[node as usize];
            [at.x, at.y]
        })
        .collect();
    let order = nested_dissection(&Graph {
        places: &places,
        starts: &starts,
        neighbours: &neighbours,
    });
    let free: Vec<u32> = order.iter().map(|&at| numbered[at as usize]).collect();
    for (at, &node) in free.iter().enumerate() {
        place[node as usize] = at as u32;
    }
    (place, free)
}
