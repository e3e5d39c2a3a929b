//! A network at rest by either road: a factor of all of it, or iterations.
use std::sync::Arc;

use loadframe_api::spec::paper_tensile::equilibrium::{DIRECT, has_rigid_groups};
use loadframe_numerics::Team;

use super::balance::{Forces, Motion};
use super::clusters::Clusters;
use super::element::PARTS;
use super::equilibrium::{Equilibrium, Refactoring, UNBALANCED};
use super::error::FrameError;
use super::gradients::{Relaxation, Start};
use super::input::NodeLoad;
use super::moving::MotionTest;
use super::network::Network;
use super::state::PullCost;
use super::survey::{Critical, breaks_at};
use super::together::together;
use super::tubes::PointSprings;

/// How equilibrium is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Solver {
    /// By a factor, unless that is large or bonds have no nodes of their own.
    #[default]
    ByCost,
    /// By a Cholesky factor; only where bonds have nodes of their own.
    Direct(Refactoring),
    /// By conjugate gradients.
    Iterative,
}

/// What equilibrium is found with.
#[derive(Debug, Clone)]
pub struct Means {
    pub solver: Solver,
    /// Threads that share the iterations; a factor takes one.
    pub team: Arc<Team>,
    /// Masses in motion instead of equilibrium.
    pub motion: Option<MotionTest>,
}

impl Default for Means {
    fn default() -> Self {
        Self::by(Solver::ByCost)
    }
}

impl Means {
    /// One thread.
    #[must_use]
    pub fn by(solver: Solver) -> Self {
        Self {
            solver,
            team: Arc::new(Team::alone()),
            motion: None,
        }
    }

    fn refactoring(&self, network: &Network) -> Option<Refactoring> {
        match self.solver {
            Solver::Direct(refactoring) => Some(refactoring),
            Solver::Iterative => None,
            Solver::ByCost => {
                let unknowns = network.nodes() * network.motions();
                let is_direct = network.hanging().is_empty() && unknowns <= DIRECT;
                (is_direct || network.tubes().is_some()).then_some(Refactoring::ByCost)
            }
        }
    }
}

