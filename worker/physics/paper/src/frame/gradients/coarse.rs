//! Neighbourhoods as rigid bodies: six motions at every point of a grid over the sheet.
//!
//! With bilinear weights φ of the corners of a cell, the motions t, ω of its corners at places X_c move a
//! point X by Σ φ (t + ω × (X - X_c)) and turn it by Σ φ ω: a rigid motion of all corners is one of the
//! sheet. The jaws hold the corners at x = 0 and at the distance of the jaws. The matrix is
//! that of the elements between points that move so, each in the cell of its middle: where a segment
//! reaches into the next cell, the weights of its own go on. That is near enough for a preconditioner,
//! and makes the matrix one of bilinear finite elements.
use std::ops::Range;

use loadframe_numerics::Team;
use nalgebra::Vector3;

use super::super::element::{Element, Ends, Matrix12, PARTS};
use super::super::error::FrameError;
use super::super::factor::Factor;
use super::super::network::Network;
use super::operator::{Nodal, Operator, dot, parts, slices};

/// Width of a cell in the mean length of fibres, and in that of segments, and least cells along a side.
/// Between a quarter and a twentieth of a fibre the time of a solution changes little.
const FIBRES: f64 = 0.1;
const SEGMENTS: f64 = 1.0;
/// Most cells: their factor is to be small beside the chains.
const CELLS: f64 = 8000.0;
/// What raises the diagonal, as a share of it: motions that nothing resists.
const RAISED: f64 = 1e-9;
/// Motions of a cell's corners.
const OF_CELL: usize = 24;
/// Cells that are one piece of work.
const CELLS_OF_PIECE: usize = 64;

/// The grid and its factor.
#[derive(Debug)]
pub(super) struct Coarse {
    grid: Grid,
    /// Nodes of fibres by cell: `nodes[first[cell]..first[cell + 1]]`.
    first: Vec<u32>,
    nodes: Vec<u32>,
    factor: Factor,
    /// Motions of corners in the order of the factor, and by corner.
    unknowns: Vec<f64>,
    corners: Vec<[Vector3<f64>; 2]>,
    sums: Vec<[[Vector3<f64>; 2]; 4]>,
}

#[derive(Debug, Clone)]
struct Grid {
    from: [f64; 2],
    width: [f64; 2],
    cells: [usize; 2],
    height: f64,
}

impl Grid {
    fn over(network: &Network) -> Self {
        let nodes = &network.positions()[..network.fibre_nodes()];
        let along = |axis: usize| {
            let at = nodes.iter().map(move |node| node[axis]);
            let least = at.clone().fold(f64::INFINITY, f64::min);
            [least, at.fold(f64::NEG_INFINITY, f64::max)]
        };
        let length = network.model().length_um;
        let [low, high] = along(1);
        let sides = [length, (high - low).max(1.0)];
        let mut fibres = 0.0;
        for fibre in 0..network.fibres() {
            let nodes = network.nodes_of(fibre);
            fibres += network.arc_um(nodes.end - 1) - network.arc_um(nodes.start);
        }
        let of_fibre = fibres / network.fibres().max(1) as f64;
        let of_segment = fibres / network.segments().max(1) as f64;
        let wanted = (FIBRES * of_fibre)
            .max(SEGMENTS * of_segment)
            .max((sides[0] * sides[1] / CELLS).sqrt());
        let cells = sides.map(|side| (side / wanted).round().max(2.0) as usize);
        let [below, above] = along(2);
        Self {
            from: [0.0, low],
            width: [sides[0] / cells[0] as f64, sides[1] / cells[1] as f64],
            cells,
            height: 0.5 * (below + above),
        }
    }

    fn cell(&self, at: &Vector3<f64>) -> usize {
        let [x, y] = [0, 1].map(|axis| {
            let cell = (at[axis] - self.from[axis]) / self.width[axis];
            (cell.max(0.0) as usize).min(self.cells[axis] - 1)
        });
        x * self.cells[1] + y
    }

    fn corners(&self, cell: usize) -> [u32; 4] {
        let [x, y] = [cell / self.cells[1], cell % self.cells[1]];
        let row = self.cells[1] + 1;
        let first = x * row + y;
        [first, first + 1, first + row, first + row + 1].map(|corner| corner as u32)
    }

    fn place(&self, corner: usize) -> Vector3<f64> {
        let row = self.cells[1] + 1;
        let [x, y] = [corner / row, corner % row];
        Vector3::new(
            self.from[0] + x as f64 * self.width[0],
            self.from[1] + y as f64 * self.width[1],
            self.height,
        )
    }

    fn is_held(&self, corner: usize) -> bool {
        let x = corner / (self.cells[1] + 1);
        x == 0 || x == self.cells[0]
    }

