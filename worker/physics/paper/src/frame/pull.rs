//! The pull: event by event to the break.
//!
//! Between breaks a network of small displacements is linear, and without breaks it would come back to
//! where it was. So its rest at unit elongation is all that is needed: it says at which elongation
//! the next part breaks. A machine drives the elongation e, which only grows: when what is left would have
//! broken at less than e, it breaks at e, in the same avalanche, the most overloaded first.
//!
//! Bonds break when (fₙ/Fₙ)² + (fₛ/Fₛ)² = 1, fibres where N/A + |M| w/(2 I) reaches their strength.
use serde::{Deserialize, Serialize};

use super::element::stress_gpa;
use super::equilibrium::Clusters;
use super::error::{FrameError, check};
use super::held::{Held, Means};
use super::network::Network;
use super::state::{PullCost, PullState};

/// Until when is pulled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PullTest {
    /// Elongation over the distance of the jaws at which it ends at the latest.
    pub max_strain: f64,
    /// It ends when an avalanche leaves this share of the largest force or less.
    pub stop_force_fraction: f64,
    /// All parts whose failure index lies within this share of the largest break together; 0: one by one.
    /// Those break under that much less than their strength at most.
    pub break_precision: f64,
}

/// What broke.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Broken {
    Bond(usize),
    Segment(usize),
}

/// What it bore when it broke.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Bore {
    /// A bond: force across its face (opening is positive) and along it [mN].
    Bond { normal_mn: f64, shear_mn: f64 },
    /// A segment: tensile stress of force and bending [GPa].
    Segment { stress_gpa: f64 },
}

/// A break.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Event {
    pub strain: f64,
    pub elongation_um: f64,
    /// Which avalanche it belongs to, from 1: breaks at one elongation.
    pub avalanche: u32,
    pub broken: Broken,
    pub bore: Bore,
    /// Force at the moving jaw before and after [mN].
    pub force_before_mn: f64,
    pub force_after_mn: f64,
    /// Force at the jaw at rest after it [mN].
    pub left_force_after_mn: f64,
    /// Elastic energy that it set free [nJ].
    pub energy_released_nj: f64,
    /// Largest unbalanced force after it over the largest force of an element.
    pub residual: f64,
}

/// Why a pull ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum PullEnd {
    /// The largest strain is reached.
    MaxStrain,
    /// The force fell to the given share of its peak.
    ForceFraction,
    /// Nothing ties the jaws together any more.
    Parted,
    /// Nothing ever did: the network is below percolation.
    NoPath,
}

impl PullEnd {
    /// The reason in a sentence.
    #[must_use]
    pub fn sentence(self) -> &'static str {
        match self {
            Self::MaxStrain => "the largest strain is reached",
            Self::ForceFraction => "the force fell to the given share of its peak",
            Self::Parted => "no fibres and bonds tie the jaws together any more",
            Self::NoPath => "no fibres and bonds ever tied the jaws together: the force is 0",
        }
    }
}

/// What a step of the pull gave.
#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    /// Parts broke together, the most loaded first; one where they break one by one. The force falls, and
    /// energy is set free, with the last.
    Broke(Vec<Event>),
    Ended(PullEnd),
}

/// A pull under way.
#[derive(Debug)]
pub struct Pull<'n> {
    rest: Held<'n>,
    test: PullTest,
    state: PullState,
}

impl<'n> Pull<'n> {
    /// Holds the network in its jaws.
    ///
    /// # Errors
    /// [`FrameError`] when the test is outside its range, or the network has no equilibrium.
    pub fn new(network: &'n Network, test: PullTest) -> Result<Self, FrameError> {
        Self::resume(network, test, PullState::default(), &Means::default())
    }

    /// Goes on from a state of the same network and test, to the same bits.
    ///
    /// # Errors
    /// As [`Pull::new`], and when the state names parts that the network does not have.
    pub fn resume(
        network: &'n Network,
        test: PullTest,
        state: PullState,
        means: &Means,
    ) -> Result<Self, FrameError> {
        let (strain, fraction) = (test.max_strain, test.stop_force_fraction);
        check(|| "largest strain".into(), strain, strain > 0.0, "above 0")?;
        let is_share = (0.0..1.0).contains(&fraction);
        check(
            || "force fraction".into(),
            fraction,
            is_share,
            "0 to below 1",
        )?;
        let precision = test.break_precision;
        let is_share = (0.0..1.0).contains(&precision);
        check(
            || "break precision".into(),
            precision,
            is_share,
            "0 to below 1",
        )?;
        state.check(network)?;
        let broken = (state.factored.as_slice(), state.taken.as_slice());
        let known = (precision, state.motion.as_slice());
        let unit = (1.0, [].as_slice());
        let rest = Held::new(network, Clusters::Spanning, unit, means, broken, known)?;
        let mut pull = Self { rest, test, state };
        if pull.state.is_new() {
            if pull.rest.is_active() {
                pull.state.measures.initial_stiffness_mn =
                    pull.stiffness() * network.model().length_um;
            } else {
                pull.state.ended = Some(PullEnd::NoPath);
            }
            pull.state.motion = pull.rest.flat_motion().to_vec();
            pull.measure();
        }
        Ok(pull)
    }

