//! The pull: event by event to the break.
//!
//! Between breaks a network of small displacements is linear, and without breaks it would come back to
//! where it was. So its rest at unit elongation is all that is needed: it says at which elongation
//! the next part breaks. A machine drives the elongation e, which only grows: when what is left would have
//! broken at less than e, it breaks at e, in the same avalanche, the most overloaded first.
//!
//! Bonds break when (fₙ/Fₙ)² + (fₛ/Fₛ)² = 1, fibres where N/A + |M| w/(2 I) reaches their strength.
use super::clusters::Clusters;
use super::element::PARTS;
use super::error::{FrameError, check};
use super::events::{Bore, Breaking, Broken, Event, PullEnd, Step, bore};
use super::held::{Held, Means};
use super::network::Network;
use super::pulling::{Loads, Pulling, run};
use super::state::{PullCost, PullState};
use super::together::{few, waits_to};

/// Until when is pulled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PullTest {
    /// Elongation over the distance of the jaws at which it ends at the latest.
    pub max_strain: f64,
    /// It ends when an avalanche leaves this share of the largest force or less.
    pub stop_force_fraction: f64,
    /// Where something is over its strength by this share, all breaks together that is, or is short of it by a
    /// quarter of this share, but what has a neighbour that is more overloaded by more than this share; 0: one by
    /// one.
    pub break_precision: f64,
}

impl PullTest {
    pub(crate) fn check(&self) -> Result<(), FrameError> {
        let (strain, fraction) = (self.max_strain, self.stop_force_fraction);
        check(|| "largest strain".into(), strain, strain > 0.0, "above 0")?;
        let is_share = (0.0..1.0).contains(&fraction);
        check(
            || "force fraction".into(),
            fraction,
            is_share,
            "0 to below 1",
        )?;
        let precision = self.break_precision;
        let is_share = (0.0..1.0).contains(&precision);
        check(
            || "break precision".into(),
            precision,
            is_share,
            "0 to below 1",
        )
    }
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
        if network.yields() {
            return Err(FrameError::Yields);
        }
        test.check()?;
        state.check(network)?;
        let broken = (state.factored.as_slice(), state.taken.as_slice());
        let known = (test.break_precision, state.motion.as_slice());
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

    /// Pulls to the end; gives every break and why it ended.
    ///
    /// # Errors
    /// As [`Pull::advance`].
    pub fn run(&mut self) -> Result<(Vec<Event>, PullEnd), FrameError> {
        run(self)
    }

    /// Force per elongation [mN/µm].
    fn stiffness(&self) -> f64 {
        self.rest.forces().at_jaws(self.rest.network().jaws())[1]
    }

    fn is_below_fraction(&self) -> bool {
        let force = self.stiffness() * self.state.elongation_um;
        force <= self.test.stop_force_fraction * self.state.measures.peak_force_mn
    }

    /// The elongation at which something breaks, the first part being at its strength at `first`; none above the
    /// present one where that is now.
    fn waits_until(&self, first: f64, last: f64) -> f64 {
        let precision = self.test.break_precision;
        let (present, waits) = (self.state.elongation_um, waits_to(precision));
        let few = few(precision, self.state.measures.broken());
        if first * waits > present || few == 0 {
            return first * waits;
        }
        let without_few = self.rest.reached_by_more_than(few) * waits;
        let may_wait = without_few <= last.min(present * waits);
        if may_wait { without_few } else { first * waits }
    }

    fn elongate(&mut self, to: f64) {
        let stiffness = self.stiffness();
        let from = self.state.elongation_um;
        self.state.elongation_um = to;
        let length = self.rest.network().model().length_um;
        let measures = &mut self.state.measures;
        measures.elongated([from, to], [stiffness * from, stiffness * to], length);
        if measures.strain_at_peak * length >= to {
            let turn = self.turn_rad();
            let most = &mut self.state.measures.turn_to_peak_rad;
            *most = most.max(turn);
        }
    }

