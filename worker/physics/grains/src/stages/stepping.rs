//! One step after the other: which are looked at, and which the threads do among themselves.
use std::sync::Arc;

use loadframe_api::spec::granular_scene::Stage;
use loadframe_harness::{Recorder, SimulationError};

use super::runner::Runner;
use crate::step::alone::Seen;

/// Steps between looks at energies, overlaps and the critical step, beside those recorded.
pub(super) const STEPS_PER_LOOK: u64 = 256;
/// Where from look to look the critical step falls to this part, or contacts grow in number by this
/// factor, looks come four times as often, down to every 16 steps: a bed that lands or is pressed fast
/// would outrun its time step. Otherwise half as often again.
const FALLING: f64 = 0.95;
const GROWING: f64 = 1.05;
pub(super) const MOST_HALVINGS: u32 = 4;
/// Steps between looks for interrupts, where that is so much work [particle steps] at least, some
/// milliseconds, and at most, some hundredths of a second: each calls the threads together anew.
const STEPS_PER_INTERRUPT_LOOK: u64 = 64;
const WORK_PER_INTERRUPT_LOOK: [u64; 2] = [50_000, 1_000_000];
/// Steps between looks for interrupts, at least, as long as they are not more work than some tenths of a
/// second.
const LEAST_STEPS_PER_INTERRUPT_LOOK: u64 = 16;
const MOST_WORK_OF_LEAST_STEPS: u64 = 8_000_000;

/// What a step is looked at for.
#[derive(Clone, Copy, Debug)]
struct Reason {
    /// A row.
    is_recorded: bool,
    /// A snapshot.
    is_pictured: bool,
    is_last: bool,
    /// Whether the ends of stages have rows.
    records_ends: bool,
}

