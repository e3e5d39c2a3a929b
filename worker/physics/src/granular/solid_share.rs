//! The part of a sphere that lies in a box.
//!
//! Spheres within the box count whole. Of one that faces cut without an edge of the box in it, caps of
//! height h are missing, π h² (3r − h)/3 each; this is exact. One with an edge in it is sliced across z:
//! the area of a circle in a rectangle is a closed form, and the slices z = r sin θ are summed by the
//! midpoint rule, whose weights r cos θ vanish at both ends.
use super::{Vector, sphere};

/// A box with faces across the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cuboid {
    pub(super) low: Vector,
    pub(super) high: Vector,
}

/// Slices of a sphere with an edge in it: an error of about 10⁻⁵ of its volume.
const SLICES: usize = 96;

impl Cuboid {
    /// [m³].
    pub(super) fn volume(&self) -> f64 {
        let edges = (self.high - self.low).map(|edge| edge.max(0.0));
        edges.product()
    }

    pub(super) fn contains(&self, point: &Vector) -> bool {
        (0..3).all(|axis| point[axis] >= self.low[axis] && point[axis] <= self.high[axis])
    }

    /// The part of a segment from `start` along `way` that lies within.
    pub(super) fn part_of_segment(&self, start: &Vector, way: &Vector) -> f64 {
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        for axis in 0..3 {
            if way[axis] == 0.0 {
                if start[axis] < self.low[axis] || start[axis] > self.high[axis] {
                    return 0.0;
                }
                continue;
            }
            let ends = [self.low[axis], self.high[axis]];
            let [first, second] = ends.map(|end| (end - start[axis]) / way[axis]);
            from = from.max(first.min(second));
            to = to.min(first.max(second));
        }
        (to - from).max(0.0)
    }
}

/// Volume of a sphere within a box [m³].
pub(super) fn sphere_volume_within(cuboid: &Cuboid, centre: &Vector, radius: f64) -> f64 {
    let low = (cuboid.low - centre) / radius;
    let high = (cuboid.high - centre) / radius;
    if (0..3).all(|axis| low[axis] <= -1.0 && high[axis] >= 1.0) {
        return sphere::volume(radius);
    }
    if (0..3).any(|axis| low[axis] >= 1.0 || high[axis] <= -1.0 || low[axis] >= high[axis]) {
        return 0.0;
    }
    if let Some(missing) = missing_caps(&low, &high) {
        return sphere::volume(radius) - missing * radius.powi(3);
    }
    // slices of the unit sphere between the faces across z
    let (from, to) = (low.z.max(-1.0).asin(), high.z.min(1.0).asin());
    let width = (to - from) / SLICES as f64;
    let slices = (0..SLICES).map(|slice| {
        let angle = from + (slice as f64 + 0.5) * width;
        let circle = angle.cos();
        let ends = [low.x, low.y, high.x, high.y].map(|end| end / circle);
        circle * circle * unit_circle_in(ends) * circle * width
    });
    slices.sum::<f64>() * radius.powi(3)
}

/// Volume of the caps that the faces cut off the unit sphere; `None` where caps overlap.
fn missing_caps(low: &Vector, high: &Vector) -> Option<f64> {
    let mut volume = 0.0;
    // distance of the centre from the faces that cut, largest caps first
    let mut distances = [[low.x, high.x], [low.y, high.y], [low.z, high.z]].map(|[low, high]| {
        let faces = [-low, high].map(|distance| distance.min(1.0));
        for distance in faces {
            let height = 1.0 - distance;
            volume += std::f64::consts::PI * height * height * (2.0 + distance) / 3.0;
        }
        faces[0].min(faces[1])
    });
    distances.sort_by(f64::total_cmp);
    // a cap of more than half reaches into every other; two of one axis never meet
    let [nearest, second, _] = distances;
    let is_alone = second >= 1.0;
    let are_apart = nearest >= 0.0 && nearest * nearest + second * second >= 1.0;
    (is_alone || are_apart).then_some(volume)
}

/// Area of the unit circle within the rectangle [x₀, x₁] × [y₀, y₁].
fn unit_circle_in([x0, y0, x1, y1]: [f64; 4]) -> f64 {
    quadrant(x1, y1) - quadrant(x0, y1) - quadrant(x1, y0) + quadrant(x0, y0)
}

/// Area of the unit circle left of x and below y.
fn quadrant(x: f64, y: f64) -> f64 {
    let (x, y) = (x.clamp(-1.0, 1.0), y.clamp(-1.0, 1.0));
    // ∫ √(1 − t²) from −1 to t
    let below =
        |t: f64| 0.5 * (t * (1.0 - t * t).max(0.0).sqrt() + t.asin()) + std::f64::consts::FRAC_PI_4;
    // over [−1, x] columns reach from −√(1 − t²) up to y or √(1 − t²)
    let edge = (1.0 - y * y).max(0.0).sqrt();
    let (left, right) = (x.min(-edge), x.clamp(-edge, edge));
    let middle = (right + edge) * y + below(right) - below(-edge);
    let caps = 2.0 * (below(left) + below(x.max(edge)) - below(edge));
    if y >= 0.0 { caps + middle } else { middle }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Caps are exact.
    const ROUND_OFF: f64 = 1e-15;
    /// Slices of the midpoint rule where the boundary of the area has corners.
    const SLICED: f64 = 2e-5;

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
                    (found - expected).abs() < SLICED,
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
            assert!((sum - 1.0).abs() < 8.0 * SLICED, "{corner:?}: {sum}");
        }
    }
}
