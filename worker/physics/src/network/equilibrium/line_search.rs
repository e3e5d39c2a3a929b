//! How far to go along a descent direction.
use super::work::Meter;
use crate::{
    Interrupt,
    network::{assembly::Assembly, configuration::Configuration, field::Field, strips::AtPlaces},
    parallel::Team,
    wide::wide,
};

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

/// A line to search along.
pub(super) struct Line<'a> {
    pub(super) assembly: &'a Assembly,
    pub(super) start: &'a Configuration,
    pub(super) direction: &'a Field<f64>,
    /// Largest multiple of the direction.
    pub(super) longest: f64,
    pub(super) team: &'a Team,
}

impl Line<'_> {
    /// Sets `trial` to a point on the line with sufficiently less energy and returns true, or
    /// returns false when there is none.
    ///
    /// # Errors
    /// The interrupt that ended it early.
    pub(super) fn descend(
        &self,
        trial: &mut Configuration,
        meter: &mut Meter<'_>,
    ) -> Result<bool, Interrupt> {
        let slope = self.slope(self.start);
        if slope >= 0.0 {
            return Ok(false);
        }
        let mut length = self.longest.min(1.0);
        for _ in 0..TRIALS {
            self.place(trial, length, meter)?;
            if self.descends(trial, length, slope) {
                self.lengthen(trial, length, slope, meter)?;
                return Ok(true);
            }
            let secant = slope / (slope - self.slope(trial));
            length *= if secant.is_finite() {
                secant.clamp(SHORTENING[0], SHORTENING[1])
            } else {
                SHORTENING[0]
            };
        }
        Ok(false)
    }

    /// Goes on from an accepted point while it pays.
    fn lengthen(
        &self,
        trial: &mut Configuration,
        accepted: f64,
        slope: f64,
        meter: &mut Meter<'_>,
    ) -> Result<(), Interrupt> {
        let mut accepted = accepted;
        while accepted < self.longest && self.slope(trial) < STILL_STEEP * slope {
            let length = (LENGTHENING * accepted).min(self.longest);
            self.place(trial, length, meter)?;
            if !self.descends(trial, length, slope) {
                return self.place(trial, accepted, meter);
            }
            accepted = length;
        }
        Ok(())
    }

    fn place(
        &self,
        trial: &mut Configuration,
        length: f64,
        meter: &mut Meter<'_>,
    ) -> Result<(), Interrupt> {
        meter.spend(self.assembly.bonds())?;
        let (start, direction) = (&self.start.displacements, self.direction);
        let trials = AtPlaces(trial.displacements.components_mut());
        let strips = &self.assembly.strips;
        strips.each(self.team, trials, |strip, AtPlaces(trials)| {
            let [start, direction] =
                [start, direction].map(|field| field.panel(strip.places.clone()));
            for (trial, (start, direction)) in trials.iter_mut().zip(start.iter().zip(direction)) {
                for (trial, (start, direction)) in trial.iter_mut().zip(start.iter().zip(direction))
                {
                    *trial = start + direction * length;
                }
            }
        });
        trial.update(self.assembly, self.team);
        Ok(())
    }

    /// Armijo's rule.
    fn descends(&self, trial: &Configuration, length: f64, slope: f64) -> bool {
        let promised = slope * length;
        let noise = ENERGY_ROUND_OFF * self.start.energy;
        let change = if promised.abs() < noise {
            // the trapezoidal rule on the slopes, free of the cancellation in the energies
            0.5 * (slope + self.slope(trial)) * length
        } else {
            trial.energy - self.start.energy
        };
        change <= SUFFICIENT_DECREASE * promised
    }

    /// dE/d length.
    fn slope(&self, at: &Configuration) -> f64 {
        let free = self.assembly.free();
        -self.assembly.strips.sum(self.team, (), |strip, ()| {
            let places = strip.within(&free);
            wide(
                #[inline(always)]
                || at.resultants.dot(self.direction, places.clone()),
            )
        })
    }
}
