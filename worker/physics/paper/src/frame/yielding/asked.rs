//! What the pull of fibres that yield can be asked.
use super::super::clusters::Clusters;
use super::super::equilibrium::{Equilibrium, Refactoring, UNBALANCED};
use super::super::error::FrameError;
use super::super::events::{Broken, PullEnd, Step};
use super::super::network::Network;
use super::super::pulling::{Loads, Pulling};
use super::super::state::{PullCost, PullState};
use super::super::together::waits_to;
use super::pull::{OVER, YieldingPull};

impl Pulling for YieldingPull<'_> {
    fn advance(&mut self) -> Result<Step, FrameError> {
        if let Some(end) = self.state.ended {
            return Ok(Step::Ended(end));
        }
        if !self.rate.is_as_factored() {
            self.renew()?;
        }
        let (index, _) = self.loaded();
        if index < waits_to(self.test.break_precision) * (1.0 - OVER) {
            // nothing breaks at this elongation any more: an avalanche is over
            if self.state.measures.broken() > 0 && self.is_below_fraction() {
                return Ok(self.end(PullEnd::ForceFraction));
            }
            if let Some(step) = self.strain()? {
                return Ok(step);
            }
            self.state.avalanche += 1;
        }
        let (_, elements) = self.loaded();
        let events = self.break_parts(&elements)?;
        let is_small = events
            .last()
            .is_some_and(|event| event.force_after_mn <= 1e-3 * event.force_before_mn);
        if is_small && !self.rate.is_spanning() {
            self.state.ended = Some(PullEnd::Parted);
        }
        self.keep();
        Ok(Step::Broke(events))
    }

    fn elongation_um(&self) -> f64 {
        self.state.elongation_um
    }

    fn jaw_force_mn(&self) -> [f64; 2] {
        self.strained.forces.at_jaws(self.strained.network.jaws())
    }

    fn displacement_um(&self, node: usize) -> [f64; 3] {
        self.strained.motion.nodes[node][0].into()
    }

    fn turn_rad(&self) -> f64 {
        self.strained.turn_rad()
    }

    fn loads(&self, element: usize) -> Option<Loads> {
        let is_stretched = self.rate.is_stretched(element);
        is_stretched.then(|| Loads(self.strained.loads(element)))
    }

    fn is_broken(&self, part: Broken) -> bool {
        !self.rate.is_whole(part.element(self.strained.network))
    }

    fn residual_limit(&self) -> f64 {
        UNBALANCED
    }

    fn state(&self) -> &PullState {
        &self.state
    }

    fn cost(&self) -> PullCost {
        let now = self.rate.cost();
        PullCost {
            factors: self.past.factors + now.factors,
            solutions: self.past.solutions + now.solutions,
            ..now
        }
    }

    fn network(&self) -> &Network {
        self.strained.network
    }

    fn residual_elongation_um(&self) -> Result<f64, FrameError> {
        let network = self.strained.network;
        let broken = (self.state.factored.as_slice(), [].as_slice());
        let by = Refactoring::ByCost;
        let unit = (1.0, [].as_slice());
        let elastic: Equilibrium<'_> =
            Equilibrium::new(network, Clusters::Spanning, unit, by, broken)?;
        let stiffness = elastic.forces.at_jaws(network.jaws())[1];
        let force = self.jaw_force_mn()[1];
        Ok(if stiffness > 0.0 {
            self.state.elongation_um - force / stiffness
        } else {
            self.state.elongation_um
        })
    }
}
