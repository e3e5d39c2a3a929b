//! A time step of springs in one pass over the cells, shared among threads.
//!
//! Bands of rows of particles each have one owner, which works out the forces of all cells that touch
//! them, those along its edges once more than the neighbour. So nothing is shared but what is only
//! read, and every force is summed in the same order on any number of threads. The new places take
//! those of the last ones; of forces only two rows are kept, which stay in a cache.
use loadframe_numerics::Team;

use crate::lattice::{Cell, Corners, Lattice};

/// Rows of particles in a band: few enough to be shared, many enough that the row of cells worked out
/// twice is a sixteenth of them.
const BAND: usize = 16;

/// What a step of (6) needs beside the places.
pub(super) struct Pass<'a> {
    pub(super) lattice: &'a Lattice,
    pub(super) drive: &'a [f64],
    pub(super) inverse_masses: &'a [f64],
    /// Part of the last shift that goes on.
    pub(super) keep: f64,
    /// τ², in terms of forces over masses.
    pub(super) push: f64,
}

/// Two rows of forces for every band.
pub(super) fn scratch(lattice: &Lattice) -> Vec<f64> {
    let rows = lattice.grid().y_mm().len();
    vec![0.0; rows.div_ceil(BAND) * 2 * row_of(lattice)]
}

/// Displacements of a row of particles.
fn row_of(lattice: &Lattice) -> usize {
    2 * lattice.grid().x_mm().len()
}

impl Pass<'_> {
    /// Steps from places `u`, the last ones in `places`, to the next, which replace the last; Σ m Δu²
    /// [t mm²].
    pub(super) fn step(
        &self,
        team: &Team,
        law: impl Fn(&Cell, &Corners) -> Corners + Sync,
        u: &[f64],
        places: &mut [f64],
        scratch: &mut [f64],
    ) -> f64 {
        let row = row_of(self.lattice);
        let bands = places
            .chunks_mut(BAND * row)
            .zip(scratch.chunks_mut(2 * row));
        let bands: Vec<_> = bands.enumerate().collect();
        let sums = team.map(bands, |(band, (places, forces))| {
            self.band(&law, u, band * BAND, places, forces)
        });
        sums.iter().sum()
    }

    fn band(
        &self,
        law: &(impl Fn(&Cell, &Corners) -> Corners + Sync),
        u: &[f64],
        first: usize,
        places: &mut [f64],
        forces: &mut [f64],
    ) -> f64 {
        let row = row_of(self.lattice);
        let (mut here, mut above) = forces.split_at_mut(row);
        here.fill(0.0);
        if first > 0 {
            self.cells(law, u, first - 1, above, here);
        }
        let mut sum = 0.0;
        for (offset, places) in places.chunks_mut(row).enumerate() {
            above.fill(0.0);
            let along = first + offset;
            if along < self.lattice.grid().rows() {
                self.cells(law, u, along, here, above);
            }
            sum += self.places(u, along * row, here, places);
            std::mem::swap(&mut here, &mut above);
        }
        sum
    }

    /// Adds the forces of a row of cells to those of the particles below and above it.
    fn cells(
        &self,
        law: &impl Fn(&Cell, &Corners) -> Corners,
        u: &[f64],
        row: usize,
        below: &mut [f64],
        above: &mut [f64],
    ) {
        let size = row_of(self.lattice);
        let [lower, upper] = [row, row + 1].map(|row| &u[row * size..(row + 1) * size]);
        for (place, cell) in self.lattice.row_of_cells(row).enumerate() {
            let at = 2 * place;
            let (p, q) = (&lower[at..at + 4], &upper[at..at + 4]);
            let parts = law(&cell, &[p[0], p[1], p[2], p[3], q[2], q[3], q[0], q[1]]);
            for (sum, part) in below[at..at + 4].iter_mut().zip([0, 1, 2, 3]) {
                *sum += parts[part];
            }
            for (sum, part) in above[at..at + 4].iter_mut().zip([6, 7, 4, 5]) {
                *sum += parts[part];
            }
        }
    }

    /// (6) for a row of particles.
    fn places(&self, u: &[f64], from: usize, forces: &[f64], places: &mut [f64]) -> f64 {
        let to = from + places.len();
        let masses = &self.lattice.masses_t()[from / 2..to / 2];
        let now = &u[from..to];
        let drive = &self.drive[from..to];
        let inverse_masses = &self.inverse_masses[from..to];
        let mut sum = 0.0;
        for (place, last) in places.iter_mut().enumerate() {
            let force = drive[place] - forces[place];
            let shift =
                self.keep * (now[place] - *last) + self.push * inverse_masses[place] * force;
            *last = now[place] + shift;
            sum += masses[place / 2] * shift * shift;
        }
        sum
    }
}
