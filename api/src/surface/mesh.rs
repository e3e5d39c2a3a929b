//! Triangle surfaces of grains measured by a scanner.
//!
//! [`TriangleMesh::weld`] joins loose triangles and counts what keeps the surface from being closed;
//! a closed one has a volume, an inside ([`TriangleMesh::encloses`]) and can be filled with spheres
//! ([`crate::filling`]). Nothing here knows materials or motion.
use std::collections::HashMap;

use nalgebra::Vector3;

/// Corners closer than this share of the diagonal of the bounding box are one vertex: ten times
/// what single precision leaves of a coordinate, and far below any feature one would contact.
const WELD_DISTANCE: f64 = 1e-6;
/// Triangles with less than this ratio of twice the area to the longest edge squared have no
/// direction.
const DEGENERATE: f64 = 1e-10;

/// A surface of triangles that share vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct TriangleMesh {
    /// Positions, in the unit of the triangles it was made of.
    pub vertices: Vec<Vector3<f64>>,
    /// Corners, counter-clockwise seen from outside when the surface is oriented as it should be.
    pub triangles: Vec<[u32; 3]>,
    /// Triangles left out because they had no area.
    pub degenerate: usize,
    pub seams: Seams,
}

/// Edges where a surface is not the boundary of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Seams {
    /// Edges with a triangle on one side only: rims of holes.
    pub boundary_edges: usize,
    /// Edges whose triangles turn the same way, or which an odd number above one shares.
    pub misoriented_edges: usize,
}

impl Seams {
    /// Whether the surface encloses a volume.
    pub fn is_closed(&self) -> bool {
        *self == Self::default()
    }
}

impl TriangleMesh {
    /// Joins the equal corners of finite triangles. Costs about 1 µs per triangle.
    pub fn weld(triangles: &[[Vector3<f64>; 3]]) -> Self {
        let [lower, upper] = bounds(triangles.iter().flatten());
        let distance = WELD_DISTANCE * (upper - lower).norm();
        let mut vertices = Vertices::new(lower, distance);
        let indices: Vec<[u32; 3]> = triangles
            .iter()
            .map(|corners| corners.map(|corner| vertices.index_of(&corner)))
            .collect();
        // a triangle without area may still join its neighbours
        let seams = seams(&indices);
        let positions = vertices.positions;
        let has_area = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|corner| positions[corner as usize]);
            let edges = [b - a, c - b, a - c];
            let longest = edges.iter().map(Vector3::norm_squared).fold(0.0, f64::max);
            edges[0].cross(&edges[1]).norm() > DEGENERATE * longest
        };
        let kept: Vec<[u32; 3]> = indices.into_iter().filter(has_area).collect();
        Self {
            degenerate: triangles.len() - kept.len(),
            vertices: positions,
            triangles: kept,
            seams,
        }
    }

    /// The three corners of each triangle.
    pub fn corners(&self) -> impl Iterator<Item = [Vector3<f64>; 3]> {
        let position = |corner: u32| self.vertices[corner as usize];
        self.triangles
            .iter()
            .map(move |corners| corners.map(position))
    }

    /// Lower and upper corner of the bounding box; infinite and reversed for an empty surface.
    pub fn bounds(&self) -> [Vector3<f64>; 2] {
        bounds(&self.vertices)
    }

    /// Whether a point lies inside a closed surface, whichever way that is oriented.
    ///
    /// The solid angles of all triangles seen from the point add up to 4π inside and 0 outside, so
    /// that no single triangle decides, as it would for a ray through an edge. Costs about 20 ns
    /// per triangle. Source: van Oosterom and Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125:
    /// tan(Ω/2) = a·(b × c)/(abc + (a·b) c + (b·c) a + (c·a) b).
    pub fn encloses(&self, point: &Vector3<f64>) -> bool {
        let solid_angles = self.corners().map(|corners| {
            let [a, b, c] = corners.map(|corner| corner - point);
            let [to_a, to_b, to_c] = [a, b, c].map(|ray| ray.norm());
            let triple = a.dot(&b.cross(&c));
            let sum = to_a * to_b * to_c + a.dot(&b) * to_c + b.dot(&c) * to_a + c.dot(&a) * to_b;
            2.0 * triple.atan2(sum)
        });
        solid_angles.sum::<f64>().abs() > 2.0 * std::f64::consts::PI
    }
}

/// Smallest box around points.
fn bounds<'a>(points: impl IntoIterator<Item = &'a Vector3<f64>>) -> [Vector3<f64>; 2] {
    let nothing = [f64::INFINITY, f64::NEG_INFINITY].map(Vector3::repeat);
    let grow = |[lower, upper]: [Vector3<f64>; 2], point| [lower.inf(point), upper.sup(point)];
    points.into_iter().fold(nothing, grow)
}

/// Counts the edges that do not cancel against a neighbour's.
fn seams(triangles: &[[u32; 3]]) -> Seams {
    // how often each edge is passed upwards and downwards in vertex numbers
    let mut passes: HashMap<[u32; 2], [u32; 2]> = HashMap::new();
    for corners in triangles {
        for start in 0..3 {
            let (from, to) = (corners[start], corners[(start + 1) % 3]);
            if from != to {
                let count = passes.entry([from.min(to), from.max(to)]).or_default();
                count[usize::from(from > to)] += 1;
            }
        }
    }
    let mut seams = Seams::default();
    for [upwards, downwards] in passes.into_values() {
        if upwards + downwards == 1 {
            seams.boundary_edges += 1;
        } else if upwards != downwards {
            seams.misoriented_edges += 1;
        }
    }
    seams
}

/// Vertices found so far, by the cells of a grid as wide as the weld distance.
struct Vertices {
    positions: Vec<Vector3<f64>>,
    /// The vertex found last in a cell.
    cells: HashMap<[i64; 3], u32>,
    /// For each vertex the one found before it in its cell.
    earlier: Vec<Option<u32>>,
    origin: Vector3<f64>,
    distance: f64,
}

impl Vertices {
    fn new(origin: Vector3<f64>, distance: f64) -> Self {
        Self {
            positions: Vec::new(),
            cells: HashMap::new(),
            earlier: Vec::new(),
            origin,
            // one point, or none
            distance: if distance > 0.0 { distance } else { 1.0 },
        }
    }

    /// Number of the vertex at a position: the first one seen within the weld distance.
    fn index_of(&mut self, position: &Vector3<f64>) -> u32 {
        let place = (position - self.origin) / self.distance;
        let cell: [i64; 3] = place.map(|coordinate| coordinate.floor() as i64).into();
        // an equal vertex lies in the same cell or in one beside it
        let offsets = (0..27).map(|number| [number % 3, number / 3 % 3, number / 9]);
        // its own cell first, where it nearly always is
        let neighbours = offsets.map(|offset| {
            let beside = [0, 1, -1];
            std::array::from_fn(|axis| cell[axis] + beside[offset[axis]])
        });
        for neighbour in neighbours {
            let mut candidate = self.cells.get::<[i64; 3]>(&neighbour).copied();
            while let Some(index) = candidate {
                let known = self.positions[index as usize];
                if (known - position).norm() <= self.distance {
                    return index;
                }
                candidate = self.earlier[index as usize];
            }
        }
        let index = self.positions.len() as u32;
        self.positions.push(*position);
        self.earlier.push(self.cells.insert(cell, index));
        index
    }
}

#[cfg(test)]
mod tests;
