//! Cells over a network, and the interpolation between their corners and the nodes.
//!
//! Nodes of one row of cells are interpolated row by row of the network: within a cell a
//! displacement is a + s b + t c + s t d with the node's coordinates s, t, so the four numbers of
//! each cell are laid out once along x and then serve every row of nodes there. Nodes of no row are
//! rows of one.
use std::ops::Range;

use crate::{
    network::{
        Row, Vector,
        field::{Field, Real},
    },
    wide::wide,
};

/// Side of a cell in mean rest lengths. Smaller cells cost more and leave less to the nodes.
const CELL: f64 = 4.0;
/// Fewer cells between the jaws hold no wave that nodes themselves would not find soon.
const FEWEST_CELLS: usize = 6;
/// Nodes of a row worked on at once.
const BLOCK: usize = 256;

/// A rectangle of equal cells from jaw to jaw. Displacements do not vary through the thickness:
/// waves that do are short in any fabric, and nodes find them themselves.
#[derive(Clone, Debug)]
pub(crate) struct Mesh {
    /// Cells along x and y.
    cells: [usize; 2],
    /// The corner at the left end of the bottom jaw [mm].
    lowest: [f64; 2],
    /// 1 over the sides of a cell [1/mm].
    inverse_sides: [f64; 2],
    bands: Vec<Band>,
    /// Coordinates in its cell of the node at each place, from 0 to 1 inside.
    at: [Vec<f32>; 2],
}

/// Rows of nodes, at most [`BLOCK`] long, whose nodes lie in the same cells one by one.
#[derive(Clone, Debug)]
struct Band {
    /// Place of each row's first node.
    rows: Vec<u32>,
    count: usize,
    /// First corner of the cell of the first node.
    corner: u32,
    /// Nodes in that cell, in the next along x, and so on.
    runs: Vec<u32>,
}

/// Values at the corners of a cell, x running faster than y.
pub(super) type Corners = [f32; 4];

/// Which part of a row of nodes starts where.
struct Piece {
    place: u32,
    count: usize,
    corner: u32,
    runs: Vec<u32>,
}

impl Mesh {
    /// Cells over the free nodes at these `positions` [mm] between jaws at these `heights` [mm];
    /// `rows` are all of them, with the places of their nodes. `None` where too few would do.
    pub(crate) fn new(
        positions: &Field<f64>,
        rows: &[(Range<usize>, Row)],
        heights: [f64; 2],
        mean_length: f64,
    ) -> Option<Self> {
        let extent = |axis: usize| {
            let values = positions.axis(axis);
            let places = rows.iter().flat_map(|(places, _)| places.clone());
            let values = places.filter_map(|place| values.get(place).copied());
            let ends = (f64::INFINITY, f64::NEG_INFINITY);
            let (from, to) = values.fold(ends, |(from, to), v| (v.min(from), v.max(to)));
            if from <= to { [from, to] } else { [0.0, 0.0] }
        };
        let ranges = [extent(0), heights];
        let side = CELL * mean_length;
        let cells = ranges.map(|[from, to]| cells((to - from) / side));
        if cells[1] < FEWEST_CELLS || cells[0] == 0 {
            return None;
        }
        let mut mesh = Self {
            cells,
            lowest: ranges.map(|[from, _]| from),
            inverse_sides: [0, 1].map(|axis| {
                let [from, to] = ranges[axis];
                cells[axis] as f64 / (to - from)
            }),
            bands: Vec::new(),
            at: [0, 1].map(|_| vec![0.0; positions.axis(0).len()]),
        };
        let mut pieces = Vec::new();
        for (places, row) in rows {
            mesh.cut(places.clone(), row, positions, &mut pieces);
        }
        pieces.sort_by(|a, b| (a.corner, &a.runs, a.place).cmp(&(b.corner, &b.runs, b.place)));
        let alike = |a: &Piece, b: &Piece| (a.corner, &a.runs) == (b.corner, &b.runs);
        let band = |pieces: &[Piece]| Band {
            rows: pieces.iter().map(|piece| piece.place).collect(),
            count: pieces[0].count,
            corner: pieces[0].corner,
            runs: pieces[0].runs.clone(),
        };
        mesh.bands = pieces.chunk_by(alike).map(band).collect();
        Some(mesh)
    }

