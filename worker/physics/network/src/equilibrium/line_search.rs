//! How far to go along a descent direction.
//!
//! Other methods halve a step until it is good ([`loadframe_numerics::equilibrium::halved`]). Here a trial is
//! a pass over all bonds that gives the slope at its end, too: a secant of slopes needs fewer of them, and
//! steps that leave a saddle are lengthened.
use loadframe_harness::Interrupt;

/// Part of the decrease promised by the slope that a step must keep (Armijo's rule); the usual
/// small value, so that a full Newton step is refused only when it truly overshoots.
const SUFFICIENT_DECREASE: f64 = 1e-4;
/// Relative rounding error of an energy that is a chunked sum over bonds. Differences below it say
/// nothing; the slopes at both ends then tell whether the energy fell.
const ENERGY_ROUND_OFF: f64 = 1e-13;
/// A step is lengthened while the slope at its end is still this part of the slope at its start. A
/// Newton step ends far below; one that leaves a saddle ends above, and would need hundreds more.
const STILL_STEEP: f64 = 0.8;
const LENGTHENING: f64 = 4.0;
/// A trial step is shortened at least to half, at most to a tenth: the slopes' secant is exact for
/// a parabola, but the bond law has kinks.
const SHORTENING: [f64; 2] = [0.1, 0.5];
/// 0.5⁴⁰ is below the rounding of a displacement.
const TRIALS: usize = 40;

/// What is known of a point on the line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    /// E [N mm].
    pub(super) energy: f64,
    /// dE by the multiple of the direction gone [N mm].
    pub(super) slope: f64,
}

/// Goes from `start` at most `longest` times the direction, to where there is sufficiently less
/// energy: `at` goes that far and says what is there. Returns false when there is no such point.
///
/// # Errors
/// The interrupt that ended it early.
pub(super) fn descend(
    start: Point,
    longest: f64,
    mut at: impl FnMut(f64) -> Result<Point, Interrupt>,
) -> Result<bool, Interrupt> {
    if start.slope >= 0.0 {
        return Ok(false);
    }
    let mut length = longest.min(1.0);
    for _ in 0..TRIALS {
        let mut trial = at(length)?;
        if !descends(start, trial, length) {
            let secant = start.slope / (start.slope - trial.slope);
            length *= if secant.is_finite() {
                secant.clamp(SHORTENING[0], SHORTENING[1])
            } else {
                SHORTENING[0]
            };
            continue;
        }
        // on from there while it pays
        while length < longest && trial.slope < STILL_STEEP * start.slope {
            let farther = (LENGTHENING * length).min(longest);
            trial = at(farther)?;
            if !descends(start, trial, farther) {
                at(length)?;
                break;
            }
            length = farther;
        }
        return Ok(true);
    }
    Ok(false)
}

/// Armijo's rule.
fn descends(start: Point, trial: Point, length: f64) -> bool {
    let promised = start.slope * length;
    let noise = ENERGY_ROUND_OFF * start.energy;
    let change = if promised.abs() < noise {
        // the trapezoidal rule on the slopes, free of the cancellation in the energies
        0.5 * (start.slope + trial.slope) * length
    } else {
        trial.energy - start.energy
    };
    change <= SUFFICIENT_DECREASE * promised
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where the search along a line with this energy and slope ends, and after how many looks.
    fn end(longest: f64, of: impl Fn(f64) -> [f64; 2]) -> (Option<f64>, usize) {
        let point = |length| {
            let [energy, slope] = of(length);
            Point { energy, slope }
        };
        let (mut here, mut looks) = (0.0, 0);
        let went = descend(point(0.0), longest, |length| {
            (here, looks) = (length, looks + 1);
            Ok(point(length))
        });
        (matches!(went, Ok(true)).then_some(here), looks)
    }

    fn is_near(found: Option<f64>, expected: f64) -> bool {
        found.is_some_and(|found| (found - expected).abs() < 1e-12)
    }

    #[test]
    fn a_full_step_to_the_bottom_is_taken_at_once() {
        let (length, looks) = end(9.0, |x| [(x - 1.0).powi(2), 2.0 * (x - 1.0)]);
        assert!(is_near(length, 1.0) && looks == 1, "{length:?}, {looks}");
    }

    #[test]
    fn a_step_too_far_ends_at_the_secant_of_the_slopes() {
        let (length, looks) = end(9.0, |x| [(x - 0.25).powi(2), 2.0 * (x - 0.25)]);
        assert!(is_near(length, 0.25) && looks == 2, "{length:?}, {looks}");
    }

    #[test]
    fn a_short_step_is_lengthened_while_the_way_is_steep_and_no_farther_than_allowed() {
        let slope = |x: f64| [-x, -1.0];
        assert!(is_near(end(10.0, slope).0, 10.0));
        // beyond 5 it goes up so far that 16 is no gain
        let (length, _) = end(
            100.0,
            |x| {
                if x < 5.0 { [-x, -1.0] } else { [x - 10.0, 1.0] }
            },
        );
        assert!(is_near(length, 4.0), "{length:?}");
    }

    #[test]
    fn uphill_there_is_nothing_to_find() {
        assert!(end(1.0, |x| [x, 1.0]).0.is_none());
        assert!(end(1.0, |_| [f64::NAN, f64::NAN]).0.is_none());
    }
}
