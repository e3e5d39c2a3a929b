//! Triangles in space: reading them from STL, and the point of one that is closest to another point.
//!
//! Both sides need this: whoever checks a scene, and whoever runs it. Nothing here knows materials
//! or motion. Vectors are arrays, in whatever unit they come.
mod closest_point;
mod faces;
#[cfg(test)]
mod fixtures;
mod mesh;
mod stl;

pub use closest_point::{ClosestPoint, Feature, closest_point};
pub use faces::{cuboid, rectangle};
#[cfg(test)]
pub(crate) use fixtures::{ball, block};
pub use mesh::{Seams, TriangleMesh};
pub use stl::{StlError, read_stl};

/// A position.
pub type Point = [f64; 3];

/// Corners, counter-clockwise seen from the side that the normal points to.
pub type Triangle = [Point; 3];

/// Triangles with less than this ratio of twice the area to the longest edge squared have no
/// direction.
const DEGENERATE: f64 = 1e-10;

/// Unit normal; `None` for a triangle without area.
pub fn unit_normal([a, b, c]: &Triangle) -> Option<Point> {
    let edges = [minus(b, a), minus(c, b), minus(a, c)];
    let longest = edges.iter().map(|edge| dot(edge, edge)).fold(0.0, f64::max);
    let normal = cross(&edges[0], &edges[1]);
    let twice_area = length(&normal);
    (twice_area > DEGENERATE * longest).then(|| normal.map(|part| part / twice_area))
}

/// Lower and upper corner of the box around points; infinite and reversed without any.
pub fn bounds<'a>(points: impl IntoIterator<Item = &'a Point>) -> [Point; 2] {
    let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for point in points {
        for axis in 0..3 {
            bounds[0][axis] = bounds[0][axis].min(point[axis]);
            bounds[1][axis] = bounds[1][axis].max(point[axis]);
        }
    }
    bounds
}

/// Volume inside closed triangles, whichever way they turn, in the cube of their unit: ∑ a·(b × c)/6
/// about the middle of their box.
pub fn enclosed_volume(triangles: &[Triangle]) -> f64 {
    let [lower, upper] = bounds(triangles.iter().flatten());
    let middle = along(&lower, &minus(&upper, &lower), 0.5);
    let tetrahedra = triangles.iter().map(|corners| {
        let [a, b, c] = corners.map(|corner| minus(&corner, &middle));
        dot(&a, &cross(&b, &c))
    });
    (tetrahedra.sum::<f64>() / 6.0).abs()
}

/// `a` − `b`.
#[inline]
pub fn minus(a: &Point, b: &Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Scalar product.
#[inline]
pub fn dot(a: &Point, b: &Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `from` + `share` · `way`.
#[inline]
pub fn along(from: &Point, way: &Point, share: f64) -> Point {
    [
        from[0] + way[0] * share,
        from[1] + way[1] * share,
        from[2] + way[2] * share,
    ]
}

/// Vector product.
#[inline]
pub fn cross(a: &Point, b: &Point) -> Point {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Length of a vector.
#[inline]
pub fn length(a: &Point) -> f64 {
    dot(a, a).sqrt()
}
