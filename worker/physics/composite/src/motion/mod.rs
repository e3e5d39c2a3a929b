//! Motion of the lattice in time, by the paper's two parts and their relatives.
//!
//! All schemes step the places of the particles by the sum of two Taylor series, which is Verlet's
//! method,
//!
//! u(t + τ) = 2 u(t) - u(t - τ) + τ² F / m   (6)
//!
//! and differ in how bonds and cells enter:
//!
//! | scheme | F holds | then |
//! |---|---|---|
//! | [`Scheme::Verlet`] | loads and the forces of springs | nothing |
//! | [`Scheme::Pbd`] | loads | n sweeps that shift the particles of each bond by a share s of its elongation |
//! | [`Scheme::Xpbd`] | loads and the multipliers of the last step | n sweeps that correct multipliers and places |
//!
//! A sweep takes bonds (or cells, whose five measures are corrected together) one after the other,
//! always in the same order. See [`gain`] for what s means.
//!
//! Source: [SizayaTsivilsky2020] for (6) and the shifts; [MacklinMuellerChentanez2016] for
//! multipliers.
mod gain;
mod lowest;
mod options;
mod pass;
mod settling;
mod stable;
mod state;
mod sweep;

use crate::error::CompositeError;
use crate::lattice::{Cell, Geometry, Lattice};
use crate::supports::Supports;
use gain::Gains;
use loadframe_api::section::settling::steps_to_rest;
use loadframe_numerics::{Team, ThreadsError};
pub use lowest::lowest_frequency_per_s;
pub use options::{Damping, MotionOptions, Scheme};
use pass::Pass;
pub use settling::Rest;
pub use stable::critical_time_step_s;
pub use state::MotionState;

/// A lattice in motion.
#[derive(Debug)]
pub struct Motion<'a> {
    lattice: &'a Lattice,
    supports: &'a Supports,
    load: Vec<f64>,
    /// The load, and what the paper's shifts have left unbalanced at their rests.
    drive: Vec<f64>,
    options: MotionOptions,
    /// Of [`Damping::Critical`].
    lowest_per_s: Option<f64>,
    time_step: f64,
    inverse_masses: Vec<f64>,
    gains: Gains,
    u: Vec<f64>,
    before: Vec<f64>,
    forces: Vec<f64>,
    team: Team,
    /// What [`pass`] keeps of forces.
    rows: Vec<f64>,
    kinetic: f64,
    /// Particles stand still now, so that half a step of force goes into the first velocity.
    is_starting: bool,
    steps: u64,
}

impl<'a> Motion<'a> {
    /// A lattice at rest and unloaded, under forces [N] that act from now on; what is held is at its
    /// prescribed place from the first moment.
    ///
    /// # Errors
    /// When the time step is beyond the stable one of springs (for XPBD: not a positive number), or
    /// the damping is not a finite number of at least 0.
    pub fn new(
        lattice: &'a Lattice,
        supports: &'a Supports,
        load_n: &[f64],
        options: MotionOptions,
    ) -> Result<Self, CompositeError> {
        let critical_s = critical_time_step_s(lattice, supports);
        let time_step = match (options.time_step_s, options.scheme) {
            (None, Scheme::Verlet | Scheme::Pbd { .. }) => 0.9 * critical_s,
            (None, Scheme::Xpbd { .. }) => 3.0 * critical_s,
            (Some(given_s), Scheme::Verlet) if given_s > critical_s => {
                return Err(CompositeError::UnstableTimeStep {
                    given_s,
                    critical_s,
                });
            }
            (Some(given_s), _) => crate::error::positive("the time step [s]", given_s)?,
        };
        if let Damping::Viscous { per_s } = options.damping
            && !(per_s.is_finite() && per_s >= 0.0)
        {
            return Err(CompositeError::OutOfRange {
                quantity: "the damping [1/s]",
                given: per_s,
                allowed: "a finite number of at least 0",
            });
        }
        let lowest_per_s = match options.damping {
            Damping::Critical => lowest_frequency_per_s(lattice, supports, load_n)?,
            _ => None,
        };
        let options = MotionOptions {
            damping: match (options.damping, lowest_per_s) {
                (Damping::Critical, Some(lowest)) => Damping::Viscous {
                    per_s: 2.0 * lowest,
                },
                (Damping::Critical, None) => Damping::Kinetic,
                (given, _) => given,
            },
            ..options
        };
        let inverse_masses: Vec<f64> = (0..lattice.displacements())
            .map(|place| {
                if supports.is_held(place) {
                    0.0
                } else {
                    1.0 / lattice.masses_t()[place / 2]
                }
            })
            .collect();
        let gains = Gains::new(lattice, &inverse_masses, options.scheme, time_step);
        let u = supports.displacements();
        Ok(Self {
            lattice,
            supports,
            load: load_n.to_vec(),
            drive: load_n.to_vec(),
            options,
            lowest_per_s,
            time_step,
            inverse_masses,
            gains,
            before: u.clone(),
            forces: vec![0.0; u.len()],
            u,
            team: Team::alone(),
            rows: if lattice.is_exact() {
                pass::scratch(lattice)
            } else {
                Vec::new()
            },
            kinetic: 0.0,
            is_starting: true,
            steps: 0,
        })
    }

