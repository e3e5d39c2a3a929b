//! Static equilibrium: the displacements at which all free forces vanish.
//!
//! Small displacements need one solution of linear equations, refined until round-off. Large ones
//! follow the load in steps; each step is Newton's method on the potential energy
//!
//! Π(u) = U(u) - λ f · u   (5)
//!
//! with a line search that only ever goes downhill and never turns a cell inside out. Where the
//! tangent is not positive definite (the section buckles), the convex part of it leads on downhill. From
//! a straight section that is pushed along its axis no way aside goes downhill at first, so that what is found
//! may be a saddle; whether it is, [`Search::is_stable`] tells.
//!
//! What looks for a rest and what asks whether it is stable have their equations in common: one file.
use crate::error::CompositeError;
use crate::lattice::{Geometry, Lattice, Tangent};
use crate::matrix::{GridMatrix, dot};
use crate::solve::circles::Circles;
use crate::solve::equations::{Equations, Method, told};
use crate::supports::Supports;
use loadframe_numerics::NoFactor;
use loadframe_numerics::equilibrium::{Newton, Settled, Unbalanced, halved, settle};
use serde::{Deserialize, Serialize};

/// How an equilibrium is looked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StaticOptions {
    pub geometry: Geometry,
    pub method: Method,
    /// Equal steps of the load, for large displacements; cut where needed.
    pub load_steps: u32,
    /// Largest unbalanced force over the largest force, at which Newton's method ends.
    pub tolerance: f64,
}

impl Default for StaticOptions {
    fn default() -> Self {
        Self {
            geometry: Geometry::Linear,
            method: Method::Automatic,
            load_steps: 1,
            // Far above round-off of 80 000 particles, far below any other error.
            tolerance: 1e-9,
        }
    }
}

/// A lattice at rest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Equilibrium {
    /// x and y by turns, particle by particle [mm].
    pub displacements_mm: Vec<f64>,
    /// Forces the supports exert; 0 where nothing is held [N].
    pub reactions_n: Vec<f64>,
    /// Elastic energy [N mm].
    pub energy_n_mm: f64,
    /// Largest unbalanced force over the largest force on a particle.
    pub residual: f64,
    /// Sum of all loads and reactions over the sum of their sizes, the worse axis.
    pub reaction_error: f64,
    /// Solutions of linear equations, and iterations of conjugate gradients in them.
    pub solutions: u64,
    pub iterations: u64,
}

/// Solutions of the linear equations after which refining them further is of no use.
const REFINEMENTS: u64 = 4;
/// Newton iterations in one load step.
const NEWTON_ITERATIONS: u32 = 60;
/// Halvings of one of their steps.
const HALVINGS: u32 = 29;
/// As near as round-off allows is near enough within so many tolerances.
const STUCK_NEAR: f64 = 1e3;
/// Round-off of a particle's force in products of its stiffness, the largest displacement and the spacing of
/// numbers: a sum of 32 of them, each rounded.
const ROUNDED: f64 = 8.0;

pub(super) struct Search<'a> {
    pub(super) lattice: &'a Lattice,
    supports: &'a Supports,
    load: &'a [f64],
    options: &'a StaticOptions,
    matrix: GridMatrix,
    equations: Equations,
    /// What stands in the way of faces.
    pub(super) circles: Circles,
    pub(super) u: Vec<f64>,
    pub(super) forces: Vec<f64>,
    right: Vec<f64>,
    step: Vec<f64>,
    trial: Vec<f64>,
    energy: f64,
    /// Of the forces at u [N], without what round-off leaves.
    left: Unbalanced,
    /// Largest stiffness of a particle as it was factored last [N/mm].
    stiffest: f64,
    /// Whether the exact tangent at u, from which the next step begins, is prepared already.
    pub(super) is_prepared: bool,
    solutions: u64,
    iterations: u64,
}

/// Why a load step did not reach its end.
#[derive(Debug)]
pub(super) enum Stuck {
    Inverted(usize),
    Slow { iterations: u64, residual: f64 },
}

