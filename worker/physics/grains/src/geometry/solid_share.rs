//! The part of a sphere that lies in a box, in closed form.
//!
//! What faces cut off is missing, what two of them cut off was taken away twice, what three cut off
//! was then given back once too often:
//!
//!   V = V₀ − Σ V₁(a) + Σ V₂(a, b) − Σ V₃(a, b, c)
//!
//! where V₁ is the part of the unit ball beyond a face at a distance a from its centre (a cap, negative
//! when the centre is beyond it as well), V₂ the part beyond two faces across each other, V₃ beyond three.
//! Where the edge or the corner lies in the ball, the divergence theorem gives these from the area S of
//! their round side and the areas A of their flat ones, and the theorem of Gauss and Bonnet gives S from
//! the arcs φ around it and the angles θ at which it turns from one to the next:
//!
//!   3 V = S − Σ a A, S = 2π − Σ a φ − Σ θ, cos θ = −ab/√((1 − a²)(1 − b²))
//!
//! Source: own derivation; for bodies with plane faces of any kind S. Strobl, A. Formella and
//! T. Pöschel, J. Comput. Phys. 311 (2016) 158.
use std::f64::consts::{PI, TAU};

use super::sphere;
use crate::numbers::Vector;

/// A box with faces across the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cuboid {
    pub(crate) low: Vector,
    pub(crate) high: Vector,
}

impl Cuboid {
    /// [m³].
    pub(crate) fn volume(&self) -> f64 {
        let edges = (self.high - self.low).map(|edge| edge.max(0.0));
        edges.product()
    }

    pub(crate) fn contains(&self, point: &Vector) -> bool {
        (0..3).all(|axis| point[axis] >= self.low[axis] && point[axis] <= self.high[axis])
    }

    /// The part of a segment from `start` along `way` that lies within.
    pub(crate) fn part_of_segment(&self, start: &Vector, way: &Vector) -> f64 {
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        let end = start + way;
        // most segments are beyond one side
        if (0..3).any(|axis| {
            start[axis].max(end[axis]) < self.low[axis]
                || start[axis].min(end[axis]) > self.high[axis]
        }) {
            return 0.0;
        }
        for axis in (0..3).filter(|axis| way[*axis] != 0.0) {
            let ends = [self.low[axis], self.high[axis]];
            let [first, second] = ends.map(|end| (end - start[axis]) / way[axis]);
            from = from.max(first.min(second));
            to = to.min(first.max(second));
        }
        (to - from).max(0.0)
    }
}

/// Volume of a sphere within a box [m³].
pub(crate) fn sphere_volume_within(cuboid: &Cuboid, centre: &Vector, radius: f64) -> f64 {
    let low = (cuboid.low - centre) / radius;
    let high = (cuboid.high - centre) / radius;
    if (0..3).all(|axis| low[axis] <= -1.0 && high[axis] >= 1.0) {
        return sphere::volume(radius);
    }
    if (0..3).any(|axis| low[axis] >= 1.0 || high[axis] <= -1.0 || low[axis] >= high[axis]) {
        return 0.0;
    }
    // distances of the faces from the centre, outwards
    let faces = [0, 1, 2].map(|axis| [-low[axis], high[axis]].map(|distance| distance.min(1.0)));
    let mut volume = sphere::volume(1.0);
    for (axis, own) in faces.iter().enumerate() {
        for a in own.iter().filter(|a| **a < 1.0) {
            volume -= beyond(*a);
            for b in faces[axis + 1..].iter().flatten() {
                volume += beyond_both(*a, *b);
            }
        }
    }
    let [x, y, z] = faces;
    for a in x.into_iter().filter(|a| *a < 1.0) {
        for b in y.into_iter().filter(|b| *b < 1.0) {
            for c in z.into_iter().filter(|c| *c < 1.0) {
                volume -= beyond_all(a, b, c);
            }
        }
    }
    volume * radius.powi(3)
}

/// V₁: x ≥ a in the unit ball.
fn beyond(a: f64) -> f64 {
    let height = 1.0 - a;
    PI * height * height * (2.0 + a) / 3.0
}

