//! Motion in time: a load that comes or goes at once, or an impact.
use loadframe_api::spec::composite_bending::{History, HistoryLoad};
use loadframe_harness::RunContext;

use super::model::Model;
use super::progress::{HistoryState, Progress};
use super::rest::unstable;
use super::swing::Swing;
use super::tested::Tested;
use super::watch::{Halt, Watch, share};
use crate::measure::face_mean_mm;
use crate::motion::{Damping, Motion, MotionOptions, Scheme};
use crate::solve::{StaticOptions, equilibrium};
use crate::supports::Face;

/// Steps between two looks at whether to go on.
const LOOK: u64 = 50;

pub(super) fn conduct(
    model: &Model<'_>,
    history: &History,
    progress: Option<Progress>,
    context: RunContext<'_>,
    watch: &mut dyn Watch,
) -> Result<Tested, Halt> {
    let knobs = model.spec.accuracy.knobs();
    let grid = model.lattice.grid();
    let options = MotionOptions {
        scheme: Scheme::Verlet,
        geometry: model.geometry(),
        time_step_s: knobs.time_step_s,
        damping: knobs
            .damping_per_s
            .map_or(Damping::None, |per_s| Damping::Viscous { per_s }),
    };
    let mut motion = Motion::new(&model.lattice, &model.supports, &model.load, options)?;
    share(&mut motion, context)?;
    let deflection = |u: &[f64], face: Face| {
        let mean = face_mean_mm(grid, face, u);
        mean[0] * model.direction[0] + mean[1] * model.direction[1]
    };
    // the rest under the load is the middle about which a section under it swings
    let at_rest = {
        let options = StaticOptions {
            geometry: model.geometry(),
            ..StaticOptions::default()
        };
        equilibrium(&model.lattice, &model.supports, &model.load, &options)?
    };
    let middle = match history.load {
        HistoryLoad::Sudden => deflection(&at_rest.displacements_mm, Face::Top),
        HistoryLoad::Released => 0.0,
    };
    watch.columns(model.spec.columns())?;
    let mut swing = Swing::default();
    let mut written = 0;
    if let Some(Progress::History(state)) = progress {
        motion.resume(state.motion)?;
        swing = state.swing;
        written = state.written;
    } else {
        if history.load == HistoryLoad::Released {
            motion.displace(&at_rest.displacements_mm);
        }
        motion.push(history.velocity_mm_per_s);
    }
    if history.load == HistoryLoad::Released {
        motion.release();
    }
    let intervals = f64::from(history.points.max(2) - 1);
    let steps = (history.duration_s / motion.time_step_s()).ceil().max(1.0) as u64;
    loop {
        let time_s = motion.time_s();
        let top = deflection(motion.displacements_mm(), Face::Top);
        swing.see(time_s, top, middle);
        let due = (f64::from(written) * steps as f64 / intervals).round() as u64;
        if motion.steps() >= due {
            let kinetic = motion.kinetic_energy_n_mm();
            let elastic = motion.elastic_energy_n_mm();
            let bottom = deflection(motion.displacements_mm(), Face::Bottom);
            watch.point(&[time_s, top, bottom, kinetic, elastic])?;
            written += 1;
        }
        if motion.steps() >= steps {
            break;
        }
        motion.advance()?;
        if motion.steps().is_multiple_of(LOOK) {
            let fraction = motion.steps() as f64 / steps as f64;
            let mut state = || {
                Progress::History(HistoryState {
                    motion: motion.state(),
                    swing: swing.clone(),
                    written,
                })
            };
            watch.look(fraction, &mut state)?;
        }
    }
    let unstable = unstable(model, &at_rest)?;
    Ok(Tested::in_time(at_rest, &motion, swing).unstable(unstable))
}
