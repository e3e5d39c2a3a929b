//! What a test takes: that of its scene, with the times that beds need to settle.
use super::{
    super::granular_scene::{Settle, Stage},
    Apparatus, Ballast, Course, Phase,
};
use crate::{Calibration, Estimate, spec_trait::Spec as _};

/// Time in which a layer comes to rest when it was shaken or cut [s]: as measured.
const SHAKEN_S: f64 = 0.1;
/// The same after the moduli grew, in steps.
const ROLLING_STEPS: u64 = 5_000;

pub(super) fn estimate<A: Apparatus>(spec: &Ballast<A>, calibration: &Calibration) -> Estimate {
    let script = spec.script();
    let mut scene = script.scene;
    let before = [Phase::Pour].into_iter().chain(script.phases);
    let blocks = spec.blocks();
    for (number, load) in &script.loads {
        // a machine turns when it has come to its force
        if let (Some(Stage::Drive(drive)), false) = (
            scene.stages.get_mut(*number),
            matches!(load.course, Course::Swing { .. }),
        ) {
            let likely = 0.5 * blocks[load.block].cycle_time();
            drive.time_s = drive.time_s.map(|longest| longest.min(likely));
        }
    }
    for (stage, before) in scene.stages.iter_mut().zip(before) {
        if let Stage::Settle(Settle { time_s, steps, .. }) = stage {
            if before != Phase::Pour {
                *time_s = time_s.map(|longest| longest.min(SHAKEN_S));
            }
            *steps = steps.map(|steps| steps.min(ROLLING_STEPS));
        }
    }
    scene.estimate(calibration).of_repeats(spec.repeats)
}
