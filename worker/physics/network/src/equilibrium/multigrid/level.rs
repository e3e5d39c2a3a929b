//! One grid of the hierarchy: the stiffness between the corners of its cells.
use std::array;

use loadframe_numerics::wide;

use super::{
    super::block_jacobi::invert,
    corners::{Corners, Vectors, offsets, weight_differences, weights, zeros},
    mesh::Mesh,
};
use crate::{
    assembly::Assembly,
    field::{LANES, Real},
    stiffness::Stiffness,
};

/// xx, yy, xy, zz, xz, yz of a symmetric block.
pub(super) type Block = [f32; 6];

/// The stiffness of a cell between its corners, pair by pair.
type Cell = [Block; PAIRS.len()];

/// Part of its own relaxation that a corner moves when all move at once. A cell's stiffness is at
/// most four times its diagonal, as many as it has corners; less than two over that keeps the
/// relaxation positive.
const RELAXATION: f32 = 0.45;
/// Pairs of corners of a cell, each with itself included.
const PAIRS: [(usize, usize); 10] = [
    (0, 0),
    (0, 1),
    (0, 2),
    (0, 3),
    (1, 1),
    (1, 2),
    (1, 3),
    (2, 2),
    (2, 3),
    (3, 3),
];
/// Bonds added to their cells at once.
const AT_ONCE: usize = 128;
/// Relaxations before, and after, the coarser correction.
const SWEEPS: usize = 2;

#[derive(Debug)]
pub(super) struct Level {
    /// Corners along x and y.
    planes: [usize; 2],
    /// Of the cells, by their first corner.
    cells: Vec<Cell>,
    /// Stiffness of the corners themselves, one array per part of a block.
    diagonal: [Vec<f32>; 6],
    /// Stiffness between corners this far apart, by the number of the first.
    links: Vec<(usize, [Vec<f32>; 6])>,
    /// Of the diagonal; zero at the jaws.
    inverses: [Vec<f32>; 6],
}

impl Level {
    /// The cells of the mesh with the stiffness of the bonds in them; the part of it that makes
    /// compressed bonds buckle is left out.
    pub(super) fn finest<T: Real>(
        mesh: &Mesh,
        assembly: &Assembly,
        stiffness: &Stiffness<T>,
    ) -> Self {
        let mut cells = vec![Parts([[0.0; LANES]; 6]); mesh.corners()];
        let mut shares = Vec::with_capacity(AT_ONCE);
        let free = assembly.free();
        for slot in 0..assembly.ends.len() {
            let block = stiffness.positive(slot).map(|part| part.wide() as f32);
            // a bond that does not act has no stiffness
            if block.iter().all(|part| *part == 0.0) {
                continue;
            }
            let ends = assembly.ends[slot].map(|end| end as usize);
            let is_free = ends.map(|end| free.contains(&end));
            let [first, second] = ends.map(|end| assembly.positions.at(end));
            let (corner, change): (usize, Corners) = match is_free {
                [true, true] => {
                    let (corner, at) = mesh.locate(&(0.5 * (first + second)));
                    let along = mesh.in_cells(&(second - first));
                    (
                        corner,
                        weight_differences(at.map(|v| v as f32), along.map(|v| v as f32)),
                    )
                }
                [false, false] => continue,
                [true, false] | [false, true] => {
                    let (corner, at) = mesh.locate(if is_free[0] { &first } else { &second });
                    (corner, weights(at.map(|v| v as f32)))
                }
            };
            let mut factors = [0.0; LANES];
            for (factor, (a, b)) in factors.iter_mut().zip(PAIRS) {
                *factor = change[a] * change[b];
            }
            shares.push(Share {
                corner,
                factors,
                block,
            });
            if shares.len() == AT_ONCE {
                add_shares(&shares, &mut cells);
                shares.clear();
            }
        }
        add_shares(&shares, &mut cells);
        let pairs = |Parts(parts): &Parts| array::from_fn(|pair| parts.map(|part| part[pair]));
        Self::new(mesh.planes(), cells.iter().map(pairs).collect())
    }

