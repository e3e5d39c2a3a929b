//! The equations of a network: what is active, its preconditioner, and the motion that solves them.
use std::sync::Arc;

use loadframe_numerics::{
    Team,
    equilibrium::{Enough, Found, Gradients, Preconditioned},
};
use nalgebra::Vector3;

use super::super::error::FrameError;
use super::super::input::NodeLoad;
use super::super::network::Network;
use super::cycle::Cycle;
use super::operator::{Nodal, Operator};
use super::points::{ends_of, flat, parts};
use super::scalar::Scalar;

/// Iterations before giving up. Some 100 are usual.
const ITERATIONS: usize = 20_000;

/// What takes part in equilibrium.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Activity {
    /// Elements that are whole and of a cluster that is solved for.
    pub(super) is_active: Vec<bool>,
    /// Nodes of fibres that move by what acts on them.
    pub(super) is_free: Vec<bool>,
}

/// Equations of three or six motions per node.
pub(super) trait System: std::fmt::Debug {
    /// Goes over to another activity, after elements broke.
    fn change(
        &mut self,
        to: &Activity,
        is_whole: &[bool],
        broken: &[usize],
    ) -> Result<(), FrameError>;
    /// Makes groups and the factor of their motions anew.
    fn renew(&mut self) -> Result<(), FrameError>;
    /// Moves the nodes until the error in energy is about `wanted`.
    fn solve(&mut self, wanted: f64) -> Found;
    /// √(uᵀKu) of what is free.
    fn energy_norm(&mut self) -> f64;
    /// Motions of a node, and of all in a row.
    fn set(&mut self, node: usize, motion: [Vector3<f64>; 2]);
    fn flat(&self) -> &[f64];
    /// # Errors
    /// [`FrameError::ForeignState`] when there are more or fewer.
    fn set_flat(&mut self, motions: &[f64]) -> Result<(), FrameError>;
    /// Displacement and rotation of every point, those of bonds between nodes included.
    fn read(&self, points: &mut [[Vector3<f64>; 2]]);
    /// The same of what the last iterations of the last solution moved.
    fn read_change(&mut self, points: &mut [[Vector3<f64>; 2]]);
    /// Gives what acts on points of bonds to the nodes that these move with.
    fn spread(&self, points: &mut [[Vector3<f64>; 2]]);
    /// Unknowns of the bodies, and the numbers that their factor stores.
    fn bodies(&self) -> [usize; 2];
}

#[derive(Debug)]
pub(super) struct Equations<'n, T, const M: usize> {
    operator: Operator<'n, M>,
    cycle: Cycle<T, M>,
    vectors: Gradients<M>,
    motion: Nodal<M>,
    changes: Nodal<M>,
    loads: Nodal<M>,
    team: Arc<Team>,
}

impl<'n, T: Scalar, const M: usize> Equations<'n, T, M> {
    pub(super) fn new(
        network: &'n Network,
        team: Arc<Team>,
        is_whole: &[bool],
        activity: &Activity,
        (loads, is_grouped): (&[NodeLoad], bool),
    ) -> Result<Self, FrameError> {
        let mut operator = Operator::new(network, is_whole);
        operator.is_grouped = is_grouped;
        for (element, &is_active) in activity.is_active.iter().enumerate() {
            operator.set_active(element, is_active);
        }
        operator.is_free.copy_from_slice(&activity.is_free);
        let nodes = network.fibre_nodes();
        let mut points = vec![[Vector3::zeros(); 2]; network.nodes()];
        for load in loads {
            points[load.node][0] += Vector3::from(load.force_mn);
            points[load.node][1] += Vector3::from(load.moment_mn_um);
        }
        let mut equations = Self {
            cycle: Cycle::new(&operator, &team)?,
            vectors: Gradients::new(nodes),
            motion: vec![[0.0; M]; nodes],
            changes: Vec::with_capacity(nodes),
            loads: Vec::new(),
            operator,
            team,
        };
        equations.spread(&mut points);
        equations.loads = points[..nodes].iter().copied().map(flat).collect();
        Ok(equations)
    }
}

/// What is active, and what it is preconditioned by.
struct Active<'a, 'n, T, const M: usize> {
    operator: &'a mut Operator<'n, M>,
    cycle: &'a mut Cycle<T, M>,
    team: &'a Team,
}

impl<T: Scalar, const M: usize> Preconditioned<M> for Active<'_, '_, T, M> {
    fn apply(&mut self, motion: &[[f64; M]], forces: &mut [[f64; M]]) -> f64 {
        self.operator.apply(self.team, motion, forces)
    }

    fn precondition(&mut self, residual: &[[f64; M]], corrected: &mut [[f64; M]]) -> f64 {
        self.cycle
            .solve(self.operator, self.team, residual, corrected)
    }
}

