//! The lattice under its drive at load factor 1, while cells of it soften.
//!
//! Its matrix is factored once; what cells lost since is taken from the factor by
//! [`Softening`](loadframe_numerics::Softening), and it is factored anew before that costs more. The
//! new displacements are found from the old ones by their unbalanced forces, so that round-off is
//! taken away with every crack and never adds up.
use loadframe_numerics::{NoFactor, Softening};
use nalgebra::Matrix3;
use serde::{Deserialize, Serialize};

use crate::error::CompositeError;
use crate::lattice::{CellStiffness, Geometry, Lattice, Measures, Rates, Tangent, gather};
use crate::matrix::GridMatrix;
use crate::solve::direct::Direct;
use crate::solve::told;
use crate::supports::Supports;

/// Columns that a factor carries before it is made anew. On 100 by 30 cells twice as many are as fast, see the table in [`breaking`](crate::breaking).
pub(super) const MOST_COLUMNS: usize = 64;

/// Largest unbalanced force over the largest force, below which displacements are not refined.
const BALANCED: f64 = 1e-11;
/// The same, above which they are no equilibrium.
const UNBALANCED: f64 = 1e-7;
/// Solutions after which refining further is of no use.
const REFINEMENTS: u64 = 5;
/// Parts of a change of stiffness below this over the largest are round-off.
const ROUND_OFF: f64 = 1e-13;

/// What drives the section, in the measure that does its work.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Drive {
    /// Forces of this size together [N].
    Forces(f64),
    /// Displacements of this [reach](Supports::reach_mm) [mm].
    Displacements(f64),
}

/// What a cell's stiffness loses, of all its measures: volume included [N mm] of the mean strains, [N/mm] of
/// the hourglass amplitudes, and [N] between both.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Loss {
    pub(crate) moduli: [[f64; 5]; 5],
}

impl Loss {
    /// a · loss · b of the measures of two states [N mm].
    pub(crate) fn between(&self, a: &Measures, b: &Measures) -> f64 {
        let mut sum = 0.0;
        for (moduli, a) in self.moduli.iter().zip(a) {
            for (modulus, b) in moduli.iter().zip(b) {
                sum += a * modulus * b;
            }
        }
        sum
    }

    /// The measures it is the sum of, each with its part: its eigenvectors, of strains and of either hourglass
    /// amplitude alone where nothing couples them. What is below `ROUND_OFF` beside what is `left` is none.
    fn modes(&self, left: &[[f64; 5]; 5]) -> Vec<(f64, [f64; 5])> {
        let mut modes = Vec::with_capacity(5);
        if (0..3).any(|row| self.moduli[row][3..] != [0.0; 2]) || self.moduli[3][4] != 0.0 {
            let eigen = Matrix5::from(self.moduli).symmetric_eigen();
            let largest = eigen.eigenvalues.amax();
            for place in 0..5 {
                let value = eigen.eigenvalues[place];
                if value.abs() > ROUND_OFF * largest {
                    modes.push((value, eigen.eigenvectors.column(place).into_owned().into()));
                }
            }
            return modes;
        }
        let strains = Matrix3::from_fn(|row, column| self.moduli[row][column]);
        let eigen = strains.symmetric_eigen();
        let largest = eigen.eigenvalues.amax();
        for place in 0..3 {
            let value = eigen.eigenvalues[place];
            if value.abs() > ROUND_OFF * largest {
                let vector = eigen.eigenvectors.column(place);
                modes.push((value, [vector[0], vector[1], vector[2], 0.0, 0.0]));
            }
        }
        for axis in 3..5 {
            let value = self.moduli[axis][axis];
            if value.abs() > ROUND_OFF * left[axis][axis] {
                let mut mode = [0.0; 5];
                mode[axis] = 1.0;
                modes.push((value, mode));
            }
        }
        modes
    }
}

type Matrix5 = nalgebra::SMatrix<f64, 5, 5>;

#[derive(Debug)]
pub(crate) struct System {
    pub(crate) lattice: Lattice,
    supports: Supports,
    pub(crate) load: Vec<f64>,
    drive: Drive,
    matrix: GridMatrix,
    direct: Direct,
    softening: Softening,
    most_columns: usize,
    /// Solutions for unit measures of cells with the factor: several teeth of a cell need them.
    solved: Vec<(u32, u8, Vec<f64>)>,
    u: Vec<f64>,
    forces: Vec<f64>,
    right: Vec<f64>,
    step: Vec<f64>,
    energy: f64,
    /// How often it was factored.
    pub(crate) factors: u64,
}