    /// Cuts a row into pieces and notes where its nodes are in their cells.
    fn cut(
        &mut self,
        places: Range<usize>,
        row: &Row,
        positions: &Field<f64>,
        pieces: &mut Vec<Piece>,
    ) {
        let start = places.start;
        let about = |place: usize| {
            let along = (place - start) as f64 * row.spacing;
            row.origin + Vector::new(along, 0.0, 0.0)
        };
        for first in places.clone().step_by(BLOCK) {
            let piece = first..(first + BLOCK).min(places.end);
            let (corner, _) = self.locate(&about(first));
            let mut runs = vec![0];
            for place in piece.clone() {
                let (own, at) = self.locate(&about(place));
                runs.resize(own - corner + 1, 0);
                runs[own - corner] += 1;
                // in the cell of the regular place, where in truth the node is
                let moved = self.in_cells(&(positions.at(place) - about(place)));
                for axis in 0..2 {
                    self.at[axis][place] = (at[axis] + moved[axis]) as f32;
                }
            }
            pieces.push(Piece {
                place: first as u32,
                count: piece.len(),
                corner: corner as u32,
                runs,
            });
        }
    }

    /// Corners along each axis.
    pub(super) fn planes(&self) -> [usize; 2] {
        self.cells.map(|cells| cells + 1)
    }

    pub(crate) fn corners(&self) -> usize {
        self.planes().iter().product()
    }

    /// First corner of the cell of a point and the coordinates in it; beyond the mesh those of the
    /// nearest cell go on.
    pub(super) fn locate(&self, point: &Vector) -> (usize, [f64; 2]) {
        let scaled =
            [0, 1].map(|axis| (point[axis] - self.lowest[axis]) * self.inverse_sides[axis]);
        let cell = [0, 1].map(|axis| (scaled[axis].max(0.0) as usize).min(self.cells[axis] - 1));
        let at = [0, 1].map(|axis| scaled[axis] - cell[axis] as f64);
        (cell[1] * (self.cells[0] + 1) + cell[0], at)
    }

    /// A difference of positions in units of cells.
    pub(super) fn in_cells(&self, difference: &Vector) -> [f64; 2] {
        [0, 1].map(|axis| difference[axis] * self.inverse_sides[axis])
    }

    /// Sets `sums` to the forces on the corners that do the work of `forces` on the nodes.
    pub(super) fn restrict<T: Real>(&self, forces: &Field<T>, sums: &mut [Vec<f32>; 3]) {
        let above = self.planes()[0];
        let mut parts = [[0.0; BLOCK]; 4];
        wide(
            #[inline(always)]
            || {
                for (forces, sums) in forces.components().into_iter().zip(sums.iter_mut()) {
                    sums.fill(0.0);
                    if forces.is_empty() {
                        continue;
                    }
                    for band in &self.bands {
                        band.restrict(&self.at, forces, sums, above, &mut parts);
                    }
                }
            },
        );
    }

    /// Adds the displacements interpolated from the `corners` to those of the nodes, as far as
    /// `shares` say for each place.
    pub(super) fn prolong<T: Real>(
        &self,
        corners: &[Vec<f32>; 3],
        shares: &[f32],
        moved: &mut Field<T>,
    ) {
        let above = self.planes()[0];
        let mut parts = [[0.0; BLOCK]; 4];
        wide(
            #[inline(always)]
            || {
                for (moved, corners) in moved.components_mut().into_iter().zip(corners) {
                    if moved.is_empty() {
                        continue;
                    }
                    for band in &self.bands {
                        band.prolong(&self.at, corners, above, shares, moved, &mut parts);
                    }
                }
            },
        );
    }
}

