//! What a test takes: that of its scene, with the times that beds need to settle.
use super::{
    super::granular_scene::{Settle, Stage},
    Apparatus, Ballast,
};
use crate::{Calibration, Estimate, kinds::Spec as _};

/// Time in which a layer comes to rest when it has fallen or was shaken [s]: as measured.
const ROLLING_S: f64 = 0.4;
/// The same after the moduli grew, in steps.
const ROLLING_STEPS: u64 = 5_000;

pub(super) fn estimate<A: Apparatus>(spec: &Ballast<A>, calibration: &Calibration) -> Estimate {
    let script = spec.script();
    let mut scene = script.scene;
    let longest = spec.preparation.longest_settling_s;
    for stage in &mut scene.stages {
        if let Stage::Settle(Settle { time_s, steps, .. }) = stage {
            *time_s = time_s.map(|_| ROLLING_S.min(longest));
            *steps = steps.map(|steps| steps.min(ROLLING_STEPS));
        }
    }
    scene.estimate(calibration)
}
