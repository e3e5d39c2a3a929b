//! Newton's way to equilibrium under large motions.
//!
//! The matrix is the second derivative of the energy, factored anew in every iteration; where it is not
//! positive definite its diagonal is raised until it is, so that steps go downhill. Moments of fixed axis
//! have no energy: under them convergence is linear instead of quadratic.
use loadframe_numerics::equilibrium::{self, Settled, Unbalanced, halved};
use nalgebra::Vector3;

use super::super::balance::Forces;
use super::super::clusters::{Clusters, Standing};
use super::super::error::FrameError;
use super::super::factor::Factor;
use super::super::input::NodeLoad;
use super::super::load::Rest;
use super::super::network::Network;
use super::super::places::Jaw;
use super::response::{Response, response};
use super::shape::Shape;

/// Forces balance to this share of the largest force of an element.
const BALANCED: f64 = 1e-11;

/// Round-off of a force as a share of a stiffness times the position of its nodes.
const ROUND_OFF: f64 = 2e-14;

/// Iterations before giving up; 5 to 10 are usual.
const ITERATIONS: u32 = 100;

/// Largest rotation in one iteration [rad]: beyond, a step of Newton says little.
const LARGEST_TURN: f64 = 0.5;

/// A step is halved until the force along it falls to this share, but not more often than this.
const SLACK: f64 = 0.8;
const HALVINGS: u32 = 4;

/// A step into what no element can follow is halved so often.
const RETREATS: u32 = 20;

/// What is solved for: the clusters that are held, without what is broken.
#[derive(Debug)]
pub(crate) struct Newton<'n> {
    pub(crate) network: &'n Network,
    pub(crate) is_active: Vec<bool>,
    /// Nodes that go with the right jaw without being held by it.
    followers: Vec<u32>,
    factor: Factor,
    gyration: f64,
}

/// An equilibrium.
#[derive(Debug, Clone)]
pub(crate) struct Found {
    pub(crate) forces: Forces,
    pub(crate) residual: f64,
    pub(crate) iterations: usize,
}

impl<'n> Newton<'n> {
    pub(crate) fn new(
        network: &'n Network,
        is_whole: &[bool],
        clusters: Clusters,
    ) -> Result<Self, FrameError> {
        if !network.hanging().is_empty() {
            return Err(FrameError::Hanging);
        }
        if network.tubes().is_some() {
            return Err(FrameError::Tubes);
        }
        let standing = network.standing_without(is_whole);
        let is_solved = |node: usize| clusters.include(standing[node]);
        let elements = network.elements();
        let is_active: Vec<bool> = elements
            .iter()
            .zip(is_whole)
            .map(|(element, is_whole)| *is_whole && is_solved(element.nodes[0] as usize))
            .collect();
        let is_free = |node: usize| is_solved(node) && network.jaw(node).is_none();
        let active = elements
            .iter()
            .zip(&is_active)
            .filter(|(_, is_active)| **is_active);
        let factor = Factor::new(network, is_free, active.map(|(element, _)| element))?;
        let followers = (0..network.nodes() as u32)
            .filter(|&node| {
                let node = node as usize;
                let is_held = network.jaw(node).is_some();
                !is_held && !is_solved(node) && standing[node] == Standing::Hanging(Jaw::Right)
            })
            .collect();
        Ok(Self {
            network,
            is_active,
            followers,
            factor,
            gyration: network.gyration_um(),
        })
    }

    /// Moves the right jaw on by `by_um`; all that is stretched goes along by its place between the jaws.
    pub(crate) fn elongate(&self, shape: &mut Shape, by_um: f64) {
        let length = self.network.model().length_um;
        for node in 0..self.network.nodes() {
            if self.network.jaw(node) == Some(Jaw::Right) {
                shape.positions[node].x += by_um;
            }
        }
        for &node in self.factor.free() {
            let share = self.network.positions()[node as usize].x / length;
            shape.positions[node as usize].x += by_um * share;
        }
        for &node in &self.followers {
            shape.positions[node as usize].x += by_um;
        }
    }

