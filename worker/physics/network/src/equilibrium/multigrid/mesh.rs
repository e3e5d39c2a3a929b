//! Cells over a network, and the interpolation between their corners and the nodes.
use std::{array, ops::Range};

use loadframe_numerics::{Team, wide};

use super::{
    band::{BLOCK, Band},
    corners::Vectors,
};
use crate::{
    Row, Vector,
    assembly::Assembly,
    field::{Field, Real},
    strips::{AtPlaces, OfStrips, Strips, again},
};

/// Side of a cell in mean rest lengths. Smaller cells cost more and leave less to the nodes.
const CELL: f64 = 4.0;
/// Fewer cells between the jaws hold no wave that nodes themselves would not find soon.
const FEWEST_CELLS: usize = 6;

/// A rectangle of equal cells from jaw to jaw. Displacements do not vary through the thickness:
/// waves that do are short in any fabric, and nodes find them themselves.
#[derive(Clone, Debug)]
pub(super) struct Mesh {
    /// Cells along x and y.
    cells: [usize; 2],
    /// The corner at the left end of the bottom jaw [mm].
    lowest: [f64; 2],
    /// 1 over the sides of a cell [1/mm].
    inverse_sides: [f64; 2],
    strips: Strips,
    /// The bands of each strip.
    bands: Vec<Bands>,
    /// Coordinates in its cell of the node at each place, from 0 to 1 inside.
    at: [Vec<f32>; 2],
}

/// All rows of nodes in a strip.
#[derive(Clone, Debug, Default)]
struct Bands {
    bands: Vec<Band>,
    /// Corners of their cells.
    corners: Range<usize>,
}

/// Forces on the corners that the strips touch, a component after the other.
pub(super) type Shares = Vec<Vec<f32>>;

/// Which part of a row of nodes starts where.
struct Piece {
    strip: usize,
    place: u32,
    count: usize,
    corner: u32,
    runs: Vec<u32>,
}

impl Mesh {
    /// Cells over the nodes of a network, with not more corners than so many; `None` when there would
    /// be too few.
    pub(super) fn over(assembly: &Assembly, most_corners: usize) -> Option<Self> {
        let mean = |places: Range<usize>| {
            let count = places.len() as f64;
            assembly.positions.axis(1)[places].iter().sum::<f64>() / count
        };
        let lengths = assembly.slots().map(|slot| assembly.rest_lengths[slot]);
        let length = lengths.sum::<f64>();
        Self::new(
            &assembly.positions,
            &assembly.rows(),
            assembly.held().map(mean),
            length / assembly.bonds() as f64,
            &assembly.strips,
            most_corners,
        )
    }