    /// Goes to the next break, or breaks, or to the end.
    ///
    /// # Errors
    /// [`FrameError`] when the network has no equilibrium.
    pub fn advance(&mut self) -> Result<Step, FrameError> {
        if let Some(end) = self.state.ended {
            return Ok(Step::Ended(end));
        }
        let length = self.rest.network().model().length_um;
        let last = self.test.max_strain * length;
        let next = self.rest.critical();
        let at = next.map_or(f64::INFINITY, |critical| critical.factor);
        if at > self.state.elongation_um {
            // nothing breaks at this elongation any more: an avalanche is over
            if self.state.measures.broken() > 0 && self.is_below_fraction() {
                return Ok(self.end(PullEnd::ForceFraction));
            }
            self.elongate(at.min(last));
            if at > last {
                return Ok(self.end(PullEnd::MaxStrain));
            }
            self.state.avalanche += 1;
        }
        let breaking = self.rest.breaking(self.test.break_precision);
        if breaking.is_empty() {
            return Ok(self.end(PullEnd::MaxStrain));
        }
        let events = self.break_parts(&breaking)?;
        if events.last().is_some_and(|event| self.is_parted(event)) {
            self.state.ended = Some(PullEnd::Parted);
        }
        Ok(Step::Broke(events))
    }

    /// Pulls to the end; gives every break and why it ended.
    ///
    /// # Errors
    /// As [`Pull::advance`].
    pub fn run(&mut self) -> Result<(Vec<Event>, PullEnd), FrameError> {
        let mut events = Vec::new();
        loop {
            match self.advance()? {
                Step::Broke(broke) => events.extend(broke),
                Step::Ended(end) => return Ok((events, end)),
            }
        }
    }

    /// Elongation as it is [µm].
    #[must_use]
    pub fn elongation_um(&self) -> f64 {
        self.state.elongation_um
    }

    /// Forces of the left and the right jaw, positive when they pull [mN].
    #[must_use]
    pub fn jaw_force_mn(&self) -> [f64; 2] {
        self.rest
            .forces()
            .at_jaws(self.rest.network())
            .map(|force| force * self.state.elongation_um)
    }

    /// Displacement of a node as it is [µm].
    #[must_use]
    pub fn displacement_um(&self, node: usize) -> [f64; 3] {
        (self.rest.motion().nodes[node][0] * self.state.elongation_um).into()
    }

    /// Tensile stress of a segment of force and bending as it is [GPa]; 0 when it is broken.
    #[must_use]
    pub fn segment_stress_gpa(&self, segment: usize) -> f64 {
        let network = self.rest.network();
        match self.rest.loads_of(segment) {
            Some(loads) => {
                let unit = stress_gpa(network.section_of(segment), network.model().level, &loads);
                unit * self.state.elongation_um
            }
            None => 0.0,
        }
    }

    /// Force along a segment as it is [mN], tension positive; 0 when it is broken.
    #[must_use]
    pub fn segment_force_mn(&self, segment: usize) -> f64 {
        let loads = self.rest.loads_of(segment);
        loads.map_or(0.0, |loads| loads[0] * self.state.elongation_um)
    }

    /// Largest turn of a node over the elongation [rad/µm], until something breaks: small displacements
    /// are small where turns are.
    #[must_use]
    pub fn largest_turn_per_um(&self) -> f64 {
        let turns = self
            .rest
            .motion()
            .nodes
            .iter()
            .map(|motion| motion[1].norm());
        turns.fold(0.0, f64::max)
    }

    /// Forces of the left and the right jaw over the elongation [mN/µm], until something breaks.
    #[must_use]
    pub fn jaw_stiffness_mn_per_um(&self) -> [f64; 2] {
        self.rest.forces().at_jaws(self.rest.network())
    }

    /// Force of a bond across its face and along it as it is [mN]; 0 when it is broken.
    #[must_use]
    pub fn bond_force_mn(&self, bond: usize) -> [f64; 2] {
        match self.rest.loads_of(self.rest.network().segments() + bond) {
            Some(loads) => {
                [loads[0], loads[1].hypot(loads[2])].map(|force| force * self.state.elongation_um)
            }
            None => [0.0; 2],
        }
    }

    /// Whether a part is broken.
    #[must_use]
    pub fn is_broken(&self, part: Broken) -> bool {
        let element = match part {
            Broken::Bond(bond) => self.rest.network().segments() + bond,
            Broken::Segment(segment) => segment,
        };
        !self.rest.is_whole(element)
    }

    /// Unbalanced force over the largest force of an element that is allowed: that of round-off with a
    /// factor, a tenth of the break precision with iterations.
    #[must_use]
    pub fn residual_limit(&self) -> f64 {
        self.rest.residual_limit()
    }

    /// What it takes to go on.
    #[must_use]
    pub fn state(&self) -> &PullState {
        &self.state
    }