/// A network at rest, with one of the two; tubes with a factor.
#[derive(Debug)]
pub(crate) enum Held<'n> {
    Direct(Box<Equilibrium<'n>>),
    Tubes(Box<Equilibrium<'n, PointSprings>>),
    Iterative(Box<Relaxation<'n>>),
}

impl<'n> Held<'n> {
    /// Finds the rest under an elongation and loads without the elements that broke before and after the
    /// last factor. `break_precision` says how well what breaks next is to be known; a motion
    /// that is not empty is what iterations have found already.
    pub(crate) fn new(
        network: &'n Network,
        clusters: Clusters,
        pull: (f64, &'n [NodeLoad]),
        means: &Means,
        broken: (&[u32], &[u32]),
        (break_precision, motion): (f64, &[f64]),
    ) -> Result<Self, FrameError> {
        let refactoring = means.refactoring(network);
        if network.tubes().is_some() {
            let refactoring = refactoring.ok_or(FrameError::Tubes)?;
            let found = Equilibrium::new(network, clusters, pull, refactoring, broken)?;
            return Ok(Self::Tubes(Box::new(found)));
        }
        if let Some(refactoring) = refactoring {
            if !network.hanging().is_empty() {
                return Err(FrameError::Hanging);
            }
            let found = Equilibrium::new(network, clusters, pull, refactoring, broken)?;
            return Ok(Self::Direct(Box::new(found)));
        }
        let start = Start {
            break_precision,
            is_grouped: has_rigid_groups(network.taut_strain(), break_precision),
            motion,
        };
        let team = Arc::clone(&means.team);
        let found = Relaxation::new(network, clusters, pull, team, start, broken)?;
        Ok(Self::Iterative(Box::new(found)))
    }

    /// Takes elements out; what they carried goes to the others.
    pub(crate) fn remove(&mut self, elements: &[usize]) -> Result<(), FrameError> {
        match self {
            Self::Direct(rest) => elements
                .iter()
                .try_for_each(|&element| rest.remove(element)),
            Self::Tubes(rest) => elements
                .iter()
                .try_for_each(|&element| rest.remove(element)),
            Self::Iterative(rest) => rest.remove(elements),
        }
    }

    /// What breaks at this elongation with one solution, the most loaded first; what breaks next alone where
    /// `precision` is 0.
    pub(crate) fn breaking(&self, elongation: f64, precision: f64) -> Vec<usize> {
        let Some(critical) = self.critical() else {
            return Vec::new();
        };
        if precision <= 0.0 {
            return vec![critical.element];
        }
        let indices = self
            .factors()
            .map(|(part, factor)| (part, elongation / factor));
        let indices: Vec<(usize, f64)> = indices.collect();
        together(self.network(), &indices, precision)
    }

    /// Elongation at which more than so many parts are at their strength; infinite where that is never.
    pub(crate) fn reached_by_more_than(&self, parts: usize) -> f64 {
        let mut factors: Vec<f64> = self.factors().map(|(_, factor)| factor).collect();
        if factors.len() <= parts {
            return f64::INFINITY;
        }
        *factors.select_nth_unstable_by(parts, f64::total_cmp).1
    }

    /// Parts that bear something, with the elongation at which they are at their strength.
    fn factors(&self) -> impl Iterator<Item = (usize, f64)> {
        let network = self.network();
        let factor = |part| Some((part, breaks_at(network, part, &self.loads_of(part)?)));
        (0..network.parts()).filter_map(factor)
    }

    pub(crate) fn network(&self) -> &'n Network {
        match self {
            Self::Direct(rest) => rest.network,
            Self::Tubes(rest) => rest.network,
            Self::Iterative(rest) => rest.network,
        }
    }

    /// Displacement and rotation of every point.
    pub(crate) fn motion(&self) -> &Motion {
        match self {
            Self::Direct(rest) => &rest.motion,
            Self::Tubes(rest) => &rest.motion,
            Self::Iterative(rest) => &rest.motion,
        }
    }

    /// Largest turn of a node, of tubes that of a ring [rad per unit].
    pub(crate) fn largest_turn(&self) -> f64 {
        let nodes = &self.motion().nodes;
        match self.network().tubes() {
            Some(tubes) => tubes.largest_turn(self.network().positions(), self.motion()),
            None => nodes
                .iter()
                .map(|motion| motion[1].norm())
                .fold(0.0, f64::max),
        }
    }

    pub(crate) fn forces(&self) -> &Forces {
        match self {
            Self::Direct(rest) => &rest.forces,
            Self::Tubes(rest) => &rest.forces,
            Self::Iterative(rest) => &rest.forces,
        }
    }

    pub(crate) fn critical(&self) -> Option<Critical> {
        match self {
            Self::Direct(rest) => rest.critical,
            Self::Tubes(rest) => rest.critical,
            Self::Iterative(rest) => rest.critical,
        }
    }

    pub(crate) fn residual(&self) -> f64 {
        match self {
            Self::Direct(rest) => rest.residual,
            Self::Tubes(rest) => rest.residual,
            Self::Iterative(rest) => rest.residual,
        }
    }

    /// Unbalanced force over the largest force of an element that is allowed.
    pub(crate) fn residual_limit(&self) -> f64 {
        match self {
            Self::Direct(_) | Self::Tubes(_) => UNBALANCED,
            Self::Iterative(rest) => rest.limit(),
        }
    }

    /// Error of failure indices that is allowed.
    pub(crate) fn index_limit(&self) -> f64 {
        match self {
            Self::Direct(_) | Self::Tubes(_) => UNBALANCED,
            Self::Iterative(rest) => rest.tolerance().max(UNBALANCED),
        }
    }

    /// Estimated error of the failure indices of what breaks next; none of a factor, whose
    /// solution is refined to round-off.
    pub(crate) fn index_error(&self) -> Option<f64> {
        match self {
            Self::Direct(_) | Self::Tubes(_) => None,
            Self::Iterative(rest) => Some(rest.index_error),
        }
    }

    /// Loads q of an element; none when it is broken or hangs loose.
    pub(crate) fn loads_of(&self, element: usize) -> Option<[f64; PARTS]> {
        match self {
            Self::Direct(rest) => rest.loads_of(element),
            Self::Tubes(rest) => rest.loads_of(element),
            Self::Iterative(rest) => rest.loads_of(element),
        }
    }

    /// Whether an element is not broken.
    pub(crate) fn is_whole(&self, element: usize) -> bool {
        match self {
            Self::Direct(rest) => rest.is_whole(element),
            Self::Tubes(rest) => rest.is_whole(element),
            Self::Iterative(rest) => rest.is_whole(element),
        }
    }

    /// Whether anything is stretched or bent at all.
    pub(crate) fn is_active(&self) -> bool {
        match self {
            Self::Direct(rest) => rest.is_active(),
            Self::Tubes(rest) => rest.is_active(),
            Self::Iterative(rest) => rest.is_any_active(),
        }
    }

    /// Whether both jaws still hold one cluster.
    pub(crate) fn is_spanning(&self) -> bool {
        match self {
            Self::Direct(rest) => rest.is_spanning(),
            Self::Tubes(rest) => rest.is_spanning(),
            Self::Iterative(rest) => rest.is_spanning(),
        }
    }

    /// Elements that broke before and after the factor was made, each in order.
    pub(crate) fn broken(&self) -> (&[u32], &[u32]) {
        match self {
            Self::Direct(rest) => rest.broken(),
            Self::Tubes(rest) => rest.broken(),
            Self::Iterative(rest) => rest.broken(),
        }
    }

    /// What iterations go on from; empty where a factor finds it again.
    pub(crate) fn flat_motion(&self) -> &[f64] {
        match self {
            Self::Direct(_) | Self::Tubes(_) => &[],
            Self::Iterative(rest) => rest.flat_motion(),
        }
    }

    pub(crate) fn cost(&self) -> PullCost {
        match self {
            Self::Direct(rest) => rest.cost(),
            Self::Tubes(rest) => rest.cost(),
            Self::Iterative(rest) => rest.cost(),
        }
    }
}