impl Band {
    /// Adds to `sums` what the nodes' `forces` are at the corners, `above` numbers from row to row.
    #[inline(always)]
    fn restrict<T: Real>(
        &self,
        at: &[Vec<f32>; 2],
        forces: &[T],
        sums: &mut [f32],
        above: usize,
        parts: &mut [[f32; BLOCK]; 4],
    ) {
        for part in parts.iter_mut() {
            part[..self.count].fill(0.0);
        }
        for row in &self.rows {
            let places = *row as usize..*row as usize + self.count;
            let [s, t] = at.each_ref().map(
                #[inline(always)]
                |at| &at[places.clone()],
            );
            let forces = &forces[places.clone()];
            let [a, b, c, d] = parts.each_mut().map(
                #[inline(always)]
                |part| &mut part[..self.count],
            );
            for node in 0..self.count {
                let force = forces[node].narrow();
                let with_t = force * t[node];
                a[node] += force;
                b[node] = force.mul_add(s[node], b[node]);
                c[node] += with_t;
                d[node] = with_t.mul_add(s[node], d[node]);
            }
        }
        let mut nodes = 0..0;
        for (cell, run) in self.runs.iter().enumerate() {
            nodes = nodes.end..nodes.end + *run as usize;
            let [a, b, c, d] = parts.each_ref().map(
                #[inline(always)]
                |part| part[nodes.clone()].iter().sum::<f32>(),
            );
            let corner = self.corner as usize + cell;
            sums[corner] += a - b - c + d;
            sums[corner + 1] += b - d;
            sums[corner + above] += c - d;
            sums[corner + above + 1] += d;
        }
    }

    /// Adds the displacements interpolated from the `corners`, `above` numbers from row to row.
    #[inline(always)]
    fn prolong<T: Real>(
        &self,
        at: &[Vec<f32>; 2],
        corners: &[f32],
        above: usize,
        shares: &[f32],
        moved: &mut [T],
        parts: &mut [[f32; BLOCK]; 4],
    ) {
        let mut nodes = 0..0;
        for (cell, run) in self.runs.iter().enumerate() {
            nodes = nodes.end..nodes.end + *run as usize;
            let corner = self.corner as usize + cell;
            let (left, right) = (corners[corner], corners[corner + 1]);
            let (above_left, above_right) = (corners[corner + above], corners[corner + above + 1]);
            let (b, c) = (right - left, above_left - left);
            let of_cell = [left, b, c, above_right - above_left - b];
            for (part, value) in parts.iter_mut().zip(of_cell) {
                part[nodes.clone()].fill(value);
            }
        }
        let [a, b, c, d] = parts.each_ref().map(
            #[inline(always)]
            |part| &part[..self.count],
        );
        for row in &self.rows {
            let places = *row as usize..*row as usize + self.count;
            let [s, t] = at.each_ref().map(
                #[inline(always)]
                |at| &at[places.clone()],
            );
            let shares = &shares[places.clone()];
            let moved = &mut moved[places];
            for node in 0..self.count {
                let at_bottom = s[node].mul_add(b[node], a[node]);
                let upwards = s[node].mul_add(d[node], c[node]);
                let value = upwards.mul_add(t[node], at_bottom);
                moved[node] += T::widen(shares[node] * value);
            }
        }
    }
}

/// Whole cells in `sides` of their lengths: a multiple of the largest power of two that leaves a
/// handful, so that coarser meshes have cells made of whole ones.
fn cells(sides: f64) -> usize {
    let mut pairings = 0;
    while sides / f64::from(1 << (pairings + 1)) >= 3.0 {
        pairings += 1;
    }
    let group = f64::from(1 << pairings);
    ((sides / group).round() * group) as usize
}

