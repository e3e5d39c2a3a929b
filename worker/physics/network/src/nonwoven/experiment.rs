//! The test itself: strain, equilibrium, breaking, until it ends.
use loadframe_api::spec::nonwoven_tensile::{Breaking, Knobs, NonwovenTensile, Solver};
use loadframe_harness::{Interrupt, SimulationError};
use loadframe_numerics::Team;

use super::{
    predictor::JawMove,
    specimen::Specimen,
    state::{Event, Increment, Point, State, Worst},
};
use crate::{
    Network, Vector,
    assembly::Assembly,
    configuration::{Configuration, Verdict},
    equilibrium::{Method, Search, Settled, Workspace, calm, work::Meter},
    field::Field,
    law::{BondLaw, StrainLaw},
    load_path::{Part, parts},
    rupture::{BreakingRule, Candidate, breaking, over_strength},
};

/// Newton iterations and sweeps allowed when the spec does not say.
const NEWTON_ITERATIONS: u32 = 1_000;
const SWEEPS: u32 = 100_000;
/// Each step that did not reach equilibrium leaves the following ones fewer Newton iterations: half
/// after the first, a third after the second, and one part in so many at least.
const LEAST_PATIENCE: u32 = 8;
/// Farthest a node may move at once, in mean rest lengths: about two row spacings. A node thrown
/// farther passes through its neighbours and settles on the wrong side of them.
const STEP_CAP: f64 = 2.0;

/// A running test.
pub(super) struct Experiment<'a> {
    spec: &'a NonwovenTensile,
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

/// What follows from which bonds are intact.
#[derive(Debug)]
pub(super) struct Loaded {
    pub(super) intact: Vec<bool>,
    pub(super) parts: Vec<Part>,
    pub(super) assembly: Assembly,
    /// Of the bond in each slot [N].
    strengths: Vec<f64>,
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
}

/// What one equilibrium brought.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Advance {
    /// Bonds broke; the step goes on.
    Broke,
    /// The step is done, and perhaps the test.
    StepDone(Option<StopReason>),
}

/// Why an equilibrium was not finished.
#[derive(Debug)]
pub(super) enum Halt {
    Interrupted(Interrupt),
    Failed(SimulationError),
}

impl From<Interrupt> for Halt {
    fn from(interrupt: Interrupt) -> Self {
        Self::Interrupted(interrupt)
    }
}

impl Loaded {
    fn new(network: &Network, intact: Vec<bool>) -> Self {
        let parts = parts(network, &intact);
        let mut assembly = Assembly::new(network);
        assembly.load(network, &intact, &parts);
        let strengths = &network.bonds.strengths;
        let of_slot = |slot| {
            assembly
                .bond_in(slot)
                .map_or(f64::INFINITY, |bond| strengths[bond])
        };
        Self {
            strengths: (0..assembly.ends.len()).map(of_slot).collect(),
            intact,
            parts,
            assembly,
        }
    }

