//! The rest of a section under its load, by any of the solvers.
use std::cell::Cell;
use std::ops::ControlFlow;

use loadframe_api::spec::composite_bending::{MOTION_RESIDUAL, Solver};
use loadframe_harness::{InterruptSource, RunContext};

use super::model::Model;
use super::progress::{Progress, RestState};
use super::results;
use super::tested::Tested;
use super::watch::{Halt, Watch, share};
use crate::lattice::Geometry;
use crate::motion::{Damping, Motion, MotionOptions, Rest, Scheme};
use crate::solve::{Equilibrium, LoadPath, StaticOptions, is_stable};

pub(super) fn conduct(
    model: &Model<'_>,
    progress: Option<Progress>,
    context: RunContext<'_>,
    watch: &mut dyn Watch,
) -> Result<Tested, Halt> {
    let state = match progress {
        Some(Progress::Rest(state)) => Some(state),
        _ => None,
    };
    let is_new = state.is_none();
    watch.columns(model.spec.columns())?;
    if is_new {
        watch.point(&[0.0; 6])?;
    }
    match model.spec.accuracy.knobs().solver {
        Solver::Static => by_equations(model, state, context.interrupt, watch),
        Solver::Verlet => by_motion(model, Scheme::Verlet, state, context, watch),
        Solver::Pbd => {
            let iterations = model.spec.accuracy.knobs().iterations;
            by_motion(model, Scheme::Pbd { iterations }, state, context, watch)
        }
        Solver::Xpbd => {
            let iterations = model.spec.accuracy.knobs().iterations;
            by_motion(model, Scheme::Xpbd { iterations }, state, context, watch)
        }
    }
}

fn by_equations(
    model: &Model<'_>,
    state: Option<RestState>,
    interrupt: &dyn InterruptSource,
    watch: &mut dyn Watch,
) -> Result<Tested, Halt> {
    let knobs = model.spec.accuracy.knobs();
    let standard = StaticOptions::default();
    let options = StaticOptions {
        geometry: model.geometry(),
        load_steps: knobs.load_steps,
        tolerance: knobs.residual.unwrap_or(standard.tolerance),
        ..standard
    };
    let asked = Cell::new(None);
    let stop = || {
        asked.set(interrupt.interrupt());
        asked.get().is_some()
    };
    let (lattice, supports) = (&model.lattice, &model.supports);
    let mut path = LoadPath::new(lattice, supports, &model.load, &options, &stop)?;
    if let Some(RestState::Path(state)) = state {
        path.resume(state)?;
    }
    while path.share() < 1.0 {
        let advanced = path.advance();
        if let Some(interrupt) = asked.take() {
            let mut state = || Progress::Rest(RestState::Path(path.state()));
            return Err(watch.halt(interrupt, &mut state));
        }
        advanced?;
        if options.geometry == Geometry::Large {
            let equilibrium = path.equilibrium();
            watch.point(&results::point(model, &equilibrium, path.share()))?;
            let mut state = || Progress::Rest(RestState::Path(path.state()));
            watch.look(path.share(), &mut state)?;
        }
    }
    let equilibrium = path.equilibrium();
    if options.geometry == Geometry::Linear {
        // everything grows with the load, the energy with its square
        for step in 1..=knobs.load_steps {
            let share = f64::from(step) / f64::from(knobs.load_steps);
            let [deflection, force, _, top, bottom, energy] =
                results::point(model, &equilibrium, 1.0);
            watch.point(&[
                share * deflection,
                share * force,
                share,
                share * top,
                share * bottom,
                share * share * energy,
            ])?;
        }
    }
    Ok(Tested::at_rest(equilibrium).unstable(path.unstable()))
}

/// The whole load, where its rest in large displacements is not stable.
pub(super) fn unstable(model: &Model<'_>, rest: &Equilibrium) -> Result<Option<f64>, Halt> {
    let u = &rest.displacements_mm;
    let is_sure =
        model.geometry() == Geometry::Linear || is_stable(&model.lattice, &model.supports, u)?;
    Ok((!is_sure).then_some(1.0))
}

fn by_motion(
    model: &Model<'_>,
    scheme: Scheme,
    state: Option<RestState>,
    context: RunContext<'_>,
    watch: &mut dyn Watch,
) -> Result<Tested, Halt> {
    let knobs = model.spec.accuracy.knobs();
    let options = MotionOptions {
        scheme,
        geometry: model.geometry(),
        time_step_s: knobs.time_step_s,
        damping: match (knobs.damping_per_s, scheme) {
            (Some(per_s), _) => Damping::Viscous { per_s },
            (None, Scheme::Verlet) => Damping::Critical,
            (None, Scheme::Pbd { .. } | Scheme::Xpbd { .. }) => Damping::Kinetic,
        },
    };
    let mut motion = Motion::new(&model.lattice, &model.supports, &model.load, options)?;
    share(&mut motion, context)?;
    if let Some(RestState::Motion(state)) = state {
        motion.resume(state)?;
    }
    let until = Rest {
        residual: knobs.residual.unwrap_or(MOTION_RESIDUAL),
        most_steps: knobs.step_limit,
    };
    let mut halt = None;
    let outcome = motion.settle_watched(until, &mut |motion, residual| {
        // the residual falls by powers of ten
        let fraction = residual.log10() / until.residual.log10();
        let mut state = || Progress::Rest(RestState::Motion(motion.state()));
        match watch.look(fraction.clamp(0.0, 1.0), &mut state) {
            Ok(()) => ControlFlow::Continue(()),
            Err(reason) => {
                halt = Some(reason);
                ControlFlow::Break(())
            }
        }
    });
    if let Some(halt) = halt {
        return Err(halt);
    }
    let equilibrium = outcome?;
    watch.point(&results::point(model, &equilibrium, 1.0))?;
    let unstable = unstable(model, &equilibrium)?;
    Ok(Tested::at_rest(equilibrium).unstable(unstable))
}
