//! A unit cell as a job.
//!
//! Each repeat places its fibres, is brought to equilibrium on three grids ([`conduct`]), and is read
//! off ([`results`]); [`files`] and [`report`] write. Repeats are tests side by side
//! ([`loadframe_harness::plan`]), their results joined.
mod conduct;
mod files;
mod report;
mod results;

use loadframe_api::Report;
use loadframe_api::spec::composite_cell::CompositeCell;
use loadframe_harness::{
    Ending, Interrupt, Recorder, RunContext, SimulationError,
    checkpoint::Fingerprint,
    plan::{Conclusion, Plan, SavedReport, Share, Tests, join_repeats, write_repeats},
};

/// Runs the simulation of `spec`.
///
/// # Errors
/// What made a result impossible, see [`SimulationError`].
pub fn run(
    spec: &CompositeCell,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Ending, SimulationError> {
    let ending = if spec.repeats > 1 {
        run_all(spec, context, recorder)?
    } else {
        run_one(spec, context, recorder)?
    };
    if let Ending::Finished(report) = &ending {
        files::write_material(report, recorder)?;
        recorder.progress(1.0, "finished");
    }
    Ok(ending)
}

fn run_all(
    spec: &CompositeCell,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Ending, SimulationError> {
    let fingerprint = Fingerprint::of(spec)?;
    let count = spec.repeats as usize;
    let plan = match context.checkpoint {
        Some(bytes) => Plan::resume(fingerprint, bytes, recorder)?,
        None => {
            let last = spec.seed + u64::from(spec.repeats - 1);
            recorder.log(&format!("{count} cells, seeds {} to {last}", spec.seed));
            Plan::new(fingerprint, count)
        }
    };
    let saved = match plan.carry_out(&Repeats(spec), context, recorder)? {
        Conclusion::Finished(saved) => saved,
        Conclusion::Interrupted(Interrupt::Cancel) => return Ok(Ending::Cancelled),
        Conclusion::Interrupted(Interrupt::Suspend) => return Ok(Ending::Suspended),
    };
    let reports = saved.iter().map(SavedReport::read);
    let reports: Vec<Report> = reports.collect::<Result<_, _>>()?;
    write_repeats(spec.seed, &reports, recorder)?;
    Ok(Ending::Finished(join_repeats(spec.seed, &reports)))
}

fn run_one(
    spec: &CompositeCell,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Ending, SimulationError> {
    let tested = match conduct::conduct(spec, context, recorder)? {
        Conclusion::Finished(tested) => tested,
        Conclusion::Interrupted(Interrupt::Cancel) => return Ok(Ending::Cancelled),
        Conclusion::Interrupted(Interrupt::Suspend) => return Ok(Ending::Suspended),
    };
    files::write(spec, &tested, recorder)?;
    Ok(Ending::Finished(report::report(spec, &tested)?))
}

/// The cells of a spec, one for each seed.
struct Repeats<'a>(&'a CompositeCell);

impl Tests for Repeats<'_> {
    type Result = SavedReport;

    fn share(&self, test: usize) -> Share {
        if test == 0 {
            Share::All
        } else {
            Share::Nothing
        }
    }

    fn run(
        &self,
        test: usize,
        context: RunContext<'_>,
        recorder: &mut dyn Recorder,
    ) -> Result<Conclusion<SavedReport>, SimulationError> {
        let mut own = self.0.clone();
        own.repeats = 1;
        own.seed += test as u64;
        Ok(match run_one(&own, context, recorder)? {
            Ending::Finished(report) => Conclusion::Finished(SavedReport::of(&report)?),
            Ending::Cancelled => Conclusion::Interrupted(Interrupt::Cancel),
            Ending::Suspended => Conclusion::Interrupted(Interrupt::Suspend),
        })
    }
}
