//! Readings from a curve given by points with ascending abscissa.

/// Ordinate at `x` on the straight line between the neighbouring points; `None` outside the curve.
pub fn interpolate(points: &[(f64, f64)], x: f64) -> Option<f64> {
    let after = points.iter().position(|(abscissa, _)| *abscissa >= x)?;
    let (x1, y1) = points[after];
    if x1 <= x {
        return Some(y1);
    }
    let (x0, y0) = points[after.checked_sub(1)?];
    Some(y0 + (y1 - y0) * (x - x0) / (x1 - x0))
}

/// Area under the curve by the trapezoidal rule.
pub fn area(points: &[(f64, f64)]) -> f64 {
    let trapezoid = |pair: &[(f64, f64)]| 0.5 * (pair[0].1 + pair[1].1) * (pair[1].0 - pair[0].0);
    points.windows(2).map(trapezoid).sum()
}

/// Slope of the straight line that fits the points best, by least squares of the ordinate; `None`
/// where the points have no spread.
pub fn slope(points: &[(f64, f64)]) -> Option<f64> {
    let count = points.len() as f64;
    let mean = |part: fn(&(f64, f64)) -> f64| points.iter().map(part).sum::<f64>() / count;
    let (x, y) = (mean(|point| point.0), mean(|point| point.1));
    let products = points.iter().map(|point| (point.0 - x) * (point.1 - y));
    let squares: f64 = points.iter().map(|point| (point.0 - x).powi(2)).sum();
    (squares > 0.0).then(|| products.sum::<f64>() / squares)
}

/// Index of the first point with the largest ordinate.
pub fn peak(points: &[(f64, f64)]) -> Option<usize> {
    let indices = 0..points.len();
    indices.reduce(|best, next| {
        if points[next].1 > points[best].1 {
            next
        } else {
            best
        }
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp, reason = "these numbers are exact")]
    use super::*;

    const CURVE: [(f64, f64); 4] = [(0.0, 1.0), (2.0, 5.0), (3.0, 5.0), (5.0, 1.0)];

    #[test]
    fn readings_between_points_lie_on_straight_lines() {
        assert_eq!(interpolate(&CURVE, 0.5), Some(1.0 + 4.0 * 0.25));
        assert_eq!(interpolate(&CURVE, 2.0), Some(5.0));
        assert_eq!(interpolate(&CURVE, 0.0), Some(1.0));
    }

    #[test]
    fn outside_the_curve_there_is_nothing_to_read() {
        assert_eq!(interpolate(&CURVE, 5.1), None);
        assert_eq!(interpolate(&CURVE, -0.1), None);
        assert_eq!(interpolate(&[], 0.0), None);
        assert_eq!(peak(&[]), None);
    }

    #[test]
    fn a_fit_of_a_line_is_that_line() {
        let line = [0.0, 1.0, 3.0].map(|x| (x, 2.0 - 4.0 * x));
        assert!(slope(&line).is_some_and(|slope| (slope + 4.0).abs() < 1e-14));
        assert_eq!(slope(&line[..1]), None);
        assert_eq!(slope(&[]), None);
    }

    #[test]
    fn area_and_peak() {
        assert_eq!(area(&CURVE), 6.0 + 5.0 + 6.0);
        assert_eq!(peak(&CURVE), Some(1));
    }
}
