//! What stays the same over all trials.
use loadframe_api::spec::calibrate::{Calibrate, Template};

use super::{coordinates::Coordinate, misfit::Targets};

/// The calibration, the job whose parameters are fitted, what was measured, and where the search walks.
#[derive(Clone, Copy)]
pub(super) struct Setting<'a> {
    pub(super) spec: &'a Calibrate,
    pub(super) template: &'a Template,
    pub(super) targets: &'a Targets<'a>,
    pub(super) coordinates: &'a [Coordinate],
}

impl<'a> Setting<'a> {
    /// The parameters at a point.
    pub(super) fn parameters(&self, point: &[f64]) -> Vec<(&'a str, f64)> {
        let free = self.spec.free.iter().zip(self.coordinates).zip(point);
        free.map(|((free, coordinate), x)| (free.parameter.as_str(), coordinate.value(*x)))
            .collect()
    }
}