impl System {
    pub(crate) fn new(
        lattice: Lattice,
        supports: &Supports,
        load_n: &[f64],
        most_columns: usize,
    ) -> Result<Self, CompositeError> {
        let drive = drive(&lattice, supports, load_n)?;
        supports.refuse_rigid_motion(lattice.grid())?;
        let matrix = lattice.matrix();
        let direct =
            Direct::new(&matrix, supports).map_err(|failure| told(failure, lattice.grid()))?;
        let size = lattice.displacements();
        let mut load = load_n.to_vec();
        release_held(&mut load, supports);
        let mut system = Self {
            softening: Softening::new(size),
            supports: supports.clone(),
            load,
            drive,
            matrix,
            direct,
            most_columns,
            solved: Vec::new(),
            u: vec![0.0; size],
            forces: vec![0.0; size],
            right: vec![0.0; size],
            step: vec![0.0; size],
            energy: 0.0,
            factors: 0,
            lattice,
        };
        system.factor()?;
        Ok(system)
    }

    /// Displacements at load factor 1 [mm].
    pub(crate) fn displacements(&self) -> &[f64] {
        &self.u
    }

    /// Measures of a cell at load factor 1.
    pub(crate) fn measures(&self, cell: usize) -> Measures {
        let corners = gather(&self.u, self.lattice.grid().corners(cell));
        self.lattice.cell(cell).measures(&corners)
    }

    /// Displacement [mm] and force [N] of the drive at load factor 1: their product is the work of
    /// all loads and supports.
    pub(crate) fn response(&self) -> [f64; 2] {
        let work =
            |forces: &[f64], u: &[f64]| forces.iter().zip(u).map(|(f, u)| f * u).sum::<f64>();
        match self.drive {
            Drive::Forces(force) => [work(&self.load, &self.u) / force, force],
            Drive::Displacements(largest) => {
                // forces on what moves freely are round-off
                let held = (0..self.u.len()).filter(|&place| self.supports.is_held(place));
                let work: f64 = held.map(|place| self.forces[place] * self.u[place]).sum();
                [largest, work / largest]
            }
        }
    }

    /// Elastic energy at load factor 1 [N mm].
    pub(crate) fn energy(&self) -> f64 {
        self.energy
    }

    /// Loads the section otherwise, by forces that sum up to as much, and factors.
    pub(crate) fn reload(&mut self, load_n: &[f64]) -> Result<(), CompositeError> {
        self.load.copy_from_slice(load_n);
        release_held(&mut self.load, &self.supports);
        self.factor()
    }

    /// Gives cells new stiffnesses and factors.
    pub(crate) fn restart(
        &mut self,
        cells: impl Iterator<Item = (usize, CellStiffness)>,
    ) -> Result<(), CompositeError> {
        for (cell, stiffness) in cells {
            self.lattice.replace_stiffness(cell, stiffness);
        }
        self.factor()
    }

    /// Gives a cell another stiffness; what it lost, and whether the system was factored anew.
    pub(crate) fn alter(
        &mut self,
        cell: usize,
        stiffness: CellStiffness,
    ) -> Result<(Loss, bool), CompositeError> {
        let before = self.lattice.cell(cell).moduli();
        self.lattice.replace_stiffness(cell, stiffness);
        let after = self.lattice.cell(cell).moduli();
        let loss = Loss {
            moduli: [0, 1, 2, 3, 4]
                .map(|row| [0, 1, 2, 3, 4].map(|column| before[row][column] - after[row][column])),
        };
        if self.softening.len() + 5 > self.most_columns || !self.take(cell, &loss) {
            self.factor()?;
            return Ok((loss, true));
        }
        if self.settle() > UNBALANCED {
            self.factor()?;
            return Ok((loss, true));
        }
        Ok((loss, false))
    }

    /// Takes a loss from the factor, or gives back what is below 0; `false` where only a new factor knows
    /// what is left.
    fn take(&mut self, cell: usize, loss: &Loss) -> bool {
        let rates = self.lattice.cell(cell).rates();
        let corners = self.lattice.grid().corners(cell);
        let modes = loss.modes(&self.lattice.cell(cell).moduli());
        self.solve_measures(cell as u32, &modes, &rates, corners);
        for (coefficient, mode) in modes {
            let mut entries = Vec::with_capacity(8);
            for (corner, particle) in corners.into_iter().enumerate() {
                for axis in 0..2 {
                    let displacement = 2 * particle + axis;
                    let value: f64 = (0..5)
                        .map(|measure| mode[measure] * rates[measure][2 * corner + axis])
                        .sum();
                    if !self.supports.is_held(displacement) && value != 0.0 {
                        entries.push((displacement as u32, value));
                    }
                }
            }
            if entries.is_empty() {
                continue;
            }
            let solved = &self.solved;
            let taken = self.softening.take(&entries, coefficient, |_, solution| {
                solution.fill(0.0);
                for (of, measure, column) in solved {
                    let weight = mode[*measure as usize];
                    if *of == cell as u32 && weight != 0.0 {
                        for (sum, value) in solution.iter_mut().zip(column) {
                            *sum += weight * value;
                        }
                    }
                }
            });
            if taken.is_err() {
                return false;
            }
        }
        true
    }

