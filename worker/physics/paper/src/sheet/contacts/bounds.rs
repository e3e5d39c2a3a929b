//! Boxes around parts of fibres.
use crate::sheet::FibreSection;

/// A box that holds part of a fibre.
pub(super) trait Bound: Copy + Send + Sync {
    /// The box of a part of a centre line, wide enough for its section and half the gap.
    fn around(points: &[[f64; 3]], section: FibreSection, gap_um: f64) -> Self;

    /// Whether two boxes have a point in common.
    fn meets(&self, other: &Self) -> bool;
}

/// A box along the sheet's axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Aligned {
    pub(super) lower: [f64; 3],
    pub(super) upper: [f64; 3],
}

impl Bound for Aligned {
    fn around(points: &[[f64; 3]], section: FibreSection, gap_um: f64) -> Self {
        let beside = 0.5 * section.width_um;
        let above = 0.5 * (section.thickness_um + gap_um);
        let margin = [beside, beside, above];
        let mut lower = [f64::INFINITY; 3];
        let mut upper = [f64::NEG_INFINITY; 3];
        for point in points {
            for axis in 0..3 {
                lower[axis] = lower[axis].min(point[axis]);
                upper[axis] = upper[axis].max(point[axis]);
            }
        }
        for axis in 0..3 {
            lower[axis] -= margin[axis];
            upper[axis] += margin[axis];
        }
        Self { lower, upper }
    }

    fn meets(&self, other: &Self) -> bool {
        (0..3).all(|axis| {
            self.lower[axis] <= other.upper[axis] && other.lower[axis] <= self.upper[axis]
        })
    }
}

/// A box turned about the sheet's normal so that it lies along its fibre.
///
/// Fibres lie in the sheet: boxes that share the normal need 5 of the 15 axes of the separating test
/// of boxes in any direction, the normal and the two sides of each. In a deposited sheet of 60 g/m² they
/// take a fifth fewer looks than boxes along the axes and lead to fewer leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Oriented {
    centre: [f64; 2],
    /// Unit vector along the fibre.
    along: [f64; 2],
    half: [f64; 2],
    heights: [f64; 2],
}

impl Bound for Oriented {
    fn around(points: &[[f64; 3]], section: FibreSection, gap_um: f64) -> Self {
        let [first, last] = [points[0], points[points.len() - 1]];
        let chord = [last[0] - first[0], last[1] - first[1]];
        let length = chord[0].hypot(chord[1]);
        let along = if length > 0.0 {
            [chord[0] / length, chord[1] / length]
        } else {
            [1.0, 0.0]
        };
        let mut lower = [f64::INFINITY; 3];
        let mut upper = [f64::NEG_INFINITY; 3];
        for point in points {
            let from = [point[0] - first[0], point[1] - first[1]];
            let place = [
                from[0] * along[0] + from[1] * along[1],
                from[1] * along[0] - from[0] * along[1],
                point[2],
            ];
            for axis in 0..3 {
                lower[axis] = lower[axis].min(place[axis]);
                upper[axis] = upper[axis].max(place[axis]);
            }
        }
        let [x, y] = [0, 1].map(|axis| 0.5 * (lower[axis] + upper[axis]));
        let above = 0.5 * (section.thickness_um + gap_um);
        Self {
            centre: [
                first[0] + x * along[0] - y * along[1],
                first[1] + x * along[1] + y * along[0],
            ],
            along,
            half: [0, 1].map(|axis| 0.5 * (upper[axis] - lower[axis] + section.width_um)),
            heights: [lower[2] - above, upper[2] + above],
        }
    }

    fn meets(&self, other: &Self) -> bool {
        if self.heights[0] > other.heights[1] || other.heights[0] > self.heights[1] {
            return false;
        }
        let [x, y] = [0, 1].map(|axis| other.centre[axis] - self.centre[axis]);
        let cosine = self.along[0] * other.along[0] + self.along[1] * other.along[1];
        let sine = self.along[0] * other.along[1] - self.along[1] * other.along[0];
        let (cosine, sine) = (cosine.abs(), sine.abs());
        // each box's reach along both sides of the other
        let is_apart = |of: &Self, from: &Self| {
            let along = x * of.along[0] + y * of.along[1];
            let across = y * of.along[0] - x * of.along[1];
            along.abs() > of.half[0] + from.half[0] * cosine + from.half[1] * sine
                || across.abs() > of.half[1] + from.half[0] * sine + from.half[1] * cosine
        };
        !(is_apart(self, other) || is_apart(other, self))
    }
}