impl<'a> Search<'a> {
    pub(super) fn new(
        lattice: &'a Lattice,
        supports: &'a Supports,
        load: &'a [f64],
        options: &'a StaticOptions,
    ) -> Result<Self, CompositeError> {
        let size = lattice.displacements();
        let matrix = lattice.matrix();
        let equations = Equations::new(options.method, &matrix, lattice.grid(), supports)
            .map_err(|failure| told(failure, lattice.grid()))?;
        Ok(Self {
            lattice,
            supports,
            load,
            options,
            matrix,
            equations,
            circles: Circles::default(),
            u: vec![0.0; size],
            forces: vec![0.0; size],
            right: vec![0.0; size],
            step: vec![0.0; size],
            trial: vec![0.0; size],
            energy: 0.0,
            left: Unbalanced {
                largest: 0.0,
                scale: 0.0,
                round_off: 0.0,
            },
            stiffest: 0.0,
            is_prepared: false,
            solutions: 0,
            iterations: 0,
        })
    }

    fn told(&self, failure: NoFactor) -> CompositeError {
        told(failure, self.lattice.grid())
    }

    /// Evaluates forces and energy at u, and the unbalanced forces at a share of the load; the
    /// largest of them over the largest force anywhere.
    fn unbalance(&mut self, share: f64) -> f64 {
        self.energy = self
            .lattice
            .forces(self.options.geometry, &self.u, &mut self.forces);
        let (stored, mut largest) = self.circles.press(&self.u, &mut self.forces);
        self.energy += stored;
        let mut unbalanced = 0.0_f64;
        for (place, force) in self.forces.iter().enumerate() {
            let load = share * self.load[place];
            largest = largest.max(load.abs());
            self.right[place] = if self.supports.is_held(place) {
                largest = largest.max(force.abs());
                0.0
            } else {
                unbalanced = unbalanced.max((load - force).abs());
                load - force
            };
        }
        if !self.energy.is_finite() {
            (unbalanced, largest) = (f64::INFINITY, 1.0);
        }
        self.left = Unbalanced {
            largest: unbalanced,
            scale: largest,
            round_off: 0.0,
        };
        self.left.share()
    }

    /// What round-off of the displacements leaves unbalanced [N]: of a slender section that has gone far it
    /// is more than any tolerance, and no iteration makes it less.
    fn round_off(&self) -> f64 {
        let farthest = self.u.iter().fold(0.0_f64, |far, u| far.max(u.abs()));
        ROUNDED * f64::EPSILON * self.stiffest * farthest
    }

    fn solve(&mut self) -> Result<(), CompositeError> {
        self.try_solve().map_err(|failure| self.told(failure))
    }

    fn try_solve(&mut self) -> Result<(), NoFactor> {
        self.solutions += 1;
        self.iterations += self
            .equations
            .solve(&self.matrix, &self.right, &mut self.step)?;
        Ok(())
    }

    pub(super) fn solve_linear(&mut self) -> Result<(), CompositeError> {
        self.u = self.supports.displacements();
        self.lattice
            .tangent(Geometry::Linear, Tangent::Exact, &self.u, &mut self.matrix);
        self.equations
            .prepare(&self.matrix)
            .map_err(|failure| self.told(failure))?;
        let mut residual = self.unbalance(1.0);
        for solution in 0..REFINEMENTS {
            if residual == 0.0 {
                break;
            }
            self.solve()?;
            self.trial.copy_from_slice(&self.u);
            for (u, step) in self.u.iter_mut().zip(&self.step) {
                *u += step;
            }
            let refined = self.unbalance(1.0);
            // The first solution counts in any case; after it only what is better.
            if solution > 0 && refined >= residual {
                self.u.copy_from_slice(&self.trial);
                self.unbalance(1.0);
                break;
            }
            let settled = solution > 0 && refined > 0.1 * residual;
            residual = refined;
            if settled {
                break;
            }
        }
        if self.u.iter().all(|u| u.is_finite()) {
            Ok(())
        } else {
            Err(CompositeError::NotFinite {
                quantity: "a displacement",
                step: 0,
            })
        }
    }

