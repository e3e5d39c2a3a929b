//! The rest of a network by conjugate gradients, from one break to the next.
//!
//! Every solution starts from the last one, and stops when what breaks next is known well enough. How well it
//! is known is what the last iterations changed of failure indices, about the error that there was before them:
//! of parts that break one by one the largest, of those that break together the root mean square, for there one
//! of thousands that goes a round too soon or too late is no matter, and the last one is what takes most
//! iterations. For how small an error in energy to ask goes by what no part exceeds: a spring of stiffness c
//! carries an error of at most √c √(eᵀKe). All parts share the error, so that each has a small part of that.
use std::sync::Arc;

use loadframe_numerics::{Team, equilibrium::Ended};
use nalgebra::Vector3;

use super::super::balance::{Forces, Motion};
use super::super::clusters::{Clusters, Standing};
use super::super::element::PARTS;
use super::super::equilibrium::UNBALANCED;
use super::super::error::FrameError;
use super::super::input::{Level, NodeLoad};
use super::super::network::Network;
use super::super::places::Jaw;
use super::super::state::PullCost;
use super::super::survey::{Critical, breaks_at, survey};
use super::scalar::Scalar;
use super::system::{Activity, Equations, System};

/// Failure indices of parts that break together are known to this share of the precision with which they do.
const OF_PRECISION: f64 = 0.1;
/// Where parts break one by one, failure indices are known to this share.
const ONE_BY_ONE: f64 = 1e-7;
/// Error in energy that is left at most, as a share of the motion's own, √(eᵀKe)/√(uᵀKu), or over the precision if
/// that is larger. The force of the jaws is off by the square of it.
const ENERGY_ERROR: f64 = 1e-3;
const ENERGY_OF_PRECISION: f64 = 0.06;
/// Unbalanced force over the largest force of an element that is left at most, over the precision. That is one node
/// of all, as far from rest as none else.
const UNBALANCED_OF_PRECISION: f64 = 0.5;
/// How many times the error in energy is asked for that would leave the tolerance if all of it were in the part that
/// breaks next. In a sheet of 1157 fibres its index was off by a 500th to a 1400th of that bound.
const SPREAD: f64 = 100.0;
/// Indices down to this share of the largest are looked at for what the last iterations changed.
const LOOKED_AT: f64 = 0.5;
/// The same where nothing says what breaks.
const ALONE: f64 = 1e-9;
/// The factor of bodies is made anew when this share of the elements broke since: a stale one costs iterations.
const STALE: f64 = 0.002;
/// Forces that balance to this share of the largest are at the floor of round-off.
const FLOOR: f64 = 1e-10;
/// How much less of an error is asked for where forces are not in balance yet, and beyond what indices lack.
const SHARPER: f64 = 0.1;
const INDEX_SHARPER: f64 = 0.5;
/// Solutions for one rest before giving up: each knows better what is wanted.
const ROUNDS: usize = 12;

/// From where a solution starts, and how well what breaks next is to be known.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Start<'a> {
    /// How far over their strength parts are that break together; 0: they break one by one.
    pub(crate) break_precision: f64,
    /// Whether a truss has rigid groups however small it is.
    pub(crate) is_grouped: bool,
    /// The motion that is the solution already; empty: none is known.
    pub(crate) motion: &'a [f64],
}

/// A network at rest.
#[derive(Debug)]
pub(crate) struct Relaxation<'n> {
    pub(crate) network: &'n Network,
    clusters: Clusters,
    loads: &'n [NodeLoad],
    elongation: f64,
    break_precision: f64,
    gyration: f64,
    is_whole: Vec<bool>,
    activity: Activity,
    system: Box<dyn System + 'n>,
    /// Elements that broke before the factor of bodies was made, and after.
    factored: Vec<u32>,
    taken: Vec<u32>,
    /// Error in energy at which the next solution may end.
    wanted: f64,
    pub(crate) motion: Motion,
    changes: Motion,
    pub(crate) forces: Forces,
    pub(crate) critical: Option<Critical>,
    pub(crate) residual: f64,
    /// Estimated error of the failure indices of what breaks next.
    pub(crate) index_error: f64,
    factors: usize,
    solutions: usize,
    iterations: usize,
}

