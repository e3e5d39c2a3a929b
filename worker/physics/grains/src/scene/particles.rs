//! Every sphere that collides, in the order of space rather than of the spec.
use serde::{Deserialize, Serialize};

use crate::{contact::Kinematics, numbers::rows::Row};

/// The particles: one entry each in every array. Scenes without friction have no spins.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Particles {
    /// Centre [m] and radius [m].
    pub(crate) centres: Vec<Row>,
    /// [m/s], and 1/m [1/kg]: 0 for what no force moves, and for members of clumps.
    pub(crate) velocities: Vec<Row>,
    /// [rad/s], and 1/I [1/(kg m²)], likewise.
    pub(crate) spins: Vec<Row>,
    /// Number of the particle in the order of the spec.
    pub(crate) numbers: Vec<u32>,
    /// Body of the spec that it belongs to.
    pub(crate) owners: Vec<u32>,
    /// Bits of the degrees of freedom x, y, z, rx, ry, rz that are fixed.
    pub(crate) fixed: Vec<u8>,
    /// Its material.
    pub(crate) surfaces: Vec<u16>,
}

impl Particles {
    pub(crate) fn len(&self) -> usize {
        self.centres.len()
    }

    /// Memory of all arrays [bytes].
    pub(crate) fn bytes(&self) -> u64 {
        let rows = [&self.centres, &self.velocities, &self.spins];
        let rows = rows.map(|rows| size_of_val(rows.as_slice()));
        let words = size_of_val(self.numbers.as_slice())
            + size_of_val(self.owners.as_slice())
            + size_of_val(self.fixed.as_slice())
            + size_of_val(self.surfaces.as_slice());
        (rows.into_iter().sum::<usize>() + words) as u64
    }

    /// `last_step` is Δt of the step before [s], `time_step` that of this one.
    pub(crate) fn kinematics(&self, last_step: f64, time_step: f64) -> Kinematics<'_> {
        Kinematics {
            centres: &self.centres,
            velocities: &self.velocities,
            spins: &self.spins,
            last_step,
            time_step,
        }
    }

    /// Sorts: what was at `order[k]` comes to `k`.
    pub(crate) fn reorder(&mut self, order: &[u32]) {
        fn sorted<T: Copy>(items: &mut Vec<T>, order: &[u32]) {
            if !items.is_empty() {
                *items = order.iter().map(|old| items[*old as usize]).collect();
            }
        }
        sorted(&mut self.centres, order);
        sorted(&mut self.velocities, order);
        sorted(&mut self.spins, order);
        sorted(&mut self.numbers, order);
        sorted(&mut self.owners, order);
        sorted(&mut self.fixed, order);
        sorted(&mut self.surfaces, order);
    }

    /// Takes off what begins at `at`.
    pub(super) fn split_off(&mut self, at: usize) -> Self {
        fn tail<T>(items: &mut Vec<T>, at: usize) -> Vec<T> {
            if items.is_empty() {
                Vec::new()
            } else {
                items.split_off(at)
            }
        }
        Self {
            centres: tail(&mut self.centres, at),
            velocities: tail(&mut self.velocities, at),
            spins: tail(&mut self.spins, at),
            numbers: tail(&mut self.numbers, at),
            owners: tail(&mut self.owners, at),
            fixed: tail(&mut self.fixed, at),
            surfaces: tail(&mut self.surfaces, at),
        }
    }
}
