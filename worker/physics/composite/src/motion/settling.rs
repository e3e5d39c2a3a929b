//! Motion until it comes to rest.
use std::ops::ControlFlow;

use super::{Motion, Scheme};
use crate::error::CompositeError;
use crate::solve::equilibrium::{Balance, Equilibrium, rest};

/// When a motion counts as rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rest {
    /// Largest unbalanced force over the largest force on a particle.
    pub residual: f64,
    /// Steps after which it is given up.
    pub most_steps: u64,
}

impl Default for Rest {
    fn default() -> Self {
        Self {
            // A tenth of a per mille of the deflection on grids of up to 1 000 particles.
            residual: 1e-7,
            most_steps: 10_000_000,
        }
    }
}

/// Steps between two looks at the residual.
const LOOK: u64 = 25;

impl Motion<'_> {
    /// Moves until the springs' own forces balance the load, and says where the lattice rests.
    ///
    /// The paper's shifts stand for springs exactly only in a single bond; in a mesh their rest is
    /// off by an error that grows with τ². Where that is larger than `until` asks, the forces left
    /// unbalanced at rest are added to what drives the shifts, and the motion goes on: the rest is
    /// then that of the lattice, whatever τ and n. [`Motion::advance`] alone is the paper's method
    /// to the letter.
    ///
    /// # Errors
    /// As [`Motion::advance`]; when rest is not reached in the steps allowed.
    pub fn settle(&mut self, until: Rest) -> Result<Equilibrium, CompositeError> {
        self.settle_watched(until, &mut |_, _| ControlFlow::Continue(()))
    }

    /// As [`Motion::settle`]; `watch` is shown the motion and its residual now and then, and may end it.
    ///
    /// # Errors
    /// As [`Motion::settle`]; [`CompositeError::Stopped`] when `watch` ended it.
    pub fn settle_watched(
        &mut self,
        until: Rest,
        watch: &mut dyn FnMut(&Self, f64) -> ControlFlow<()>,
    ) -> Result<Equilibrium, CompositeError> {
        let mut last = vec![0.0; self.u.len()];
        let mut residual = f64::INFINITY;
        while self.steps < until.most_steps {
            last.copy_from_slice(&self.u);
            for _ in 0..LOOK {
                self.advance()?;
            }
            let energy = self.elastic_energy_n_mm();
            let (unbalanced, largest) = self.unbalance();
            residual = if largest > 0.0 {
                unbalanced / largest
            } else {
                0.0
            };
            let is_still = self.kinetic <= until.residual * energy;
            if residual <= until.residual && is_still {
                return Ok(rest(
                    self.lattice,
                    self.supports,
                    &self.load,
                    self.u.clone(),
                    &self.forces,
                    Balance {
                        energy,
                        residual,
                        solutions: 0,
                        iterations: self.steps,
                    },
                ));
            }
            let drift = self.largest_shift(&last);
            let size = self.u.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            let rests = drift <= 1e-3 * residual * size;
            if matches!(self.options.scheme, Scheme::Pbd { .. }) && rests {
                for (place, drive) in self.drive.iter_mut().enumerate() {
                    if !self.supports.is_held(place) {
                        *drive += self.load[place] - self.forces[place];
                    }
                }
            }
            if watch(self, residual).is_break() {
                return Err(CompositeError::Stopped);
            }
        }
        Err(CompositeError::NotAtRest {
            steps: self.steps,
            residual,
        })
    }

    /// Largest unbalanced force and largest force at all [N].
    fn unbalance(&self) -> (f64, f64) {
        let mut unbalanced = 0.0_f64;
        let mut largest = 0.0_f64;
        for (place, force) in self.forces.iter().enumerate() {
            largest = largest.max(self.load[place].abs());
            if self.supports.is_held(place) {
                largest = largest.max(force.abs());
            } else {
                unbalanced = unbalanced.max((self.load[place] - force).abs());
            }
        }
        (unbalanced, largest)
    }

    fn largest_shift(&self, last: &[f64]) -> f64 {
        self.u
            .iter()
            .zip(last)
            .fold(0.0, |largest, (u, last)| largest.max((u - last).abs()))
    }
}
