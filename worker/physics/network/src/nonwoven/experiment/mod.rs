//! The test itself: strain, equilibrium, breaking, until it ends.
//!
//! This file takes step after step; [`loaded`] is what carries load, [`equilibrium`] how it comes to
//! rest, [`search`] how the beginning of a break is found, [`turns`] where the jaw turns.
mod equilibrium;
mod loaded;
mod search;
mod turns;

use loadframe_api::spec::nonwoven_tensile::{
    Breaking, ForceLandscape, Knobs, NonwovenTensile, Solver,
};
use loadframe_harness::Halt;
use loadframe_numerics::Team;

use super::{
    path::Path,
    specimen::Specimen,
    state::{Event, Increment, Peak, Point, Retreat, Search, State},
};
use crate::{
    boundary::{BOTTOM, TOP},
    configuration::Configuration,
    equilibrium::{Method, Settled, Workspace, work::Meter},
    rupture::{BreakingRule, Candidate, breaking, over_strength},
};
pub(super) use loaded::Loaded;
pub(super) use search::LARGEST_OVERSTEP;

/// Farthest a node may move at once where the spec does not say, in mean rest lengths: about two row
/// spacings. A node thrown
/// farther passes through its neighbours and settles on the wrong side of them.
const STEP_CAP: f64 = 2.0;

/// A running test.
pub(super) struct Experiment<'a> {
    spec: &'a NonwovenTensile,
    path: Path,
    pub(super) specimen: Specimen,
    pub(super) state: State,
    team: Team,
    knobs: Knobs,
    /// Farthest a node may move at once [mm].
    step_cap: f64,
    pub(super) loaded: Loaded,
    /// Bond states at the last equilibrium; `None` when nothing carries load, and before the first.
    pub(super) settled: Option<Settled>,
    workspace: Workspace,
}

/// Why a test ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StopReason {
    /// The force fell below the given fraction of its maximum.
    ForceDropped,
    /// No bonds connect the jaws any more.
    NoLoadPath,
    /// The last strain step was done.
    MaxStrain,
    /// The last leg of the history was done.
    HistoryFinished,
}

/// What one equilibrium brought.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Advance {
    /// Bonds broke, or a break is looked for; the step goes on.
    GoesOn,
    /// The step is done, and perhaps the test.
    StepDone(Option<StopReason>),
}

impl<'a> Experiment<'a> {
    pub(super) fn new(
        spec: &'a NonwovenTensile,
        specimen: Specimen,
        state: State,
        team: Team,
    ) -> Self {
        let network = &specimen.network;
        let (intact, broken) = state.intact(network.bonds.len());
        let mut loaded = Loaded::new(network, intact);
        let mut workspace = Workspace::default();
        // resumed between two rounds: go on from the same numbers as if it had not been suspended
        if !broken.is_empty() {
            let last = Configuration::of(&loaded.assembly, &state.displacements, &team);
            loaded.follow(network, broken);
            let is_between_rounds = state.round > state.rounds_before;
            if is_between_rounds && spec.accuracy.knobs().solver == Solver::NewtonCg {
                workspace.go_on(&loaded.assembly, last);
            }
        }
        Self {
            spec,
            path: Path::new(spec),
            team,
            knobs: spec.accuracy.knobs(),
            step_cap: spec.accuracy.knobs().largest_move.unwrap_or(STEP_CAP)
                * network.bonds.mean_rest_length(),
            loaded,
            settled: None,
            workspace,
            specimen,
            state,
        }
    }

    /// Steps between snapshots; 0 for none.
    pub(super) fn snapshot_every(&self) -> u32 {
        self.spec.output.snapshot_every_steps
    }

    /// The way of the jaw.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Bins of a force histogram.
    pub(super) fn histogram_bins(&self) -> u32 {
        self.spec.output.histogram_bins
    }

