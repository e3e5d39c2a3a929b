//! What a cell is as a whole: stiffness and constants, and the fields behind them.
use nalgebra::{Matrix6, Vector6};

use super::balance::{Balanced, balance};
use super::cells::{Cells, PlaneCells, Rates, ShearCells};
use super::constants::Constants;
use super::phase::Space;
use super::pixels::Pixels;
use super::spectrum::Spectrum;
use super::torus::{Field, Torus, dot};
use super::{Phase, UnitCell};
use crate::error::CompositeError;
use crate::material::Note;

/// Shares of their hourglass stiffness that whole pixels and pixels cut by a face keep.
///
/// A face that cuts a pixel bends its edges, which the hourglass stiffness resists as if the laminate
/// were one material: the cell is then too stiff. Errors of G₁₂ of a square array of half fibre
/// [PerrinsMcKenzieMcPhedran1979] on 96² pixels, cut pixels with all, 0.3, 0.1 and 0.01 of it:
/// fibres 24 times as stiff as the matrix 5.6e-3, 2.6e-3, 1.4e-3, 0.8e-3; 200 times 2.1e-2, 1.3e-2,
/// 8.8e-3, 5.8e-3; a hundredth -1.0e-3, -1.5e-3, -1.7e-3, -1.8e-3. What is kept holds checkerboards.
/// Whole pixels with less lose nothing and gain little.
const HOURGLASS: [f64; 2] = [1.0, 0.01];

/// Voigt places of the strains that drive the in-plane problem, and those along the fibres.
const PLANE: [usize; 4] = [0, 1, 2, 3];
const SHEAR: [usize; 2] = [5, 4];

/// What is done to a cell as a whole; order 11, 22, 33, 23, 13, 12.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Load {
    /// Mean strains [-], shears twice the tensor's.
    Strain([f64; 6]),
    /// Mean stresses [MPa].
    Stress([f64; 6]),
}

/// The effective material of a unit cell.
#[derive(Debug, Clone)]
pub struct Effective {
    pub constants: Constants,
    /// Mean stress [MPa] by mean strain, order 11, 22, 33, 23, 13, 12, shears twice the tensor's.
    pub stiffness: [[f64; 6]; 6],
    /// Share of fibre.
    pub fraction: f64,
    /// Largest residual of the load cases over their loads.
    pub residual: f64,
    /// Of conjugate gradients, all load cases together.
    pub iterations: u64,
    /// Constants of the phases that were not given.
    pub notes: Vec<(Phase, Note)>,
    pub(super) pixels: Pixels,
    /// Displacements u₂, u₃ [mm] on top of the uniform strain 1 of each of [`PLANE`].
    plane: [Field; 4],
    /// Displacements u₁ [mm] on top of γ₁₂ = 1 and of γ₁₃ = 1.
    shear: Field,
}

/// Problems with their loads: what drives them and what the cell answers.
struct Problem<'a, C> {
    torus: Torus,
    cells: &'a C,
    pixels: &'a Pixels,
    spectrum: Spectrum,
    iterations: u64,
    residual: f64,
}

impl<C: Cells> Problem<'_, C> {
    /// Displacements under a load by its stresses in every kind of pixel, and the load.
    fn solve(
        &mut self,
        energy: f64,
        stress: impl Fn(usize) -> Rates,
    ) -> Result<(Field, Field), CompositeError> {
        let mut forces = vec![[0.0; 2]; self.torus.nodes()];
        let kinds = &self.pixels.kind;
        self.torus.gather(&mut forces, |pixel| {
            stress(kinds[pixel] as usize).map(|row| row.map(|value| -value))
        });
        let nodes = self.torus.nodes() as f64;
        let Balanced {
            field,
            iterations,
            residual,
        } = balance(
            &self.torus,
            self.cells,
            kinds,
            &mut self.spectrum,
            &forces,
            energy * nodes,
        )?;
        self.iterations += iterations;
        self.residual = self.residual.max(residual);
        Ok((field, forces))
    }

    /// What of the forces displacements leave.
    fn rest(&self, forces: &Field, field: &Field) -> Field {
        let mut rest = vec![[0.0; 2]; forces.len()];
        self.torus
            .forces(self.cells, &self.pixels.kind, field, &mut rest);
        for (rest, force) in rest.iter_mut().zip(forces) {
            for unknown in 0..2 {
                rest[unknown] = force[unknown] - rest[unknown];
            }
        }
        rest
    }
}