    /// From the stiffness of its cells, by their first corner.
    fn new(planes: [usize; 2], cells: Vec<Cell>) -> Self {
        let corners = planes[0] * planes[1];
        let offsets = offsets(planes[0]);
        let zeros = || [0; 6].map(|_: i32| vec![0.0_f32; corners]);
        let mut diagonal = zeros();
        let mut links: Vec<(usize, [Vec<f32>; 6])> = Vec::new();
        for (pair, (a, b)) in PAIRS.into_iter().enumerate() {
            let apart = offsets[b] - offsets[a];
            let into = if apart == 0 {
                &mut diagonal
            } else {
                let found = links.iter().position(|(offset, _)| *offset == apart);
                let link = found.unwrap_or_else(|| {
                    links.push((apart, zeros()));
                    links.len() - 1
                });
                &mut links[link].1
            };
            for (corner, cell) in cells.iter().enumerate() {
                // beyond the last cell of a row there is none
                if cell[pair].iter().any(|part| *part != 0.0) {
                    for part in 0..6 {
                        into[part][corner + offsets[a]] += cell[pair][part];
                    }
                }
            }
        }
        let mut inverses = diagonal.clone();
        invert::<f32, 3>(&mut inverses.each_mut().map(Vec::as_mut_slice));
        let mut level = Self {
            planes,
            cells,
            diagonal,
            links,
            inverses: Default::default(),
        };
        for corner in 0..corners {
            if level.is_held(corner) {
                for part in &mut inverses {
                    part[corner] = 0.0;
                }
            }
        }
        level.inverses = inverses;
        level
    }

    pub(super) fn corners(&self) -> usize {
        self.planes[0] * self.planes[1]
    }

    /// Whether a corner is at a jaw.
    pub(super) fn is_held(&self, corner: usize) -> bool {
        let row = corner / self.planes[0];
        row == 0 || row + 1 == self.planes[1]
    }

    /// Twice as large cells along every axis on which they pair up; `None` when they do on none.
    pub(super) fn coarser(&self) -> Option<Self> {
        let halved = self.halved();
        if halved == [false; 2] {
            return None;
        }
        let planes = self.coarser_planes();
        let mut cells = vec![[[0.0; 6]; PAIRS.len()]; planes[0] * planes[1]];
        for (corner, cell) in self.cells.iter().enumerate() {
            let at = [corner % self.planes[0], corner / self.planes[0]];
            let above = [0, 1].map(|axis| at[axis] >> u8::from(halved[axis]));
            // weights of the large cell's corners at each corner of this one
            let weights = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|own| {
                weights([0, 1].map(|axis| match halved[axis] {
                    true => 0.5 * ((at[axis] & 1) + own[axis]) as f32,
                    false => own[axis] as f32,
                }))
            });
            add_projected(cell, &weights, &mut cells[above[1] * planes[0] + above[0]]);
        }
        Some(Self::new(planes, cells))
    }

    /// Along which axes the coarser grid has half the cells.
    fn halved(&self) -> [bool; 2] {
        self.planes
            .map(|corners| corners > 4 && (corners - 1).is_multiple_of(2))
    }

    fn coarser_planes(&self) -> [usize; 2] {
        let halved = self.halved();
        [0, 1].map(|axis| (self.planes[axis] - 1) / (1 + usize::from(halved[axis])) + 1)
    }

    /// Sets off from rest: relaxations under `force`.
    pub(super) fn smooth_from_rest(&self, force: &Vectors) -> Vectors {
        let mut moved = zeros(self.corners());
        self.relax(force, &mut moved);
        for _ in 1..SWEEPS {
            let left = self.residual(force, &moved);
            self.relax(&left, &mut moved);
        }
        moved
    }

    /// Relaxations under `force` from where the corners are.
    pub(super) fn smooth(&self, force: &Vectors, moved: &mut Vectors) {
        for _ in 0..SWEEPS {
            let left = self.residual(force, moved);
            self.relax(&left, moved);
        }
    }

    fn relax(&self, force: &Vectors, moved: &mut Vectors) {
        wide(
            #[inline(always)]
            || add_product(&self.inverses, RELAXATION, slices(force), slices_mut(moved)),
        );
    }

    /// What is left of `force` with the corners `moved`.
    pub(super) fn residual(&self, force: &Vectors, moved: &Vectors) -> Vectors {
        let mut left = force.clone();
        wide(
            #[inline(always)]
            || {
                add_product(&self.diagonal, -1.0, slices(moved), slices_mut(&mut left));
                for (apart, blocks) in &self.links {
                    let (apart, count) = (*apart, self.corners() - apart);
                    let from = moved.each_ref().map(|values| &values[apart..]);
                    let to = left.each_mut().map(|values| &mut values[..count]);
                    add_product(blocks, -1.0, from, to);
                    let from = moved.each_ref().map(|values| &values[..count]);
                    let to = left.each_mut().map(|values| &mut values[apart..]);
                    add_product(blocks, -1.0, from, to);
                }
            },
        );
        left
    }

    /// Forces on the corners of the coarser grid that do the work of these.
    pub(super) fn restrict(&self, force: &Vectors) -> Vectors {
        let [across, up] = self.coarser_planes();
        let mut sums = zeros(across * up);
        self.each_weight(|corner, coarse, weight| {
            for axis in 0..3 {
                sums[axis][coarse] += weight * force[axis][corner];
            }
        });
        sums
    }

    /// Adds displacements interpolated from the coarser grid.
    pub(super) fn prolong(&self, coarse: &Vectors, moved: &mut Vectors) {
        self.each_weight(|corner, other, weight| {
            for axis in 0..3 {
                moved[axis][corner] += weight * coarse[axis][other];
            }
        });
    }

    /// Calls for every corner here, every corner of the coarser grid it hangs on, and the weight.
    #[inline]
    fn each_weight(&self, mut call: impl FnMut(usize, usize, f32)) {
        let halved = self.halved();
        let [across, _] = self.coarser_planes();
        let parents = |axis: usize, at: usize| match (halved[axis], at % 2) {
            (false, _) => [(at, 1.0), (at, 0.0)],
            (true, 0) => [(at / 2, 1.0), (at / 2, 0.0)],
            (true, _) => [(at / 2, 0.5), (at / 2 + 1, 0.5)],
        };
        for y in 0..self.planes[1] {
            for x in 0..self.planes[0] {
                for (row, along) in parents(1, y) {
                    for (column, beside) in parents(0, x) {
                        let weight = along * beside;
                        if weight > 0.0 {
                            call(y * self.planes[0] + x, row * across + column, weight);
                        }
                    }
                }
            }
        }
    }

    /// The stiffness between two corners, row by row of the whole matrix: calls with each block.
    pub(super) fn each_block(&self, mut call: impl FnMut(usize, usize, Block)) {
        for corner in 0..self.corners() {
            call(
                corner,
                corner,
                self.diagonal.each_ref().map(|part| part[corner]),
            );
            for (apart, blocks) in &self.links {
                if corner + apart < self.corners() {
                    call(
                        corner,
                        corner + apart,
                        blocks.each_ref().map(|part| part[corner]),
                    );
                }
            }
        }
    }
}