    /// The force landscape, where it is to be written of the step just recorded.
    pub(super) fn landscape_due(&self) -> Option<&'a ForceLandscape> {
        let spec: &'a NonwovenTensile = self.spec;
        let asked = spec.output.force_landscape.as_ref()?;
        let is_due = !self.state.has_landscape && self.state.strain >= asked.strain;
        is_due.then_some(asked)
    }

    /// Nominal strain being worked on.
    pub(super) fn nominal_strain(&self) -> f64 {
        self.state.strain
    }

    /// Finds the next equilibrium and breaks what is over strength; or, where that would overstep a
    /// fall of the force, goes back to find where it begins. The state changes only when all of it
    /// succeeded.
    ///
    /// # Errors
    /// An interrupt, or a state that is not finite.
    pub(super) fn advance(&mut self, meter: &mut Meter<'_>) -> Result<Advance, Halt> {
        meter.look()?;
        let start = self.start(meter)?;
        if self.loaded.assembly.is_empty() {
            if self.has_fallen(0.0) {
                return Ok(self.retreat());
            }
            self.state.displacements = start;
            self.settled = None;
            let mut point = self.point([0.0, 0.0], 0.0);
            if self.is_first() {
                self.state.before_breaking = Some(point);
            }
            self.account(&mut point);
            self.record_fall(&point);
            self.record(point);
            return Ok(Advance::StepDone(Some(StopReason::NoLoadPath)));
        }
        let assembly = &self.loaded.assembly;
        let search = self.equilibrium();
        match self.settled.take() {
            Some(last) if !self.is_first() && search.method == Method::NewtonCg => {
                self.workspace.go_on(assembly, last.configuration);
            }
            Some(last) => self.workspace.take_back(last),
            None => (),
        }
        let settled = search.run(assembly, &start, &self.team, &mut self.workspace, meter)?;
        self.check_finite(&settled)?;

        let mut displacements = start;
        assembly.put(&settled.configuration.displacements, &mut displacements);
        let has_moved = self.is_before(self.state.reached.strain, self.state.strain);
        if self.is_first() && has_moved {
            let jaw_move = self.jaw_move();
            let pairs = displacements.iter().zip(&self.state.displacements);
            self.state.last_increment = Some(Increment {
                jaw: jaw_move.to - jaw_move.from,
                displacements: pairs.map(|(after, before)| after - before).collect(),
            });
        }
        let before = std::mem::replace(&mut self.state.displacements, displacements);
        let worst_before = self.state.worst_of_step;
        self.judge(&settled, search.force_limit);

        let over = self.over_strength(&settled);
        let forces = (settled.configuration).forces_on_sets(&self.loaded.assembly);
        let [top, bottom] = [TOP, BOTTOM].map(|jaw| forces[usize::from(jaw)].y);
        // tension is positive; a difference, because the negative of zero is written as -0
        let point = self.point([0.0 - top, bottom], settled.configuration.energy);
        if self.is_first() {
            self.state.before_breaking = Some(point);
            let may_be_peak = self.snapshot_every() > 0 && point.force > self.state.max_force;
            self.state.may_be_peak = may_be_peak.then(|| self.state.displacements.clone());
            if self.oversteps_force(point.force) {
                self.settled = Some(settled);
                return Ok(self.look_for_force(point.force, before, worst_before));
            }
            if !over.is_empty() && !self.is_resolved(&over, point.force, &before) {
                let found = Search {
                    strain: self.state.strain,
                    force: point.force,
                    over: over
                        .iter()
                        .map(|one| (one.bond as u32, one.index()))
                        .collect(),
                    looks: self.state.search.as_ref().map_or(0, |search| search.looks),
                };
                let retreat = Retreat {
                    displacements: before,
                    worst_of_step: worst_before,
                    events: self.state.events.len(),
                    search: found,
                };
                let is_known_to_fall = self.state.search.is_some();
                self.settled = Some(settled);
                let is_first_break = self.state.events.is_empty();
                self.state.retreat = Some(retreat);
                if is_first_break || is_known_to_fall {
                    return Ok(self.retreat());
                }
                return Ok(self.break_bonds(over));
            }
            self.state.retreat = None;
        } else if self.has_fallen(point.force) {
            self.settled = Some(settled);
            return Ok(self.retreat());
        }
        self.settled = Some(settled);
        if !over.is_empty() {
            return Ok(self.break_bonds(over));
        }
        self.state.retreat = None;
        let overstepped = self.state.search.as_ref().map(|search| search.strain);
        let is_between = overstepped.is_some_and(|end| self.is_before(self.state.strain, end));
        if self.is_first() && is_between {
            // the break lies between here and where it was overstepped
            let mut point = point;
            self.account(&mut point);
            self.reach(point.force);
            self.look_between();
            return Ok(Advance::GoesOn);
        }
        // where the network can rest in several ways, the way here may have led to one in which nothing
        // is over its strength: then there is no break
        self.judge_stability(search.force_limit);
        Ok(self.conclude(point))
    }

    /// Whether nothing has broken yet at the strain being worked on.
    fn is_first(&self) -> bool {
        self.state.round == self.state.rounds_before
    }

    /// Ends work at a strain at which nothing breaks any more.
    fn conclude(&mut self, mut point: Point) -> Advance {
        self.account(&mut point);
        let has_fallen = self.record_fall(&point);
        self.reach(point.force);
        self.state.search = None;
        let end = self.step_end();
        if !self.is_before(self.state.strain, end) || self.is_at_end(point.force) {
            self.state.aim = None;
            self.record(point);
            return Advance::StepDone(self.stop_reason());
        }
        let is_read = self.path.is_read(self.state.place, self.state.strain);
        if has_fallen || is_read {
            self.record(point);
            if let Some(reason) = self.stop_reason() {
                return Advance::StepDone(Some(reason));
            }
        }
        self.state.rounds_before = self.state.round;
        self.state.strain = self.next_strain(end);
        Advance::GoesOn
    }

    /// The bonds over their strength, by ascending number; none where none may break.
    fn over_strength(&self, settled: &Settled) -> Vec<Candidate> {
        if self.spec.test.breaking == Breaking::None {
            return Vec::new();
        }
        let assembly = &self.loaded.assembly;
        let (tensions, strengths) = (&settled.configuration.tensions, &self.loaded.strengths);
        let of_slot = |slot: usize| {
            Some(Candidate {
                bond: assembly.bond_in(slot)?,
                tension: tensions[slot],
                strength: strengths[slot],
            })
        };
        let over = over_strength(tensions, strengths);
        let candidates = over.into_iter().filter_map(of_slot);
        let mut over: Vec<Candidate> = candidates.filter(Candidate::is_over_strength).collect();
        over.sort_unstable_by_key(|candidate| candidate.bond);
        over
    }

    /// Applies the breaking rule to the bonds over their strength at the last equilibrium.
    fn break_bonds(&mut self, over: Vec<Candidate>) -> Advance {
        let rule = match self.spec.test.breaking {
            Breaking::AllOverStrength => BreakingRule::AllOverStrength,
            Breaking::WeakestFirst => BreakingRule::WeakestFirst,
            Breaking::None => BreakingRule::Never,
        };
        let broken = breaking(rule, over.into_iter());
        let (step, round) = (self.state.step, self.state.round + 1);
        let nominal_strain = self.nominal_strain();
        let assembly = &self.loaded.assembly;
        let energy = |bond: usize| {
            let settled = self.settled.as_ref();
            settled.map_or(0.0, |settled| {
                settled
                    .configuration
                    .bond(assembly, assembly.slot(bond))
                    .energy
            })
        };
        let events = broken.iter().map(|candidate| Event {
            step,
            round,
            nominal_strain,
            bond: candidate.bond as u32,
            force: candidate.tension,
            energy: energy(candidate.bond),
        });
        self.state.events.extend(events);
        self.state.aim = None;
        self.state.round += 1;
        let before = self.state.events.len() - broken.len();
        self.loaded
            .follow(&self.specimen.network, &self.state.events[before..]);
        Advance::GoesOn
    }

    /// The state at the strain being worked on.
    fn point(&self, [force, bottom_force]: [f64; 2], stored_energy: f64) -> Point {
        let state = &self.state;
        let before_breaking = match self.state.before_breaking {
            Some(before) if !self.is_first() => before.force,
            _ => force,
        };
        let width_gauge = self.specimen.width_gauge.as_ref();
        let leg = self.path.leg(state.place);
        Point {
            nominal_strain: state.strain,
            step: state.step,
            cycle: leg.cycle,
            is_unloading: leg.unloads,
            force,
            bottom_force,
            force_before_breaking: before_breaking,
            broken: state.events.len() as u64,
            residual_ratio: state.worst_of_step.residual_ratio,
            rounds: state.round - state.rounds_before,
            stored_energy,
            work: state.work_done,
            lost_energy: state.energy_lost,
            width_strain: width_gauge.map(|gauge| gauge.strain(&state.displacements)),
        }
    }

    fn record(&mut self, point: Point) {
        if self.snapshot_every() > 0 && point.force > self.state.max_force {
            self.keep_peak(&point);
        }
        let state = &mut self.state;
        let worst = std::mem::take(&mut state.worst_of_step);
        if worst.is_unconverged {
            state.unconverged.push(point.nominal_strain);
        } else if worst.is_round_off {
            state.round_off.push(point.nominal_strain);
        }
        state.max_force = state.max_force.max(point.force);
        state.farthest = state.farthest.max(point.nominal_strain);
        state.points.push(point);
    }

    /// Keeps the state of `point`: the present one, or that before bonds broke at this strain.
    fn keep_peak(&mut self, point: &Point) {
        let state = &mut self.state;
        let events = point.broken as usize;
        let before = state.may_be_peak.take();
        let displacements = match before {
            Some(before) if events < state.events.len() => before,
            _ => state.displacements.clone(),
        };
        state.peak = Some(Peak {
            nominal_strain: point.nominal_strain,
            events,
            displacements,
        });
    }

    /// What is loaded at a peak, and how.
    pub(super) fn at(&self, peak: &Peak) -> (Loaded, Configuration) {
        let network = &self.specimen.network;
        let mut intact = vec![true; network.bonds.len()];
        for event in &self.state.events[..peak.events] {
            intact[event.bond as usize] = false;
        }
        let loaded = Loaded::new(network, intact);
        let configuration = Configuration::of(&loaded.assembly, &peak.displacements, &self.team);
        (loaded, configuration)
    }
}