    /// Goes to the equilibrium from a shape near it; loads count by `share`.
    pub(crate) fn settle(
        &mut self,
        shape: &mut Shape,
        loads: &[NodeLoad],
        share: f64,
    ) -> Result<Found, FrameError> {
        let unbalanced = |residual, iterations: u32| FrameError::Unbalanced {
            residual,
            allowed: BALANCED,
            iterations: iterations as usize,
        };
        let forces = self
            .look(shape)
            .ok_or_else(|| unbalanced(f64::INFINITY, 0))?;
        let right = self.unbalanced(&forces, loads, share);
        let mut way = Way {
            newton: self,
            shape,
            loads,
            share,
            forces,
            right,
            residual: f64::INFINITY,
        };
        match equilibrium::settle(&mut way, ITERATIONS)? {
            Settled::AtRest(steps) => Ok(Found {
                forces: way.forces,
                residual: way.residual,
                iterations: steps as usize,
            }),
            Settled::Stuck(steps) => Err(unbalanced(way.residual, steps)),
            Settled::Slow => Err(unbalanced(way.residual, ITERATIONS)),
        }
    }

    /// All active elements in a shape; none where one cannot follow it.
    pub(crate) fn responses<'s>(
        &'s self,
        shape: &'s Shape,
    ) -> impl Iterator<Item = (usize, Option<Response>)> + 's {
        let active = self
            .is_active
            .iter()
            .enumerate()
            .filter(|(_, is_active)| **is_active);
        active.map(|(index, _)| (index, response(self.network, index, shape)))
    }

    fn look(&self, shape: &Shape) -> Option<Forces> {
        let mut forces = Forces::new(self.network.nodes());
        for (index, response) in self.responses(shape) {
            let response = response?;
            let element = &self.network.elements()[index];
            forces.add_ends(element.nodes, &response.ends(), self.gyration);
            forces.energy += response.energy;
            let farthest = shape.positions[element.nodes[0] as usize].amax();
            forces.round_off = forces.round_off.max(element.stiffness[0] * farthest);
        }
        Some(forces)
    }

    fn factor(&mut self, shape: &Shape) -> Result<(), FrameError> {
        let Self {
            network,
            is_active,
            factor,
            ..
        } = self;
        let network = *network;
        let active = is_active
            .iter()
            .enumerate()
            .filter(|(_, is_active)| **is_active);
        let matrices = active.filter_map(|(index, _)| {
            let response = response(network, index, shape)?;
            Some((network.elements()[index].nodes, response.matrix()))
        });
        let mut outcome = factor.factor(network, matrices);
        let mut share = 1e-8;
        while outcome.is_err() && share < 10.0 {
            outcome = factor.factor_shifted(network.positions(), share);
            share *= 10.0;
        }
        outcome
    }

    fn unbalanced(&self, forces: &Forces, loads: &[NodeLoad], share: f64) -> Vec<f64> {
        let motions = self.network.motions();
        let mut right = Vec::with_capacity(self.factor.size());
        for &node in self.factor.free() {
            let node = &forces.nodes[node as usize];
            right.extend((0..motions).map(|motion| -node[motion / 3][motion % 3]));
        }
        for load in loads {
            if let Some(first) = self.factor.unknown(load.node as u32) {
                for motion in 0..motions {
                    let value = [load.force_mn, load.moment_mn_um][motion / 3][motion % 3];
                    right[first + motion] += share * value;
                }
            }
        }
        right
    }

    fn worst(&self, right: &[f64]) -> f64 {
        let motions = self.network.motions();
        right
            .iter()
            .enumerate()
            .fold(0.0, |worst: f64, (unknown, value)| {
                let lever = if unknown % motions > 2 {
                    self.gyration
                } else {
                    1.0
                };
                worst.max(value.abs() / lever)
            })
    }

    fn largest_turn(&self, step: &[f64]) -> f64 {
        let motions = self.network.motions();
        let turns = step
            .iter()
            .enumerate()
            .filter(|(unknown, _)| unknown % motions > 2);
        turns.fold(f64::MIN_POSITIVE, |largest, (_, value)| {
            largest.max(value.abs())
        })
    }

    fn step(&self, shape: &mut Shape, step: &[f64], length: f64) {
        let motions = self.network.motions();
        for (place, &node) in self.factor.free().iter().enumerate() {
            let step = &step[place * motions..(place + 1) * motions];
            let shift = Vector3::from_column_slice(&step[..3]) * length;
            let turn = match step.get(3..6) {
                Some(turn) => Vector3::from_column_slice(turn) * length,
                None => Vector3::zeros(),
            };
            shape.step(node as usize, shift, turn);
        }
    }
}

