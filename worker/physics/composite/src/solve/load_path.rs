//! The way to the full load: equal steps, each halved where Newton's method does not reach its end.
use serde::{Deserialize, Serialize};

use crate::error::CompositeError;
use crate::lattice::{Geometry, Lattice};
use crate::solve::equilibrium::{Equilibrium, Search, StaticOptions, Stuck};
use crate::supports::Supports;

/// How often a load step may be halved.
const CUTS: u32 = 14;

/// Finds the equilibrium of a lattice under forces on its particles [N].
///
/// # Errors
/// When the supports leave it loose, the lattice folds, cells would be turned inside out, or no
/// equilibrium is found.
pub fn equilibrium(
    lattice: &Lattice,
    supports: &Supports,
    load_n: &[f64],
    options: &StaticOptions,
) -> Result<Equilibrium, CompositeError> {
    let mut path = LoadPath::new(lattice, supports, load_n, options, &|| false)?;
    while path.share() < 1.0 {
        path.advance()?;
    }
    Ok(path.equilibrium())
}

/// The equilibria of a lattice under a growing load, one equal step of the load after the other.
#[allow(
    missing_debug_implementations,
    reason = "holds what asks whether to stop"
)]
pub struct LoadPath<'a> {
    search: Search<'a>,
    options: &'a StaticOptions,
    stop: &'a dyn Fn() -> bool,
    at: PathState,
}

/// Where on the path a lattice is: what a checkpoint keeps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PathState {
    /// λ of the last equilibrium.
    share: f64,
    /// What λ grows by at once, smaller after steps that had to be cut.
    increment: f64,
    steps: u64,
    /// λ of the first rest that was not stable.
    unstable: Option<f64>,
    u: Vec<f64>,
}

/// Whether it takes energy to push a lattice from a rest in large displacements u [mm], whichever way.
///
/// # Errors
/// When there is no memory for the equations.
pub fn is_stable(
    lattice: &Lattice,
    supports: &Supports,
    u: &[f64],
) -> Result<bool, CompositeError> {
    let options = StaticOptions {
        geometry: Geometry::Large,
        ..StaticOptions::default()
    };
    let mut search = Search::new(lattice, supports, &[], &options)?;
    search.u.copy_from_slice(u);
    search.is_stable()
}

impl<'a> LoadPath<'a> {
    /// Before any load; `stop` is asked before every solution.
    ///
    /// # Errors
    /// When the supports leave the lattice loose, or there is no memory for the equations.
    pub fn new(
        lattice: &'a Lattice,
        supports: &'a Supports,
        load_n: &'a [f64],
        options: &'a StaticOptions,
        stop: &'a dyn Fn() -> bool,
    ) -> Result<Self, CompositeError> {
        supports.refuse_rigid_motion(lattice.grid())?;
        Ok(Self {
            search: Search::new(lattice, supports, load_n, options)?,
            options,
            stop,
            at: PathState {
                share: 0.0,
                increment: 1.0,
                steps: 0,
                unstable: None,
                u: Vec::new(),
            },
        })
    }

    /// Part of the load at the last equilibrium.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.at.share
    }

    /// Part of the load at the first of the rests found, one for each of the equal steps, from which the least
    /// push leads away; always none where displacements are small, which buckle nothing.
    #[must_use]
    pub fn unstable(&self) -> Option<f64> {
        self.at.unstable
    }

    /// Displacements of the last equilibrium [mm].
    #[must_use]
    pub fn displacements_mm(&self) -> &[f64] {
        &self.search.u
    }

    /// What a checkpoint keeps.
    #[must_use]
    pub fn state(&self) -> PathState {
        PathState {
            u: self.search.u.clone(),
            ..self.at
        }
    }

    /// Goes on from an equilibrium found before.
    ///
    /// # Errors
    /// [`CompositeError::OtherSize`] when it is of another lattice.
    pub fn resume(&mut self, state: PathState) -> Result<(), CompositeError> {
        if state.u.len() != self.search.u.len() {
            return Err(CompositeError::OtherSize);
        }
        self.search.u = state.u;
        self.at = PathState {
            u: Vec::new(),
            ..state
        };
        Ok(())
    }

    /// On to the next of the equal steps of the load, all at once where displacements are small.
    ///
    /// # Errors
    /// As [`equilibrium`]; [`CompositeError::Stopped`].
    pub fn advance(&mut self) -> Result<(), CompositeError> {
        match self.options.geometry {
            Geometry::Linear => {
                if (self.stop)() {
                    return Err(CompositeError::Stopped);
                }
                self.search.solve_linear()?;
                self.at.share = 1.0;
                Ok(())
            }
            Geometry::Large => {
                self.follow_load()?;
                // the next step begins with the same tangent
                self.search.is_prepared = self.search.is_stable()?;
                if !self.search.is_prepared {
                    self.at.unstable.get_or_insert(self.at.share);
                }
                Ok(())
            }
        }
    }

    /// The equilibrium at the present share of the load.
    pub fn equilibrium(&mut self) -> Equilibrium {
        self.search.finish(self.at.share)
    }

    fn follow_load(&mut self) -> Result<(), CompositeError> {
        let count = f64::from(self.options.load_steps.max(1));
        let full = 1.0 / count;
        let smallest = full / f64::from(1_u32 << CUTS);
        // the nearest of the equal steps beyond where the last one ended
        let end = ((self.at.share * count + 1e-6).floor() + 1.0).min(count) / count;
        self.at.increment = self.at.increment.min(full);
        while self.at.share < end {
            if (self.stop)() {
                return Err(CompositeError::Stopped);
            }
            let reach = self.at.share + 1.001 * self.at.increment;
            let goal = if reach >= end {
                end
            } else {
                self.at.share + self.at.increment
            };
            let start = self.search.u.clone();
            let done = self.search.load_step(self.at.share, goal, self.stop);
            // a step that was not finished is begun anew, from where it began before
            let done = done.inspect_err(|_| self.search.u.copy_from_slice(&start))?;
            match done {
                Ok(()) => {
                    self.at.share = goal;
                    self.at.steps += 1;
                    self.at.increment = (2.0 * self.at.increment).min(full);
                }
                Err(_) if 0.5 * self.at.increment >= smallest => {
                    self.search.u = start;
                    self.at.increment *= 0.5;
                }
                Err(Stuck::Inverted(cell)) => {
                    let grid = self.search.lattice.grid();
                    let [x_mm, y_mm] = grid.middle_mm(cell);
                    return Err(CompositeError::Inverted {
                        column: cell % grid.columns(),
                        row: cell / grid.columns(),
                        x_mm,
                        y_mm,
                        step: self.at.steps + 1,
                        load_fraction: goal,
                    });
                }
                Err(Stuck::Slow {
                    iterations,
                    residual,
                }) => {
                    return Err(CompositeError::NotConverged {
                        load_fraction: goal,
                        iterations,
                        residual,
                    });
                }
            }
        }
        Ok(())
    }
}
