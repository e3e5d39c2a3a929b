//! Particles on a grid and what holds them together.
//!
//! Two lattices share one form: the *exact* one has a [`cell`] for every four particles, the
//! *paper's* one has [bonds](bond) between pairs. [`Geometry`] says whether displacements are small
//! or large; it is chosen once, outside of every loop. Supports, loads and ways to equilibrium are
//! not known here.
mod bond;
mod cell;
mod geometry;
mod large;
mod paper;
pub mod springs;
#[cfg(test)]
mod tests;

pub use bond::Bond;
pub(crate) use bond::{Ends, ends};
pub(crate) use cell::{Cell, Corners, Measures, Rates};
use cell::{CellBars, strain_along};
pub use geometry::Geometry;
pub(crate) use geometry::Tangent;
pub use paper::{BondPattern, BondStiffness, PaperRule};

use crate::error::CompositeError;
use crate::matrix::GridMatrix;
use crate::section::{Bars, Grid, Layout};
use crate::stiffness::Stiffness;

/// Particles, and the cells or bonds between them.
#[derive(Debug, Clone)]
pub struct Lattice {
    grid: Grid,
    thickness_mm: f64,
    /// Plane stiffness of each cell [MPa]; none in the paper's lattice.
    stiffness: Vec<Stiffness>,
    /// Hourglass stiffness of each cell [N/mm].
    hourglass: Vec<[f64; 2]>,
    /// Of fibres at an angle to the grid, by cell, and which share of them is left.
    bars: Vec<(Bars, f64)>,
    bonds: Vec<Bond>,
    /// Mass of each particle [t], so that forces in N give mm/s².
    masses_t: Vec<f64>,
}

/// What a cell is left with where parts of it are damaged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CellStiffness {
    /// Of the mean strain [MPa].
    pub(crate) stiffness: Stiffness,
    /// Share of the modulus of its fibres along their axis.
    pub(crate) along_fibres: f64,
}

/// kg/m³ in t/mm³.
const TONNES_PER_MM3: f64 = 1e-12;

impl Lattice {
    /// The lattice that is exact in uniform strain.
    #[must_use]
    pub fn exact(layout: &Layout) -> Self {
        let cells = layout.grid.cells();
        let mut lattice = Self {
            grid: layout.grid.clone(),
            thickness_mm: layout.thickness_mm,
            stiffness: layout.stiffness.clone(),
            hourglass: vec![[0.0; 2]; cells],
            bars: layout.bars.iter().map(|bars| (*bars, 1.0)).collect(),
            bonds: Vec::new(),
            masses_t: masses(layout),
        };
        for place in 0..cells {
            lattice.hourglass[place] = lattice.hourglass_beside_bars(place);
        }
        lattice
    }

    /// The hourglass stiffness of a cell without what its bars bear [N/mm].
    fn hourglass_beside_bars(&self, place: usize) -> [f64; 2] {
        let sides = self.grid.sides_mm(place);
        let mut stiffness = self.stiffness[place];
        if let Some((bars, left)) = self.find_bars(place).map(|at| &self.bars[at]) {
            let along = nalgebra::Vector3::from(strain_along(bars.axis));
            let borne = left * bars.moments[0] / (sides[0] * sides[1]);
            stiffness -= along * along.transpose() * borne;
        }
        cell::hourglass(&stiffness, sides, self.thickness_mm)
    }

    fn find_bars(&self, place: usize) -> Option<usize> {
        let found = self
            .bars
            .binary_search_by_key(&place, |(bars, _)| bars.cell as usize);
        found.ok()
    }

    fn bars_of(&self, (bars, left): &(Bars, f64)) -> CellBars {
        let share = left * self.thickness_mm;
        CellBars {
            axis: bars.axis,
            stiffness: [share * bars.moments[1], share * bars.moments[2]],
        }
    }

    /// The paper's lattice: springs by the materials of their two particles.
    ///
    /// # Errors
    /// When cells are not square, or the rule has no stiffness for a material.
    pub fn paper(
        section: &crate::section::Section,
        layout: &Layout,
        rule: PaperRule,
    ) -> Result<Self, CompositeError> {
        Ok(Self {
            grid: layout.grid.clone(),
            thickness_mm: layout.thickness_mm,
            stiffness: Vec::new(),
            hourglass: Vec::new(),
            bars: Vec::new(),
            bonds: paper::bonds(section, layout, rule)?,
            masses_t: masses(layout),
        })
    }

