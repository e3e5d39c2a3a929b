//! Tests of further beds of one spec, whose seeds count on: what tests of [`ballast`](crate::ballast) and
//! [`soil`](crate::soil) share.
use loadframe_api::{Report, Studied};
use loadframe_harness::{
    Ending, Recorder, RunContext, SimulationError,
    checkpoint::Fingerprint,
    plan::{Place, Specimens, test_specimens},
};
use serde::Serialize;

/// The spec of a test that may be done to several beds.
pub(crate) trait Repeated: Studied + Clone + Serialize + Sync {
    /// What they are called.
    const SEVERAL: &'static str;
    /// Leading columns of the curve that are kept of every bed.
    const KEPT_COLUMNS: usize;
    /// The result that is told of each in the log.
    const TOLD: &'static str;

    /// Their number.
    fn repeats(&self) -> u32;

    /// Seed of the first.
    fn seed(&self) -> u64;

    /// Makes it the test of the first alone, with all that is written.
    fn first_alone(&mut self);

    /// Runs the test of one bed.
    ///
    /// # Errors
    /// What made a result impossible, see [`SimulationError`].
    fn run_one(
        &self,
        context: RunContext<'_>,
        recorder: &mut dyn Recorder,
    ) -> Result<Ending, SimulationError>;
}

/// Runs the tests of all beds.
///
/// # Errors
/// As [`Repeated::run_one`].
pub(crate) fn run<S: Repeated>(
    spec: &S,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Ending, SimulationError> {
    if spec.repeats() <= 1 {
        return spec.run_one(context, recorder);
    }
    test_specimens(&Beds(spec), Fingerprint::of(spec)?, context, recorder)
}

struct Beds<'a, S>(&'a S);

impl<S: Repeated> Specimens for Beds<'_, S> {
    fn count(&self) -> usize {
        self.0.repeats() as usize
    }

    fn first_seed(&self) -> u64 {
        self.0.seed()
    }

    fn kept_columns(&self) -> usize {
        S::KEPT_COLUMNS
    }

    fn has_sampling_errors(&self) -> bool {
        true
    }

    fn overview(&self) -> String {
        let (seed, count) = (self.0.seed(), self.0.repeats());
        let last = seed + u64::from(count - 1);
        format!("{count} {}, seeds {seed} to {last}", S::SEVERAL)
    }

    fn line(&self, place: Place, report: &Report) -> Option<String> {
        let told = report.summary.get(S::TOLD)?;
        let seed = self.first_seed() + place.specimen as u64;
        let name = S::TOLD.replace('_', " ");
        Some(match told.value {
            Some(value) => format!("seed {seed}: {name} {value:.4} {}", told.unit),
            None => format!("seed {seed}: {name} unknown"),
        })
    }

    fn test(
        &self,
        place: Place,
        context: RunContext<'_>,
        recorder: &mut dyn Recorder,
    ) -> Result<Ending, SimulationError> {
        let seed = self.first_seed() + place.specimen as u64;
        let mut own = self.0.clone();
        match place.specimen {
            0 => own.first_alone(),
            // nobody sees pictures of others
            _ => own.single(seed),
        }
        own.run_one(context, recorder)
    }
}