    /// Shares every step of springs between cells among threads; the motion does not depend on how many.
    ///
    /// # Errors
    /// When the operating system refuses the threads.
    pub fn share(&mut self, threads: usize) -> Result<(), ThreadsError> {
        self.team = Team::new(threads)?;
        Ok(())
    }

    /// Starts from other displacements [mm], at rest; held ones stay as prescribed.
    pub fn displace(&mut self, u: &[f64]) {
        for (place, value) in u.iter().enumerate() {
            if !self.supports.is_held(place) {
                self.u[place] = *value;
            }
        }
        self.stop();
    }

    /// Gives all particles that are not held a velocity along x and y [mm/s].
    pub fn push(&mut self, velocity: [f64; 2]) {
        for place in 0..self.u.len() {
            if !self.supports.is_held(place) {
                // u(-τ) of the Taylor series, whose term of τ² the halved first force stands for
                self.before[place] -= self.time_step * velocity[place % 2];
            }
        }
        self.kinetic = 0.5 * self.moved() / (self.time_step * self.time_step);
    }

    /// Σ m Δu² of the last step [t mm²].
    fn moved(&self) -> f64 {
        let mut moved = 0.0;
        for (place, u) in self.u.iter().enumerate() {
            let shift = u - self.before[place];
            moved += self.lattice.masses_t()[place / 2] * shift * shift;
        }
        moved
    }

    /// Takes the load away; what is displaced goes on from where it is.
    pub fn release(&mut self) {
        self.load.fill(0.0);
        self.drive.fill(0.0);
    }

    /// Steps until a part `residual` of the load is unbalanced, as far as they can be foreseen: with
    /// [`Damping::Critical`], in small displacements.
    #[must_use]
    pub fn steps_to_rest(&self, residual: f64) -> Option<f64> {
        let lowest = self.lowest_per_s?;
        Some(steps_to_rest(lowest, None, self.time_step, residual))
    }

    /// Steps done.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// All particles stand still.
    fn stop(&mut self) {
        self.before.copy_from_slice(&self.u);
        self.kinetic = 0.0;
        self.is_starting = true;
    }

    /// Displacements, x and y by turns [mm].
    #[must_use]
    pub fn displacements_mm(&self) -> &[f64] {
        &self.u
    }

    /// τ [s].
    #[must_use]
    pub fn time_step_s(&self) -> f64 {
        self.time_step
    }

    /// Time since the start [s].
    #[must_use]
    pub fn time_s(&self) -> f64 {
        self.steps as f64 * self.time_step
    }

    /// Kinetic energy half a step ago, before the first that of the velocity given [N mm].
    #[must_use]
    pub fn kinetic_energy_n_mm(&self) -> f64 {
        self.kinetic
    }

    /// Elastic energy [N mm].
    pub fn elastic_energy_n_mm(&mut self) -> f64 {
        self.lattice
            .forces(self.options.geometry, &self.u, &mut self.forces)
    }