/// V₂: x ≥ a and y ≥ b in the unit ball.
fn beyond_both(a: f64, b: f64) -> f64 {
    if a >= 1.0 || b >= 1.0 {
        return 0.0;
    }
    if a * a + b * b >= 1.0 {
        // the edge passes by the ball
        return match (a < 0.0, b < 0.0) {
            (false, false) => 0.0,
            (true, _) => beyond(b) - beyond_both(-a, b),
            (false, true) => beyond(a) - beyond_both(a, -b),
        };
    }
    // arc and area of the flat side x = a: what of a circle is beyond y = b
    let side = |a: f64, b: f64| {
        let square = 1.0 - a * a;
        let half = (b / square.sqrt()).clamp(-1.0, 1.0).acos();
        [2.0 * half, square * half - b * (square - b * b).sqrt()]
    };
    let [[first_arc, first], [second_arc, second]] = [side(a, b), side(b, a)];
    let round = TAU - a * first_arc - b * second_arc - 2.0 * turn(a, b);
    (round - a * first - b * second) / 3.0
}

/// V₃: x ≥ a, y ≥ b and z ≥ c in the unit ball.
fn beyond_all(a: f64, b: f64, c: f64) -> f64 {
    if a * a + b * b + c * c >= 1.0 {
        // the corner is not in the ball: seen from the centre either nothing is beyond it, or a face is
        // on this side
        return if a < 0.0 {
            beyond_both(b, c) - beyond_all(-a, b, c)
        } else if b < 0.0 {
            beyond_both(a, c) - beyond_all(a, -b, c)
        } else if c < 0.0 {
            beyond_both(a, b) - beyond_all(a, b, -c)
        } else {
            0.0
        };
    }
    // arc and area of the flat side x = a: what of a circle is beyond y = b and z = c
    let side = |a: f64, b: f64, c: f64| {
        let square = 1.0 - a * a;
        let [end, start] = [b, c].map(|distance| (distance / square.sqrt()).clamp(-1.0, 1.0));
        let arc = end.acos() - start.asin();
        let [along_b, along_c] = [(b, c), (c, b)].map(|(d, e)| (square - d * d).sqrt() - e);
        [arc, 0.5 * (square * arc - b * along_b - c * along_c)]
    };
    let faces = [(a, side(a, b, c)), (b, side(b, c, a)), (c, side(c, a, b))];
    let arcs: f64 = faces
        .iter()
        .map(|(distance, [arc, _])| distance * arc)
        .sum();
    let flat: f64 = faces
        .iter()
        .map(|(distance, [_, area])| distance * area)
        .sum();
    let round = TAU - arcs - turn(a, b) - turn(b, c) - turn(c, a);
    (round - flat) / 3.0
}