    /// Solves for unit forces of the measures of a cell that its modes need, once for each factor.
    fn solve_measures(
        &mut self,
        cell: u32,
        modes: &[(f64, [f64; 5])],
        rates: &Rates,
        corners: [usize; 4],
    ) {
        let is_needed = |measure: usize| modes.iter().any(|(_, mode)| mode[measure] != 0.0);
        let is_known = |measure: usize| {
            let same = |(of, which, _): &(u32, u8, Vec<f64>)| {
                *of == cell && usize::from(*which) == measure
            };
            self.solved.iter().any(same)
        };
        let missing: Vec<usize> = (0..5)
            .filter(|&measure| is_needed(measure) && !is_known(measure))
            .collect();
        if missing.is_empty() {
            return;
        }
        let mut columns = vec![vec![0.0; self.u.len()]; missing.len()];
        for (column, &measure) in columns.iter_mut().zip(&missing) {
            for (corner, particle) in corners.into_iter().enumerate() {
                for axis in 0..2 {
                    column[2 * particle + axis] = rates[measure][2 * corner + axis];
                }
            }
        }
        self.direct.solve_several(&mut columns);
        let solved = missing.into_iter().zip(columns);
        self.solved
            .extend(solved.map(|(measure, column)| (cell, measure as u8, column)));
    }

    /// Factors the lattice as it is and finds its displacements from nothing else, so that what
    /// follows is the same whatever came before.
    fn factor(&mut self) -> Result<(), CompositeError> {
        self.factors += 1;
        self.lattice
            .tangent(Geometry::Linear, Tangent::Exact, &self.u, &mut self.matrix);
        let told = |failure: NoFactor, lattice: &Lattice| told(failure, lattice.grid());
        self.direct
            .factor(&self.matrix)
            .map_err(|failure| told(failure, &self.lattice))?;
        self.softening.clear();
        self.solved.clear();
        self.u = self.supports.displacements();
        let residual = self.settle();
        if residual > UNBALANCED || residual.is_nan() {
            return Err(CompositeError::NotConverged {
                load_fraction: 1.0,
                iterations: REFINEMENTS,
                residual,
            });
        }
        Ok(())
    }

    /// Refines the displacements; what is left unbalanced.
    fn settle(&mut self) -> f64 {
        let mut residual = self.unbalance();
        for _ in 0..REFINEMENTS {
            if residual <= BALANCED {
                break;
            }
            self.direct.solve(&self.right, &mut self.step);
            self.softening.correct(&mut self.step);
            for (u, step) in self.u.iter_mut().zip(&self.step) {
                *u += step;
            }
            let refined = self.unbalance();
            // beyond this it is round-off that changes
            if refined > 0.5 * residual {
                residual = refined;
                break;
            }
            residual = refined;
        }
        residual
    }

    /// Forces and energy at the displacements; the largest unbalanced force over the largest one.
    fn unbalance(&mut self) -> f64 {
        self.energy = self
            .lattice
            .forces(Geometry::Linear, &self.u, &mut self.forces);
        let (mut largest, mut unbalanced) = (0.0_f64, 0.0_f64);
        for (place, force) in self.forces.iter().enumerate() {
            if self.supports.is_held(place) {
                largest = largest.max(force.abs());
                self.right[place] = 0.0;
            } else {
                let left = self.load[place] - force;
                largest = largest.max(self.load[place].abs());
                unbalanced = unbalanced.max(left.abs());
                self.right[place] = left;
            }
        }
        if !self.energy.is_finite() {
            f64::INFINITY
        } else if unbalanced > 0.0 {
            unbalanced / largest
        } else {
            0.0
        }
    }
}

/// What pushes on a support does no work.
fn release_held(load: &mut [f64], supports: &Supports) {
    for (place, force) in load.iter_mut().enumerate() {
        if supports.is_held(place) {
            *force = 0.0;
        }
    }
}

/// The one thing that drives a section.
fn drive(lattice: &Lattice, supports: &Supports, load_n: &[f64]) -> Result<Drive, CompositeError> {
    let size = lattice.displacements();
    if load_n.len() != size || supports.displacements().len() != size {
        return Err(CompositeError::OtherSize);
    }
    let (mut sum, mut sizes) = ([0.0_f64; 2], 0.0_f64);
    for (place, force) in load_n.iter().enumerate() {
        crate::error::finite("a load [N]", *force)?;
        if !supports.is_held(place) {
            sum[place % 2] += force;
        }
    }
    let largest = supports.reach_mm();
    for particle in 0..load_n.len() / 2 {
        let free = [0, 1].map(|axis| {
            let place = 2 * particle + axis;
            if supports.is_held(place) {
                0.0
            } else {
                load_n[place]
            }
        });
        sizes += free[0].hypot(free[1]);
    }
    match (sizes > 0.0, largest > 0.0) {
        (true, true) => Err(CompositeError::MixedDrive),
        (false, false) => Err(CompositeError::NoDrive),
        (false, true) => Ok(Drive::Displacements(largest)),
        (true, false) => {
            // forces that balance each other open something: half of them pull at each side
            let whole = sum[0].hypot(sum[1]);
            let balance = 1e-9 * sizes;
            Ok(Drive::Forces(if whole > balance {
                whole
            } else {
                0.5 * sizes
            }))
        }
    }
}
