//! Everything later results of a test depend on: the content of its checkpoint.
use serde::{Deserialize, Serialize};

use crate::{Vector, equilibrium::work::Work};

/// A test between two equilibria.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct State {
    /// Strain step being worked on, counted from 0, the step without strain.
    pub(super) step: u64,
    /// Where on its way the jaw is.
    pub(super) place: Place,
    /// Nominal strain being worked on: that of the step, or one on the way to it.
    pub(super) strain: f64,
    /// Breaking rounds done in this step.
    pub(super) round: u32,
    /// Those done when work at this strain began.
    pub(super) rounds_before: u32,
    /// The last state in which no bond was over its strength.
    pub(super) reached: Reached,
    /// What is known of a break that is being looked for.
    pub(super) search: Option<Search>,
    /// What is known of a force that is being looked for.
    pub(super) aim: Option<Aim>,
    /// Where to go back to should the force fall in the breaking that goes on.
    pub(super) retreat: Option<Retreat>,
    /// Displacement of every node [mm].
    pub(super) displacements: Vec<Vector>,
    /// How the displacements changed in the last step before anything broke.
    pub(super) last_increment: Option<Increment>,
    /// At this strain before any bond broke there.
    pub(super) before_breaking: Option<Point>,
    /// Worst residual ratio and verdict among the equilibria of this step.
    pub(super) worst_of_step: Worst,
    /// Displacements of that state where it may be the one of the largest force, which is pictured.
    pub(super) may_be_peak: Option<Vec<Vector>>,
    /// The recorded state of the largest force, where it is pictured.
    pub(super) peak: Option<Peak>,
    pub(super) points: Vec<Point>,
    /// Largest recorded force [N].
    pub(super) max_force: f64,
    /// Largest recorded nominal strain.
    pub(super) farthest: f64,
    /// Work of the moving jaw so far [N mm].
    pub(super) work_done: f64,
    /// Energy that went where bonds broke [N mm].
    pub(super) energy_lost: f64,
    /// Every bond that broke, in the order in which it did.
    pub(super) events: Vec<Event>,
    pub(super) histogram: Vec<HistogramBin>,
    /// Bins at the strains the spec asks for.
    pub(super) force_distribution: Vec<HistogramBin>,
    /// How far the force may have risen past where it should have fallen, at the strain being worked
    /// on [N].
    pub(super) overstep: f64,
    /// The fall of the force that was found least precisely.
    pub(super) unresolved: Option<Unresolved>,
    /// Whether the force landscape was written.
    pub(super) has_landscape: bool,
    /// Steps of which a snapshot was written, and their nominal strain.
    pub(super) snapshots: Vec<(u64, f64)>,
    /// Strains at which equilibrium was not reached.
    pub(super) unconverged: Vec<f64>,
    /// Strains at which round-off, not the force limit, bounded the residual.
    pub(super) round_off: Vec<f64>,
    /// The first node found to move without resistance, and the strain.
    pub(super) mechanism: Option<(usize, f64)>,
    /// The first node found to rest where it is not stable, and the strain.
    pub(super) unstable: Option<(usize, f64)>,
    pub(super) work: Work,
}

/// How far the jaw is on its way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Place {
    /// Number of the leg, counted from 0.
    pub(super) leg: usize,
    /// Nominal strain at which it began.
    pub(super) from: f64,
    /// Strain step after which it began.
    pub(super) after_step: u64,
}

/// An increment of the displacements and the jaw displacement it belongs to [mm].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Increment {
    pub(super) jaw: f64,
    pub(super) displacements: Vec<Vector>,
}

/// The state of the largest force.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Peak {
    pub(super) nominal_strain: f64,
    /// Events until then.
    pub(super) events: usize,
    pub(super) displacements: Vec<Vector>,
}

/// A state in which no bond is over its strength.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Reached {
    pub(super) strain: f64,
    /// On the moving jaw [N].
    pub(super) force: f64,
}

/// A strain at which bonds are over their strength, to be approached from below.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Search {
    pub(super) strain: f64,
    /// On the moving jaw before any bond broke there [N].
    pub(super) force: f64,
    /// Number of each bond over its strength there, and its tension over strength.
    pub(super) over: Vec<(u32, f64)>,
    /// Strains tried on the way.
    pub(super) looks: u32,
}

/// A strain at which the force is beyond the one that ends the leg, to be approached from before.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Aim {
    pub(super) strain: f64,
    /// On the moving jaw there [N].
    pub(super) force: f64,
    /// Strains tried on the way.
    pub(super) looks: u32,
}

