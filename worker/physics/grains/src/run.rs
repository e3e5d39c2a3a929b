//! A run: steps, what is observed on the way, until the end of the last of its
//! [`stages`](super::stages).
mod limits;
mod stepping;

use std::{borrow::Cow, collections::BTreeMap, ops::Range};

use loadframe_api::spec::granular_scene::{Body, GranularScene, Stage, TimeStep};
use loadframe_harness::{
    Ending, Interrupt, Recorder, RunContext, SimulationError,
    checkpoint::{self, CheckpointError, Fingerprint},
};
use loadframe_numerics::Team;
use serde::{Deserialize, Serialize, Serializer, ser::Error as _};

use limits::{foreseen, unstable};
use stepping::MOST_HALVINGS;

use super::{
    contact::{law::Chosen, lists::Lists},
    engine::{Engine, State},
    fragments,
    journal::Journal,
    observe::put_in_order,
    report, snapshot,
    specimen::Specimen,
    survey::Survey,
    tables,
};

/// Created energy over the scale beyond which a run is not worth going on with.
const RUNAWAY: f64 = 0.5;

/// A state and the spec it belongs to.
#[derive(Serialize, Deserialize)]
struct Checkpoint {
    spec: Fingerprint,
    journal: Journal,
    state: State,
    /// Those of each patch, packed.
    contact_lists: Vec<Vec<u8>>,
}

/// The same, to be written without a copy.
#[derive(Serialize)]
struct CheckpointOf<'a> {
    spec: Fingerprint,
    journal: &'a Journal,
    state: &'a State,
    contact_lists: Vec<Packed<'a>>,
}

/// Lists that are packed one patch after the other.
struct Packed<'a>(&'a dyn Lists);

impl Serialize for Packed<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let bytes = self.0.pack().map_err(S::Error::custom)?;
        bytes.serialize(serializer)
    }
}

/// What goes through the stages.
pub(super) struct Runner<'a> {
    pub(super) spec: &'a GranularScene,
    pub(super) engine: Engine,
    pub(super) journal: Journal,
    /// Bodies that wait for a stage, by its number.
    pub(super) reserved: BTreeMap<usize, Range<usize>>,
    /// All bodies as they are described.
    bodies: Cow<'a, [Body]>,
    recorded: Vec<u32>,
    /// Part of the critical step that an automatic one takes; `None` when the step is given.
    automatic: Option<f64>,
    /// Critical step of contacts that may come, whether there are any now [s].
    foreseen: f64,
    smallest_radius: f64,
    fingerprint: Fingerprint,
}

