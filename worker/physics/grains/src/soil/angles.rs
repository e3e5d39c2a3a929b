//! Strengths, angles and strains that are read off curves of soil.
use loadframe_harness::curve;

/// Part of the way at its end over which the critical state is taken.
pub(super) const CRITICAL: f64 = 0.2;
/// Part of the way, on either side of the peak, over which a slope is fitted.
pub(super) const AROUND: f64 = 0.05;

/// Mean ordinate over the last [`CRITICAL`] of the way.
pub(super) fn critical(points: &[(f64, f64)]) -> f64 {
    let end = points.last().map_or(f64::NAN, |point| point.0);
    let start = points.first().map_or(f64::NAN, |point| point.0);
    let from = end - CRITICAL * (end - start);
    let last: Vec<f64> = points
        .iter()
        .filter(|point| point.0 >= from)
        .map(|point| point.1)
        .collect();
    last.iter().sum::<f64>() / last.len() as f64
}

/// Slope of the ordinate around this abscissa, by least squares within [`AROUND`] of the way.
pub(super) fn slope_at(points: &[(f64, f64)], place: f64) -> f64 {
    let end = points.last().map_or(f64::NAN, |point| point.0);
    let start = points.first().map_or(f64::NAN, |point| point.0);
    let reach = AROUND * (end - start);
    let near = points.iter().copied();
    let near: Vec<(f64, f64)> = near
        .filter(|point| (point.0 - place).abs() <= reach)
        .collect();
    curve::slope(&near).unwrap_or(f64::NAN)
}

/// Where a curve has first risen by this part of what it rises by in all, and its secant up to there.
pub(super) fn secant(points: &[(f64, f64)], part: f64) -> Option<(f64, f64)> {
    let [(start, first), (_, last)] = [points.first()?, points.last()?].map(|point| *point);
    let rise = part * (last - first);
    let place = reached(points, first + rise)?;
    Some((place, rise / (place - start)))
}

/// Abscissa at which the ordinate first reaches this, on the straight line between points; `None` where it never
/// does, or no less is before.
fn reached(points: &[(f64, f64)], ordinate: f64) -> Option<f64> {
    let after = points.iter().position(|point| point.1 >= ordinate)?;
    let [(x0, y0), (x1, y1)] = [points[after.checked_sub(1)?], points[after]];
    Some(x0 + (ordinate - y0) / (y1 - y0) * (x1 - x0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_fifth_of_the_way_is_critical_and_a_slope_is_that_of_a_line() {
        let points: Vec<(f64, f64)> = (0..=100)
            .map(|place| {
                let x = f64::from(place);
                (x, if place < 80 { 3.0 * x } else { 7.0 })
            })
            .collect();
        assert!((critical(&points) - 7.0).abs() < 1e-12);
        assert!((slope_at(&points, 40.0) - 3.0).abs() < 1e-12);
    }

    #[test]
    fn a_secant_is_that_of_the_part_that_a_curve_has_risen_by() {
        let points = [(1.0, 1.0), (2.0, 5.0), (4.0, 5.5), (6.0, 11.0)];
        assert_eq!(secant(&points, 0.2), Some((1.5, 4.0)));
        assert_eq!(secant(&points, 0.45), Some((4.0, 1.5)));
        assert_eq!(secant(&points, 1.1), None);
    }

    #[test]
    fn an_ordinate_is_reached_between_points_for_the_first_time() {
        let points = [(0.0, 1.0), (1.0, 2.0), (3.0, 6.0), (4.0, 1.0), (5.0, 9.0)];
        assert_eq!(reached(&points, 5.0), Some(2.5));
        assert_eq!(reached(&points, 2.0), Some(1.0));
        assert_eq!(reached(&points, 9.5), None);
        assert_eq!(reached(&points, 0.5), None);
    }
}