    /// Factors the tangent at u, its convex part where it is not positive definite.
    fn prepare(&mut self) -> Result<(), CompositeError> {
        if std::mem::take(&mut self.is_prepared) {
            return Ok(());
        }
        let prepared = match self.prepare_part(Tangent::Exact) {
            Err(NoFactor::Indefinite { .. }) => self.prepare_part(Tangent::Convex),
            prepared => prepared,
        };
        prepared.map_err(|failure| self.told(failure))
    }

    fn prepare_part(&mut self, tangent: Tangent) -> Result<(), NoFactor> {
        self.lattice
            .tangent(Geometry::Large, tangent, &self.u, &mut self.matrix);
        let exact = tangent == Tangent::Exact;
        self.circles.stiffen(&self.u, exact, &mut self.matrix);
        self.equations.prepare(&self.matrix)?;
        let all = (0..self.u.len()).map(|place| self.matrix.diagonal(place));
        self.stiffest = all.fold(0.0, f64::max);
        Ok(())
    }

    /// Whether it takes energy to push the section from its rest whichever way: whether the exact tangent at u
    /// is positive definite, which is prepared then.
    pub(super) fn is_stable(&mut self) -> Result<bool, CompositeError> {
        match self.prepare_part(Tangent::Exact) {
            Ok(()) => Ok(self.equations.is_positive(&self.matrix)),
            Err(NoFactor::Indefinite { .. }) => Ok(false),
            Err(failure) => Err(self.told(failure)),
        }
    }

    /// Solves for the present right-hand side with the tangent that was prepared; with its convex part where
    /// only iterations find that it curves down.
    fn solve_prepared(&mut self) -> Result<(), CompositeError> {
        match self.try_solve() {
            Err(NoFactor::Indefinite { .. }) => {
                self.prepare_part(Tangent::Convex)
                    .map_err(|failure| self.told(failure))?;
                self.solve()
            }
            solved => solved.map_err(|failure| self.told(failure)),
        }
    }

    /// One Newton direction for the present right-hand side.
    fn direction(&mut self) -> Result<(), CompositeError> {
        self.prepare()?;
        self.solve_prepared()
    }

    pub(super) fn load_step(
        &mut self,
        from: f64,
        to: f64,
        stop: &dyn Fn() -> bool,
    ) -> Result<Result<(), Stuck>, CompositeError> {
        if let Some(stuck) = self.predict(from, to)? {
            return Ok(Err(stuck));
        }
        self.unbalance(to);
        let mut step = LoadStep {
            search: self,
            share: to,
            stop,
            inverted: None,
        };
        let settled = settle(&mut step, NEWTON_ITERATIONS)?;
        let inverted = step.inverted;
        let residual = self.left.share();
        let slow = Stuck::Slow {
            iterations: self.solutions,
            residual,
        };
        Ok(match (settled, inverted) {
            (Settled::AtRest(_), _) => Ok(()),
            (Settled::Stuck(_), Some(cell)) => Err(Stuck::Inverted(cell)),
            (Settled::Stuck(_), None) if residual <= STUCK_NEAR * self.options.tolerance => Ok(()),
            (Settled::Stuck(_) | Settled::Slow, _) => Err(slow),
        })
    }

    /// Moves what is held to its new place, and everything else along the tangent with it.
    fn predict(&mut self, from: f64, to: f64) -> Result<Option<Stuck>, CompositeError> {
        let mut moved = vec![0.0; self.u.len()];
        let mut moves = false;
        for (place, change) in moved.iter_mut().enumerate() {
            if let Some(value) = self.supports.prescribed(place) {
                *change = (to - from) * value;
                moves |= *change != 0.0;
            }
        }
        if !moves {
            return Ok(None);
        }
        self.unbalance(to);
        self.prepare()?;
        let mut image = vec![0.0; self.u.len()];
        self.matrix.multiply(&moved, &mut image);
        for (place, right) in self.right.iter_mut().enumerate() {
            if !self.supports.is_held(place) {
                *right -= image[place];
            }
        }
        self.solve_prepared()?;
        for ((u, moved), step) in self.u.iter_mut().zip(&moved).zip(&self.step) {
            *u += moved + step;
        }
        // Exact, so that steps of the load do not add up their round-off.
        for place in 0..self.u.len() {
            if let Some(value) = self.supports.prescribed(place) {
                self.u[place] = to * value;
            }
        }
        Ok(self.lattice.inverted_cell(&self.u).map(Stuck::Inverted))
    }

