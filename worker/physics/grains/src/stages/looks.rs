//! Looks at a scene: what is recorded of it, and what tells whether to believe it.
use loadframe_api::spec::granular_scene::{Stage, TimeStep};
use loadframe_harness::{Recorder, SimulationError};

use super::{runner::Runner, stepping::MOST_HALVINGS};
use crate::{
    observe::{contact::put_in_order, survey::Survey, time_step::Critical},
    output::{
        breaks,
        fragments::FragmentRow,
        journal::{ServoError, Worst},
        snapshot, tables,
    },
};

/// Created energy over the scale beyond which a run is not worth going on with.
const RUNAWAY: f64 = 0.5;

impl Runner<'_> {
    /// Chooses the first time step and records the state before it.
    pub(super) fn begin(&mut self, recorder: &mut dyn Recorder) -> Result<(), SimulationError> {
        self.engine.push_still();
        let survey = self.engine.survey(true);
        let critical = survey.critical;
        self.journal.time_step = match self.spec.time_step_s {
            TimeStep::Given(step) => {
                self.journal.time_step = step;
                self.check_critical(critical)?;
                step
            }
            TimeStep::Automatic(_) => {
                self.journal.look_halvings = MOST_HALVINGS;
                self.automatic_step(critical)
            }
        };
        let state = &self.engine.state;
        recorder.log(&format!(
            "{} bodies ({} spheres), {} contacts, time step {:.3e} s",
            self.engine.present_bodies().count(),
            state.particles.len(),
            survey.contacts.len(),
            self.journal.time_step
        ));
        self.show(survey, recorder)
    }

    /// Whether a given step is beyond what the contacts of a body together allow.
    fn check_critical(&self, critical: Option<Critical>) -> Result<(), SimulationError> {
        match critical {
            Some(critical)
                if !self.has_automatic_step()
                    && !self.spec.allow_unstable
                    && self.journal.time_step > critical.step =>
            {
                Err(self.unstable(critical.step, [critical.body, critical.partner]))
            }
            _ => Ok(()),
        }
    }

    /// Reads off and records a scene between two steps, after something was done to it.
    pub(crate) fn observe_still(
        &mut self,
        recorder: &mut dyn Recorder,
    ) -> Result<(), SimulationError> {
        self.engine.push_still();
        let survey = self.engine.survey(true);
        if self.has_automatic_step() {
            self.journal.time_step = self.automatic_step(survey.critical);
        }
        self.show(survey, recorder)
    }

    fn show(
        &mut self,
        mut survey: Survey,
        recorder: &mut dyn Recorder,
    ) -> Result<(), SimulationError> {
        let journal = &mut self.journal;
        journal.worst.see_step(journal.time_step, survey.critical);
        journal.last = (self.engine).reading(&survey.sums, &self.engine.body_sums());
        self.record(recorder, &mut survey)?;
        if self.spec.record.snapshot_every_steps > 0 {
            self.picture(recorder, &mut survey)?;
        }
        Ok(())
    }

    pub(super) fn picture(
        &mut self,
        recorder: &mut dyn Recorder,
        survey: &mut Survey,
    ) -> Result<(), SimulationError> {
        put_in_order(&mut survey.contacts);
        let state = &self.engine.state;
        snapshot::take(&self.engine, &survey.contacts, recorder)?;
        let entry = (state.step, state.time);
        // after bodies were taken out, the picture of the same step is taken again
        if self.journal.snapshots.last() != Some(&entry) {
            self.journal.snapshots.push(entry);
        }
        Ok(())
    }

    /// Keeps what an observation says about the quality of the run.
    /// `work` is that of the walls until the middle of the step [J], where energies are known.
    pub(super) fn judge(&mut self, survey: &Survey, work: f64) -> Result<(), SimulationError> {
        self.check_finite()?;
        let journal = &mut self.journal;
        let largest = survey.sums.overlap_ratio;
        journal.worst.see_step(journal.time_step, survey.critical);
        if let Some(Stage::Settle(settle)) = self.spec.stages.get(journal.stage) {
            let bound = settle.unbalanced_force_ratio;
            let plates = self.engine.unrest_of_plates(&survey.plates);
            let bodies = match (journal.last.unbalanced, journal.last.bodies, plates) {
                (Some(ratio), ..) => ratio <= bound,
                // nothing but plates moves
                (None, 0, Some(_)) => true,
                (None, ..) => false,
            };
            journal.is_settled = bodies && plates.is_none_or(|ratio| ratio <= bound);
        }
        let stage = self.spec.stages.get(journal.stage);
        if let Some(Stage::Relax(relax)) = stage {
            journal.is_settled = largest <= relax.largest_overlap_ratio;
            // what is relaxed is not yet the scene that is asked about
            journal.balance.pause();
            return Ok(());
        }
        if self.spec.stop_when_pushed_through
            && let Some((body, plane)) = self.engine.first_behind_plane()
        {
            return Err(SimulationError::PushedThrough {
                body,
                plane: self.engine.model.planes[plane].name.clone(),
                step: self.engine.state.step,
            });
        }
        journal.worst = journal.worst.with(&self.engine.state.seen);
        self.note_worst();
        self.check_critical(survey.critical)?;
        let journal = &mut self.journal;
        if stage.is_some_and(Stage::is_quasi_static) {
            let scene = self.engine.cuboid([None; 2]);
            let scene = self
                .engine
                .measure(&scene, None, &self.engine.points(), &survey.contacts);
            journal.driving.add(&scene, journal.last.unbalanced);
        }
        if self.engine.model.has_driven_bodies {
            return Ok(());
        }
        if let Some(Stage::Vibrate(_) | Stage::Stiffen(_)) = stage {
            // shaking and stiffening give energy that is not measured
            journal.balance.pause();
            return Ok(());
        }
        journal
            .balance
            .add(&journal.last, work, self.engine.state.step);
        let created = journal.balance.created_ratio();
        if created > RUNAWAY && !self.spec.allow_unstable {
            return Err(SimulationError::EnergyGrowth {
                step: self.engine.state.step,
                created_j: journal.balance.created,
                step_ratio: journal.worst.step_ratio,
            });
        }
        Ok(())
    }

    /// Keeps how far servos were from their forces; to be called as a stage ends.
    pub(super) fn note_servos(&mut self) {
        for (wall, face) in self.engine.state.faces.iter().enumerate() {
            let Some(servo) = face.motion.servo.filter(|servo| servo.force > 0.0) else {
                continue;
            };
            let error = servo.pressing(&self.engine.wall_force(wall)) - servo.force;
            let ratio = error.abs() / servo.force;
            if self.journal.servo.is_none_or(|worst| ratio > worst.ratio) {
                let stage = self.journal.stage;
                self.journal.servo = Some(ServoError { ratio, stage, wall });
            }
        }
    }

    /// Keeps in which stage what was worst so far.
    pub(super) fn note_worst(&mut self) {
        let journal = &mut self.journal;
        let before = journal.noted;
        let now = journal.worst.with(&self.engine.state.seen);
        let figures = |worst: &Worst| [worst.overlap_ratio, worst.step_ratio];
        for (of, (now, before)) in figures(&now).into_iter().zip(figures(&before)).enumerate() {
            if now > before {
                journal.worst_stages[of] = journal.stage;
            }
        }
        journal.noted = now;
    }

    /// Adds the rows of this moment. The curve's is summed before contacts that are to be listed are put
    /// in order, so that no bit of it depends on what else is recorded.
    pub(super) fn record(
        &mut self,
        recorder: &mut dyn Recorder,
        survey: &mut Survey,
    ) -> Result<(), SimulationError> {
        let contacts = &mut survey.contacts;
        let ratio = survey
            .critical
            .map_or(0.0, |critical| self.journal.time_step / critical.step);
        let row = tables::curve_row(self.spec, &self.engine, &self.journal, contacts, ratio);
        recorder.point(&row)?;
        self.journal.curve.extend(row);
        self.engine
            .body_rows(&self.recorded, &mut self.journal.bodies);
        self.record_fragments();
        let step = self.engine.state.step;
        if self.spec.record.contacts && step > 0 {
            put_in_order(contacts);
            let has_moments = self.spec.has_moments();
            tables::contact_rows(step, contacts, has_moments, &mut self.journal.contacts);
        }
        Ok(())
    }

    /// Adds a row on the breakable grains of the scene, if it has any, and the bonds that broke.
    fn record_fragments(&mut self) {
        if !self.engine.model.grains.is_empty() {
            let bonds = self.engine.bonded_bodies();
            let row = FragmentRow::new(&self.engine, self.journal.stage, &bonds);
            self.journal.fragments.push(row);
            breaks::add_rows(&self.engine, &mut self.journal, bonds);
        }
    }
}