    /// Weights of a cell's corners at a point, which may lie beside it, and the arms from them.
    fn weights(&self, cell: usize, at: &Vector3<f64>) -> [(f64, Vector3<f64>); 4] {
        let corners = self.corners(cell);
        let first = self.place(corners[0] as usize);
        let [s, t] = [0, 1].map(|axis| (at[axis] - first[axis]) / self.width[axis]);
        let weights = [(1.0 - s) * (1.0 - t), (1.0 - s) * t, s * (1.0 - t), s * t];
        std::array::from_fn(|corner| (weights[corner], at - self.place(corners[corner] as usize)))
    }
}

impl Coarse {
    /// The grid of a network, and the factor of what is active of it.
    pub(super) fn new<const M: usize>(operator: &Operator<'_, M>) -> Result<Self, FrameError> {
        let network = operator.network;
        let grid = Grid::over(network);
        let cells = grid.cells[0] * grid.cells[1];
        let cell_of: Vec<usize> = network.positions()[..network.fibre_nodes()]
            .iter()
            .map(|at| grid.cell(at))
            .collect();
        let mut first = vec![0; cells + 1];
        for &cell in &cell_of {
            first[cell + 1] += 1;
        }
        for cell in 0..cells {
            first[cell + 1] += first[cell];
        }
        let mut next = first.clone();
        let mut nodes = vec![0; cell_of.len()];
        for (node, &cell) in cell_of.iter().enumerate() {
            nodes[next[cell] as usize] = node as u32;
            next[cell] += 1;
        }
        let matrices = matrices(&grid, operator);
        let mut is_touched = vec![false; (grid.cells[0] + 1) * (grid.cells[1] + 1)];
        for (cell, matrix) in matrices.iter().enumerate() {
            if matrix[0][0] > 0.0 {
                for corner in grid.corners(cell) {
                    is_touched[corner as usize] = true;
                }
            }
        }
        let places: Vec<Vector3<f64>> = (0..is_touched.len())
            .map(|corner| grid.place(corner))
            .collect();
        let pairs = (0..cells).flat_map(|cell| {
            let corners = grid.corners(cell);
            PAIRS.map(|pair| pair.map(|corner| corners[corner]))
        });
        let is_free = |corner: usize| is_touched[corner] && !grid.is_held(corner);
        let mut factor = Factor::of_pairs(6, &places, is_free, pairs)?;
        factor.sum(matrices.iter().enumerate().flat_map(|(cell, matrix)| {
            let corners = grid.corners(cell);
            PAIRS.into_iter().enumerate().map(move |(index, pair)| {
                // the corners' own blocks come with the first two pairs, which meet each once
                let block = pair_block(matrix, pair, index < 2);
                (pair.map(|corner| corners[corner]), block)
            })
        }));
        factor.factor_shifted(&places, RAISED)?;
        Ok(Self {
            first,
            nodes,
            unknowns: vec![0.0; factor.size()],
            factor,
            corners: vec![[Vector3::zeros(); 2]; places.len()],
            sums: vec![[[Vector3::zeros(); 2]; 4]; cells],
            grid,
        })
    }

    /// Unknowns of the factor and the numbers it stores.
    pub(super) fn size(&self) -> [usize; 2] {
        [self.factor.size(), self.factor.stored()]
    }

    /// The motions of corners that forces on the nodes lead to.
    pub(super) fn solve<const M: usize>(
        &mut self,
        operator: &Operator<'_, M>,
        team: &Team,
        right: &[[f64; M]],
    ) {
        let Self {
            grid,
            first,
            nodes,
            factor,
            unknowns,
            corners,
            sums,
        } = self;
        let positions = operator.network.positions();
        let gather = |(piece, sums): (usize, &mut [[[Vector3<f64>; 2]; 4]])| {
            for (cell, sums) in (piece * CELLS_OF_PIECE..).zip(sums) {
                *sums = Default::default();
                for &node in &nodes[first[cell] as usize..first[cell + 1] as usize] {
                    let [force, moment] = parts(&right[node as usize]);
                    let weights = grid.weights(cell, &positions[node as usize]);
                    for (sum, (weight, arm)) in sums.iter_mut().zip(weights) {
                        sum[0] += force * weight;
                        sum[1] += (arm.cross(&force) + moment) * weight;
                    }
                }
            }
        };
        team.map(
            sums.chunks_mut(CELLS_OF_PIECE).enumerate().collect(),
            gather,
        );
        corners.fill([Vector3::zeros(); 2]);
        for (cell, sums) in sums.iter().enumerate() {
            for (corner, sum) in grid.corners(cell).into_iter().zip(sums) {
                let corner = &mut corners[corner as usize];
                corner[0] += sum[0];
                corner[1] += sum[1];
            }
        }
        for (corner, forces) in corners.iter_mut().enumerate() {
            if let Some(place) = factor.unknown(corner as u32) {
                for motion in 0..6 {
                    unknowns[place + motion] = forces[motion / 3][motion % 3];
                }
            }
        }
        factor.solve(unknowns, 1);
        for (corner, motions) in corners.iter_mut().enumerate() {
            *motions = Default::default();
            if let Some(place) = factor.unknown(corner as u32) {
                for motion in 0..6 {
                    motions[motion / 3][motion % 3] = unknowns[place + motion];
                }
            }
        }
    }

