//! The point of a triangle that is closest to another point.
use super::{Point, Triangle, along, dot, minus};

/// Which part of a triangle a point lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Feature {
    Face,
    /// From the corner of this number (0, 1, 2) to the next.
    Edge(u8),
    /// The corner of this number.
    Vertex(u8),
}

/// A point on a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoint {
    /// Position, in the triangle's unit.
    pub position: Point,
    /// A contact on an edge or a corner is shared with the neighbours that have it too.
    pub feature: Feature,
}

impl ClosestPoint {
    /// Whether it lies inside the triangle.
    #[inline]
    pub fn is_on_face(&self) -> bool {
        self.feature == Feature::Face
    }
}

/// The point closest to `point` on a triangle that has an area.
///
/// Walks the Voronoi regions of corners and edges by the signs of dot products; what is left is
/// the face. Source: C. Ericson, *Real-Time Collision Detection* (2005), section 5.1.5.
#[inline]
pub fn closest_point(triangle: &Triangle, point: &Point) -> ClosestPoint {
    let [a, b, c] = triangle;
    let (ab, ac) = (minus(b, a), minus(c, a));
    let at = |position, feature| ClosestPoint { position, feature };

    let from_a = minus(point, a);
    let (d1, d2) = (dot(&ab, &from_a), dot(&ac, &from_a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return at(*a, Feature::Vertex(0));
    }
    let from_b = minus(point, b);
    let (d3, d4) = (dot(&ab, &from_b), dot(&ac, &from_b));
    if d3 >= 0.0 && d4 <= d3 {
        return at(*b, Feature::Vertex(1));
    }
    let beyond_ab = d1 * d4 - d3 * d2;
    if beyond_ab <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return at(along(a, &ab, d1 / (d1 - d3)), Feature::Edge(0));
    }
    let from_c = minus(point, c);
    let (d5, d6) = (dot(&ab, &from_c), dot(&ac, &from_c));
    if d6 >= 0.0 && d5 <= d6 {
        return at(*c, Feature::Vertex(2));
    }
    let beyond_ca = d5 * d2 - d1 * d6;
    if beyond_ca <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return at(along(a, &ac, d2 / (d2 - d6)), Feature::Edge(2));
    }
    let beyond_bc = d3 * d6 - d5 * d4;
    let (along_b, along_c) = (d4 - d3, d5 - d6);
    if beyond_bc <= 0.0 && along_b >= 0.0 && along_c >= 0.0 {
        let share = along_b / (along_b + along_c);
        return at(along(b, &minus(c, b), share), Feature::Edge(1));
    }
    let sum = beyond_ab + beyond_bc + beyond_ca;
    let position = along(&along(a, &ab, beyond_ca / sum), &ac, beyond_ab / sum);
    at(position, Feature::Face)
}

#[cfg(test)]
mod tests {
    use super::super::{cross, length};
    use super::*;
    use proptest::prelude::*;

    const RIGHT: Triangle = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 3.0, 0.0]];

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
            let closest = closest_point(&RIGHT, &point);
            let off = length(&minus(&closest.position, &expected));
            assert!(off < 1e-14, "{point:?}: {closest:?}");
            assert_eq!(closest.feature, feature, "{point:?}");
        }
    }

    /// Closest point of a segment.
    fn on_segment(from: &Point, to: &Point, point: &Point) -> Point {
        let way = minus(to, from);
        let share = dot(&way, &minus(point, from)) / dot(&way, &way);
        along(from, &way, share.clamp(0.0, 1.0))
    }

    proptest! {
        /// The best of the three edges and, where the foot of the normal lies inside, the face.
        #[test]
        fn no_part_of_the_triangle_is_closer(
            triangle in prop::array::uniform3(prop::array::uniform3(-1.0..1.0_f64)),
            point in prop::array::uniform3(-2.0..2.0_f64),
        ) {
            let [a, b, c] = triangle;
            let normal = cross(&minus(&b, &a), &minus(&c, &a));
            prop_assume!(length(&normal) > 1e-3);
            let away = |from: &Point| length(&minus(from, &point));
            let mut best = [(a, b), (b, c), (c, a)]
                .map(|(from, to)| away(&on_segment(&from, &to, &point)))
                .into_iter()
                .fold(f64::INFINITY, f64::min);
            let height = dot(&normal, &minus(&point, &a)) / dot(&normal, &normal);
            let foot = along(&point, &normal, -height);
            let is_left = |from: Point, to: Point| {
                dot(&cross(&minus(&to, &from), &minus(&foot, &from)), &normal) >= 0.0
            };
            if is_left(a, b) && is_left(b, c) && is_left(c, a) {
                best = best.min(away(&foot));
            }
            let closest = closest_point(&triangle, &point);
            let distance = away(&closest.position);
            prop_assert!((distance - best).abs() < 1e-10, "{} {}", distance, best);
            // and it lies where it says
            let off = |place: &Point| length(&minus(&closest.position, place));
            let from_feature = match closest.feature {
                Feature::Face => dot(&minus(&closest.position, &a), &normal) / length(&normal),
                Feature::Edge(start) => {
                    let start = usize::from(start);
                    off(&on_segment(&triangle[start], &triangle[(start + 1) % 3], &point))
                }
                Feature::Vertex(corner) => off(&triangle[usize::from(corner)]),
            };
            prop_assert!(from_feature.abs() < 1e-10);
        }
    }
}
