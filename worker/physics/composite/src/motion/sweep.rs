//! One sweep of corrections over all cells and bonds.
use crate::lattice::{Geometry, Lattice, ends, gather};
use crate::motion::gain::Gains;

impl Gains {
    /// Shifts the particles of every cell and bond by what its measures ask for, one after the
    /// other.
    pub(super) fn sweep(
        &mut self,
        lattice: &Lattice,
        geometry: Geometry,
        inverse_masses: &[f64],
        u: &mut [f64],
    ) {
        self.sweep_cells(lattice, geometry, inverse_masses, u);
        self.sweep_bonds(lattice, geometry, inverse_masses, u);
    }

    fn sweep_cells(
        &mut self,
        lattice: &Lattice,
        geometry: Geometry,
        inverse_masses: &[f64],
        u: &mut [f64],
    ) {
        for (place, gain) in self.cells.iter().enumerate() {
            let cell = lattice.cell(place);
            let corners = lattice.grid().corners(place);
            let here = gather(u, corners);
            let (measures, rates) = match geometry {
                Geometry::Linear => (cell.measures(&here), cell.rates()),
                Geometry::Large => cell.large_measures(&here),
            };
            let mut excess = measures;
            if let Some(memory) = &mut self.memory {
                let kept = &mut memory.cells[place];
                for (excess, kept) in excess.iter_mut().zip(kept.iter()) {
                    *excess -= kept;
                }
                let rate = &memory.cell_rates[place];
                for (row, kept) in kept.iter_mut().enumerate() {
                    for (column, excess) in excess.iter().enumerate() {
                        *kept += rate[(row, column)] * excess;
                    }
                }
            }
            for (row, rate) in rates.iter().enumerate() {
                let impulse: f64 = (0..5)
                    .map(|column| -gain[(row, column)] * excess[column])
                    .sum();
                for (corner, particle) in corners.into_iter().enumerate() {
                    for axis in 0..2 {
                        let displacement = 2 * particle + axis;
                        u[displacement] +=
                            inverse_masses[displacement] * rate[2 * corner + axis] * impulse;
                    }
                }
            }
        }
    }

    fn sweep_bonds(
        &mut self,
        lattice: &Lattice,
        geometry: Geometry,
        inverse_masses: &[f64],
        u: &mut [f64],
    ) {
        for (place, (bond, gain)) in lattice.bonds().iter().zip(&self.bonds).enumerate() {
            let here = ends(u, bond);
            let (stretch, d) = match geometry {
                Geometry::Linear => bond.linear_stretch(&here),
                Geometry::Large => bond.large_stretch(&here),
            };
            let mut excess = stretch;
            if let Some(memory) = &mut self.memory {
                let kept = &mut memory.bonds[place];
                excess -= *kept;
                *kept += memory.bond_rates[place] * excess;
            }
            let impulse = -gain * excess;
            let [first, second] = bond.particles.map(|particle| 2 * particle as usize);
            for axis in 0..2 {
                u[first + axis] -= inverse_masses[first + axis] * d[axis] * impulse;
                u[second + axis] += inverse_masses[second + axis] * d[axis] * impulse;
            }
        }
    }
}
