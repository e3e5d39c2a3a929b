//! How far to go along a descent direction.
use super::work::Meter;
use crate::{
    Interrupt,
    network::{Vector, assembly::Assembly, configuration::Configuration},
    parallel::{Team, ordered_sum},
};

/// Part of the decrease promised by the slope that a step must keep (Armijo's rule); the usual
/// small value, so that a full Newton step is refused only when it truly overshoots.
const SUFFICIENT_DECREASE: f64 = 1e-4;
/// Relative rounding error of an energy that is a chunked sum over bonds. Differences below it say
/// nothing; the slopes at both ends then tell whether the energy fell.
const ENERGY_ROUND_OFF: f64 = 1e-13;
/// A trial step is shortened at least to half, at most to a tenth: the slopes' secant is exact for
/// a parabola, but the bond law has kinks.
const SHORTENING: [f64; 2] = [0.1, 0.5];
/// 0.5⁴⁰ is below the rounding of a displacement.
const TRIALS: usize = 40;

/// Sets `trial` to the accepted point along `direction` and returns true, or returns false when no
/// step lowers the energy.
///
/// # Errors
/// The interrupt that ended it early.
pub(super) fn descend(
    assembly: &Assembly,
    start: &Configuration,
    direction: &[Vector],
    trial: &mut Configuration,
    team: &Team,
    meter: &mut Meter<'_>,
) -> Result<bool, Interrupt> {
    let slope_at = |configuration: &Configuration| {
        -ordered_sum(assembly.free(), |node| {
            configuration.resultants[node].dot(&direction[node])
        })
    };
    let slope = slope_at(start);
    if slope >= 0.0 {
        return Ok(false);
    }
    let noise = ENERGY_ROUND_OFF * start.energy;
    let mut length = 1.0;
    for _ in 0..TRIALS {
        for ((trial, start), direction) in
            (trial.displacements.iter_mut().zip(&start.displacements)).zip(direction)
        {
            *trial = start + direction * length;
        }
        meter.spend(assembly.bonds.len())?;
        trial.update(assembly, team);
        let end_slope = slope_at(trial);
        let promised = slope * length;
        let change = if promised.abs() < noise {
            // the trapezoidal rule on the slopes, free of the cancellation in the energies
            0.5 * (slope + end_slope) * length
        } else {
            trial.energy - start.energy
        };
        if change <= SUFFICIENT_DECREASE * promised {
            return Ok(true);
        }
        let secant = slope / (slope - end_slope);
        length *= if secant.is_finite() {
            secant.clamp(SHORTENING[0], SHORTENING[1])
        } else {
            SHORTENING[0]
        };
    }
    Ok(false)
}