    /// One time step.
    ///
    /// # Errors
    /// When a cell was turned inside out, or a displacement is no longer finite.
    pub fn advance(&mut self) -> Result<(), CompositeError> {
        let square = self.time_step * self.time_step;
        let (keep, push) = match self.options.damping {
            Damping::Viscous { per_s } => {
                let half = 0.5 * per_s * self.time_step;
                let push = match self.options.scheme {
                    Scheme::Verlet => square / (1.0 + half),
                    // The sweeps stand for forces over the full square of the step.
                    Scheme::Pbd { .. } | Scheme::Xpbd { .. } => square,
                };
                ((1.0 - half) / (1.0 + half), push)
            }
            Damping::None | Damping::Kinetic | Damping::Critical => (1.0, square),
        };
        // u(-τ) = u(τ) of a particle that stands still: (6) with half the force. A full one would put
        // in energy at every stop, without bound near the stable step.
        let push = match self.options.scheme {
            Scheme::Verlet if self.is_starting => 0.5 * push,
            _ => push,
        };
        self.is_starting = false;
        self.steps += 1;
        if self.options.scheme == Scheme::Verlet && self.lattice.is_exact() {
            let kinetic = self.pass(keep, push);
            return self.watch(kinetic);
        }
        match self.options.scheme {
            Scheme::Verlet => {
                self.lattice
                    .forces(self.options.geometry, &self.u, &mut self.forces);
            }
            Scheme::Pbd { .. } => self.forces.fill(0.0),
            Scheme::Xpbd { .. } => self.gains.multiplier_forces(
                self.lattice,
                self.options.geometry,
                &self.u,
                &mut self.forces,
            ),
        }
        for place in 0..self.u.len() {
            let (now, last) = (self.u[place], self.before[place]);
            self.before[place] = now;
            let force = self.drive[place] - self.forces[place];
            self.u[place] = now + keep * (now - last) + push * self.inverse_masses[place] * force;
        }
        if let Scheme::Pbd { iterations } | Scheme::Xpbd { iterations } = self.options.scheme {
            for _ in 0..iterations.max(1) {
                self.gains.sweep(
                    self.lattice,
                    self.options.geometry,
                    &self.inverse_masses,
                    &mut self.u,
                );
            }
        }
        self.watch(self.moved())
    }

    /// A step of springs between cells; Σ m Δu² [t mm²].
    fn pass(&mut self, keep: f64, push: f64) -> f64 {
        let pass = Pass {
            lattice: self.lattice,
            drive: &self.drive,
            inverse_masses: &self.inverse_masses,
            keep,
            push,
        };
        let (u, before, rows) = (&self.u, &mut self.before, &mut self.rows);
        let team = &self.team;
        let sum = match self.options.geometry {
            Geometry::Linear => pass.step(
                team,
                |cell, u| Cell::linear_forces(cell, u).1,
                u,
                before,
                rows,
            ),
            Geometry::Large => pass.step(
                team,
                |cell, u| Cell::large_forces(cell, u).1,
                u,
                before,
                rows,
            ),
        };
        std::mem::swap(&mut self.u, &mut self.before);
        sum
    }

    /// Kinetic energy, by Σ m Δu², kinetic damping, and what must not happen.
    fn watch(&mut self, moved: f64) -> Result<(), CompositeError> {
        let kinetic = moved * 0.5 / (self.time_step * self.time_step);
        if !kinetic.is_finite() {
            return Err(CompositeError::NotFinite {
                quantity: "the kinetic energy",
                step: self.steps,
            });
        }
        if self.options.damping == Damping::Kinetic && kinetic < self.kinetic {
            self.stop();
        } else {
            self.kinetic = kinetic;
        }
        if self.options.geometry == Geometry::Large
            && let Some(cell) = self.lattice.inverted_cell(&self.u)
        {
            let grid = self.lattice.grid();
            let [x_mm, y_mm] = grid.middle_mm(cell);
            return Err(CompositeError::Inverted {
                column: cell % grid.columns(),
                row: cell / grid.columns(),
                x_mm,
                y_mm,
                step: self.steps,
                load_fraction: 1.0,
            });
        }
        Ok(())
    }
}