/// θ between the arcs x = a and y = b where they meet.
fn turn(a: f64, b: f64) -> f64 {
    let cosine = -a * b / ((1.0 - a * a) * (1.0 - b * b)).sqrt();
    cosine.clamp(-1.0, 1.0).acos()
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROUND_OFF: f64 = 2e-15;

    fn share(low: [f64; 3], high: [f64; 3]) -> f64 {
        let cuboid = Cuboid {
            low: Vector::from(low),
            high: Vector::from(high),
        };
        let centre = Vector::new(0.3, -0.2, 0.1);
        let at = |corner: Vector| centre + 2.0 * corner;
        let cuboid = Cuboid {
            low: at(cuboid.low),
            high: at(cuboid.high),
        };
        sphere_volume_within(&cuboid, &centre, 2.0) / sphere::volume(2.0)
    }

    #[test]
    fn halves_octants_caps_and_wholes() {
        let far = 5.0;
        let cap = |height: f64| height * height * (3.0 - height) / 4.0;
        for (low, high, expected) in [
            ([-far; 3], [far; 3], 1.0),
            ([1.5, -far, -far], [far; 3], 0.0),
            ([0.0, -far, -far], [far; 3], 0.5),
            ([0.0; 3], [far; 3], 0.125),
            ([-far; 3], [0.0; 3], 0.125),
            ([-far, 0.4, -far], [far; 3], cap(0.6)),
            ([-far; 3], [far, far, -0.7], cap(0.3)),
            ([-0.5; 3], [0.5; 3], 0.75 / std::f64::consts::PI),
            ([-far, -0.4, -0.3], [0.1, far, far], 0.0),
        ] {
            if expected > 0.0 || low[0] > 1.0 {
                let found = share(low, high);
                assert!(
                    (found - expected).abs() < ROUND_OFF,
                    "{low:?}: {found} {expected}"
                );
            }
        }
    }

    #[test]
    fn caps_without_an_edge_between_them_are_exact() {
        let far = 5.0;
        let cap = |height: f64| height * height * (3.0 - height) / 4.0;
        for (low, high, expected) in [
            ([-far, 0.4, -far], [far; 3], cap(0.6)),
            (
                [-far, -0.4, -far],
                [far, 0.9, far],
                1.0 - cap(0.6) - cap(0.1),
            ),
            // two faces whose edge just misses the sphere
            (
                [-0.8, -far, -far],
                [far, 0.6, far],
                1.0 - cap(0.2) - cap(0.4),
            ),
            (
                [-0.9, -0.8, -0.7],
                [0.9, 0.75, 0.95],
                1.0 - [0.1, 0.2, 0.3, 0.1, 0.25, 0.05]
                    .map(cap)
                    .iter()
                    .sum::<f64>(),
            ),
        ] {
            let found = share(low, high);
            assert!(
                (found - expected).abs() < ROUND_OFF,
                "{low:?}: {found} {expected}"
            );
        }
    }

    /// The same by columns along z.
    fn summed(low: [f64; 3], high: [f64; 3]) -> f64 {
        const COLUMNS: usize = 500;
        let width = 2.0 / COLUMNS as f64;
        let middle = |column: usize| (column as f64 + 0.5) * width - 1.0;
        let within = |axis: usize, place: f64| {
            (place.min(high[axis] - 0.5 * width) + 0.5 * width
                - (place.max(low[axis] + 0.5 * width) - 0.5 * width))
                .clamp(0.0, width)
        };
        let column = |x: f64, y: f64| {
            let half = (1.0 - x * x - y * y).max(0.0).sqrt();
            (half.min(high[2]) - (-half).max(low[2])).max(0.0) * within(0, x) * within(1, y)
        };
        let places = (0..COLUMNS).flat_map(|x| (0..COLUMNS).map(move |y| (middle(x), middle(y))));
        places.map(|(x, y)| column(x, y)).sum::<f64>() / sphere::volume(1.0)
    }

    #[test]
    fn any_box_is_what_its_columns_sum_up_to() {
        let mut number = 1_u32;
        let mut draw = || {
            number = number.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(number >> 8) / f64::from(1 << 23) - 1.0
        };
        for _ in 0..60 {
            let ends = [(); 3].map(|()| [1.2 * draw(), 1.2 * draw()]);
            let [low, high] = [f64::min, f64::max].map(|pick| ends.map(|[a, b]| pick(a, b)));
            let (found, expected) = (share(low, high), summed(low, high));
            // columns on the rim of the ball
            assert!(
                (found - expected).abs() < 2e-4,
                "{low:?} {high:?}: {found} {expected}"
            );
        }
    }

    #[test]
    fn eight_boxes_around_any_corner_share_a_sphere() {
        for corner in [[0.1, -0.3, 0.5], [-0.7, 0.6, -0.2], [0.9, 0.9, 0.9]] {
            let mut sum = 0.0;
            for sides in 0..8 {
                let is_high = |axis: usize| sides >> axis & 1 == 1;
                let low =
                    std::array::from_fn(|axis| if is_high(axis) { corner[axis] } else { -9.0 });
                let high =
                    std::array::from_fn(|axis| if is_high(axis) { 9.0 } else { corner[axis] });
                sum += share(low, high);
            }
            assert!((sum - 1.0).abs() < 8.0 * ROUND_OFF, "{corner:?}: {sum}");
        }
    }
}
