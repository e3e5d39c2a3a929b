//! The point of a triangle that is closest to another point.
use nalgebra::Vector3;

/// Which part of a triangle a point lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Feature {
    Face,
    /// From the corner of this number (0, 1, 2) to the next.
    Edge(u8),
    /// The corner of this number.
    Vertex(u8),
}

/// A point on a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ClosestPoint {
    /// Position, in the triangle's unit.
    pub(crate) position: Vector3<f64>,
    /// A contact on an edge or a corner is shared with the neighbours that have it too.
    pub(crate) feature: Feature,
}

/// The point closest to `point` on a triangle that has an area.
///
/// Walks the Voronoi regions of corners and edges by the signs of dot products; what is left is
/// the face. Source: C. Ericson, *Real-Time Collision Detection* (2005), section 5.1.5.
#[inline]
pub(crate) fn closest_point(triangle: &[Vector3<f64>; 3], point: &Vector3<f64>) -> ClosestPoint {
    let [a, b, c] = triangle;
    let (ab, ac) = (b - a, c - a);
    let at = |position, feature| ClosestPoint { position, feature };

    let from_a = point - a;
    let (d1, d2) = (ab.dot(&from_a), ac.dot(&from_a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return at(*a, Feature::Vertex(0));
    }
    let from_b = point - b;
    let (d3, d4) = (ab.dot(&from_b), ac.dot(&from_b));
    if d3 >= 0.0 && d4 <= d3 {
        return at(*b, Feature::Vertex(1));
    }
    let beyond_ab = d1 * d4 - d3 * d2;
    if beyond_ab <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return at(a + ab * (d1 / (d1 - d3)), Feature::Edge(0));
    }
    let from_c = point - c;
    let (d5, d6) = (ab.dot(&from_c), ac.dot(&from_c));
    if d6 >= 0.0 && d5 <= d6 {
        return at(*c, Feature::Vertex(2));
    }
    let beyond_ca = d5 * d2 - d1 * d6;
    if beyond_ca <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return at(a + ac * (d2 / (d2 - d6)), Feature::Edge(2));
    }
    let beyond_bc = d3 * d6 - d5 * d4;
    let (along_b, along_c) = (d4 - d3, d5 - d6);
    if beyond_bc <= 0.0 && along_b >= 0.0 && along_c >= 0.0 {
        let share = along_b / (along_b + along_c);
        return at(b + (c - b) * share, Feature::Edge(1));
    }
    let sum = beyond_ab + beyond_bc + beyond_ca;
    let position = a + ab * (beyond_ca / sum) + ac * (beyond_ab / sum);
    at(position, Feature::Face)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const RIGHT: [Vector3<f64>; 3] = [
        Vector3::new(0.0, 0.0, 0.0),
        Vector3::new(4.0, 0.0, 0.0),
        Vector3::new(0.0, 3.0, 0.0),
    ];

    #[test]
    fn every_region_has_its_feature() {
        let cases = [
            ([1.0, 1.0, 2.0], [1.0, 1.0, 0.0], Feature::Face),
            ([1.0, 1.0, -2.0], [1.0, 1.0, 0.0], Feature::Face),
            ([2.0, -1.0, 1.0], [2.0, 0.0, 0.0], Feature::Edge(0)),
            ([-1.0, 2.0, 1.0], [0.0, 2.0, 0.0], Feature::Edge(2)),
            // from the middle of the hypotenuse along its normal (3, 4)/5
            (
                [2.0 + 3.0, 1.5 + 4.0, 0.0],
                [2.0, 1.5, 0.0],
                Feature::Edge(1),
            ),
            ([-1.0, -2.0, 3.0], [0.0, 0.0, 0.0], Feature::Vertex(0)),
            ([6.0, -1.0, 1.0], [4.0, 0.0, 0.0], Feature::Vertex(1)),
            ([-1.0, 5.0, 1.0], [0.0, 3.0, 0.0], Feature::Vertex(2)),
        ];
        for (point, expected, feature) in cases {
            let closest = closest_point(&RIGHT, &Vector3::from(point));
            let off = (closest.position - Vector3::from(expected)).norm();
            assert!(off < 1e-14, "{point:?}: {closest:?}");
            assert_eq!(closest.feature, feature, "{point:?}");
        }
    }

    /// Closest point of a segment.
    fn on_segment(from: &Vector3<f64>, to: &Vector3<f64>, point: &Vector3<f64>) -> Vector3<f64> {
        let way = to - from;
        from + way * (way.dot(&(point - from)) / way.norm_squared()).clamp(0.0, 1.0)
    }

    proptest! {
        /// The best of the three edges and, where the foot of the normal lies inside, the face.
        #[test]
        fn no_part_of_the_triangle_is_closer(
            corners in prop::array::uniform3(prop::array::uniform3(-1.0..1.0_f64)),
            point in prop::array::uniform3(-2.0..2.0_f64),
        ) {
            let triangle = corners.map(Vector3::from);
            let point = Vector3::from(point);
            let [a, b, c] = triangle;
            let normal = (b - a).cross(&(c - a));
            prop_assume!(normal.norm() > 1e-3);
            let mut best = [(a, b), (b, c), (c, a)]
                .map(|(from, to)| (on_segment(&from, &to, &point) - point).norm())
                .into_iter()
                .fold(f64::INFINITY, f64::min);
            let foot = point - normal * (normal.dot(&(point - a)) / normal.norm_squared());
            let is_left = |from: Vector3<f64>, to: Vector3<f64>| {
                (to - from).cross(&(foot - from)).dot(&normal) >= 0.0
            };
            if is_left(a, b) && is_left(b, c) && is_left(c, a) {
                best = best.min((foot - point).norm());
            }
            let closest = closest_point(&triangle, &point);
            let distance = (closest.position - point).norm();
            prop_assert!((distance - best).abs() < 1e-10, "{} {}", distance, best);
            // and it lies where it says
            let from_feature = match closest.feature {
                Feature::Face => (closest.position - a).dot(&normal) / normal.norm(),
                Feature::Edge(start) => {
                    let start = usize::from(start);
                    let foot = on_segment(&triangle[start], &triangle[(start + 1) % 3], &point);
                    (closest.position - foot).norm()
                }
                Feature::Vertex(corner) => (closest.position - triangle[usize::from(corner)]).norm(),
            };
            prop_assert!(from_feature.abs() < 1e-10);
        }
    }
}
