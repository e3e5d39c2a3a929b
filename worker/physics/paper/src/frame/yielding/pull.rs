//! The pull of fibres that yield: from yield to yield and break to break.
use super::super::equilibrium::{BALANCED, Equilibrium, ROUND_OFF, UNBALANCED};
use super::super::error::FrameError;
use super::super::events::{Bore, Breaking, Broken, Event, PullEnd, Step, bore};
use super::super::network::Network;
use super::super::pull::PullTest;
use super::super::pulling::Pulling;
use super::super::state::{Peak, PullCost, PullState, Yielded};
use super::super::survey::breaks_at;
use super::super::together::{together, waits_to};
use super::reach::{until_break, until_yield};
use super::relax::{changes, relax};
use super::strained::Strained;

/// A pull stops to be looked at after this share of its way, and after so many yields.
const PART: f64 = 1.0 / 200.0;
const YIELDS: usize = 64;
/// A segment this share of its limit below it is on it: such as were to yield together.
const ON_LIMIT: f64 = 1e-10;
/// Rates of force below this share of the largest are none.
const NEUTRAL: f64 = 1e-12;
/// Rounds in which all that flow wrongly change at once; then the first alone, which ends for sure
/// [Murty1974].
const AT_ONCE: usize = 8;
const ROUNDS: usize = 100_000;
/// Refinements of forces that do not balance.
const REFINEMENTS: usize = 4;
/// An index this share below its limit is over it: of two that break together, round-off leaves one so.
pub(super) const OVER: f64 = 1e-10;
/// Forces below this share of the largest that ever was are none.
const NOTHING: f64 = 1e-9;

/// A pull under way.
#[derive(Debug)]
pub(crate) struct YieldingPull<'n> {
    pub(super) test: PullTest,
    pub(super) state: PullState,
    pub(super) strained: Strained<'n>,
    /// What 1 µm more does.
    pub(super) rate: Equilibrium<'n>,
    /// Of the state, which is only brought up to date when it is asked for.
    residual: f64,
    pub(super) past: PullCost,
}

/// What happens next.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Next {
    Nothing,
    Yields(usize),
    Breaks,
}

impl<'n> YieldingPull<'n> {
    /// Holds the network in its jaws, or goes on from a state of the same network and test.
    pub(crate) fn resume(
        network: &'n Network,
        test: PullTest,
        state: PullState,
    ) -> Result<Self, FrameError> {
        if !network.hanging().is_empty() {
            return Err(FrameError::Yields);
        }
        test.check()?;
        state.check(network)?;
        let mut strained = Strained::new(network);
        if let Some(yielded) = &state.yielding {
            strained.put(&yielded.motion, &yielded.segments)?;
        }
        let rate = slopes(&strained, &state.factored)?;
        strained.look(rate.active());
        let past = PullCost {
            unknowns: 0,
            stored: 0,
            factors: 0,
            solutions: 0,
            iterations: 0,
        };
        let mut pull = Self {
            test,
            state,
            strained,
            rate,
            residual: 0.0,
            past,
        };
        if pull.state.is_new() && pull.state.yielding.is_none() {
            if pull.rate.is_active() {
                let stiffness = pull.rate.forces.at_jaws(network.jaws())[1];
                pull.state.measures.initial_stiffness_mn = stiffness * network.model().length_um;
            } else {
                pull.state.ended = Some(PullEnd::NoPath);
            }
            pull.keep();
            pull.measure();
        }
        Ok(pull)
    }