    /// Cells over the free nodes at these `positions` [mm] between jaws at these `heights` [mm];
    /// `rows` are all of them, with the places of their nodes. Cells are as small as is worth while, but
    /// have not more than `most_corners`. `None` where too few would do.
    fn new(
        positions: &Field<f64>,
        rows: &[(Range<usize>, Row)],
        heights: [f64; 2],
        mean_length: f64,
        strips: &Strips,
        most_corners: usize,
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
        let mut cells = ranges.map(|[from, to]| cells((to - from) / side));
        if cells[1] < FEWEST_CELLS || cells[0] == 0 {
            return None;
        }
        while (cells[0] + 1) * (cells[1] + 1) > most_corners {
            cells = cells.map(|cells| cells.div_ceil(2));
        }
        let mut mesh = Self {
            cells,
            lowest: ranges.map(|[from, _]| from),
            inverse_sides: [0, 1].map(|axis| {
                let [from, to] = ranges[axis];
                cells[axis] as f64 / (to - from)
            }),
            strips: strips.clone(),
            bands: vec![Bands::default(); strips.count()],
            at: [0, 1].map(|_| vec![0.0; positions.axis(0).len()]),
        };
        let mut pieces = Vec::new();
        for (places, row) in rows {
            mesh.cut(places.clone(), row, positions, &mut pieces);
        }
        pieces.sort_by(|a, b| (a.key(), a.place).cmp(&(b.key(), b.place)));
        for pieces in pieces.chunk_by(|a, b| a.key() == b.key()) {
            let first = &pieces[0];
            let of_strip = &mut mesh.bands[first.strip];
            let corners =
                first.corner as usize..first.corner as usize + first.runs.len() + cells[0] + 2;
            if of_strip.bands.is_empty() {
                of_strip.corners = corners.clone();
            }
            let known = &mut of_strip.corners;
            *known = known.start.min(corners.start)..known.end.max(corners.end);
            of_strip.bands.push(Band {
                rows: pieces.iter().map(|piece| piece.place).collect(),
                count: first.count,
                corner: first.corner,
                runs: first.runs.clone(),
            });
        }
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
        let mut first = start;
        while first < places.end {
            let strip = self.strips.at(first);
            let end = places.end.min(self.strips.strip(strip).places.end);
            let piece = first..end.min(first + BLOCK);
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
                strip,
                place: first as u32,
                count: piece.len(),
                corner: corner as u32,
                runs,
            });
            first = piece.end;
        }
    }

    /// Corners along each axis.
    pub(super) fn planes(&self) -> [usize; 2] {
        self.cells.map(|cells| cells + 1)
    }

    pub(super) fn corners(&self) -> usize {
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

    /// Memory for [`Mesh::restrict`].
    pub(super) fn shares(&self) -> Shares {
        let strips = self.bands.iter();
        strips
            .map(|strip| vec![0.0; 3 * strip.corners.len()])
            .collect()
    }

    /// Sets the first components of `sums` to the forces on the corners that do the work of `forces` on
    /// the nodes.
    pub(super) fn restrict<T: Real, const C: usize>(
        &self,
        forces: &Field<T>,
        shares: &mut Shares,
        sums: &mut Vectors,
        team: &Team,
    ) {
        let above = self.planes()[0];
        let forces: [&[T]; C] = first(forces.components());
        self.strips
            .each(team, OfStrips(shares), |strip, OfStrips(shares)| {
                let Bands { bands, corners } = &self.bands[strip.number];
                let shares = &mut shares[0];
                shares.fill(0.0);
                let (x, others) = shares.split_at_mut(corners.len());
                let (y, z) = others.split_at_mut(corners.len());
                let mut shares: [&mut [f32]; C] = first([x, y, z]);
                let mut parts = [[[0.0; BLOCK]; 4]; C];
                wide(
                    #[inline(always)]
                    || {
                        for band in bands {
                            let first = corners.start;
                            band.restrict(&self.at, forces, first, &mut shares, above, &mut parts);
                        }
                    },
                );
            });
        for sums in sums.iter_mut() {
            sums.fill(0.0);
        }
        for (Bands { corners, .. }, shares) in self.bands.iter().zip(shares) {
            let components = shares.chunks(corners.len().max(1));
            for (sums, shares) in sums.iter_mut().zip(components).take(C) {
                for (sum, share) in sums[corners.clone()].iter_mut().zip(shares) {
                    *sum += *share;
                }
            }
        }
    }

    /// Adds the displacements interpolated from the first components at the `corners` to those of the
    /// nodes, times their `mobility`.
    pub(super) fn prolong<T: Real, const C: usize>(
        &self,
        corners: &Vectors,
        mobility: &[T],
        moved: &mut Field<T>,
        team: &Team,
    ) {
        let above = self.planes()[0];
        let outputs = AtPlaces(moved.components_mut());
        self.strips.each(team, outputs, |strip, AtPlaces(moved)| {
            let start = strip.places.start;
            let mut moved: [&mut [T]; C] = first(again(moved));
            let mut parts = [[[0.0; BLOCK]; 4]; C];
            wide(
                #[inline(always)]
                || {
                    for band in &self.bands[strip.number].bands {
                        band.prolong(
                            &self.at, corners, above, mobility, start, &mut moved, &mut parts,
                        );
                    }
                },
            );
        });
    }
}

/// The first of three.
fn first<S: Default, const C: usize>(three: [S; 3]) -> [S; C] {
    let mut three = three.into_iter();
    array::from_fn(|_| three.next().unwrap_or_default())
}

impl Piece {
    /// What pieces of a band have in common.
    fn key(&self) -> (usize, u32, &[u32]) {
        (self.strip, self.corner, &self.runs)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{blocks::Blocks, field::dot};

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

    fn mesh(positions: &Field<f64>, rows: &[(Range<usize>, Row)]) -> Mesh {
        let strips = Blocks::new(&[], positions.axis(0).len()).strips;
        Mesh::new(positions, rows, [-5.0, 400.0], 10.0, &strips, usize::MAX).expect("enough cells")
    }

    #[test]
    fn linear_displacements_of_the_corners_are_linear_at_the_nodes() {
        let (positions, rows) = shaken();
        let mesh = mesh(&positions, &rows);
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
        mesh.prolong::<_, 2>(&corners, &vec![1.0_f64; places], &mut moved, &Team::alone());
        for place in 0..places {
            let [x, y] = [0, 1].map(|axis| positions.axis(axis)[place]);
            // some roundings of single precision, of numbers of order ten
            assert!((moved.axis(0)[place] - linear(x, y)).abs() < 1e-5);
        }
    }

    #[test]
    fn forces_and_displacements_go_the_same_way() {
        let (positions, rows) = shaken();
        let mesh = mesh(&positions, &rows);
        let places = positions.axis(0).len();
        let wave = |place: usize| Vector::new((0.3 * place as f64).sin(), 0.5, 0.0);
        let forces: Field<f64> = Field::of(&(0..places).map(wave).collect::<Vec<_>>(), 2);
        let mut sums = [0, 1, 2].map(|_| vec![0.0; mesh.corners()]);
        mesh.restrict::<_, 2>(&forces, &mut mesh.shares(), &mut sums, &Team::alone());
        let corner = |corner: usize| (0.9 * corner as f32).cos();
        let corners = [0, 1, 2].map(|_| (0..mesh.corners()).map(corner).collect::<Vec<f32>>());
        let mut moved: Field<f64> = Field::zeros(places, 2);
        mesh.prolong::<_, 2>(&corners, &vec![1.0_f64; places], &mut moved, &Team::alone());
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
