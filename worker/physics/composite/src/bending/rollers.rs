//! Bending on rollers, step by step.
use loadframe_api::spec::composite_bending as spec;

use super::model::{Model, drive};
use super::progress::{Progress, RollersState};
use super::tested::Tested;
use super::watch::{Halt, Watch};
use crate::flexure::{Drive, Flexure, FlexureResult};
use crate::lattice::Geometry;
use crate::solve::StaticOptions;

pub(super) fn conduct(
    model: &Model<'_>,
    flexure: Flexure,
    given: &spec::Flexure,
    progress: Option<Progress>,
    watch: &mut dyn Watch,
) -> Result<Tested, Halt> {
    let knobs = model.spec.accuracy.knobs();
    let standard = StaticOptions::default();
    let options = StaticOptions {
        geometry: model.geometry(),
        tolerance: knobs.residual.unwrap_or(standard.tolerance),
        ..standard
    };
    watch.columns(model.spec.columns())?;
    let state = match progress {
        Some(Progress::Rollers(state)) => state,
        _ => {
            watch.point(&[0.0; 6])?;
            RollersState::default()
        }
    };
    let steps = knobs.load_steps;
    let share = |step: u32| f64::from(step) / f64::from(steps);
    let done = state.done;
    if options.geometry == Geometry::Large {
        let (supports, still) = flexure.kept(&model.section, &model.lattice)?;
        let (section, lattice) = (&model.section, &model.lattice);
        let mut rolling = flexure.rolling(section, lattice, &supports, &still, &options)?;
        if let Some(state) = state.rolling {
            rolling.resume(state)?;
        }
        let mut unstable = state.unstable;
        for step in done + 1..=steps {
            match drive(given, share(step)) {
                Drive::Force(force_n) => rolling.press_to(force_n)?,
                Drive::Advance(way) => rolling.advance_to(way)?,
            }
            let contact = rolling.equilibrium()?;
            let found = flexure.read(section, lattice, Geometry::Large, contact)?;
            watch.point(&point(&found, share(step)))?;
            if !rolling.is_stable()? {
                unstable.get_or_insert(share(step));
            }
            if step == steps {
                return Ok(Tested::bent(found).unstable(unstable));
            }
            watch.look(share(step), &mut || {
                Progress::Rollers(RollersState {
                    done: step,
                    rolling: Some(rolling.state()),
                    unstable,
                })
            })?;
        }
    }
    let at = |step: u32| {
        let drive = drive(given, share(step));
        let found = flexure.bend(&model.section, &model.lattice, drive, &options)?;
        Ok::<FlexureResult, Halt>(found)
    };
    for step in done + 1..steps {
        let found = at(step)?;
        watch.point(&point(&found, share(step)))?;
        watch.look(share(step), &mut || {
            Progress::Rollers(RollersState {
                done: step,
                rolling: None,
                unstable: None,
            })
        })?;
    }
    let found = at(steps)?;
    watch.point(&point(&found, share(steps)))?;
    Ok(Tested::bent(found))
}

fn point(found: &FlexureResult, share: f64) -> [f64; 6] {
    [
        found.midspan_deflection_mm,
        found.force_n,
        share,
        found.roller_deflection_mm,
        found.outer_strain,
        found.outer_stress_mpa,
    ]
}
