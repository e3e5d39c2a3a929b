//! Small displacements: rest of a network that is pulled by its jaws or loaded at its nodes.
//!
//! One Cholesky factor serves while parts break: what breaks is some rank-one terms, its springs (six of a beam or
//! bond), and the motion changes by what these had carried, Δu = K'⁻¹ B q (their forces q before the break). One
//! pass with a right side for each gives K⁻¹ B for both the [`Softening`] and Δu. The factor is made anew,
//! without what is no longer stretched, when corrections have cost as much as a factor does.
use std::borrow::Cow;

use loadframe_numerics::Softening;

use super::balance::{Forces, Motion};
use super::clusters::{Clusters, Standing};
use super::element::{Element, PARTS};
use super::error::FrameError;
use super::factor::Factor;
use super::input::NodeLoad;
use super::network::Network;
use super::places::Jaw;
use super::springs::SpringSum;
use super::state::PullCost;
use super::survey::{Critical, survey_of};

mod softer;

/// Forces that balance to this share of the largest are not refined further. Backward stability of a
/// Cholesky solution gives about 1e-13 for sheets of 1000 segments from jaw to jaw.
pub(crate) const BALANCED: f64 = 1e-10;

/// Forces that balance worse than this, refined, are refused; [`ROUND_OFF`] excuses.
pub(crate) const UNBALANCED: f64 = 1e-6;

/// Round-off of a force as a share of stiffness times displacement, for what carries nearly nothing.
pub(crate) const ROUND_OFF: f64 = 1e-11;

/// A residual this many times the one at which refinement ended last is not refined: where the shortest
/// segments are stiff beside the sheet, that is round-off, and a refinement costs as much as a break.
const NEAR_FLOOR: f64 = 4.0;

/// Refinements before giving up.
const REFINEMENTS: usize = 4;

/// What a machine does in a second: multiplications while factoring, entries read while solving or
/// correcting. Of the order of one core's, and only used to choose the cheaper road.
const FACTOR_RATE: f64 = 8e9;
const READ_RATE: f64 = 1e9;

/// Columns that may be kept, in entries, however small the factor is.
const FREE_COLUMNS: usize = 10_000_000;

/// When a factor is made anew.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Refactoring {
    /// When corrections have cost as much as a factor.
    #[default]
    ByCost,
    /// After every break. For checks.
    Always,
    /// Only when a correction is impossible. For checks.
    Never,
}

/// A network at rest.
#[derive(Debug)]
pub(crate) struct Equilibrium<'n, E: SpringSum = Element> {
    pub(crate) network: &'n Network,
    /// The network's, or as they are where some yield or are torn.
    elements: Cow<'n, [E]>,
    clusters: Clusters,
    refactoring: Refactoring,
    loads: &'n [NodeLoad],
    elongation: f64,
    gyration: f64,
    is_whole: Vec<bool>,
    /// Whole, and of a cluster that is solved for.
    is_active: Vec<bool>,
    factor: Factor,
    softening: Softening,
    /// Elements that broke before the factor was made, and after.
    factored: Vec<u32>,
    taken: Vec<u32>,
    spent: f64,
    /// Largest force of an element since the factor was made [mN per unit].
    largest: f64,
    /// Residual at which refinement ended last.
    floor: f64,
    pub(crate) motion: Motion,
    pub(crate) forces: Forces,
    pub(crate) critical: Option<Critical>,
    pub(crate) residual: f64,
    columns: Vec<f64>,
    pub(crate) factors: usize,
    pub(crate) solutions: usize,
}