    fn break_parts(&mut self, elements: &[usize]) -> Result<Vec<Event>, FrameError> {
        let network = self.rest.network();
        let elongation = self.state.elongation_um;
        let bore = elements.iter().map(|&element| {
            let loads = self.loads(element).map_or([0.0; PARTS], |loads| loads.0);
            bore(network, element, &loads)
        });
        let bore: Vec<(Broken, Bore)> = bore.collect();
        let energy = |rest: &Held| rest.forces().energy * elongation * elongation;
        let (stored_before_nj, before_mn) = (energy(&self.rest), self.jaw_force_mn());
        self.rest.remove(elements)?;
        let released_nj = stored_before_nj - energy(&self.rest);
        let measures = &mut self.state.measures;
        measures.released_nj += released_nj;
        measures.count(&bore);
        let (factored, taken) = self.rest.broken();
        self.state.factored = factored.to_vec();
        self.state.taken = taken.to_vec();
        self.state.motion.clear();
        self.state.motion.extend(self.rest.flat_motion());
        self.measure();
        let breaking = Breaking {
            elongation_um: elongation,
            avalanche: self.state.avalanche,
            before_mn,
            after_mn: self.jaw_force_mn(),
            stored_before_nj,
            released_nj,
            residual: self.rest.residual(),
        };
        Ok(breaking.events(network, bore))
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

impl Pulling for Pull<'_> {
    fn advance(&mut self) -> Result<Step, FrameError> {
        if let Some(end) = self.state.ended {
            return Ok(Step::Ended(end));
        }
        let length = self.rest.network().model().length_um;
        let last = self.test.max_strain * length;
        let next = self.rest.critical();
        let at = next.map_or(f64::INFINITY, |critical| critical.factor);
        let to = self.waits_until(at, last).min(last);
        if to > self.state.elongation_um || at > last {
            // nothing breaks at this elongation any more: an avalanche is over
            if self.state.measures.broken() > 0 && self.is_below_fraction() {
                return Ok(self.end(PullEnd::ForceFraction));
            }
            self.elongate(to);
            if at > last {
                return Ok(self.end(PullEnd::MaxStrain));
            }
            self.state.avalanche += 1;
        }
        let breaking = self
            .rest
            .breaking(self.state.elongation_um, self.test.break_precision);
        if breaking.is_empty() {
            return Ok(self.end(PullEnd::MaxStrain));
        }
        let events = self.break_parts(&breaking)?;
        if events.last().is_some_and(|event| self.is_parted(event)) {
            self.state.ended = Some(PullEnd::Parted);
        }
        Ok(Step::Broke(events))
    }

    fn elongation_um(&self) -> f64 {
        self.state.elongation_um
    }

    fn jaw_force_mn(&self) -> [f64; 2] {
        self.rest
            .forces()
            .at_jaws(self.rest.network().jaws())
            .map(|force| force * self.state.elongation_um)
    }

    fn displacement_um(&self, node: usize) -> [f64; 3] {
        (self.rest.motion().nodes[node][0] * self.state.elongation_um).into()
    }

    fn turn_rad(&self) -> f64 {
        self.rest.largest_turn() * self.state.elongation_um
    }

    fn loads(&self, element: usize) -> Option<Loads> {
        let loads = self.rest.loads_of(element)?;
        Some(Loads(loads.map(|load| load * self.state.elongation_um)))
    }

    fn is_broken(&self, part: Broken) -> bool {
        !self.rest.is_whole(part.element(self.rest.network()))
    }

    /// That of round-off with a factor, half of the break precision with iterations.
    fn residual_limit(&self) -> f64 {
        self.rest.residual_limit()
    }

    /// That of round-off with a factor, a tenth of the break precision with iterations.
    fn index_limit(&self) -> f64 {
        self.rest.index_limit()
    }

    fn state(&self) -> &PullState {
        &self.state
    }

    fn cost(&self) -> PullCost {
        self.rest.cost()
    }

    fn network(&self) -> &Network {
        self.rest.network()
    }

    fn residual_elongation_um(&self) -> Result<f64, FrameError> {
        Ok(0.0)
    }
}
