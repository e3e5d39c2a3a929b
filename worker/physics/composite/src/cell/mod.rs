//! A unit cell as a job.
//!
//! Each repeat places its fibres, is brought to equilibrium on three grids ([`conduct`]), and is read
//! off ([`results`]); [`files`] and [`report`] write. Repeats are tests side by side
//! ([`loadframe_harness::plan`]), their results joined.
mod conduct;
mod files;
mod report;
mod results;

use loadframe_api::spec::composite_cell::CompositeCell;
use loadframe_harness::{
    Ending, Halt, Recorder, RunContext, SimulationError,
    checkpoint::Fingerprint,
    plan::{Conclusion, Place, Specimens, first_of, test_specimens},
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
        test_specimens(&Repeats(spec), Fingerprint::of(spec)?, context, recorder)?
    } else {
        run_one(spec, context, recorder)?
    };
    if let Ending::Finished(report) = &ending {
        files::write_material(report, recorder)?;
        recorder.progress(1.0, "finished");
    }
    Ok(ending)
}

/// Draws the first cell of `spec`; returns what is shown.
///
/// # Errors
/// When there is no such cell, or the recorder fails; a cancel.
pub fn preview(
    spec: &CompositeCell,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<String, Halt> {
    let cell = conduct::unit_cell(spec, context.interrupt)?;
    context.interrupt.heed()?;
    let grid = spec.cells().map(|count| count as usize);
    let drawn = files::Drawn {
        grid,
        pixel_mm: [0, 1].map(|axis| cell.size_mm[axis] / grid[axis] as f64),
        shares: &cell.fibre_shares(grid)?,
        stresses: None,
    };
    files::draw(&drawn, recorder)?;
    let words = "The unit cell on its grid, seen along the fibres.";
    Ok(first_of(words, spec.repeats))
}

fn run_one(
    spec: &CompositeCell,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Ending, SimulationError> {
    let tested = match conduct::conduct(spec, context, recorder)? {
        Conclusion::Finished(tested) => tested,
        Conclusion::Interrupted(interrupt) => return Ok(interrupt.into()),
    };
    files::write(spec, &tested, recorder)?;
    Ok(Ending::Finished(report::report(spec, &tested)?))
}

/// The cells of a spec, one for each seed.
struct Repeats<'a>(&'a CompositeCell);

impl Specimens for Repeats<'_> {
    fn count(&self) -> usize {
        self.0.repeats as usize
    }

    fn first_seed(&self) -> u64 {
        self.0.seed
    }

    fn overview(&self) -> String {
        let (seed, count) = (self.0.seed, self.0.repeats);
        let last = seed + u64::from(count - 1);
        format!("{count} cells, seeds {seed} to {last}")
    }

    fn test(
        &self,
        place: Place,
        context: RunContext<'_>,
        recorder: &mut dyn Recorder,
    ) -> Result<Ending, SimulationError> {
        let mut own = self.0.clone();
        own.repeats = 1;
        own.seed += place.specimen as u64;
        run_one(&own, context, recorder)
    }
}