    /// Adds to the nodes what the corners' motions make of them; gives its product with `right`.
    pub(super) fn add<const M: usize>(
        &self,
        operator: &Operator<'_, M>,
        team: &Team,
        right: &[[f64; M]],
        solution: &mut Nodal<M>,
    ) -> f64 {
        let network = operator.network;
        let work = |(fibres, own): (Range<usize>, &mut [[f64; M]])| {
            let mut sum = 0.0;
            let start = network.nodes_of(fibres.start).start;
            for (node, own) in (start..).zip(own) {
                if operator.is_free[node] {
                    let at = &network.positions()[node];
                    let cell = self.grid.cell(at);
                    let mut moved = [Vector3::zeros(); 2];
                    let weights = self.grid.weights(cell, at);
                    for (corner, (weight, arm)) in self.grid.corners(cell).into_iter().zip(weights)
                    {
                        let [shift, turn] = self.corners[corner as usize];
                        moved[0] += (shift + turn.cross(&arm)) * weight;
                        moved[1] += turn * weight;
                    }
                    let moved: [f64; M] =
                        std::array::from_fn(|motion| moved[motion / 3][motion % 3]);
                    for (own, moved) in own.iter_mut().zip(moved) {
                        *own += moved;
                    }
                    sum += dot(&right[node], &moved);
                }
            }
            sum
        };
        let pieces = slices(network, operator.pieces(), solution);
        team.map(pieces, work).into_iter().sum()
    }
}

/// Pairs of a cell's corners.
const PAIRS: [[usize; 2]; 6] = [[0, 1], [2, 3], [0, 2], [0, 3], [1, 2], [1, 3]];

type CellMatrix = [[f64; OF_CELL]; OF_CELL];

/// Of a cell's matrix what joins two corners, with what each has of its own or without.
fn pair_block(matrix: &CellMatrix, pair: [usize; 2], with_own: bool) -> Matrix12 {
    let mut block = [[0.0; 12]; 12];
    for (row, values) in block.iter_mut().enumerate() {
        for (column, value) in values.iter_mut().enumerate() {
            if with_own || row / 6 != column / 6 {
                *value = matrix[6 * pair[row / 6] + row % 6][6 * pair[column / 6] + column % 6];
            }
        }
    }
    block
}

/// The matrix of each cell.
fn matrices<const M: usize>(grid: &Grid, operator: &Operator<'_, M>) -> Vec<Box<CellMatrix>> {
    let network = operator.network;
    let none = || Box::new([[0.0; OF_CELL]; OF_CELL]);
    let mut matrices: Vec<Box<CellMatrix>> =
        (0..grid.cells[0] * grid.cells[1]).map(|_| none()).collect();
    for (element, is_active) in network.elements().iter().zip(&operator.is_active) {
        if *is_active {
            let points = element
                .nodes
                .map(|point| network.positions()[point as usize]);
            let cell = grid.cell(&(0.5 * (points[0] + points[1])));
            let weights = points.each_ref().map(|at| grid.weights(cell, at));
            add(&mut matrices[cell], element, &weights);
        }
    }
    matrices
}

fn add(matrix: &mut CellMatrix, element: &Element, weights: &[[(f64, Vector3<f64>); 4]; 2]) {
    let mut columns = [[0.0; OF_CELL]; PARTS];
    for corner in 0..4 {
        for axis in 0..3 {
            let mut unit = Vector3::zeros();
            unit[axis] = 1.0;
            let shifted: Ends = [
                unit * weights[0][corner].0,
                Vector3::zeros(),
                unit * weights[1][corner].0,
                Vector3::zeros(),
            ];
            let turned: Ends = std::array::from_fn(|part| {
                let (weight, arm) = weights[part / 2][corner];
                if part % 2 == 0 {
                    unit.cross(&arm) * weight
                } else {
                    unit * weight
                }
            });
            for (motion, ends) in [(axis, shifted), (axis + 3, turned)] {
                let deformation = element.deformation(&ends);
                for (column, value) in columns.iter_mut().zip(deformation) {
                    column[6 * corner + motion] = value;
                }
            }
        }
    }
    for (column, stiffness) in columns.iter().zip(element.stiffness) {
        if stiffness > 0.0 {
            for (row, of_row) in matrix.iter_mut().zip(column) {
                let of_row = stiffness * of_row;
                for (value, of_column) in row.iter_mut().zip(column) {
                    *value += of_row * of_column;
                }
            }
        }
    }
}
