//! What stays the same over all trials.
use loadframe_api::spec::calibrate::{Calibrate, Template};
use loadframe_api::{JobSpec, Violation};
use loadframe_harness::Run;

use super::{coordinates::Coordinate, misfit::Targets};

/// The calibration, the job whose parameters are fitted, what was measured, where the search walks, and what
/// runs a job.
#[derive(Clone, Copy)]
pub(super) struct Setting<'a> {
    pub(super) spec: &'a Calibrate,
    pub(super) template: &'a Template,
    pub(super) targets: &'a Targets<'a>,
    pub(super) coordinates: &'a [Coordinate],
    pub(super) simulate: Run<JobSpec>,
}

impl<'a> Setting<'a> {
    /// The parameters at a point.
    pub(super) fn parameters(&self, point: &[f64]) -> Vec<(&'a str, f64)> {
        let free = self.spec.free.iter().zip(self.coordinates).zip(point);
        free.map(|((free, coordinate), x)| (free.parameter.as_str(), coordinate.value(*x)))
            .collect()
    }
}

/// What is wrong with a job, for people.
pub(super) fn in_words(violations: &[Violation]) -> String {
    let violations: Vec<String> = violations.iter().map(ToString::to_string).collect();
    violations.join("; ")
}