impl<'n> Relaxation<'n> {
    /// Finds the rest without the elements `factored` and `taken`; that of bodies knows only that the
    /// first are gone.
    pub(crate) fn new(
        network: &'n Network,
        clusters: Clusters,
        (elongation, loads): (f64, &'n [NodeLoad]),
        team: Arc<Team>,
        start: Start<'_>,
        (factored, taken): (&[u32], &[u32]),
    ) -> Result<Self, FrameError> {
        let mut is_whole = network.unbroken();
        for &element in factored {
            is_whole[element as usize] = false;
        }
        let (activity, _) = stand(network, clusters, &is_whole);
        let means = (team, start.is_grouped);
        let given = (network, is_whole.as_slice(), &activity, loads);
        // without nodes at bonds no segment is so short beside others that single precision loses it, nor does it lose
        // what taut bars resist across
        let is_even = !network.hanging().is_empty();
        let system = match network.model().level {
            Level::Beam if is_even => system::<f32, 6>(given, means)?,
            Level::Beam | Level::Tube => system::<f64, 6>(given, means)?,
            Level::Truss if is_even && start.is_grouped => system::<f32, 3>(given, means)?,
            Level::Truss => system::<f64, 3>(given, means)?,
        };
        let mut relaxation = Self {
            network,
            clusters,
            loads,
            elongation,
            break_precision: start.break_precision,
            gyration: network.gyration_um(),
            is_whole,
            activity,
            system,
            factored: factored.to_vec(),
            taken: Vec::new(),
            wanted: f64::INFINITY,
            motion: Motion::rest(network.nodes()),
            changes: Motion::rest(network.nodes()),
            forces: Forces::new(network.nodes()),
            critical: None,
            residual: 0.0,
            index_error: 0.0,
            factors: 1,
            solutions: 0,
            iterations: 0,
        };
        let taken: Vec<usize> = taken.iter().map(|&element| element as usize).collect();
        relaxation.take(&taken)?;
        if start.motion.is_empty() {
            relaxation.stretch();
            relaxation.settle()?;
        } else {
            relaxation.system.set_flat(start.motion)?;
            relaxation.look();
        }
        Ok(relaxation)
    }

    pub(crate) fn is_active(&self, element: usize) -> bool {
        self.activity.is_active[element]
    }

    pub(crate) fn is_any_active(&self) -> bool {
        self.activity.is_active.contains(&true)
    }

    pub(crate) fn is_whole(&self, element: usize) -> bool {
        self.is_whole[element]
    }

    pub(crate) fn broken(&self) -> (&[u32], &[u32]) {
        (&self.factored, &self.taken)
    }

    /// The motion of all nodes of fibres, to go on from.
    pub(crate) fn flat_motion(&self) -> &[f64] {
        self.system.flat()
    }

    pub(crate) fn loads_of(&self, element: usize) -> Option<[f64; PARTS]> {
        self.is_active(element).then(|| {
            let element = &self.network.elements()[element];
            element.loads(&element.deformation(&self.motion.ends(element)))
        })
    }

    pub(crate) fn is_spanning(&self) -> bool {
        let standing = self.network.standing_without(&self.is_whole);
        standing.contains(&Standing::Spanning)
    }

    pub(crate) fn cost(&self) -> PullCost {
        let [_, stored] = self.system.bodies();
        let free = self.activity.is_free.iter().filter(|is_free| **is_free);
        PullCost {
            unknowns: free.count() * self.network.motions(),
            stored,
            factors: self.factors,
            solutions: self.solutions,
            iterations: self.iterations,
        }
    }

    /// Takes elements out; what they carried goes to the others.
    pub(crate) fn remove(&mut self, elements: &[usize]) -> Result<(), FrameError> {
        self.take(elements)?;
        let most = STALE * self.network.elements().len() as f64;
        if self.taken.len() as f64 > most {
            self.factored.append(&mut self.taken);
            self.system.renew()?;
            self.factors += 1;
        }
        self.settle()
    }

    fn take(&mut self, elements: &[usize]) -> Result<(), FrameError> {
        for &element in elements {
            self.is_whole[element] = false;
            self.taken.push(element as u32);
        }
        let (activity, standing) = stand(self.network, self.clusters, &self.is_whole);
        // what came loose goes with its jaw, or stays
        let nodes = standing.iter().enumerate();
        for (node, standing) in nodes.take(self.network.fibre_nodes()) {
            if !activity.is_free[node] {
                let along = match self.network.jaw(node) {
                    Some(jaw) => jaw == Jaw::Right,
                    None => *standing == Standing::Hanging(Jaw::Right),
                };
                let shift = if along { self.elongation } else { 0.0 };
                let shift = Vector3::x() * shift;
                self.system.set(node, [shift, Vector3::zeros()]);
            }
        }
        self.system.change(&activity, &self.is_whole, elements)?;
        self.activity = activity;
        Ok(())
    }

    /// A first guess: everything is stretched alike.
    fn stretch(&mut self) {
        let length = self.network.model().length_um;
        for node in 0..self.network.fibre_nodes() {
            if self.activity.is_free[node] {
                let share = self.network.position_um(node)[0] / length;
                let shift = Vector3::x() * (share * self.elongation);
                self.system.set(node, [shift, Vector3::zeros()]);
            }
        }
    }

    fn settle(&mut self) -> Result<(), FrameError> {
        if !self.is_any_active() {
            self.look();
            return Ok(());
        }
        if self.wanted.is_infinite() {
            let share = if self.loads.is_empty() {
                self.energy_share()
            } else {
                0.0
            };
            self.wanted = share * self.system.energy_norm();
        }
        let mut iterations = 0;
        let mut was_at_floor = false;
        for _ in 0..ROUNDS {
            let iterated = self.system.solve(self.wanted);
            iterations += iterated.iterations;
            self.solutions += 1;
            self.iterations += iterated.iterations;
            self.look();
            let is_at_floor = self.residual <= FLOOR;
            if iterated.ended != Ended::Near && !is_at_floor {
                break;
            }
            self.index_error = self.changed_index();
            let is_balanced = self.residual <= self.limit();
            let is_known = self.index_error <= self.tolerance();
            if iterated.error <= self.wanted && is_known && is_balanced {
                return Ok(());
            }
            // where a factor of all leaves nothing at once, what its first iterations moved tells of no error: another
            // round does
            if is_at_floor && (is_known || was_at_floor) {
                return Ok(());
            }
            was_at_floor = is_at_floor;
            if !is_known {
                let share = INDEX_SHARPER * self.tolerance() / self.index_error;
                self.wanted = self.wanted.min(share * iterated.error);
            }
            if !is_balanced {
                self.wanted = self.wanted.min(SHARPER * iterated.error);
            }
        }
        Err(FrameError::Unbalanced {
            residual: self.residual,
            allowed: self.limit(),
            iterations,
        })
    }

    /// Error of failure indices that is left at most.
    pub(crate) fn tolerance(&self) -> f64 {
        (OF_PRECISION * self.break_precision).max(ONE_BY_ONE)
    }

    /// Unbalanced force over the largest force of an element that is left at most.
    pub(crate) fn limit(&self) -> f64 {
        (UNBALANCED_OF_PRECISION * self.break_precision).max(UNBALANCED)
    }

    /// Error in energy that is left at most where something may break, over √(uᵀKu).
    fn energy_share(&self) -> f64 {
        ENERGY_ERROR.max(ENERGY_OF_PRECISION * self.break_precision)
    }

    /// One pass over what is active: forces, what breaks first, and how well it must be known.
    fn look(&mut self) {
        self.system.read(&mut self.motion.nodes);
        let active = &self.activity.is_active;
        self.critical = survey(
            self.network,
            active,
            &self.motion,
            self.gyration,
            &mut self.forces,
        );
        self.system.spread(&mut self.forces.nodes);
        self.residual = self.worst_force() / self.forces.scale.max(f64::MIN_POSITIVE);
        let share = if self.critical.is_some() {
            self.energy_share()
        } else {
            ALONE
        };
        let by_energy = share * (2.0 * self.forces.energy).sqrt();
        self.wanted =
            by_energy.min(SPREAD * self.tolerance() / self.sensitivity().max(f64::MIN_POSITIVE));
    }

    /// What the last iterations changed of failure indices near that of what breaks next, over the latter: the root
    /// mean square, or the most where parts break one by one.
    fn changed_index(&mut self) -> f64 {
        let Some(critical) = self.critical else {
            return 0.0;
        };
        self.system.read_change(&mut self.changes.nodes);
        let (mut most, mut squares, mut parts): (f64, f64, f64) = (0.0, 0.0, 0.0);
        for part in 0..self.network.parts() {
            let Some(loads) = self.loads_of(part) else {
                continue;
            };
            let index = critical.factor / breaks_at(self.network, part, &loads);
            if index >= LOOKED_AT {
                let element = &self.network.elements()[part];
                let change = element.loads(&element.deformation(&self.changes.ends(element)));
                let before = std::array::from_fn(|spring| loads[spring] - change[spring]);
                let before = critical.factor / breaks_at(self.network, part, &before);
                let changed = index - before;
                most = most.max(changed.abs());
                squares += changed * changed;
                parts += 1.0;
            }
        }
        if self.break_precision > 0.0 {
            (squares / parts.max(1.0)).sqrt()
        } else {
            most
        }
    }

    /// Most that an error in energy of 1 changes the failure index of what breaks next, over itself.
    fn sensitivity(&self) -> f64 {
        let Some(critical) = self.critical else {
            return 0.0;
        };
        let segments = self.network.segments();
        let stiffness = self.network.elements()[critical.element].stiffness;
        let per_error = if critical.element >= segments {
            let [normal, shear] = self.network.strengths(critical.element - segments);
            stiffness[0].sqrt() / normal.min(shear)
        } else {
            let section = self.network.section_of(critical.element);
            let bent = stiffness[1].max(stiffness[4]).sqrt();
            let lever = 0.5 * section.width_um / section.inertia_um4;
            let bent = match self.network.model().level {
                // two moments, each about two axes
                Level::Beam | Level::Tube => 2.0 * bent * lever,
                Level::Truss => 0.0,
            };
            let strength = section.strength_gpa.unwrap_or(f64::INFINITY);
            (stiffness[0].sqrt() / section.area_um2 + bent) / strength
        };
        per_error * critical.factor
    }

    /// Largest of the forces that nothing balances [mN]; moments over the radius of gyration.
    fn worst_force(&self) -> f64 {
        let mut worst: f64 = 0.0;
        let mut loads: Vec<[Vector3<f64>; 2]> = Vec::new();
        if !self.loads.is_empty() {
            loads.resize(self.network.nodes(), Default::default());
            for load in self.loads {
                loads[load.node][0] += Vector3::from(load.force_mn);
                loads[load.node][1] += Vector3::from(load.moment_mn_um);
            }
            self.system.spread(&mut loads);
        }
        for (node, is_free) in self.activity.is_free.iter().enumerate() {
            if *is_free {
                let load = loads.get(node).copied().unwrap_or_default();
                let [force, moment] =
                    [0, 1].map(|part| (self.forces.nodes[node][part] - load[part]).amax());
                let moment = match self.network.model().level {
                    Level::Beam | Level::Tube => moment / self.gyration,
                    Level::Truss => 0.0,
                };
                if force.is_nan() || moment.is_nan() {
                    return f64::INFINITY;
                }
                worst = worst.max(force).max(moment);
            }
        }
        worst
    }
}

fn system<'n, T: Scalar, const M: usize>(
    (network, is_whole, activity, loads): (&'n Network, &[bool], &Activity, &[NodeLoad]),
    (team, is_grouped): (Arc<Team>, bool),
) -> Result<Box<dyn System + 'n>, FrameError> {
    let loads = (loads, is_grouped);
    let equations = Equations::<T, M>::new(network, team, is_whole, activity, loads)?;
    Ok(Box::new(equations))
}

/// What takes part when only these elements are whole, and what every point is held by.
fn stand(network: &Network, clusters: Clusters, is_whole: &[bool]) -> (Activity, Vec<Standing>) {
    let standing = network.standing_without(is_whole);
    let is_solved = |node: usize| clusters.include(standing[node]);
    let elements = network.elements().iter().zip(is_whole);
    let is_active = elements
        .map(|(element, is_whole)| *is_whole && is_solved(element.nodes[0] as usize))
        .collect();
    let is_free = (0..network.fibre_nodes())
        .map(|node| is_solved(node) && network.jaw(node).is_none())
        .collect();
    let activity = Activity { is_active, is_free };
    (activity, standing)
}
