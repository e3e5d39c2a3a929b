//! A sort of jobs whose errors are measured, and what their results say of themselves.
use loadframe_api::{JobSpec, Report};

use crate::run::value;

/// A knob: the source of error that it stands for, and its levels, the coarsest first; the last is what
/// others are measured against.
pub(crate) struct Knob {
    pub(crate) source: &'static str,
    pub(crate) levels: Vec<f64>,
}

/// Jobs drawn at random. A setting has a value for each knob.
pub(crate) trait Sort: Sync {
    /// Results that are measured.
    fn results(&self) -> &'static [&'static str];
    fn knobs(&self) -> Vec<Knob>;
    /// Where the others are while one knob is varied.
    fn base(&self) -> Vec<f64>;
    /// The settings that people use, of which `seed` draws one.
    fn presets(&self, seed: u64) -> Vec<Vec<f64>>;
    fn job(&self, seed: u64, setting: &[f64]) -> JobSpec;
    /// What decides how the job of a seed errs, as the engine names it, given what it found.
    fn traits(&self, seed: u64, found: &Report) -> Vec<(&'static str, f64)>;

    /// What errors of the job of a seed are relative to, where that is not the result itself.
    fn scale(&self, _seed: u64) -> Option<f64> {
        None
    }

    /// The finest level of each knob.
    fn finest(&self) -> Vec<f64> {
        let levels = self.knobs().into_iter();
        levels
            .filter_map(|knob| knob.levels.last().copied())
            .collect()
    }
}

/// How many of its stated errors each result of the job of a seed, at one of the presets, lies from that
/// of the finest run.
pub(crate) fn errors_apart(
    sort: &dyn Sort,
    seed: u64,
    report: impl Fn(&JobSpec) -> Option<Report>,
) -> Vec<(&'static str, Option<f64>)> {
    let presets = sort.presets(seed);
    let setting = &presets[seed as usize % presets.len()];
    let tests = [setting, &sort.finest()].map(|setting| report(&sort.job(seed, setting)));
    let [Some(test), Some(finest)] = tests else {
        return Vec::new();
    };
    let apart = |name: &str| {
        let stated = test.summary.get(name)?.error.as_ref()?.value;
        let (found, finest) = value(&test, name).zip(value(&finest, name))?;
        let apart = (found - finest).abs();
        // both may be nothing
        Some(if apart == 0.0 { 0.0 } else { apart / stated })
    };
    let results = sort.results().iter();
    results.map(|name| (*name, apart(name))).collect()
}
