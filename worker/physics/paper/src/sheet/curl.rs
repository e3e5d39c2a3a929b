//! Curled fibres: an arc whose chord over length is the shape factor.
use std::f64::consts::PI;

/// Half of the angle ψ [rad] that a circular arc turns by, from its shape factor C [-], chord over
/// arc: sin ψ/ψ = C, 0 ≤ ψ < π.
///
/// Newton's steps on sin ψ − C ψ from ψ₀ = √(6 (1 − C)), which lies below the root since
/// sin ψ/ψ ≥ 1 − ψ²/6; a step out of the bracket is replaced by halving it. The patent's words allow
/// the angle of a triangle as well, which is 14 % larger; this is the exact one.
pub fn half_angle(shape_factor: f64) -> f64 {
    if shape_factor >= 1.0 {
        return 0.0;
    }
    let (mut below, mut above) = (0.0, PI);
    let mut angle = (6.0 * (1.0 - shape_factor)).sqrt().min(PI);
    // Newton doubles the digits and halving alone needs 53 of them
    for _ in 0..100 {
        let excess = angle.sin() - shape_factor * angle;
        if excess > 0.0 {
            below = angle;
        } else {
            above = angle;
        }
        let newton = angle - excess / (angle.cos() - shape_factor);
        let next = if newton > below && newton < above {
            newton
        } else {
            0.5 * (below + above)
        };
        if (next - angle).abs() <= 2.0 * f64::EPSILON * angle {
            return next;
        }
        angle = next;
    }
    angle
}

/// Points of an arc of a length [µm] about its middle, where it runs along x; it bends towards +y.
///
/// All segments have the same length, together exactly `length_um`, and each turns from the one
/// before by 2 ψ/N: eq. (7) of the patent with the exact ψ. The chord is L sin ψ/(N sin(ψ/N)), which
/// is the shape factor's but for ψ²/(6 N²).
pub(super) fn arc(length_um: f64, shape_factor: f64, segments: usize) -> Vec<[f64; 2]> {
    let count = segments as f64;
    let segment = length_um / count;
    let turn = 2.0 * half_angle(shape_factor) / count;
    let mut points = Vec::with_capacity(segments + 1);
    let mut at = [0.0; 2];
    points.push(at);
    for index in 0..segments {
        let direction = turn * (index as f64 - 0.5 * (count - 1.0));
        at = [
            at[0] + segment * direction.cos(),
            at[1] + segment * direction.sin(),
        ];
        points.push(at);
    }
    // the middle is a point, or that of the middle segment
    let [one, other] = [points[segments / 2], points[segments.div_ceil(2)]];
    let middle = [0.5 * (one[0] + other[0]), 0.5 * (one[1] + other[1])];
    for point in &mut points {
        *point = [point[0] - middle[0], point[1] - middle[1]];
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_half_angle_is_that_of_the_reference_table() {
        // half of 4 x angle(OAB)/2: angle OAB = ψ/2 is tabulated with four digits
        for (shape, angle) in [(0.99, 0.1227), (0.95, 0.2760), (0.9, 0.3933), (0.8, 0.5656)] {
            assert!((0.5 * half_angle(shape) - angle).abs() < 5.1e-5, "{shape}");
        }
    }

    #[test]
    fn the_equation_holds_from_nearly_straight_to_nearly_round() {
        for shape in [1.0 - 1e-9, 0.999, 0.9, 0.5, 0.2, 0.1, 0.01] {
            let angle = half_angle(shape);
            assert!(angle > 0.0 && angle < PI);
            let residual = angle.sin() / angle - shape;
            assert!(residual.abs() < 1e-14, "{shape}: {residual}");
        }
        assert!(half_angle(1.0).abs() < f64::MIN_POSITIVE);
    }

    #[test]
    fn chord_over_length_is_the_shape_factor() {
        let distance = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
        for shape in [1.0, 0.99, 0.92, 0.8, 0.5, 0.2] {
            for segments in [1000, 1001] {
                let points = arc(2000.0, shape, segments);
                let length: f64 = points.windows(2).map(|w| distance(w[0], w[1])).sum();
                assert!((length - 2000.0).abs() < 1e-9, "{length}");
                let chord = distance(points[0], points[segments]);
                assert!((chord / length - shape).abs() < 1e-6, "{}", chord / length);
            }
        }
    }

    /// ψ²/(6 N²) is lost by segments: seen on few of them.
    #[test]
    fn few_segments_are_less_curled_by_the_known_amount() {
        let points = arc(1.0, 0.9, 10);
        let chord = (points[10][0] - points[0][0]).hypot(points[10][1] - points[0][1]);
        let angle = half_angle(0.9);
        let expected = angle.sin() / (10.0 * (angle / 10.0).sin());
        assert!((chord - expected).abs() < 1e-14);
        assert!((chord / 0.9 - 1.0 - angle * angle / 600.0).abs() < 1e-6);
    }

    #[test]
    fn an_arc_lies_symmetrically_about_its_middle() {
        for segments in [1, 2, 7, 8] {
            let points = arc(100.0, 0.8, segments);
            let [first, last] = [points[0], points[segments]];
            assert!((first[0] + last[0]).abs() < 1e-12);
            assert!((first[1] - last[1]).abs() < 1e-12 && first[1] >= -1e-12);
        }
    }
}
