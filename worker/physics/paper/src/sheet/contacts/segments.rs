//! Where two straight segments come nearest to one another.
use crate::sheet::FibreSection;

/// The measure of distance between two fibres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Metric {
    /// What heights are stretched by, so that both sections are round.
    stretch: f64,
    /// Distance [µm] up to which they touch.
    reach_um: f64,
}

/// Two segments that touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Touch {
    /// Numbers of the segments on their fibres.
    pub(super) segments: [u32; 2],
    /// Where they are nearest, shares of each segment.
    pub(super) shares: [f64; 2],
    /// Distance there over the largest at which they touch [-].
    pub(super) nearness: f64,
}

impl Metric {
    pub(super) fn new(sections: [FibreSection; 2], gap_um: f64) -> Self {
        let [one, other] = sections;
        let widths = one.width_um + other.width_um;
        let heights = one.thickness_um + other.thickness_um + 2.0 * gap_um;
        Self {
            stretch: widths / heights,
            reach_um: 0.5 * widths,
        }
    }

    /// The touch of two segments of two centre lines, if there is one.
    pub(super) fn touch(&self, lines: [&[[f64; 3]]; 2], segments: [usize; 2]) -> Option<Touch> {
        let round = |point: [f64; 3]| [point[0], point[1], point[2] * self.stretch];
        let ends = |which: usize| {
            let (line, segment) = (lines[which], segments[which]);
            [round(line[segment]), round(line[segment + 1])]
        };
        let [one, other] = [ends(0), ends(1)];
        let (shares, squared) = nearest(one, other);
        (squared <= self.reach_um * self.reach_um).then(|| Touch {
            segments: segments.map(|segment| segment as u32),
            shares,
            nearness: squared.sqrt() / self.reach_um,
        })
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Shares of two segments at which they are nearest, and their squared distance there.
///
/// Of parallel segments that lie beside one another all pairs are equally near; the middle of what
/// lies side by side is taken. Source: [Ericson2005], 5.1.9, with this choice added.
fn nearest([a, b]: [[f64; 3]; 2], [c, d]: [[f64; 3]; 2]) -> ([f64; 2], f64) {
    let [u, v, w] = [minus(b, a), minus(d, c), minus(a, c)];
    let [uu, vv, uv] = [dot(u, u), dot(v, v), dot(u, v)];
    let [uw, vw] = [dot(u, w), dot(v, w)];
    let share = |over: f64, under: f64| {
        if under > 0.0 {
            (over / under).clamp(0.0, 1.0)
        } else {
            0.0
        }
    };
    // |u × v|²; below this rounding says nothing about where lines cross
    let sine = uu * vv - uv * uv;
    let mut s = if sine > 1e-12 * uu * vv {
        share(uv * vw - uw * vv, sine)
    } else {
        // ends of the other segment on this one
        let [from, to] = [share(-uw, uu), share(uv - uw, uu)];
        0.5 * (from + to)
    };
    let t = share(uv * s + vw, vv);
    s = share(uv * t - uw, uu);
    let gap: [f64; 3] = std::array::from_fn(|axis| w[axis] + s * u[axis] - t * v[axis]);
    ([s, t], dot(gap, gap))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp, reason = "these numbers are exact")]
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn crossing_touching_and_parallel_segments_by_hand() {
        let x = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0]];
        let ([s, t], squared) = nearest(x, [[1.0, -1.0, 2.0], [1.0, 3.0, 2.0]]);
        assert_eq!([s, t, squared], [0.25, 0.25, 4.0]);
        // beside, overlapping from 2 to 4
        let ([s, t], squared) = nearest(x, [[2.0, 1.0, 0.0], [6.0, 1.0, 0.0]]);
        assert_eq!([s, t, squared], [0.75, 0.25, 1.0]);
        // in line, with a gap, either way round
        let ([s, t], squared) = nearest(x, [[7.0, 0.0, 0.0], [6.0, 0.0, 0.0]]);
        assert_eq!([s, t, squared], [1.0, 1.0, 4.0]);
        // a point
        let ([s, _], squared) = nearest(x, [[1.0, 2.0, 0.0]; 2]);
        assert_eq!([s, squared], [0.25, 4.0]);
        let ([_, t], squared) = nearest([[1.0, 2.0, 0.0]; 2], x);
        assert_eq!([t, squared], [0.25, 4.0]);
    }

    fn point() -> impl Strategy<Value = [f64; 3]> {
        proptest::array::uniform3(-1.0..1.0)
    }

    proptest! {
        /// The distance is convex in both shares: no point of a fine net is nearer.
        #[test]
        fn no_pair_of_points_is_nearer(a in point(), b in point(), c in point(), d in point()) {
            let (shares, squared) = nearest([a, b], [c, d]);
            prop_assert!(shares.iter().all(|share| (0.0..=1.0).contains(share)));
            let at = |from: [f64; 3], to: [f64; 3], share: f64| -> [f64; 3] {
                std::array::from_fn(|axis| from[axis] + share * (to[axis] - from[axis]))
            };
            for i in 0..=20 {
                for j in 0..=20 {
                    let [s, t] = [i, j].map(|k| f64::from(k) / 20.0);
                    let gap = minus(at(a, b, s), at(c, d, t));
                    prop_assert!(dot(gap, gap) >= squared - 1e-12);
                }
            }
        }
    }
}
