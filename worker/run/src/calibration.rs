//! How fast this machine is: a short run of the real solver, timed.
use loadframe_api::Calibration;
use loadframe_physics::{
    Ending, RunContext, Uninterrupted, Unrecorded, calibration_spec, simulate,
};

use super::machine::processor_time_s;

/// The best of so many runs counts: others on the machine, its caches above all, can only make a
/// run slower.
const RUNS: usize = 5;

/// The speed of one core of this machine, `None` when the run did not give one.
pub fn calibrate() -> Option<Calibration> {
    let spec = calibration_spec();
    let speed = |_| {
        let context = RunContext {
            threads: 1,
            interrupt: &Uninterrupted,
            checkpoint: None,
        };
        let started_s = processor_time_s();
        let ending = simulate(&spec, context, &mut Unrecorded).ok()?;
        // processor time: what others do on the machine meanwhile is not its speed
        let elapsed_s = processor_time_s() - started_s;
        let Ending::Finished(report) = ending else {
            return None;
        };
        Some(*report.work.get("bond_evaluations")? as f64 / elapsed_s)
    };
    let best = (0..RUNS).filter_map(speed).max_by(f64::total_cmp)?;
    (best.is_finite() && best > 0.0).then_some(Calibration {
        bond_evaluations_per_s: best,
    })
}