/// The way to an equilibrium.
struct Way<'w, 'n> {
    newton: &'w mut Newton<'n>,
    shape: &'w mut Shape,
    loads: &'w [NodeLoad],
    share: f64,
    forces: Forces,
    right: Vec<f64>,
    residual: f64,
}

impl equilibrium::Newton for Way<'_, '_> {
    type Failure = FrameError;

    fn is_at_rest(&mut self, _: u32) -> Result<bool, FrameError> {
        let left = Unbalanced {
            largest: self.newton.worst(&self.right),
            scale: self.forces.scale,
            round_off: ROUND_OFF * self.forces.round_off,
        };
        self.residual = left.share();
        Ok(left.is_within(BALANCED))
    }

    fn advance(&mut self) -> Result<bool, FrameError> {
        self.newton.factor(self.shape)?;
        let newton = &*self.newton;
        let mut step = self.right.clone();
        newton.factor.solve(&mut step, 1);
        let length = (LARGEST_TURN / newton.largest_turn(&step)).min(1.0);
        let along = |right: &[f64]| right.iter().zip(&step).map(|(r, s)| r * s).sum::<f64>();
        let before = along(&self.right);
        halved(length, RETREATS, |length, halvings| {
            let mut trial = self.shape.clone();
            newton.step(&mut trial, &step, length);
            let Some(there) = newton.look(&trial) else {
                return Ok(false);
            };
            let remaining = newton.unbalanced(&there, self.loads, self.share);
            let is_down = along(&remaining).abs() <= SLACK * before.abs();
            let is_taken = is_down || halvings >= HALVINGS;
            if is_taken {
                *self.shape = trial;
                self.forces = there;
                self.right = remaining;
            }
            Ok(is_taken)
        })
    }
}

impl Network {
    /// Rest for displacements and rotations of any size: elongation and loads grow in `steps` equal steps.
    /// Elements turn by less than a right angle against their chord, so curved fibres want short segments.
    ///
    /// # Errors
    /// [`FrameError`] when a load is not on a held cluster, or equilibrium is not found.
    pub fn rest_at_large(
        &self,
        elongation_um: f64,
        loads: &[NodeLoad],
        steps: usize,
    ) -> Result<Rest, FrameError> {
        self.check_loads(elongation_um, loads)?;
        let steps = steps.max(1);
        let mut newton = Newton::new(self, &self.unbroken(), Clusters::Held)?;
        let mut shape = Shape::of(self);
        let mut iterations = 0;
        let mut found = None;
        for step in 1..=steps {
            newton.elongate(&mut shape, elongation_um / steps as f64);
            let rest = newton.settle(&mut shape, loads, step as f64 / steps as f64)?;
            iterations += rest.iterations;
            found = Some(rest);
        }
        let (forces, residual) = match found {
            Some(found) => (found.forces, found.residual),
            None => (Forces::new(self.nodes()), 0.0),
        };
        let moved = shape.positions.iter().zip(self.positions());
        Ok(Rest {
            displacement_um: moved.map(|(now, before)| (now - before).into()).collect(),
            rotation: shape
                .turns
                .iter()
                .map(|turn| turn.scaled_axis().into())
                .collect(),
            jaw_force_mn: forces.at_jaws(self.jaws()),
            energy_nj: forces.energy,
            residual,
            iterations,
        })
    }
}