    /// After these bonds broke.
    fn follow(&mut self, network: &Network, broken: &[Event]) {
        let bonds = || broken.iter().map(|event| event.bond as usize);
        for bond in bonds() {
            self.intact[bond] = false;
            self.assembly.release(bond);
        }
        // a bond whose ends hang together without it parts nothing
        if !bonds().all(|bond| self.assembly.is_bridged(bond)) {
            self.parts = parts(network, &self.intact);
            self.assembly.load(network, &self.intact, &self.parts);
        }
    }
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
            if spec.accuracy.knobs().solver == Solver::NewtonCg {
                workspace.go_on(&loaded.assembly, last);
            }
        }
        Self {
            spec,
            team,
            knobs: spec.accuracy.knobs(),
            step_cap: STEP_CAP * network.bonds.mean_rest_length(),
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

    /// Bins of a force histogram.
    pub(super) fn histogram_bins(&self) -> u32 {
        self.spec.output.histogram_bins
    }

    /// Nominal strain of the step being worked on.
    pub(super) fn nominal_strain(&self) -> f64 {
        nominal_strain(self.spec, self.state.step)
    }

    /// Finds the next equilibrium, breaks what is over strength, and records the step if nothing
    /// is. The state changes only when all of it succeeded.
    ///
    /// # Errors
    /// An interrupt, or a state that is not finite.
    pub(super) fn advance(&mut self, meter: &mut Meter<'_>) -> Result<Advance, Halt> {
        meter.look()?;
        let start = self.start(meter)?;
        if self.loaded.assembly.is_empty() {
            self.state.displacements = start;
            self.settled = None;
            self.note_force(0.0);
            self.record([0.0, 0.0], 0.0);
            return Ok(Advance::StepDone(Some(StopReason::NoLoadPath)));
        }
        let assembly = &self.loaded.assembly;
        let search = self.search();
        match self.settled.take() {
            Some(last) if self.state.round > 0 && search.method == Method::NewtonCg => {
                self.workspace.go_on(assembly, last.configuration);
            }
            Some(last) => self.workspace.take_back(last),
            None => (),
        }
        let settled = search.run(assembly, &start, &self.team, &mut self.workspace, meter)?;
        self.check_finite(&settled).map_err(Halt::Failed)?;

        let mut displacements = start;
        assembly.put(&settled.configuration.displacements, &mut displacements);
        if self.state.round == 0 && self.state.step > 0 {
            let jaw_move = self.jaw_move();
            let pairs = displacements.iter().zip(&self.state.displacements);
            self.state.last_increment = Some(Increment {
                jaw: jaw_move.to - jaw_move.from,
                displacements: pairs.map(|(after, before)| after - before).collect(),
            });
        }
        self.state.displacements = displacements;
        self.judge(&settled, search.force_limit);

        let broken = self.break_bonds(&settled);
        let jaw_forces = assembly_forces(&self.loaded.assembly, &settled);
        self.note_force(jaw_forces[0]);
        let energy = settled.configuration.energy;
        self.settled = Some(settled);
        if broken > 0 {
            self.state.round += 1;
            let before = self.state.events.len() - broken;
            let broken = &self.state.events[before..];
            self.loaded.follow(&self.specimen.network, broken);
            return Ok(Advance::Broke);
        }
        self.record(jaw_forces, energy);
        Ok(Advance::StepDone(self.stop_reason()))
    }

    /// Goes on to the next step.
    pub(super) fn next_step(&mut self) {
        self.state.step += 1;
        self.state.round = 0;
        self.state.worst_of_step = Worst::default();
    }

    /// Displacements to search equilibrium from.
    fn start(&mut self, meter: &mut Meter<'_>) -> Result<Vec<Vector>, Interrupt> {
        let state = &self.state;
        if state.round > 0 || state.step == 0 {
            return Ok(state.displacements.clone());
        }
        let (network, parts) = (&self.specimen.network, &self.loaded.parts);
        let jaw_move = self.jaw_move();
        let stretched = jaw_move.stretch(network, parts, &state.displacements);
        let (Solver::NewtonCg, Some(last)) = (self.knobs.solver, &state.last_increment) else {
            return Ok(stretched);
        };
        // of two guesses the one with less energy is closer to the minimum; it is at hand then
        let repeated = jaw_move.repeat(last, network, parts, &state.displacements);
        let assembly = &self.loaded.assembly;
        meter.spend(2 * assembly.bonds())?;
        let is_first = self
            .workspace
            .choose(assembly, [&repeated, &stretched], &self.team);
        Ok(if is_first { repeated } else { stretched })
    }

    fn jaw_move(&self) -> JawMove {
        let specimen = &self.specimen;
        let displacement = |step| nominal_strain(self.spec, step) * specimen.gauge_length;
        JawMove {
            from: displacement(self.state.step.saturating_sub(1)),
            to: displacement(self.state.step),
            bottom: specimen.bottom,
            gauge_length: specimen.gauge_length,
        }
    }

    fn search(&self) -> Search {
        let knobs = &self.knobs;
        let (method, iterations) = match knobs.solver {
            Solver::NewtonCg => {
                // a test that fails step after step is to end all the same
                let failed = self.state.unconverged.len() as u32;
                let share = (1 + failed).min(LEAST_PATIENCE);
                (Method::NewtonCg, NEWTON_ITERATIONS / share)
            }
            Solver::Sequential => (Method::Sequential, SWEEPS),
            Solver::Parallel => {
                let relaxation_factor = knobs.relaxation_factor;
                (Method::Parallel { relaxation_factor }, SWEEPS)
            }
        };
        // without strain the limit would be zero, so step 0 is held to the limit of step 1
        let strain = self.nominal_strain().max(self.spec.test.strain_step);
        let in_tension = BondLaw {
            compression_stiffness: 0.0,
            ..self.specimen.mean_law
        };
        Search {
            method,
            iteration_limit: knobs.iteration_limit.unwrap_or(iterations),
            force_limit: in_tension.tension(strain) / knobs.force_accuracy,
            step_cap: self.step_cap,
            calm: calm(knobs.force_accuracy),
        }
    }

    /// Keeps what the equilibrium says about its own quality.
    fn judge(&mut self, settled: &Settled, force_limit: f64) {
        let worst = &mut self.state.worst_of_step;
        let ratio = settled.residual.largest / force_limit;
        worst.residual_ratio = worst.residual_ratio.max(ratio);
        worst.is_unconverged |= settled.residual.verdict == Verdict::Unbalanced;
        worst.is_round_off |= settled.residual.verdict == Verdict::RoundOff;
        if self.state.mechanism.is_none() {
            let node = settled.mechanism(&self.loaded.assembly);
            self.state.mechanism = node.map(|node| (node, self.nominal_strain()));
        }
    }

    /// Applies the breaking rule; returns how many bonds broke.
    fn break_bonds(&mut self, settled: &Settled) -> usize {
        let rule = match self.spec.test.breaking {
            Breaking::AllOverStrength => BreakingRule::AllOverStrength,
            Breaking::WeakestFirst => BreakingRule::WeakestFirst,
            Breaking::None => BreakingRule::Never,
        };
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
        let mut candidates: Vec<Candidate> = over.into_iter().filter_map(of_slot).collect();
        candidates.sort_unstable_by_key(|candidate| candidate.bond);
        let broken = breaking(rule, candidates.into_iter());
        let (step, round) = (self.state.step, self.state.round + 1);
        let nominal_strain = self.nominal_strain();
        let events = broken.iter().map(|candidate| Event {
            step,
            round,
            nominal_strain,
            bond: candidate.bond as u32,
            force: candidate.tension,
            energy: settled
                .configuration
                .bond(assembly, assembly.slot(candidate.bond))
                .energy,
        });
        self.state.events.extend(events);
        broken.len()
    }

    /// Keeps the force at the first equilibrium of a step.
    fn note_force(&mut self, force: f64) {
        if self.state.round == 0 {
            self.state.force_before_breaking = force;
        }
    }

    fn record(&mut self, [force, bottom_force]: [f64; 2], stored_energy: f64) {
        let nominal_strain = self.nominal_strain();
        let state = &mut self.state;
        let worst = state.worst_of_step;
        if worst.is_unconverged {
            state.unconverged.push(nominal_strain);
        } else if worst.is_round_off {
            state.round_off.push(nominal_strain);
        }
        state.max_force = state.max_force.max(force);
        let width_gauge = self.specimen.width_gauge.as_ref();
        state.points.push(Point {
            nominal_strain,
            force,
            bottom_force,
            force_before_breaking: state.force_before_breaking,
            broken: state.events.len() as u64,
            residual_ratio: worst.residual_ratio,
            rounds: state.round,
            stored_energy,
            width_strain: width_gauge.map(|gauge| gauge.strain(&state.displacements)),
        });
    }

    fn stop_reason(&self) -> Option<StopReason> {
        let test = &self.spec.test;
        let force = self.state.points.last().map_or(0.0, |point| point.force);
        // a force that falls although nothing broke is slack being taken up, not rupture
        let has_broken = !self.state.events.is_empty();
        if has_broken && force < test.stop_force_fraction * self.state.max_force {
            Some(StopReason::ForceDropped)
        } else if self.nominal_strain() >= test.max_strain {
            Some(StopReason::MaxStrain)
        } else {
            None
        }
    }

    fn check_finite(&self, settled: &Settled) -> Result<(), SimulationError> {
        let configuration = &settled.configuration;
        let error = |node, quantity| SimulationError::NonFinite {
            node: self.loaded.assembly.node(node),
            step: self.state.step,
            quantity,
        };
        let first = |field: &Field<f64>| {
            if field.is_finite() {
                return None;
            }
            let is_bad = |node: &usize| !field.at(*node).iter().all(|value| value.is_finite());
            (0..self.loaded.assembly.places()).find(is_bad)
        };
        if let Some(node) = first(&configuration.displacements) {
            return Err(error(node, "displacement"));
        }
        if let Some(node) = first(&configuration.resultants) {
            return Err(error(node, "resultant"));
        }
        Ok(())
    }
}

fn assembly_forces(assembly: &Assembly, settled: &Settled) -> [f64; 2] {
    assembly.jaw_forces(&settled.configuration.resultants)
}

/// Nominal strain of a step: a product, because a sum would drift, and at most the largest strain.
pub(super) fn nominal_strain(spec: &NonwovenTensile, step: u64) -> f64 {
    let strain = step as f64 * spec.test.strain_step;
    // a hair below the end is the end: 0.1 must not be followed by 0.1 + 1e-17
    if strain > spec.test.max_strain * (1.0 - LAST_STEP_SLACK) {
        spec.test.max_strain
    } else {
        strain
    }
}

/// Rounding of `step * strain_step` against `max_strain`, with a wide margin.
const LAST_STEP_SLACK: f64 = 1e-12;
