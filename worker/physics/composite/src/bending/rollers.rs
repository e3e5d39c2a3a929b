//! Bending on rollers, step by step.
use loadframe_api::spec::composite_bending as spec;

use super::model::{Model, drive};
use super::results::Tested;
use super::{Halt, Progress, Watch};
use crate::flexure::{Flexure, FlexureResult};
use crate::solve::StaticOptions;

pub(super) fn conduct(
    model: &Model<'_>,
    flexure: Flexure,
    given: &spec::Flexure,
    progress: Option<Progress>,
    watch: &mut dyn Watch,
) -> Result<Tested, Halt> {
    let options = StaticOptions::default();
    let knobs = model.spec.accuracy.knobs();
    watch.columns(model.spec.columns())?;
    let done = match progress {
        Some(Progress::Rollers(done)) => done,
        _ => {
            watch.point(&[0.0; 6])?;
            0
        }
    };
    let steps = knobs.load_steps;
    let at = |step: u32| {
        let share = f64::from(step) / f64::from(steps);
        let drive = drive(given, share);
        let found = flexure.bend(&model.section, &model.lattice, drive, &options)?;
        Ok::<(f64, FlexureResult), Halt>((share, found))
    };
    for step in done + 1..steps {
        let (share, found) = at(step)?;
        watch.point(&point(&found, share))?;
        let fraction = f64::from(step) / f64::from(steps);
        watch.look(fraction, &mut || Progress::Rollers(step))?;
    }
    let (share, found) = at(steps)?;
    watch.point(&point(&found, share))?;
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