pub(super) fn run(
    spec: &GranularScene,
    law: Chosen,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Ending, SimulationError> {
    let mut runner = Runner::new(spec, law, Team::new(context.threads)?)?;
    if let Some(bytes) = context.checkpoint {
        let checkpoint: Checkpoint = checkpoint::unpack(bytes)?;
        runner.fingerprint.check(checkpoint.spec)?;
        runner.journal = checkpoint.journal;
        let lists = checkpoint.contact_lists.iter();
        let lists = lists.map(|bytes| (law.unpack)(bytes));
        let lists = lists.collect::<Result<_, CheckpointError>>()?;
        runner.engine.resume(checkpoint.state, lists);
    }
    let columns = tables::curve_columns(spec);
    let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
    recorder.columns(&columns)?;
    for row in runner.journal.curve.chunks_exact(columns.len()) {
        recorder.point(row)?;
    }
    if context.checkpoint.is_none() {
        runner.begin(recorder)?;
    }
    let mut work = 0;
    while let Some(stage) = spec.stages.get(runner.journal.stage) {
        runner.begin_drives(stage);
        runner.rub(stage);
        if let Stage::Cut(cut) = stage {
            runner.cut(cut, recorder)?;
        }
        if let Stage::Place(place) = stage {
            runner.place(place, recorder)?;
        }
        while !runner.is_stage_done(stage) {
            work += runner.steps_unseen(stage, work)?;
            if runner.is_stage_done(stage) {
                break;
            }
            work += runner.work_of_step();
            if work > runner.work_uninterrupted() {
                work = 0;
                match context.interrupt.interrupt() {
                    Some(Interrupt::Cancel) => return Ok(Ending::Cancelled),
                    Some(Interrupt::Suspend) => {
                        runner.keep(recorder)?;
                        return Ok(Ending::Suspended);
                    }
                    None => {}
                }
                runner.tell_progress(recorder);
                if recorder.checkpoint_due() {
                    runner.keep(recorder)?;
                }
            }
            runner.prepare_step(stage);
            runner.supply(stage, recorder);
            runner.step(recorder)?;
        }
        let waits = matches!(stage, Stage::Settle(_) | Stage::Relax(_));
        if waits && !runner.journal.is_settled {
            runner.journal.unsettled_stages.push(runner.journal.stage);
        }
        runner.end_supply(stage);
        runner.end_stiffening(stage);
        runner.journal.is_settled = false;
        runner.journal.stage += 1;
        runner.journal.stage_steps = 0;
        runner.journal.stage_start = runner.engine.state.time;
    }
    tables::write(spec, &runner.journal, recorder)?;
    let has_walls = runner.engine.wall_count() > 0;
    snapshot::write_series(&runner.journal, has_walls, recorder)?;
    recorder.progress(1.0, "finished");
    Ok(Ending::Finished(report::report(
        spec,
        &runner.engine,
        &runner.journal,
    )))
}

impl<'a> Runner<'a> {
    fn new(spec: &'a GranularScene, law: Chosen, team: Team) -> Result<Self, SimulationError> {
        let specimen = Specimen::new(spec)?;
        let engine = Engine::new(spec, law, &specimen, team);
        let speed = GranularScene::first_speed(&specimen.bodies);
        let foreseen = foreseen(spec, &specimen.bodies, &engine, speed);
        let movable = specimen.bodies.iter().filter(|body| !body.is_held());
        let smallest_radius = movable
            .map(|body| body.smallest_radius())
            .fold(f64::INFINITY, f64::min);
        let automatic = match spec.time_step_s {
            TimeStep::Given(_) => None,
            TimeStep::Automatic(_) => Some(spec.accuracy.knobs().critical_step_fraction),
        };
        Ok(Self {
            spec,
            engine,
            journal: Journal::default(),
            recorded: spec.recorded_bodies(specimen.numbers()),
            reserved: specimen.waiting,
            bodies: specimen.bodies,
            automatic,
            foreseen,
            smallest_radius,
            fingerprint: Fingerprint::of(spec)?,
        })
    }

    /// Chooses the first time step and records the state before it.
    fn begin(&mut self, recorder: &mut dyn Recorder) -> Result<(), SimulationError> {
        self.engine.push_still();
        let survey = self.engine.survey(true);
        let critical = survey.critical;
        self.journal.time_step = match self.spec.time_step_s {
            TimeStep::Given(step) => {
                if let Some(critical) = critical
                    && step > critical.step
                    && !self.spec.allow_unstable
                {
                    return Err(unstable(step, critical));
                }
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

    /// Reads off and records a scene between two steps, after something was done to it.
    pub(super) fn observe_still(
        &mut self,
        recorder: &mut dyn Recorder,
    ) -> Result<(), SimulationError> {
        self.engine.push_still();
        let survey = self.engine.survey(true);
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

    fn picture(
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
    fn judge(&mut self, survey: &Survey) -> Result<(), SimulationError> {
        self.check_finite()?;
        let journal = &mut self.journal;
        let largest = survey.sums.overlap_ratio;
        journal.worst.see_step(journal.time_step, survey.critical);
        if let Some(Stage::Settle(settle)) = self.spec.stages.get(journal.stage) {
            let ratio = journal.last.unbalanced;
            journal.is_settled = ratio.is_some_and(|ratio| ratio <= settle.unbalanced_force_ratio);
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
        journal.worst.overlap_ratio = journal.worst.overlap_ratio.max(largest);
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
            .add(&journal.last, self.engine.state.wall_work);
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

    /// Adds the rows of this moment. The curve's is summed before contacts that are to be listed are put
    /// in order, so that no bit of it depends on what else is recorded.
    fn record(
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
        fragments::add_row(&self.engine, &mut self.journal);
        let step = self.engine.state.step;
        if self.spec.record.contacts && step > 0 {
            put_in_order(contacts);
            tables::contact_rows(step, contacts, &mut self.journal.contacts);
        }
        Ok(())
    }

    fn keep(&self, recorder: &mut dyn Recorder) -> Result<(), SimulationError> {
        // what is not finite would never come right again: the last good checkpoint stays
        self.check_finite()?;
        let checkpoint = CheckpointOf {
            spec: self.fingerprint,
            journal: &self.journal,
            state: &self.engine.state,
            contact_lists: (self.engine.contact_lists.iter())
                .map(|lists| Packed(lists.as_ref()))
                .collect(),
        };
        recorder.checkpoint(&checkpoint::pack(&checkpoint)?)?;
        Ok(())
    }
}