    /// The grid of particles.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Out of the plane [mm].
    #[must_use]
    pub fn thickness_mm(&self) -> f64 {
        self.thickness_mm
    }

    /// The paper's bonds; none in the exact lattice.
    #[must_use]
    pub fn bonds(&self) -> &[Bond] {
        &self.bonds
    }

    /// Leaves out the bonds that are not wanted.
    pub fn keep_bonds(&mut self, wanted: impl FnMut(&Bond) -> bool) {
        self.bonds.retain(wanted);
    }

    /// Mass of each particle [t].
    #[must_use]
    pub fn masses_t(&self) -> &[f64] {
        &self.masses_t
    }

    /// Whether cells, not bonds, hold the particles.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        !self.stiffness.is_empty()
    }

    /// Number of displacements: two for each particle.
    #[must_use]
    pub fn displacements(&self) -> usize {
        2 * self.grid.particles()
    }

    pub(crate) fn cell(&self, place: usize) -> Cell {
        let sides = self.grid.sides_mm(place);
        Cell {
            sides,
            volume: sides[0] * sides[1] * self.thickness_mm,
            stiffness: self.stiffness[place],
            hourglass: self.hourglass[place],
            bars: self.find_bars(place).map(|at| self.bars_of(&self.bars[at])),
        }
    }

    /// The cells of a row from left to right.
    pub(crate) fn row_of_cells(&self, row: usize) -> impl Iterator<Item = Cell> + '_ {
        let columns = self.grid.columns();
        let (x, y) = (self.grid.x_mm(), self.grid.y_mm());
        let height = y[row + 1] - y[row];
        let cells = row * columns..(row + 1) * columns;
        let stiffness = &self.stiffness[cells.clone()];
        let first = cells.start;
        let before = self
            .bars
            .partition_point(|(bars, _)| (bars.cell as usize) < first);
        let mut bars = self.bars[before..].iter().peekable();
        let held = stiffness.iter().zip(&self.hourglass[cells]);
        held.zip(x.windows(2))
            .enumerate()
            .map(move |(column, ((stiffness, hourglass), pair))| {
                let is_here = |(bars, _): &&(Bars, f64)| bars.cell as usize == first + column;
                let sides = [pair[1] - pair[0], height];
                Cell {
                    sides,
                    volume: sides[0] * sides[1] * self.thickness_mm,
                    stiffness: *stiffness,
                    hourglass: *hourglass,
                    bars: bars.next_if(is_here).map(|bars| self.bars_of(bars)),
                }
            })
    }

    /// Gives a cell another stiffness, and the hourglass stiffness that goes with it.
    pub(crate) fn replace_stiffness(&mut self, place: usize, left: CellStiffness) {
        self.stiffness[place] = left.stiffness;
        if let Some(at) = self.find_bars(place) {
            self.bars[at].1 = left.along_fibres;
        }
        self.hourglass[place] = self.hourglass_beside_bars(place);
    }

    pub(crate) fn cells(&self) -> usize {
        self.stiffness.len()
    }

    /// Energy [N mm] at displacements u [mm], whose derivatives [N], the forces that hold it there,
    /// are written to `forces`.
    pub fn forces(&self, geometry: Geometry, u: &[f64], forces: &mut [f64]) -> f64 {
        forces.fill(0.0);
        match geometry {
            Geometry::Linear => {
                self.cell_forces(u, forces, Cell::linear_forces)
                    + self.bond_forces(u, forces, Bond::linear_stretch)
            }
            Geometry::Large => {
                self.cell_forces(u, forces, Cell::large_forces)
                    + self.bond_forces(u, forces, Bond::large_stretch)
            }
        }
    }

    fn cell_forces(
        &self,
        u: &[f64],
        forces: &mut [f64],
        law: impl Fn(&Cell, &Corners) -> (f64, Corners),
    ) -> f64 {
        let mut energy = 0.0;
        for place in 0..self.cells() {
            let corners = self.grid.corners(place);
            let (stored, parts) = law(&self.cell(place), &gather(u, corners));
            energy += stored;
            for (corner, particle) in corners.into_iter().enumerate() {
                forces[2 * particle] += parts[2 * corner];
                forces[2 * particle + 1] += parts[2 * corner + 1];
            }
        }
        energy
    }

    fn bond_forces(
        &self,
        u: &[f64],
        forces: &mut [f64],
        stretch: impl Fn(&Bond, &Ends) -> (f64, [f64; 2]),
    ) -> f64 {
        let mut energy = 0.0;
        for bond in &self.bonds {
            let [first, second] = bond.particles.map(|particle| particle as usize);
            let (stored, parts) = bond.forces(stretch(bond, &ends(u, bond)));
            energy += stored;
            forces[2 * first] += parts[0];
            forces[2 * first + 1] += parts[1];
            forces[2 * second] += parts[2];
            forces[2 * second + 1] += parts[3];
        }
        energy
    }

    /// An empty matrix for [`Lattice::tangent`].
    pub(crate) fn matrix(&self) -> GridMatrix {
        GridMatrix::zeros(self.grid.columns() + 1, self.grid.rows() + 1)
    }

    /// The tangent of the forces at displacements u [N/mm].
    pub(crate) fn tangent(
        &self,
        geometry: Geometry,
        tangent: Tangent,
        u: &[f64],
        matrix: &mut GridMatrix,
    ) {
        matrix.clear();
        let exact = tangent == Tangent::Exact;
        for place in 0..self.cells() {
            let cell = self.cell(place);
            let corners = self.grid.corners(place);
            let part = match geometry {
                Geometry::Linear => cell.linear_matrix(),
                Geometry::Large => cell.large_matrix(&gather(u, corners), exact),
            };
            matrix.add_cell(corners[0], &part);
        }
        for bond in &self.bonds {
            let block = match geometry {
                Geometry::Linear => bond.block(bond.linear_stretch(&ends(u, bond)), 0.0),
                Geometry::Large => {
                    let stretch = bond.large_stretch(&ends(u, bond));
                    let across = bond.tension_over_length(stretch.0);
                    bond.block(stretch, if exact { across } else { across.max(0.0) })
                }
            };
            matrix.add_spring(bond.particles.map(|particle| particle as usize), block);
        }
    }

    /// The first cell that displacements turn inside out.
    #[must_use]
    pub fn inverted_cell(&self, u: &[f64]) -> Option<usize> {
        (0..self.grid.cells()).find(|&place| self.is_inverted(place, u))
    }

    /// Cells that displacements turn inside out.
    pub fn inverted_cells<'a>(&'a self, u: &'a [f64]) -> impl Iterator<Item = usize> + 'a {
        (0..self.grid.cells()).filter(|&place| self.is_inverted(place, u))
    }

    fn is_inverted(&self, place: usize, u: &[f64]) -> bool {
        let corners = gather(u, self.grid.corners(place));
        cell::is_inverted(self.grid.sides_mm(place), &corners)
    }

    /// Mean stress of a cell (σ_xx, σ_yy, σ_xy) [MPa] in its own frame; `None` in the paper's
    /// lattice, whose cells have no stress.
    #[must_use]
    pub fn stress(&self, geometry: Geometry, place: usize, u: &[f64]) -> Option<[f64; 3]> {
        (place < self.cells()).then(|| {
            let cell = self.cell(place);
            let corners = gather(u, self.grid.corners(place));
            let measures = match geometry {
                Geometry::Linear => cell.measures(&corners),
                Geometry::Large => cell.large_measures(&corners).0,
            };
            let answers = cell.answers(&measures);
            [0, 1, 2].map(|part| answers[part] / cell.volume)
        })
    }
}

/// Displacements of four particles, x and y by turns.
pub(crate) fn gather(u: &[f64], corners: [usize; 4]) -> Corners {
    let mut gathered = [0.0; 8];
    for (corner, particle) in corners.into_iter().enumerate() {
        gathered[2 * corner] = u[2 * particle];
        gathered[2 * corner + 1] = u[2 * particle + 1];
    }
    gathered
}

/// A quarter of each cell's mass goes to each of its particles.
fn masses(layout: &Layout) -> Vec<f64> {
    let grid = &layout.grid;
    let mut masses = vec![0.0; grid.particles()];
    for (place, density) in layout.density.iter().enumerate() {
        let [a, b] = grid.sides_mm(place);
        let quarter = density * TONNES_PER_MM3 * a * b * layout.thickness_mm / 4.0;
        for particle in grid.corners(place) {
            masses[particle] += quarter;
        }
    }
    masses
}