    fn network(&self) -> &'n Network {
        self.strained.network
    }

    /// A factor anew, so that the same state goes on to the same bits.
    pub(super) fn renew(&mut self) -> Result<(), FrameError> {
        let cost = self.rate.cost();
        self.past.factors += cost.factors;
        self.past.solutions += cost.solutions;
        self.rate = slopes(&self.strained, &self.state.factored)?;
        Ok(())
    }

    /// What flows while the jaw goes on: what is on its limit and would be loaded further.
    fn find_flow(&mut self) -> Result<(), FrameError> {
        for round in 0..ROUNDS {
            let neutral = NEUTRAL * self.rate.forces.scale;
            let mut wrong = Vec::new();
            for (segment, law) in self.strained.laws.iter().enumerate() {
                let (Some(law), Some(rates)) = (law, self.rate.loads_of(segment)) else {
                    continue;
                };
                let plastic = self.strained.plastic[segment];
                let force = self.strained.loads(segment)[0];
                let limit = law.limit(plastic.hardened_um);
                let is_on_limit = force.abs() >= limit * (1.0 - ON_LIMIT);
                let onwards = force.signum() * rates[0];
                let is_wrong = if plastic.flows {
                    !is_on_limit || onwards < -neutral
                } else {
                    is_on_limit && onwards > neutral
                };
                if is_wrong {
                    wrong.push(segment);
                }
            }
            if wrong.is_empty() {
                return Ok(());
            }
            if round >= AT_ONCE {
                wrong.truncate(1);
            }
            for segment in wrong {
                let plastic = &mut self.strained.plastic[segment];
                plastic.flows = !plastic.flows;
            }
            let changed = changes(&self.strained, &self.rate);
            self.rate.change(&changed)?;
        }
        Err(FrameError::Undecided { rounds: ROUNDS })
    }

    /// The way to what happens next.
    fn next(&self) -> (f64, Next) {
        let network = self.network();
        let waits_to = waits_to(self.test.break_precision);
        let mut first = (f64::INFINITY, Next::Nothing);
        for element in 0..network.elements().len() {
            let Some(rates) = self.rate.loads_of(element) else {
                continue;
            };
            let loads = self.strained.loads(element);
            let law = self.strained.laws.get(element).copied().flatten();
            if let Some(law) = law {
                let plastic = self.strained.plastic[element];
                if !plastic.flows {
                    let way = until_yield(&law, plastic, loads[0], rates[0]);
                    if way < first.0 {
                        first = (way, Next::Yields(element));
                    }
                }
            }
            let way = until_break(network, element, &loads, &rates, waits_to);
            if way < first.0 {
                first = (way, Next::Breaks);
            }
        }
        first
    }

    /// The jaw goes on by `way`, while nothing happens.
    fn go(&mut self, to: f64) -> Result<(), FrameError> {
        let network = self.network();
        let from = self.state.elongation_um;
        let from_mn = self.jaw_force_mn()[1];
        let before = self.strained.motion.clone();
        let way = to - from;
        let rates = &self.rate.motion.nodes;
        for (motion, rate) in self.strained.motion.nodes.iter_mut().zip(rates) {
            for (part, rate) in motion.iter_mut().zip(rate) {
                *part += way * rate;
            }
        }
        self.strained.moved(&before);
        self.strained.look(self.rate.active());
        self.balance()?;
        self.state.elongation_um = to;
        let to_mn = self.jaw_force_mn()[1];
        let measures = &mut self.state.measures;
        measures.dissipated_nj = self.strained.dissipated_nj();
        let length = network.model().length_um;
        measures.elongated([from, to], [from_mn, to_mn], length);
        if measures.strain_at_peak * length >= to {
            measures.turn_to_peak_rad = measures.turn_to_peak_rad.max(self.strained.turn_rad());
        }
        Ok(())
    }

    /// Refines what does not balance, as sums of many small ways may not.
    fn balance(&mut self) -> Result<(), FrameError> {
        let mut last = f64::INFINITY;
        for refinement in 0..=REFINEMENTS {
            let mut right = self.rate.unbalanced(&self.strained.forces);
            let worst = self.rate.worst_force(&right);
            self.residual = worst / self.strained.forces.scale.max(self.floor_mn());
            let is_round_off = worst <= ROUND_OFF * self.strained.forces.round_off;
            let is_stuck = self.residual <= UNBALANCED && self.residual > 0.3 * last;
            if self.residual <= BALANCED || is_round_off || is_stuck {
                return Ok(());
            }
            last = self.residual;
            if refinement < REFINEMENTS {
                self.rate.solve(&mut right);
                let before = self.strained.motion.clone();
                self.rate.add_to(&mut self.strained.motion, &right, 1.0);
                self.strained.moved(&before);
                self.strained.look(self.rate.active());
            }
        }
        Err(FrameError::Unbalanced {
            residual: self.residual,
            allowed: UNBALANCED,
            iterations: REFINEMENTS,
        })
    }

    /// Forces below this are none [mN].
    fn floor_mn(&self) -> f64 {
        (NOTHING * self.state.measures.peak_force_mn).max(f64::MIN_POSITIVE)
    }

    /// The largest failure index, and what breaks with one solution, the most loaded first.
    pub(super) fn loaded(&self) -> (f64, Vec<usize>) {
        let network = self.network();
        let indices = (0..network.elements().len()).filter_map(|element| {
            let is_stretched = self.rate.is_stretched(element);
            let index = || 1.0 / breaks_at(network, element, &self.strained.loads(element));
            is_stretched.then(|| (element, index()))
        });
        let indices: Vec<(usize, f64)> = indices.collect();
        let mut largest: Option<(usize, f64)> = None;
        for &(element, index) in &indices {
            // the first of equals stays
            if largest.is_none_or(|(_, most)| index > most) {
                largest = Some((element, index));
            }
        }
        let Some((most, largest)) = largest else {
            return (0.0, Vec::new());
        };
        let elements = if self.test.break_precision > 0.0 {
            together(network, &indices, self.test.break_precision)
        } else {
            vec![most]
        };
        (largest, elements)
    }

    pub(super) fn break_parts(&mut self, elements: &[usize]) -> Result<Vec<Event>, FrameError> {
        let network = self.network();
        let bore = elements
            .iter()
            .map(|&element| bore(network, element, &self.strained.loads(element)));
        let bore: Vec<(Broken, Bore)> = bore.collect();
        self.measure();
        self.keep_peak();
        let stored_before_nj = self.strained.forces.energy;
        let lost_before = self.strained.dissipated_nj();
        let before_mn = self.jaw_force_mn();
        let gone = elements.iter().map(|&element| element as u32);
        self.state.factored.extend(gone);
        self.renew()?;
        let floor = self.floor_mn();
        self.residual = relax(&mut self.strained, &mut self.rate, floor)?;
        let lost = self.strained.dissipated_nj() - lost_before;
        let released_nj = stored_before_nj - self.strained.forces.energy - lost;
        let measures = &mut self.state.measures;
        measures.dissipated_nj = self.strained.dissipated_nj();
        measures.released_nj += released_nj;
        measures.count(&bore);
        self.measure();
        let breaking = Breaking {
            elongation_um: self.state.elongation_um,
            avalanche: self.state.avalanche,
            before_mn,
            after_mn: self.jaw_force_mn(),
            stored_before_nj,
            released_nj,
            residual: self.residual,
        };
        Ok(breaking.events(network, bore))
    }

    pub(super) fn is_below_fraction(&self) -> bool {
        let force = self.jaw_force_mn()[1];
        force <= self.test.stop_force_fraction * self.state.measures.peak_force_mn
    }

    fn is_at_peak(&self) -> bool {
        let length = self.network().model().length_um;
        let measures = &self.state.measures;
        measures.strain_at_peak * length >= self.state.elongation_um * (1.0 - f64::EPSILON)
    }

    /// Keeps what is looked at when all is over, where the force is the largest so far and nothing has
    /// broken at it.
    fn keep_peak(&mut self) {
        let force = self.jaw_force_mn()[1];
        if self.is_at_peak() && force >= self.state.measures.peak_force_mn {
            self.state.measures.yielded_share_at_peak = self.strained.yielded_share();
            let (motion, segments) = self.strained.kept();
            if let Some(yielding) = &mut self.state.yielding {
                yielding.peak = Some(Peak { motion, segments });
            }
        }
    }

    /// Brings the state up to date.
    pub(super) fn keep(&mut self) {
        let peak = self.state.yielding.take().and_then(|yielded| yielded.peak);
        let (motion, segments) = self.strained.kept();
        self.state.yielding = Some(Yielded {
            motion,
            segments,
            peak,
        });
    }

    fn measure(&mut self) {
        let [left, right] = self.jaw_force_mn();
        let forces = &self.strained.forces;
        let share = if forces.energy > 0.0 {
            forces.taut_energy / forces.energy
        } else {
            0.0
        };
        let measures = &mut self.state.measures;
        measures.stored_nj = forces.energy;
        measures.largest_residual = measures.largest_residual.max(self.residual);
        let imbalance = (right - left).abs() / measures.peak_force_mn.max(f64::MIN_POSITIVE);
        measures.largest_jaw_imbalance = measures.largest_jaw_imbalance.max(imbalance);
        measures.largest_taut_share = measures.largest_taut_share.max(share);
    }

    pub(super) fn end(&mut self, end: PullEnd) -> Step {
        self.state.ended = Some(end);
        self.measure();
        self.keep_peak();
        self.keep();
        Step::Ended(end)
    }

    /// Goes on to the next break; none where it stopped before one.
    pub(super) fn strain(&mut self) -> Result<Option<Step>, FrameError> {
        let last = self.test.max_strain * self.network().model().length_um;
        let to = last.min(self.state.elongation_um + PART * last);
        for _ in 0..YIELDS {
            self.find_flow()?;
            let (way, next) = self.next();
            let at = self.state.elongation_um + way;
            if at > to {
                self.go(to)?;
                self.measure();
                if to >= last {
                    return Ok(Some(self.end(PullEnd::MaxStrain)));
                }
                self.keep();
                return Ok(Some(Step::Strained));
            }
            self.go(at)?;
            self.measure();
            match next {
                Next::Breaks => return Ok(None),
                Next::Yields(segment) => {
                    self.strained.plastic[segment].flows = true;
                    let changed = changes(&self.strained, &self.rate);
                    self.rate.change(&changed)?;
                }
                Next::Nothing => {}
            }
        }
        self.keep();
        Ok(Some(Step::Strained))
    }
}

/// What 1 µm more does to a network with what flows in it, without what is broken.
fn slopes<'n>(strained: &Strained<'n>, broken: &[u32]) -> Result<Equilibrium<'n>, FrameError> {
    let network = strained.network;
    let mut elements = network.elements().to_vec();
    for (segment, plastic) in strained.plastic.iter().enumerate() {
        if let (true, Some(law)) = (plastic.flows, &strained.laws[segment]) {
            elements[segment].stiffness[0] = law.softened;
        }
    }
    Equilibrium::softer(network, elements, broken)
}