impl Effective {
    pub(super) fn of(
        pixels: Pixels,
        fraction: f64,
        notes: Vec<(Phase, Note)>,
    ) -> Result<Self, CompositeError> {
        Self::with_hourglass(pixels, fraction, notes, HOURGLASS)
    }

    /// With these shares of the hourglass stiffness in whole and in cut pixels.
    ///
    /// The effective stiffness is the energy of two load cases together, per volume,
    /// C_ab = ⟨E_a C E_b⟩ - f_a u_b - u_a r_b, with loads f = -⟨B C E⟩ and what is left r = f - A u:
    /// wrong only by the product of two residuals.
    pub(super) fn with_hourglass(
        pixels: Pixels,
        fraction: f64,
        notes: Vec<(Phase, Note)>,
        hourglass: [f64; 2],
    ) -> Result<Self, CompositeError> {
        let torus = Torus {
            grid: pixels.grid,
            sides_mm: pixels.sides_mm,
        };
        let kinds = &pixels.stiffness;
        let share = |kind: usize| hourglass[usize::from(kind > 1)];
        let uniform = [(kinds[0] + kinds[1]) * 0.5];
        let mean = Space::from_fn(|i, j| pixels.mean(|kind| kinds[kind][(i, j)]));
        let nodes = torus.nodes() as f64;
        let mut stiffness = mean;

        let cells = PlaneCells::new(kinds, pixels.sides_mm, share);
        let like = PlaneCells::new(&uniform, pixels.sides_mm, |_| hourglass[0]);
        let mut problem = Problem {
            torus,
            cells: &cells,
            pixels: &pixels,
            spectrum: Spectrum::new(&torus, &like, 0),
            iterations: 0,
            residual: 0.0,
        };
        let mut solved = Vec::with_capacity(PLANE.len());
        for place in PLANE {
            let (field, forces) = problem.solve(mean[(place, place)], |kind| {
                let stress = |row: usize| kinds[kind][(row, place)];
                [[stress(1), stress(3)], [stress(3), stress(2)], [0.0; 2]]
            })?;
            let rest = problem.rest(&forces, &field);
            solved.push((field, forces, rest));
        }
        for (a, (u_a, f_a, _)) in solved.iter().enumerate() {
            for (b, (u_b, _, r_b)) in solved.iter().enumerate() {
                let relief = dot(f_a, u_b) + dot(u_a, r_b);
                stiffness[(PLANE[a], PLANE[b])] -= relief / nodes;
            }
        }
        let (mut iterations, mut residual) = (problem.iterations, problem.residual);
        let mut fields = solved.into_iter().map(|(field, ..)| field);
        let plane = [0; 4].map(|_| fields.next().unwrap_or_default());

        let cells = ShearCells::new(kinds, pixels.sides_mm, share);
        let like = ShearCells::new(&uniform, pixels.sides_mm, |_| hourglass[0]);
        let mut problem = Problem {
            torus,
            cells: &cells,
            pixels: &pixels,
            spectrum: Spectrum::new(&torus, &like, 0),
            iterations: 0,
            residual: 0.0,
        };
        // both cases at once: as derivatives of the two unknowns
        let (shear, forces) = problem.solve(mean[(4, 4)] + mean[(5, 5)], |kind| {
            cells.answer(kind as u32, [[1.0, 0.0], [0.0, 1.0], [0.0; 2]])
        })?;
        let rest = problem.rest(&forces, &shear);
        for (a, &row) in SHEAR.iter().enumerate() {
            for (b, &column) in SHEAR.iter().enumerate() {
                let relief: f64 = (0..shear.len())
                    .map(|node| forces[node][a] * shear[node][b] + shear[node][a] * rest[node][b])
                    .sum();
                stiffness[(row, column)] -= relief / nodes;
            }
        }
        iterations += problem.iterations;
        residual = residual.max(problem.residual);

        let stiffness = (stiffness + stiffness.transpose()) * 0.5;
        let compliance = inverse(&stiffness)?;
        Ok(Self {
            constants: Constants::of_compliance(&compliance),
            stiffness: [0, 1, 2, 3, 4, 5].map(|i| [0, 1, 2, 3, 4, 5].map(|j| stiffness[(i, j)])),
            fraction,
            residual,
            iterations,
            notes,
            pixels,
            plane,
            shear,
        })
    }