impl<'n, E: SpringSum> Equilibrium<'n, E> {
    /// Finds the rest without the elements `factored`; those of `taken` leave one by one, as they did
    /// before, so that a state that goes on has the same bits.
    pub(crate) fn new(
        network: &'n Network,
        clusters: Clusters,
        (elongation, loads): (f64, &'n [NodeLoad]),
        refactoring: Refactoring,
        (factored, taken): (&[u32], &[u32]),
    ) -> Result<Self, FrameError> {
        let elements = Cow::Borrowed(E::of(network));
        let solved = (clusters, refactoring);
        let mut equilibrium =
            Self::of_elements(network, elements, solved, (elongation, loads), factored)?;
        for &element in taken {
            equilibrium.remove(element as usize)?;
        }
        Ok(equilibrium)
    }

    fn of_elements(
        network: &'n Network,
        elements: Cow<'n, [E]>,
        (clusters, refactoring): (Clusters, Refactoring),
        (elongation, loads): (f64, &'n [NodeLoad]),
        factored: &[u32],
    ) -> Result<Self, FrameError> {
        let nodes = network.nodes();
        let mut equilibrium = Self {
            network,
            elements,
            clusters,
            refactoring,
            loads,
            elongation,
            gyration: network.gyration_um(),
            is_whole: network.unbroken(),
            is_active: Vec::new(),
            factor: Factor::empty(network)?,
            softening: Softening::new(0),
            factored: factored.to_vec(),
            taken: Vec::new(),
            spent: 0.0,
            largest: 0.0,
            floor: 0.0,
            motion: Motion::rest(nodes),
            forces: Forces::new(nodes),
            critical: None,
            residual: 0.0,
            columns: Vec::new(),
            factors: 0,
            solutions: 0,
        };
        for &element in factored {
            equilibrium.is_whole[element as usize] = false;
        }
        equilibrium.rebuild()?;
        Ok(equilibrium)
    }

    /// Whether anything is stretched or bent at all.
    pub(crate) fn is_active(&self) -> bool {
        self.is_active.contains(&true)
    }

    /// Elements that broke before and after the factor was made, each in order.
    pub(crate) fn broken(&self) -> (&[u32], &[u32]) {
        (&self.factored, &self.taken)
    }

    /// Whether an element is not broken.
    pub(crate) fn is_whole(&self, element: usize) -> bool {
        self.is_whole[element]
    }

    /// Loads q of an element; none when it is broken or hangs loose.
    pub(crate) fn loads_of(&self, element: usize) -> Option<[f64; PARTS]> {
        self.is_active[element].then(|| self.elements[element].loads(&self.motion))
    }

    pub(crate) fn cost(&self) -> PullCost {
        PullCost {
            unknowns: self.factor.size(),
            stored: self.factor.stored(),
            factors: self.factors,
            solutions: self.solutions,
            iterations: 0,
        }
    }

    /// Whether both jaws still hold one cluster.
    pub(crate) fn is_spanning(&self) -> bool {
        let standing = self.network.standing_without(&self.is_whole);
        standing.contains(&Standing::Spanning)
    }

    /// Factors without what broke, and solves afresh.
    fn rebuild(&mut self) -> Result<(), FrameError> {
        self.factored.append(&mut self.taken);
        let network = self.network;
        let standing = network.standing_without(&self.is_whole);
        let is_solved: Vec<bool> = standing
            .iter()
            .map(|standing| self.clusters.include(*standing))
            .collect();
        E::tear(network, &self.is_whole, &mut self.elements);
        self.is_active.clear();
        let elements = &self.elements;
        let active = elements.iter().zip(&self.is_whole);
        self.is_active.extend(
            active.map(|(element, is_whole)| *is_whole && is_solved[element.first_node() as usize]),
        );

        let active = || {
            elements
                .iter()
                .zip(&self.is_active)
                .filter(|(_, is_active)| **is_active)
        };
        let is_free = |node: usize| is_solved[node] && network.jaw(node).is_none();
        // the old one's memory first
        self.factor = Factor::empty(network)?;
        let pairs = active().flat_map(|(element, _)| element.pairs());
        let (motions, positions) = (network.motions(), network.positions());
        self.factor = Factor::of_pairs(motions, positions, is_free, pairs)?;
        let factor = &mut self.factor;
        factor.clear();
        for (element, _) in active() {
            element.matrices(&mut |nodes, matrix| factor.add(nodes, matrix));
        }
        factor.factor_entries(positions)?;
        self.softening = Softening::new(self.factor.size());
        self.factors += 1;
        self.spent = 0.0;
        self.largest = 0.0;
        self.floor = 0.0;

        for (node, motion) in self.motion.nodes.iter_mut().enumerate() {
            let goes_along = match network.jaw(node) {
                Some(jaw) => jaw == Jaw::Right,
                None => !is_solved[node] && standing[node] == Standing::Hanging(Jaw::Right),
            };
            *motion = Default::default();
            motion[0].x = if goes_along { self.elongation } else { 0.0 };
        }
        self.settle()
    }

    /// Takes an element out; what it carried goes to the others.
    pub(crate) fn remove(&mut self, element: usize) -> Result<(), FrameError> {
        self.is_whole[element] = false;
        let was_active = std::mem::replace(&mut self.is_active[element], false);
        self.taken.push(element as u32);
        if !was_active {
            return Ok(());
        }
        let stiffness = self.elements[element].stiffness().to_vec();
        let is_torn = E::tears(self.network, element);
        if is_torn || !self.is_correction_due(stiffness.len()) || !self.take(element, &stiffness) {
            return self.rebuild();
        }
        self.settle()
    }

    /// Solves for the motion under forces by unknown, in place.
    pub(crate) fn solve(&mut self, right: &mut [f64]) {
        self.factor.solve(right, 1);
        self.softening.correct(right);
        self.solutions += 1;
    }

    /// Moves the free nodes by a share of a solution.
    pub(crate) fn add_to(&self, motion: &mut Motion, change: &[f64], share: f64) {
        let motions = self.network.motions();
        for (place, &node) in self.factor.free().iter().enumerate() {
            let motion = &mut motion.nodes[node as usize];
            for (index, value) in change[place * motions..(place + 1) * motions]
                .iter()
                .enumerate()
            {
                motion[index / 3][index % 3] += share * value;
            }
        }
    }

    fn is_correction_due(&self, springs: usize) -> bool {
        match self.refactoring {
            Refactoring::Always => false,
            Refactoring::Never => true,
            Refactoring::ByCost => self.is_correction_cheap(springs),
        }
    }

    fn is_correction_cheap(&self, springs: usize) -> bool {
        let entries = (self.softening.len() + springs) * self.factor.size();
        let factor_cost =
            self.factor.multiplications() / FACTOR_RATE + self.factor.stored() as f64 / READ_RATE;
        let more = (springs.div_ceil(PARTS) - 1) as f64 * self.factor.stored() as f64 / READ_RATE;
        entries <= self.factor.stored().max(FREE_COLUMNS) && self.spent + more <= factor_cost
    }

    /// Softens the factor by this much of the stiffness of an element's springs, and moves the nodes; false when
    /// the rest would be loose.
    fn take(&mut self, element: usize, stiffness: &[f64]) -> bool {
        let element = &self.elements[element];
        let deformations = element.deformations(&self.motion);
        let size = self.factor.size();
        let mut taken: Vec<(usize, Vec<(u32, f64)>)> = Vec::with_capacity(stiffness.len());
        self.columns.clear();
        for (spring, _) in stiffness.iter().enumerate().filter(|(_, c)| **c != 0.0) {
            let entries = element.column(spring, &self.factor);
            if entries.is_empty() {
                // between nodes that are held
                continue;
            }
            self.columns.resize((taken.len() + 1) * size, 0.0);
            for &(unknown, value) in &entries {
                self.columns[taken.len() * size + unknown as usize] = value;
            }
            taken.push((spring, entries));
        }
        let count = taken.len();
        self.factor.solve(&mut self.columns[..count * size], count);
        self.solutions += 1;
        let mut change = vec![0.0; size];
        for ((spring, entries), column) in taken.iter().zip(self.columns.chunks(size.max(1))) {
            let stiffness = stiffness[*spring];
            let taken = self.softening.take(entries, stiffness, |_, solution| {
                solution.copy_from_slice(column);
            });
            if taken.is_err() {
                return false;
            }
            let load = stiffness * deformations[*spring];
            for (change, value) in change.iter_mut().zip(column) {
                *change += load * value;
            }
        }
        self.softening.correct(&mut change);
        self.spent += (self.softening.len() * size) as f64 / READ_RATE;
        self.move_by(&change);
        true
    }

    fn move_by(&mut self, change: &[f64]) {
        let mut motion = std::mem::replace(&mut self.motion, Motion::rest(0));
        self.add_to(&mut motion, change, 1.0);
        self.motion = motion;
    }

    /// Looks at all elements, and refines until forces balance.
    fn settle(&mut self) -> Result<(), FrameError> {
        let mut before = f64::INFINITY;
        for refinement in 0..=REFINEMENTS {
            self.look();
            let mut right = self.unbalanced(&self.forces);
            let worst = self.worst_force(&right);
            self.largest = self.largest.max(self.forces.scale);
            let scale = self.forces.scale.max(E::NOTHING * self.largest);
            self.residual = worst / scale.max(f64::MIN_POSITIVE);
            let is_round_off = refinement > 0 && worst <= ROUND_OFF * self.forces.round_off;
            let is_at_floor = refinement == 0 && self.residual <= NEAR_FLOOR * self.floor;
            let is_stuck =
                refinement > 0 && self.residual <= UNBALANCED && self.residual > 0.3 * before;
            if self.residual <= BALANCED || is_round_off || is_at_floor || is_stuck {
                if refinement > 0 {
                    self.floor = self.residual;
                }
                return Ok(());
            }
            before = self.residual;
            if refinement < REFINEMENTS {
                self.solve(&mut right);
                self.move_by(&right);
            }
        }
        if self.residual <= UNBALANCED {
            return Ok(());
        }
        Err(FrameError::Unbalanced {
            residual: self.residual,
            allowed: UNBALANCED,
            iterations: REFINEMENTS,
        })
    }

    /// One pass over what is active.
    fn look(&mut self) {
        let network = self.network;
        self.critical = survey_of(
            network,
            &self.elements,
            &self.is_active,
            &self.motion,
            self.gyration,
            &mut self.forces,
        );
    }

    /// Largest of the forces that nothing balances [mN]; moments over the radius of gyration.
    pub(crate) fn worst_force(&self, unbalanced: &[f64]) -> f64 {
        let motions = self.network.motions();
        let mut worst: f64 = 0.0;
        for (unknown, value) in unbalanced.iter().enumerate() {
            let lever = if unknown % motions > 2 {
                self.gyration
            } else {
                1.0
            };
            let force = value.abs() / lever;
            if force.is_nan() {
                return f64::INFINITY;
            }
            worst = worst.max(force);
        }
        worst
    }

    /// Loads less the forces of the elements, by unknown.
    pub(crate) fn unbalanced(&self, forces: &Forces) -> Vec<f64> {
        let motions = self.network.motions();
        let mut right = Vec::with_capacity(self.factor.size());
        for &node in self.factor.free() {
            let node = &forces.nodes[node as usize];
            right.extend((0..motions).map(|motion| -node[motion / 3][motion % 3]));
        }
        for load in self.loads {
            if let Some(first) = self.factor.unknown(load.node as u32) {
                for motion in 0..motions {
                    right[first + motion] +=
                        [load.force_mn, load.moment_mn_um][motion / 3][motion % 3];
                }
            }
        }
        right
    }
}
