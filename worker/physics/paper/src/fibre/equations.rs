//! The stiffness matrix of a tube's springs for the displacements that are free, and its factor.
//!
//! Points are eliminated ring by ring, as they are numbered: the matrix is a narrow band along the
//! tube, for which no other order fills in less.
use loadframe_numerics::{NoFactor, SparseCholesky};

use super::{Spring, Tube, TubeError};

/// Place of a displacement that is not free.
const HELD: u32 = u32::MAX;

/// A spring's part of the matrix, along and across its direction.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stiffness {
    /// Unit vector from the lower point to the higher.
    pub(super) direction: [f64; 3],
    /// [mN/µm]
    pub(super) along: f64,
    /// Force over length [mN/µm].
    pub(super) across: f64,
}

impl Stiffness {
    /// (k - f/L) n nᵀ + (f/L) 1.
    fn block(&self) -> [[f64; 3]; 3] {
        let mut block = [[0.0; 3]; 3];
        for (row, entries) in block.iter_mut().enumerate() {
            for (column, entry) in entries.iter_mut().enumerate() {
                *entry = (self.along - self.across) * self.direction[row] * self.direction[column];
            }
            entries[row] += self.across;
        }
        block
    }
}

/// Pattern of the matrix with its factor, made once for a tube and its supports.
#[derive(Debug)]
pub(super) struct Equations {
    /// Where in `blocks` each entry comes from.
    sources: Vec<u32>,
    /// Blocks of a spring: of its lower point, of its higher, and between.
    of_spring: Vec<[u32; 3]>,
    blocks: Vec<[f64; 9]>,
    factor: SparseCholesky,
    points: usize,
}

impl Equations {
    /// Analyses the pattern for the displacements that are not held.
    pub(super) fn new(tube: &Tube, held: &[bool]) -> Result<Self, TubeError> {
        let points = tube.places_um().len();
        let mut below: Vec<Vec<u32>> = (0..points as u32).map(|point| vec![point]).collect();
        for spring in tube.springs() {
            below[spring.points[1] as usize].push(spring.points[0]);
        }
        let mut first_block = Vec::with_capacity(points);
        let mut blocks = 0;
        for all in &mut below {
            all.sort_unstable();
            all.dedup();
            first_block.push(blocks);
            blocks += all.len() as u32;
        }
        let block = |high: u32, low: u32| -> u32 {
            let all = &below[high as usize];
            first_block[high as usize] + all.partition_point(|&point| point < low) as u32
        };
        let of_spring = tube.springs().iter().map(|spring| {
            let [low, high] = spring.points;
            [block(low, low), block(high, high), block(high, low)]
        });
        let of_spring = of_spring.collect();

        let mut place = vec![HELD; held.len()];
        let mut free = Vec::new();
        for (displacement, _) in held.iter().enumerate().filter(|(_, held)| !**held) {
            place[displacement] = free.len() as u32;
            free.push(displacement as u32);
        }
        let (mut starts, mut rows, mut sources) = (vec![0], Vec::new(), Vec::new());
        for &displacement in &free {
            let (point, axis) = (displacement / 3, displacement % 3);
            for &other in &below[point as usize] {
                for other_axis in 0..3 {
                    let row = place[(3 * other + other_axis) as usize];
                    if row <= place[displacement as usize] {
                        rows.push(row);
                        sources.push(9 * block(point, other) + 3 * axis + other_axis);
                    }
                }
            }
            starts.push(rows.len() as u32);
        }
        let factor = SparseCholesky::new(free, starts, rows);
        Ok(Self {
            factor: factor.map_err(|error| told(error, points))?,
            sources,
            of_spring,
            blocks: vec![[0.0; 9]; blocks as usize],
            points,
        })
    }

    /// Factors the matrix of these springs.
    pub(super) fn factor(
        &mut self,
        stiffness: impl Iterator<Item = Stiffness>,
    ) -> Result<(), TubeError> {
        self.blocks.fill([0.0; 9]);
        for (spring, [low, high, between]) in stiffness.zip(&self.of_spring) {
            let block = spring.block();
            let flat = block.as_flattened();
            for (at, sign) in [(low, 1.0), (high, 1.0), (between, -1.0)] {
                for (sum, part) in self.blocks[*at as usize].iter_mut().zip(flat) {
                    *sum += sign * part;
                }
            }
        }
        let entries = self.sources.iter().map(|&source| {
            let source = source as usize;
            self.blocks[source / 9][source % 9]
        });
        let outcome = self.factor.factor(entries);
        outcome.map_err(|error| told(error, self.points))
    }

    /// Solves for the free displacements, reading forces and writing displacements there; all others
    /// become 0.
    pub(super) fn solve(&self, forces: &[f64], displacements: &mut [f64]) {
        self.factor.solve(forces, displacements);
    }
}

/// What to tell of a tube that has no factor.
fn told(error: NoFactor, points: usize) -> TubeError {
    match error {
        NoFactor::Indefinite { unknown } => TubeError::Unstable { point: unknown / 3 },
        NoFactor::TooLarge => TubeError::TooLarge { points },
    }
}

/// A spring's direction and length [µm] in a place.
pub(super) fn direction(spring: &Spring, places: &[[f64; 3]]) -> ([f64; 3], f64) {
    let [low, high] = spring.points.map(|point| places[point as usize]);
    let apart = [0, 1, 2].map(|axis| high[axis] - low[axis]);
    let length = (apart[0] * apart[0] + apart[1] * apart[1] + apart[2] * apart[2]).sqrt();
    (apart.map(|part| part / length), length)
}