/// The state before the strain at which bonds now break.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Retreat {
    pub(super) displacements: Vec<Vector>,
    pub(super) worst_of_step: Worst,
    /// Events until then.
    pub(super) events: usize,
    /// What was found at the strain before anything broke.
    pub(super) search: Search,
}

/// A fall of the force that is not known to begin where it is said to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Unresolved {
    pub(super) nominal_strain: f64,
    /// The maximum of the force may lie so much beside what was recorded [N].
    pub(super) force: f64,
}

/// The worst equilibrium of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Worst {
    /// Largest resultant over its limit.
    pub(super) residual_ratio: f64,
    pub(super) is_unconverged: bool,
    pub(super) is_round_off: bool,
}

/// A point of the curve: the state at the end of a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Point {
    pub(super) nominal_strain: f64,
    /// Strain step it belongs to.
    pub(super) step: u64,
    /// Cycle of the history, counted from 1.
    pub(super) cycle: u32,
    /// Whether the jaw comes back.
    pub(super) is_unloading: bool,
    /// On the moving jaw [N].
    pub(super) force: f64,
    /// On the jaw at rest [N].
    pub(super) bottom_force: f64,
    /// On the moving jaw after straining, before bonds of this step broke [N].
    pub(super) force_before_breaking: f64,
    /// Bonds broken since the start.
    pub(super) broken: u64,
    /// Worst in the step.
    pub(super) residual_ratio: f64,
    /// Breaking rounds in the step.
    pub(super) rounds: u32,
    /// Energy in the loaded bonds [N mm].
    pub(super) stored_energy: f64,
    /// Work of the moving jaw, and energy that went where bonds broke, since the start [N mm].
    pub(super) work: f64,
    pub(super) lost_energy: f64,
    /// ε_x, where it can be measured.
    pub(super) width_strain: Option<f64>,
}

/// A bond that broke.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Event {
    pub(super) step: u64,
    /// Counted from 1 in each step.
    pub(super) round: u32,
    pub(super) nominal_strain: f64,
    pub(super) bond: u32,
    /// Tension at which it broke [N].
    pub(super) force: f64,
    /// Energy it held [N mm].
    pub(super) energy: f64,
}

/// Bonds whose force lies between two bounds [N] at some strain; the upper bound belongs to the
/// last bin only.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct HistogramBin {
    pub(super) nominal_strain: f64,
    pub(super) lower: f64,
    pub(super) upper: f64,
    pub(super) bonds: u64,
}

impl Point {
    /// −ε_x over nominal strain [-], 0 at no strain, where it is undefined.
    pub(super) fn poisson_ratio(&self) -> Option<f64> {
        let ratio = |width_strain: f64| match self.nominal_strain > 0.0 {
            true => -width_strain / self.nominal_strain,
            false => 0.0,
        };
        self.width_strain.map(ratio)
    }
}

impl State {
    /// A test of a network of `nodes` that has not begun.
    pub(super) fn new(nodes: usize) -> Self {
        Self {
            step: 0,
            place: Place::default(),
            strain: 0.0,
            round: 0,
            rounds_before: 0,
            reached: Reached::default(),
            search: None,
            aim: None,
            retreat: None,
            displacements: vec![Vector::zeros(); nodes],
            last_increment: None,
            before_breaking: None,
            may_be_peak: None,
            peak: None,
            worst_of_step: Worst::default(),
            points: Vec::new(),
            max_force: 0.0,
            farthest: 0.0,
            work_done: 0.0,
            energy_lost: 0.0,
            events: Vec::new(),
            histogram: Vec::new(),
            force_distribution: Vec::new(),
            overstep: 0.0,
            unresolved: None,
            has_landscape: false,
            snapshots: Vec::new(),
            unconverged: Vec::new(),
            round_off: Vec::new(),
            mechanism: None,
            unstable: None,
            work: Work::default(),
        }
    }

    /// Whether each of `bonds` was intact before the last breaking round of this step, and what broke
    /// in it.
    pub(super) fn intact(&self, bonds: usize) -> (Vec<bool>, &[Event]) {
        let is_last = |event: &&Event| (event.step, event.round) == (self.step, self.round);
        let last = self.events.iter().rev().take_while(is_last).count();
        let (before, last) = self.events.split_at(self.events.len() - last);
        let mut intact = vec![true; bonds];
        for event in before {
            intact[event.bond as usize] = false;
        }
        (intact, last)
    }
}