    /// Factors made and passes of solution, since it was built: what a pull costs.
    #[must_use]
    pub fn cost(&self) -> PullCost {
        self.rest.cost()
    }

    /// Force per elongation [mN/µm].
    fn stiffness(&self) -> f64 {
        self.rest.forces().at_jaws(self.rest.network())[1]
    }

    fn is_below_fraction(&self) -> bool {
        let force = self.stiffness() * self.state.elongation_um;
        force <= self.test.stop_force_fraction * self.state.measures.peak_force_mn
    }

    fn elongate(&mut self, to: f64) {
        let stiffness = self.stiffness();
        let from = self.state.elongation_um;
        self.state.measures.work_nj += 0.5 * stiffness * (to - from) * (to + from);
        self.state.elongation_um = to;
        let measures = &mut self.state.measures;
        // from rest there is always a first peak, be it 0
        if stiffness * to > measures.peak_force_mn || from == 0.0 {
            measures.peak_force_mn = stiffness * to;
            measures.strain_at_peak = to / self.rest.network().model().length_um;
            measures.work_to_peak_nj = measures.work_nj;
        }
    }

    /// What a part is, and what it bears.
    fn bore(&self, element: usize) -> (Broken, Bore) {
        let network = self.rest.network();
        let elongation = self.state.elongation_um;
        let loads = self.rest.loads_of(element).unwrap_or_default();
        if element < network.segments() {
            let stress = stress_gpa(network.section_of(element), network.model().level, &loads);
            let bore = Bore::Segment {
                stress_gpa: stress * elongation,
            };
            (Broken::Segment(element), bore)
        } else {
            let bore = Bore::Bond {
                normal_mn: loads[0] * elongation,
                shear_mn: loads[1].hypot(loads[2]) * elongation,
            };
            (Broken::Bond(element - network.segments()), bore)
        }
    }

    fn break_parts(&mut self, elements: &[usize]) -> Result<Vec<Event>, FrameError> {
        let network = self.rest.network();
        let elongation = self.state.elongation_um;
        let bore: Vec<(Broken, Bore)> = elements.iter().map(|&part| self.bore(part)).collect();
        let energy = |rest: &Held| rest.forces().energy * elongation * elongation;
        let (energy_before, force_before_mn) = (energy(&self.rest), self.stiffness() * elongation);
        let left_force_before_mn = self.jaw_force_mn()[0];
        self.rest.remove(elements)?;
        let energy_released_nj = energy_before - energy(&self.rest);
        let [left_force_after_mn, force_after_mn] = self.jaw_force_mn();

        let measures = &mut self.state.measures;
        measures.released_nj += energy_released_nj;
        for (broken, _) in &bore {
            match broken {
                Broken::Bond(_) => measures.broken_bonds += 1,
                Broken::Segment(_) => measures.broken_segments += 1,
            }
        }
        let (factored, taken) = self.rest.broken();
        self.state.factored = factored.to_vec();
        self.state.taken = taken.to_vec();
        self.state.motion.clear();
        self.state.motion.extend(self.rest.flat_motion());
        self.measure();
        let last = bore.len() - 1;
        let events = bore.into_iter().enumerate().map(|(index, (broken, bore))| {
            let is_last = index == last;
            Event {
                strain: elongation / network.model().length_um,
                elongation_um: elongation,
                avalanche: self.state.avalanche,
                broken,
                bore,
                force_before_mn,
                force_after_mn: if is_last {
                    force_after_mn
                } else {
                    force_before_mn
                },
                left_force_after_mn: if is_last {
                    left_force_after_mn
                } else {
                    left_force_before_mn
                },
                energy_released_nj: if is_last { energy_released_nj } else { 0.0 },
                residual: self.rest.residual(),
            }
        });
        Ok(events.collect())
    }

    /// The jaws are parted at the latest when nothing is left of the force; then it is looked.
    fn is_parted(&self, event: &Event) -> bool {
        let is_small = event.force_after_mn <= 1e-3 * event.force_before_mn;
        is_small && !self.rest.is_spanning()
    }

    fn measure(&mut self) {
        let [left, right] = self.jaw_force_mn();
        let elongation = self.state.elongation_um;
        let forces = self.rest.forces();
        let stored = forces.energy * elongation * elongation;
        let share = if forces.energy > 0.0 {
            forces.taut_energy / forces.energy
        } else {
            0.0
        };
        let measures = &mut self.state.measures;
        measures.stored_nj = stored;
        measures.largest_residual = measures.largest_residual.max(self.rest.residual());
        if let Some(error) = self.rest.index_error() {
            let largest = measures.largest_index_error.unwrap_or(0.0);
            measures.largest_index_error = Some(largest.max(error));
        }
        let imbalance = (right - left).abs() / measures.peak_force_mn.max(f64::MIN_POSITIVE);
        measures.largest_jaw_imbalance = measures.largest_jaw_imbalance.max(imbalance);
        measures.largest_taut_share = measures.largest_taut_share.max(share);
    }

    fn end(&mut self, end: PullEnd) -> Step {
        self.state.ended = Some(end);
        self.measure();
        Step::Ended(end)
    }
}