impl Runner<'_> {
    /// Particles that a step moves, and what it costs besides.
    pub(super) fn work_of_step(&self) -> u64 {
        self.engine.state.particles.len() as u64 + 100
    }

    /// Work between looks for interrupts.
    pub(super) fn work_uninterrupted(&self) -> u64 {
        let [least, most] = WORK_PER_INTERRUPT_LOOK;
        let step = self.work_of_step();
        (STEPS_PER_INTERRUPT_LOOK * step)
            .clamp(least, most)
            .max((LEAST_STEPS_PER_INTERRUPT_LOOK * step).min(MOST_WORK_OF_LEAST_STEPS))
            .max(step)
    }

    /// What a stage does to the scene of this moment, and how large a step that allows.
    pub(super) fn prepare_step(&mut self, stage: &Stage) -> Result<(), SimulationError> {
        self.stiffen(stage);
        self.shake(stage);
        self.meet_plates();
        self.drive(stage);
        if self.limit_walls()? {
            // what swings is brought to another place
            self.drive(stage);
        }
        Ok(())
    }

    /// Does steps until the next that is looked at, that a stage may change in more than its drives, or
    /// after which somebody may want to interrupt; the threads are called together once for all of
    /// them. Returns the work done after `work`.
    pub(super) fn steps_unseen(
        &mut self,
        stage: &Stage,
        work: u64,
    ) -> Result<u64, SimulationError> {
        if matches!(stage, Stage::Insert(_) | Stage::Relax(_)) {
            return Ok(0);
        }
        let team = Arc::clone(&self.engine.team);
        team.gather(|| {
            let mut done = 0;
            while !self.is_stage_done(stage)
                && self.reason_to_look().is_none()
                && work + done + self.work_of_step() <= self.work_uninterrupted()
            {
                done += self.work_of_step();
                self.prepare_step(stage)?;
                self.plain_step(stage)?;
            }
            Ok(done)
        })
    }

    /// A step that nobody looks at.
    fn plain_step(&mut self, stage: &Stage) -> Result<(), SimulationError> {
        let seen = self.engine.state.seen;
        self.engine.step(self.next_step(stage));
        self.journal.stage_steps += 1;
        self.end_step(seen)
    }

    /// `seen` is what was before the step.
    fn end_step(&mut self, seen: Seen) -> Result<(), SimulationError> {
        self.journal.candidate_steps += self.engine.candidates();
        if let Some(Stage::Relax(_)) = self.spec.stages.get(self.journal.stage) {
            self.engine.halt();
            // what is relaxed is not yet the scene that is asked about
            self.engine.unsee(seen);
            return Ok(());
        }
        self.check_step()?;
        self.check_speed()
    }

    /// Whether the end of the present stage has a row.
    pub(super) fn records_ends(&self) -> bool {
        let record = &self.spec.record;
        let is_told = self.journal.stage >= record.from_stage;
        !is_told || !self.engine.model.grains.is_empty() || record.stage_ends
    }

    /// What the next step is looked at for, if it is.
    fn reason_to_look(&self) -> Option<Reason> {
        let next = self.engine.state.step + 1;
        let record = &self.spec.record;
        let is_last = self.is_last_step();
        let is_told = self.journal.stage >= record.from_stage;
        let records_ends = self.records_ends();
        let is_end = records_ends && self.ends_stage();
        let reason = Reason {
            is_recorded: is_told && next.is_multiple_of(record.every_steps) || is_last || is_end,
            is_pictured: match record.snapshot_every_steps {
                0 => false,
                every => is_told && next.is_multiple_of(every) || is_last || !is_told && is_end,
            },
            is_last,
            records_ends,
        };
        let is_due = next.is_multiple_of(STEPS_PER_LOOK >> self.journal.look_halvings);
        (reason.is_recorded || reason.is_pictured || is_due).then_some(reason)
    }

    /// Whether a look wants every contact, and not only what they add up to.
    fn needs_contacts(&self, reason: Reason) -> bool {
        let record = &self.spec.record;
        let stage = self.spec.stages.get(self.journal.stage);
        // the look itself may end such a stage, and that is recorded
        let may_end = matches!(stage, Some(Stage::Settle(_) | Stage::Relax(_)));
        let has_pictures = record.snapshot_every_steps > 0;
        let has_rows = record.contacts
            || !record.regions.is_empty()
            || !record.normal_forces.is_empty()
            || !self.engine.model.driven.is_empty();
        stage.is_some_and(Stage::is_quasi_static)
            || reason.is_pictured
            || reason.is_recorded && has_rows
            || may_end && (has_rows || has_pictures)
    }

    pub(super) fn step(
        &mut self,
        stage: &Stage,
        recorder: &mut dyn Recorder,
    ) -> Result<(), SimulationError> {
        let Some(reason) = self.reason_to_look() else {
            return self.plain_step(stage);
        };
        let Reason {
            is_recorded,
            is_pictured,
            is_last,
            records_ends,
        } = reason;
        let time_step = self.next_step(stage);
        let seen = self.engine.state.seen;
        self.engine.push(time_step);
        let mut survey = self.engine.survey(self.needs_contacts(reason));
        let before = self.engine.body_sums();
        let work_before = self.engine.state.wall_work;
        self.engine.advance(time_step);
        self.journal.stage_steps += 1;
        let contacts_before = self.journal.last.contacts;
        self.journal.last = self.engine.reading(&survey.sums, &before);
        let work = 0.5 * (work_before + self.engine.state.wall_work);
        self.judge(&survey, work)?;
        let is_last =
            is_last || (self.journal.is_settled && (self.is_last_stage() || records_ends));
        let is_recorded = is_recorded || is_last;
        let is_pictured = is_pictured || (is_last && self.spec.record.snapshot_every_steps > 0);
        if is_recorded {
            self.record(recorder, &mut survey)?;
        }
        if is_pictured {
            self.picture(recorder, &mut survey)?;
        }
        if self.automatic.is_some() {
            let step = self.automatic_step(survey.critical);
            let journal = &mut self.journal;
            let is_falling = step < FALLING * journal.time_step;
            let is_growing = journal.last.contacts as f64 > GROWING * contacts_before as f64;
            journal.look_halvings = if is_falling || is_growing {
                (journal.look_halvings + 2).min(MOST_HALVINGS)
            } else {
                journal.look_halvings.saturating_sub(1)
            };
            journal.time_step = step;
        }
        self.end_step(seen)
    }
}
