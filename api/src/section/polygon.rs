//! Convex polygons: clipped by half-planes, measured exactly.

/// A convex polygon, corners counterclockwise [mm].
///
/// A cell, the section and two fibres have sixteen sides: no part of them all has more corners.
#[derive(Debug, Clone, Copy)]
pub struct Polygon {
    corners: [[f64; 2]; Self::MOST],
    count: usize,
}

impl Polygon {
    const MOST: usize = 16;

    pub fn rectangle(x: [f64; 2], y: [f64; 2]) -> Self {
        Self::of(&[[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]])
    }

    pub fn of(given: &[[f64; 2]; 4]) -> Self {
        let mut corners = [[0.0; 2]; Self::MOST];
        corners[..4].copy_from_slice(given);
        Self { corners, count: 4 }
    }

    pub fn corners(&self) -> &[[f64; 2]] {
        &self.corners[..self.count]
    }

    /// What is left where n · p ≤ `limit`.
    pub fn clipped(&self, normal: [f64; 2], limit: f64) -> Self {
        let height = |p: [f64; 2]| normal[0] * p[0] + normal[1] * p[1] - limit;
        let mut kept = Self {
            corners: [[0.0; 2]; Self::MOST],
            count: 0,
        };
        for (place, &from) in self.corners().iter().enumerate() {
            let to = self.corners[(place + 1) % self.count];
            let (below, above) = (height(from), height(to));
            if below <= 0.0 {
                kept.push(from);
            }
            if (below < 0.0 && above > 0.0) || (below > 0.0 && above < 0.0) {
                let share = below / (below - above);
                kept.push([
                    from[0] + share * (to[0] - from[0]),
                    from[1] + share * (to[1] - from[1]),
                ]);
            }
        }
        kept
    }

    fn push(&mut self, corner: [f64; 2]) {
        // Round-off can make a corner twice; a seventeenth one could only be such a double.
        if self.count < Self::MOST {
            self.corners[self.count] = corner;
            self.count += 1;
        }
    }

    /// The part inside another convex polygon.
    pub fn within(&self, other: &Self) -> Self {
        let mut kept = *self;
        for (place, &from) in other.corners().iter().enumerate() {
            let to = other.corners[(place + 1) % other.count];
            let normal = [to[1] - from[1], from[0] - to[0]];
            let limit = normal[0] * from[0] + normal[1] * from[1];
            kept = kept.clipped(normal, limit);
        }
        kept
    }

    /// Area [mm²] and centroid [mm]; the first corner is the origin, so that a small polygon far
    /// from the global one loses no digits.
    pub fn area_and_centroid(&self) -> (f64, [f64; 2]) {
        let Some((&first, rest)) = self.corners().split_first() else {
            return (0.0, [0.0; 2]);
        };
        let mut area = 0.0;
        let mut moment = [0.0; 2];
        for pair in rest.windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|p| [p[0] - first[0], p[1] - first[1]]);
            let triangle = 0.5 * (a[0] * b[1] - a[1] * b[0]);
            area += triangle;
            moment[0] += triangle * (a[0] + b[0]) / 3.0;
            moment[1] += triangle * (a[1] + b[1]) / 3.0;
        }
        if area <= 0.0 {
            return (0.0, first);
        }
        (
            area,
            [first[0] + moment[0] / area, first[1] + moment[1] / area],
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_a_square_by_its_diagonal() {
        let square = Polygon::rectangle([2.0, 4.0], [1.0, 3.0]);
        let lower = square.clipped([-1.0, 1.0], -1.0);
        let (area, centroid) = lower.area_and_centroid();
        assert!((area - 2.0).abs() < 1e-15);
        assert!((centroid[0] - (2.0 + 4.0 / 3.0)).abs() < 1e-14);
        assert!((centroid[1] - (1.0 + 2.0 / 3.0)).abs() < 1e-14);
    }

    #[test]
    fn nothing_is_left_outside() {
        let square = Polygon::rectangle([0.0, 1.0], [0.0, 1.0]);
        assert!(square.clipped([1.0, 0.0], -0.5).corners().is_empty());
        let far = Polygon::rectangle([2.0, 3.0], [0.0, 1.0]);
        assert!(square.within(&far).area_and_centroid().0 < 1e-15);
    }
}