/// Weights of the corners of a cell at coordinates in it.
pub(super) fn weights([x, y]: [f32; 2]) -> Corners {
    [(1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y]
}

/// How much the weights of a cell's corners change along a difference, both in units of the cell:
/// exact for differences within the cell that have their middle `at` these coordinates.
pub(super) fn weight_differences([x, y]: [f32; 2], [dx, dy]: [f32; 2]) -> Corners {
    [
        -(1.0 - y) * dx - (1.0 - x) * dy,
        (1.0 - y) * dx - x * dy,
        -y * dx + (1.0 - x) * dy,
        y * dx + x * dy,
    ]
}

/// How far the corners of a cell are from its first one, `across` corners in a row.
pub(super) fn offsets(across: usize) -> [usize; 4] {
    [0, 1, across, across + 1]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::field::dot;

    /// Rows of alternately 40 and 41 nodes, 10 mm apart, pushed off their places.
    fn shaken() -> (Field<f64>, Vec<(Range<usize>, Row)>) {
        let (mut nodes, mut rows) = (Vec::new(), Vec::new());
        for row in 0..40 {
            let (count, offset) = (40 + row % 2, if row % 2 == 0 { 5.0 } else { 0.0 });
            let origin = Vector::new(offset, 10.0 * f64::from(row), 0.0);
            let first = nodes.len();
            for column in 0..count {
                let push = Vector::new((0.7 * f64::from(column * row)).sin(), 1.3, 0.0);
                nodes.push(origin + Vector::new(10.0 * f64::from(column), 0.0, 0.0) + push);
            }
            let row = Row {
                first: first as u32,
                count: count as u32,
                origin,
                spacing: 10.0,
            };
            rows.push((first..nodes.len(), row));
        }
        (Field::of(&nodes, 2), rows)
    }

    #[test]
    fn linear_displacements_of_the_corners_are_linear_at_the_nodes() {
        let (positions, rows) = shaken();
        let mesh = Mesh::new(&positions, &rows, [-5.0, 400.0], 10.0).expect("enough cells");
        let [across, up] = mesh.planes();
        let linear = |x: f64, y: f64| 0.3 + 0.02 * x - 0.01 * y;
        let corner = |corner: usize| {
            let x = mesh.lowest[0] + (corner % across) as f64 / mesh.inverse_sides[0];
            let y = mesh.lowest[1] + (corner / across) as f64 / mesh.inverse_sides[1];
            linear(x, y) as f32
        };
        let corners = [0, 1, 2].map(|_| (0..across * up).map(corner).collect::<Vec<f32>>());
        let places = positions.axis(0).len();
        let mut moved: Field<f64> = Field::zeros(places, 2);
        mesh.prolong(&corners, &vec![1.0; places], &mut moved);
        for place in 0..places {
            let [x, y] = [0, 1].map(|axis| positions.axis(axis)[place]);
            // some roundings of single precision, of numbers of order ten
            assert!((moved.axis(0)[place] - linear(x, y)).abs() < 1e-5);
        }
    }

    #[test]
    fn forces_and_displacements_go_the_same_way() {
        let (positions, rows) = shaken();
        let mesh = Mesh::new(&positions, &rows, [-5.0, 400.0], 10.0).expect("enough cells");
        let places = positions.axis(0).len();
        let wave = |place: usize| Vector::new((0.3 * place as f64).sin(), 0.5, 0.0);
        let forces: Field<f64> = Field::of(&(0..places).map(wave).collect::<Vec<_>>(), 2);
        let mut sums = [0, 1, 2].map(|_| vec![0.0; mesh.corners()]);
        mesh.restrict(&forces, &mut sums);
        let corner = |corner: usize| (0.9 * corner as f32).cos();
        let corners = [0, 1, 2].map(|_| (0..mesh.corners()).map(corner).collect::<Vec<f32>>());
        let mut moved: Field<f64> = Field::zeros(places, 2);
        mesh.prolong(&corners, &vec![1.0; places], &mut moved);
        let at_nodes = moved.dot(&forces, 0..places);
        let pairs = sums.iter().zip(&corners).take(2);
        let at_corners: f64 = pairs.map(|(sums, corners)| dot(sums, corners)).sum();
        assert!((at_nodes - at_corners).abs() < 1e-4 * at_nodes.abs());
    }

    #[test]
    fn cells_pair_up_to_a_handful() {
        for (sides, expected) in [(0.4, 0), (5.0, 5), (13.4, 12), (13.9, 12), (30.0, 32)] {
            assert_eq!(cells(sides), expected, "{sides}");
        }
    }
}