/// The stiffness of a cell part by part, each for all pairs: whole vectors, none across two lines of
/// memory.
#[derive(Clone)]
#[repr(align(64))]
struct Parts([[f32; LANES]; 6]);

/// What a bond adds to its cell.
struct Share {
    /// First corner of the cell.
    corner: usize,
    /// Part of the block that each pair has.
    factors: [f32; LANES],
    block: Block,
}

/// Adds what bonds have to their cells, those of one cell in a row at once.
fn add_shares(shares: &[Share], cells: &mut [Parts]) {
    wide(
        #[inline(always)]
        || {
            let mut next = 0;
            while next < shares.len() {
                let corner = shares[next].corner;
                let mut sums = cells[corner].0;
                while next < shares.len() && shares[next].corner == corner {
                    let Share { factors, block, .. } = &shares[next];
                    for (sums, part) in sums.iter_mut().zip(block) {
                        for (sum, factor) in sums.iter_mut().zip(factors) {
                            *sum = factor.mul_add(*part, *sum);
                        }
                    }
                    next += 1;
                }
                cells[corner].0 = sums;
            }
        },
    );
}

/// Adds Wᵀ K W to a cell, K of a cell within it.
fn add_projected(cell: &Cell, weights: &[Corners; 4], into: &mut Cell) {
    // K W first
    let mut half = [[[0.0_f32; 6]; 4]; 4];
    for (block, (a, b)) in cell.iter().zip(PAIRS) {
        for other in 0..4 {
            for part in 0..6 {
                half[a][other][part] += block[part] * weights[b][other];
                if a != b {
                    half[b][other][part] += block[part] * weights[a][other];
                }
            }
        }
    }
    for (block, (a, b)) in into.iter_mut().zip(PAIRS) {
        for own in 0..4 {
            for part in 0..6 {
                block[part] += weights[own][a] * half[own][b][part];
            }
        }
    }
}

/// `to` += `factor` B `from`, block by block.
#[inline(always)]
fn add_product(blocks: &[Vec<f32>; 6], factor: f32, from: [&[f32]; 3], to: [&mut [f32]; 3]) {
    let [fx, fy, fz] = from;
    let [tx, ty, tz] = to;
    let count = fx.len();
    let (fy, fz, tx, ty, tz) = (
        &fy[..count],
        &fz[..count],
        &mut tx[..count],
        &mut ty[..count],
        &mut tz[..count],
    );
    let [xx, yy, xy, zz, xz, yz] = blocks.each_ref().map(
        #[inline(always)]
        |part| &part[..count],
    );
    for i in 0..count {
        let (x, y, z) = (factor * fx[i], factor * fy[i], factor * fz[i]);
        tx[i] += xx[i] * x + xy[i] * y + xz[i] * z;
        ty[i] += xy[i] * x + yy[i] * y + yz[i] * z;
        tz[i] += xz[i] * x + yz[i] * y + zz[i] * z;
    }
}

#[inline(always)]
fn slices(vectors: &Vectors) -> [&[f32]; 3] {
    vectors.each_ref().map(Vec::as_slice)
}

#[inline(always)]
fn slices_mut(vectors: &mut Vectors) -> [&mut [f32]; 3] {
    vectors.each_mut().map(Vec::as_mut_slice)
}