    /// Number of pixels along 2 and 3.
    #[must_use]
    pub fn grid(&self) -> [usize; 2] {
        self.pixels.grid
    }

    /// Sides of a pixel along 2 and 3 [mm].
    #[must_use]
    pub fn pixel_mm(&self) -> [f64; 2] {
        self.pixels.sides_mm
    }

    /// Longer sides of a pixel across the thinnest fibre; infinite without fibres.
    #[must_use]
    pub fn pixels_across_fibre(&self) -> f64 {
        self.pixels.across_fibre
    }

    /// Share of fibre in every pixel, those along 2 in sequence.
    #[must_use]
    pub fn fibre_shares(&self) -> Vec<f64> {
        self.pixels.fibre_shares()
    }

    /// Mean stress of every pixel [MPa] under a load, those along 2 in sequence; order 11, 22, 33,
    /// 23, 13, 12.
    ///
    /// # Errors
    /// When a load is not finite.
    pub fn fields(&self, load: &Load) -> Result<Vec<[f64; 6]>, CompositeError> {
        let strains = self.strains(load)?;
        let stress = |(pixel, strain)| self.pixels.stress(pixel, strain).into();
        Ok(strains.iter().enumerate().map(stress).collect())
    }

    /// Mean strain of every pixel under a load.
    pub(super) fn strains(&self, load: &Load) -> Result<Vec<Vector6<f64>>, CompositeError> {
        let mean = self.mean_strain(load)?;
        let mut plane = vec![[0.0; 2]; self.shear.len()];
        for (field, place) in self.plane.iter().zip(PLANE) {
            for (sum, value) in plane.iter_mut().zip(field) {
                sum[0] += mean[place] * value[0];
                sum[1] += mean[place] * value[1];
            }
        }
        let torus = Torus {
            grid: self.pixels.grid,
            sides_mm: self.pixels.sides_mm,
        };
        let mut strains = vec![mean; self.pixels.count()];
        torus.for_rates(&plane, |pixel, [along_2, along_3, _]| {
            let strain = &mut strains[pixel];
            strain[1] += along_2[0];
            strain[2] += along_3[1];
            strain[3] += along_2[1] + along_3[0];
        });
        torus.for_rates(&self.shear, |pixel, [along_2, along_3, _]| {
            let strain = &mut strains[pixel];
            for (case, place) in SHEAR.into_iter().enumerate() {
                strain[5] += mean[place] * along_2[case];
                strain[4] += mean[place] * along_3[case];
            }
        });
        Ok(strains)
    }

    /// Mean strain of a load.
    fn mean_strain(&self, load: &Load) -> Result<Vector6<f64>, CompositeError> {
        let (Load::Strain(given) | Load::Stress(given)) = load;
        for value in given {
            crate::error::finite("a strain or stress of the load", *value)?;
        }
        let given = Vector6::from(*given);
        match load {
            Load::Strain(_) => Ok(given),
            Load::Stress(_) => Ok(inverse(&self.matrix())? * given),
        }
    }

    pub(super) fn matrix(&self) -> Matrix6<f64> {
        Matrix6::from_fn(|i, j| self.stiffness[i][j])
    }
}

/// The compliance [1/MPa] of a stiffness.
pub(super) fn inverse(stiffness: &Matrix6<f64>) -> Result<Matrix6<f64>, CompositeError> {
    match stiffness.cholesky() {
        Some(factor) => Ok(factor.inverse()),
        None => Err(CompositeError::NotFinite {
            quantity: "the compliance of a unit cell",
            step: 0,
        }),
    }
}

impl UnitCell {
    /// The effective material, on a grid of so many pixels along 2 and 3.
    ///
    /// # Errors
    /// When a size, a material, a fibre or the number of pixels is outside its range, fibres overlap,
    /// or no equilibrium is found.
    pub fn effective(&self, grid: [usize; 2]) -> Result<Effective, CompositeError> {
        let (phases, notes) = self.checked(grid)?;
        let pixels = Pixels::new(self, grid, phases);
        Effective::of(pixels, self.fraction(), notes)
    }

    /// Share of fibre in every pixel of such a grid, those along 2 in sequence.
    ///
    /// # Errors
    /// As [`Self::effective`], before equilibrium.
    pub fn fibre_shares(&self, grid: [usize; 2]) -> Result<Vec<f64>, CompositeError> {
        let (phases, _) = self.checked(grid)?;
        Ok(Pixels::new(self, grid, phases).fibre_shares())
    }
}