    pub(super) fn finish(&mut self, share: f64) -> Equilibrium {
        let residual = self.unbalance(share);
        let load: Vec<f64> = self.load.iter().map(|load| share * load).collect();
        rest(
            self.lattice,
            self.supports,
            &load,
            self.u.clone(),
            &self.forces,
            Balance {
                energy: self.energy,
                residual,
                solutions: self.solutions,
                iterations: self.iterations,
            },
        )
    }
}

/// The way to the rest at a share of the load.
struct LoadStep<'s, 'a> {
    search: &'s mut Search<'a>,
    share: f64,
    stop: &'s dyn Fn() -> bool,
    /// The cell that the last step would have turned inside out however short.
    inverted: Option<usize>,
}

impl Newton for LoadStep<'_, '_> {
    type Failure = CompositeError;

    fn is_at_rest(&mut self, _: u32) -> Result<bool, CompositeError> {
        let left = Unbalanced {
            round_off: self.search.round_off(),
            ..self.search.left
        };
        Ok(left.is_within(self.search.options.tolerance))
    }

    fn advance(&mut self) -> Result<bool, CompositeError> {
        if (self.stop)() {
            return Err(CompositeError::Stopped);
        }
        let Self {
            search,
            share,
            inverted,
            ..
        } = self;
        let share = *share;
        search.direction()?;
        let slope: f64 = -dot(&search.right, &search.step);
        let work = share * dot(search.load, &search.u);
        let potential = search.energy - work;
        // Below this, differences of the potential are round-off and residuals decide.
        let noise = 1e-13 * (search.energy.abs() + work.abs());
        let residual = search.left.share();
        search.trial.copy_from_slice(&search.u);
        let goes = |length: f64, _| {
            for place in 0..search.u.len() {
                search.u[place] = search.trial[place] + length * search.step[place];
            }
            *inverted = search.lattice.inverted_cell(&search.u);
            if inverted.is_some() {
                return Ok(false);
            }
            let refined = search.unbalance(share);
            let now = search.energy - share * dot(search.load, &search.u);
            let is_downhill = now <= potential + 1e-4 * length * slope;
            let is_in_noise = (length * slope).abs() <= noise && refined < residual;
            Ok(is_downhill || is_in_noise)
        };
        let is_found = halved(1.0, HALVINGS, goes)?;
        if !is_found {
            search.u.copy_from_slice(&search.trial);
            search.unbalance(share);
        }
        Ok(is_found)
    }
}

/// What is known of a state of rest beside its forces.
pub(crate) struct Balance {
    pub(crate) energy: f64,
    pub(crate) residual: f64,
    pub(crate) solutions: u64,
    pub(crate) iterations: u64,
}

/// Reactions and their balance.
pub(crate) fn rest(
    lattice: &Lattice,
    supports: &Supports,
    load: &[f64],
    u: Vec<f64>,
    forces: &[f64],
    balance: Balance,
) -> Equilibrium {
    let mut reactions = vec![0.0; lattice.displacements()];
    let mut sums = [0.0; 2];
    let mut sizes = [0.0; 2];
    for (place, reaction) in reactions.iter_mut().enumerate() {
        if supports.is_held(place) {
            *reaction = forces[place] - load[place];
        }
        sums[place % 2] += *reaction + load[place];
        sizes[place % 2] += reaction.abs() + load[place].abs();
    }
    let size = sizes[0].max(sizes[1]);
    let reaction_error = if size > 0.0 {
        sums[0].abs().max(sums[1].abs()) / size
    } else {
        0.0
    };
    Equilibrium {
        displacements_mm: u,
        reactions_n: reactions,
        energy_n_mm: balance.energy,
        residual: balance.residual,
        reaction_error,
        solutions: balance.solutions,
        iterations: balance.iterations,
    }
}
