//! Where the search walks: one coordinate for each free parameter, in which equal steps mean equal
//! changes. ln p on a logarithmic scale, (p − min)/(max − min) on a linear one.
use loadframe_api::spec::calibrate::{FreeParameter, Scale};

/// The coordinate of one parameter.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coordinate {
    scale: Scale,
    min: f64,
    max: f64,
}

impl Coordinate {
    pub(super) fn new(free: &FreeParameter) -> Self {
        Self {
            scale: free.scale,
            min: free.min,
            max: free.max,
        }
    }

    pub(super) fn of(self, value: f64) -> f64 {
        match self.scale {
            Scale::Log => value.ln(),
            Scale::Linear => (value - self.min) / (self.max - self.min),
        }
    }

    /// The value at a coordinate, never outside its range by rounding.
    pub(super) fn value(self, coordinate: f64) -> f64 {
        let value = match self.scale {
            Scale::Log => coordinate.exp(),
            Scale::Linear => self.min + coordinate * (self.max - self.min),
        };
        value.clamp(self.min, self.max)
    }

    /// Ends of the range.
    pub(super) fn range(self) -> [f64; 2] {
        [self.of(self.min), self.of(self.max)]
    }

    /// The step derivatives are taken from: `step`, or less where the range is short.
    pub(super) fn difference(self, step: f64) -> f64 {
        /// Part of the range a step takes at most.
        const MOST: f64 = 0.25;
        let [low, high] = self.range();
        step.min(MOST * (high - low))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_come_back_and_stay_in_range() {
        for (scale, half) in [(Scale::Log, 10.0_f64.sqrt()), (Scale::Linear, 5.5)] {
            let free = FreeParameter {
                parameter: String::new(),
                min: 1.0,
                max: 10.0,
                start: None,
                scale,
            };
            let coordinate = Coordinate::new(&free);
            let [low, high] = coordinate.range();
            // two roundings of a number of order ten
            assert!((coordinate.value(0.5 * (low + high)) - half).abs() < 1e-14);
            assert!((coordinate.value(coordinate.of(3.7)) - 3.7).abs() < 1e-14);
            assert!(coordinate.value(high + 1e-9) <= 10.0 && coordinate.value(low - 1.0) >= 1.0);
        }
    }
}