impl<T: Scalar, const M: usize> System for Equations<'_, T, M> {
    fn change(
        &mut self,
        to: &Activity,
        is_whole: &[bool],
        broken: &[usize],
    ) -> Result<(), FrameError> {
        let network = self.operator.network;
        let segments = network.segments();
        let mut fibres: Vec<usize> = Vec::new();
        for &element in broken {
            if element < segments {
                self.operator
                    .tie_again(network.segment_fibre(element), is_whole);
                fibres.push(network.segment_fibre(element));
            }
        }
        for (element, &is_active) in to.is_active.iter().enumerate() {
            if self.operator.is_active[element] != is_active {
                self.operator.set_active(element, is_active);
                match element.checked_sub(segments) {
                    None => fibres.push(network.segment_fibre(element)),
                    Some(bond) => {
                        let ends = self.operator.ties(bond);
                        fibres.extend(ends.iter().map(|tie| network.fibre_of(tie.nodes[0])));
                    }
                }
            }
        }
        for (node, &is_free) in to.is_free.iter().enumerate() {
            if self.operator.is_free[node] != is_free {
                self.operator.is_free[node] = is_free;
                fibres.push(network.fibre_of(node as u32));
            }
        }
        fibres.sort_unstable();
        fibres.dedup();
        for fibre in fibres {
            self.cycle.factor_again(&self.operator, fibre)?;
        }
        Ok(())
    }

    fn renew(&mut self) -> Result<(), FrameError> {
        self.cycle.renew(&self.operator)
    }

    fn solve(&mut self, wanted: f64) -> Found {
        let Self {
            operator,
            cycle,
            vectors,
            motion,
            loads,
            team,
            ..
        } = self;
        team.gather(|| {
            operator.lack(team, motion, loads, &mut vectors.residual);
            let mut active = Active {
                operator,
                cycle,
                team,
            };
            let enough = Enough::EnergyError(wanted);
            vectors.solve(&mut active, team, motion, enough, ITERATIONS)
        })
    }

    fn energy_norm(&mut self) -> f64 {
        let squared = self
            .operator
            .apply(&self.team, &self.motion, &mut self.vectors.residual);
        squared.abs().sqrt()
    }

    fn set(&mut self, node: usize, motion: [Vector3<f64>; 2]) {
        self.motion[node] = flat(motion);
    }

    fn flat(&self) -> &[f64] {
        self.motion.as_flattened()
    }

    fn set_flat(&mut self, motions: &[f64]) -> Result<(), FrameError> {
        let own = self.motion.as_flattened_mut();
        if own.len() != motions.len() {
            return Err(FrameError::ForeignState {
                what: "motion",
                index: motions.len(),
                count: own.len(),
            });
        }
        own.copy_from_slice(motions);
        Ok(())
    }

    fn read(&self, points: &mut [[Vector3<f64>; 2]]) {
        read(&self.operator, &self.motion, points);
    }

    fn read_change(&mut self, points: &mut [[Vector3<f64>; 2]]) {
        let moved = self.motion.iter().zip(self.vectors.earlier());
        self.changes.clear();
        self.changes.extend(
            moved.map(|(now, earlier)| std::array::from_fn(|motion| now[motion] - earlier[motion])),
        );
        read(&self.operator, &self.changes, points);
    }

    fn spread(&self, points: &mut [[Vector3<f64>; 2]]) {
        let network = self.operator.network;
        let nodes = network.fibre_nodes();
        for bond in 0..network.bonds() {
            let ties = self.operator.ties(bond);
            let element = &network.elements()[network.segments() + bond];
            for (tie, point) in ties.iter().zip(element.nodes) {
                if point as usize >= nodes {
                    let forces = tie.spread(std::mem::take(&mut points[point as usize]));
                    for (end, node) in tie.nodes.into_iter().enumerate() {
                        points[node as usize][0] += forces[2 * end];
                        points[node as usize][1] += forces[2 * end + 1];
                    }
                }
            }
        }
    }

    fn bodies(&self) -> [usize; 2] {
        self.cycle.size()
    }
}

/// Displacement and rotation of every point that a motion of the nodes leads to.
fn read<const M: usize>(
    operator: &Operator<'_, M>,
    motion: &[[f64; M]],
    points: &mut [[Vector3<f64>; 2]],
) {
    let network = operator.network;
    for (point, motion) in points.iter_mut().zip(motion) {
        *point = parts(motion);
    }
    for bond in 0..network.bonds() {
        let element = &network.elements()[network.segments() + bond];
        for (tie, point) in operator.ties(bond).iter().zip(element.nodes) {
            if point as usize >= network.fibre_nodes() {
                points[point as usize] = tie.motion(&ends_of(motion, tie.nodes));
            }
        }
    }
}
