//! What a test takes: that of its scene, with the times that beds need to settle.
use super::{
    super::granular_scene::{Settle, Stage},
    Apparatus, Ballast,
};
use crate::{Calibration, Estimate, kinds::Spec as _};

/// Time in which a poured layer comes to rest, after its fall from this height [s]: the fall, and
/// rebounds and rolling that die away.
const ROLLING_S: f64 = 0.25;

pub(super) fn estimate<A: Apparatus>(spec: &Ballast<A>, calibration: &Calibration) -> Estimate {
    let script = spec.script();
    let mut scene = script.scene;
    let longest = spec.preparation.longest_settling_s;
    for stage in &mut scene.stages {
        if let Stage::Settle(Settle {
            time_s: Some(time), ..
        }) = stage
        {
            *time = ROLLING_S.min(longest);
        }
    }
    scene.estimate(calibration)
}
