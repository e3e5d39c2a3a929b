//! A job whose test is done to several specimens, each in one direction or in two.
//!
//! A kind says by [`Specimens`] what they are and how one is tested; what is done with them is the same
//! for all kinds: a [`Plan`] of the tests, the first shown as the job's own, the results joined.
use std::io;

use loadframe_api::Report;
use serde::{Deserialize, Serialize};

use super::directions::{Compared, join, suffix};
use super::{
    Conclusion, Curve, CurveKeeper, Plan, SavedReport, Share, Tests, add_sampling_errors,
    join_repeats, write_repeats,
};
use crate::{
    Ending, Interrupt, Recorder, RunContext, SimulationError, checkpoint::Fingerprint, csv,
};

/// The specimens of a job, whose seeds count on from the first.
pub trait Specimens: Sync {
    /// Their number.
    fn count(&self) -> usize;

    /// Seed of the first.
    fn first_seed(&self) -> u64;

    /// Names of the directions in which each is tested: none, one or two.
    fn directions(&self) -> Vec<&'static str> {
        Vec::new()
    }

    /// Results that are compared between two directions.
    fn compared(&self) -> &'static [Compared] {
        &[]
    }

    /// Leading columns of the curve that are kept of every test.
    fn kept_columns(&self) -> usize {
        0
    }

    /// Whether a mean of which no other error is known has that of its scatter; for kinds whose guide says
    /// what else was not looked at.
    fn has_sampling_errors(&self) -> bool {
        false
    }

    /// What is going to be done, for the log.
    fn overview(&self) -> String;

    /// A line on a finished test, for the log.
    fn line(&self, _place: Place, _report: &Report) -> Option<String> {
        None
    }

    /// Tests a specimen in one of its directions.
    ///
    /// # Errors
    /// What made a result impossible.
    fn test(
        &self,
        place: Place,
        context: RunContext<'_>,
        recorder: &mut dyn Recorder,
    ) -> Result<Ending, SimulationError>;
}

/// A test among those of a job; both counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    pub specimen: usize,
    pub direction: usize,
}

/// What a picture of a specimen shows, where it is the first of so many.
pub fn first_of(words: &str, specimens: u32) -> String {
    match specimens {
        0 | 1 => words.to_owned(),
        _ => format!("{words} It is the first of {specimens} specimens."),
    }
}

/// Tests all specimens of a job side by side.
///
/// # Errors
/// What made a result impossible, see [`SimulationError`].
pub fn test_specimens(
    specimens: &impl Specimens,
    job: Fingerprint,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Ending, SimulationError> {
    let directions = specimens.directions();
    let each = directions.len().max(1);
    let plan = match context.checkpoint {
        Some(bytes) => Plan::resume(job, bytes, recorder)?,
        None => {
            recorder.log(&specimens.overview());
            Plan::new(job, specimens.count() * each)
        }
    };
    let all = All {
        specimens,
        directions: &directions,
    };
    let finished = match plan.carry_out(&all, context, recorder)? {
        Conclusion::Finished(finished) => finished,
        Conclusion::Interrupted(interrupt) => return Ok(interrupt.into()),
    };
    let reports = finished.iter().map(|test| test.report.read());
    let reports: Vec<Report> = reports.collect::<Result<_, _>>()?;
    for (test, report) in reports.iter().enumerate() {
        if let Some(line) = specimens.line(all.place(test), report) {
            recorder.log(&line);
        }
    }
    let joint: Vec<Report> = reports
        .chunks(each)
        .map(|reports| join(&directions, specimens.compared(), reports))
        .collect();
    let report = match joint.as_slice() {
        [report] => report.clone(),
        joint => {
            write_repeats(specimens.first_seed(), joint, recorder)?;
            for first in 0..each {
                let name = all.share(first).name("repeats_curves.csv");
                let tests = finished.iter().skip(first).step_by(each);
                write_curves(&name, tests.map(|test| &test.curve), recorder)?;
            }
            let mut joint = join_repeats(specimens.first_seed(), joint);
            if specimens.has_sampling_errors() {
                add_sampling_errors(&mut joint);
            }
            joint
        }
    };
    recorder.progress(1.0, "finished");
    Ok(Ending::Finished(report))
}

/// The curves of all specimens in one direction, if any were kept.
fn write_curves<'a>(
    name: &str,
    curves: impl Iterator<Item = &'a Curve> + Clone,
    recorder: &mut dyn Recorder,
) -> io::Result<()> {
    let Some(first) = curves.clone().find(|curve| !curve.columns.is_empty()) else {
        return Ok(());
    };
    let kept = first.columns.iter().map(String::as_str);
    let columns: Vec<&str> = std::iter::once("repeat").chain(kept).collect();
    recorder.file(name, &mut |out| {
        csv::header(out, &columns)?;
        for (index, curve) in curves.clone().enumerate() {
            for point in curve.rows() {
                let mut row = vec![(index + 1) as f64];
                row.extend(point);
                csv::row(out, &row)?;
            }
        }
        Ok(())
    })
}

/// What is kept of a finished test.
#[derive(Debug, Serialize, Deserialize)]
struct Finished {
    report: SavedReport,
    curve: Curve,
}

/// The tests of all specimens: the directions of the first, then those of the second, ...
struct All<'a, S> {
    specimens: &'a S,
    directions: &'a [&'static str],
}

impl<S> All<'_, S> {
    fn place(&self, test: usize) -> Place {
        let each = self.directions.len().max(1);
        Place {
            specimen: test / each,
            direction: test % each,
        }
    }
}

impl<S: Specimens> Tests for All<'_, S> {
    type Result = Finished;

    /// The first specimen is shown, its first direction as the job's own.
    fn share(&self, test: usize) -> Share {
        let place = self.place(test);
        match (place.specimen, self.directions.get(place.direction)) {
            _ if test == 0 => Share::All,
            (0, Some(direction)) => Share::Folder(suffix(direction)),
            _ => Share::Nothing,
        }
    }

    fn run(
        &self,
        test: usize,
        context: RunContext<'_>,
        recorder: &mut dyn Recorder,
    ) -> Result<Conclusion<Finished>, SimulationError> {
        let mut keeper = CurveKeeper::new(recorder, self.specimens.kept_columns());
        let ending = self
            .specimens
            .test(self.place(test), context, &mut keeper)?;
        Ok(match ending {
            Ending::Finished(report) => Conclusion::Finished(Finished {
                report: SavedReport::of(&report)?,
                curve: keeper.into_curve(),
            }),
            Ending::Cancelled => Conclusion::Interrupted(Interrupt::Cancel),
            Ending::Suspended => Conclusion::Interrupted(Interrupt::Suspend),
        })
    }
}
