//! What a shift of particles along a bond has to be, to stand for a spring.
//!
//! One bond of stiffness k between particles of inverse masses w₁ + w₂ = W, relaxed n times a step by
//! the share s of its elongation, comes to rest under a force F at F / k_eff with
//!
//! k_eff = ((1 - s)⁻ⁿ - 1) / (τ² W)  ⇔  s = 1 - (1 + τ² k W)^(-1/n)   (7)
//!
//! The share of the elongation, given as an impulse, is Δλ = -g(kW) k δ with
//! g(Λ) = (1 - (1 + τ²Λ)^(-1/n)) / Λ. A cell has five measures e with moduli D = C Cᵀ; with
//! Cᵀ W C = Q Λ Qᵀ the same holds for all of them together: Δλ = -C Q g(Λ) Qᵀ Cᵀ e. XPBD has
//! g(Λ) = 1 / (Λ + 1/τ²), which is the same for n = 1.
//!
//! Inverse masses of held displacements are 0: the partner takes all.
use nalgebra::{SMatrix, SVector};

use crate::lattice::{Bond, Cell, Ends, Geometry, Lattice, Measures, Rates, ends, gather};
use crate::motion::options::Scheme;

type Matrix5 = SMatrix<f64, 5, 5>;

/// Gains of all cells and bonds, and XPBD's multipliers.
#[derive(Debug)]
pub(super) struct Gains {
    pub(super) cells: Vec<Matrix5>,
    pub(super) bonds: Vec<f64>,
    /// XPBD only.
    pub(super) memory: Option<Memory>,
}

/// The multipliers, kept as the measures z whose forces D z they are: at rest z is e.
#[derive(Debug)]
pub(super) struct Memory {
    /// How z follows e: Δz = D⁻¹ G (e - z) / τ².
    pub(super) cell_rates: Vec<Matrix5>,
    pub(super) bond_rates: Vec<f64>,
    pub(super) cells: Vec<Measures>,
    pub(super) bonds: Vec<f64>,
}

impl Gains {
    pub(super) fn new(
        lattice: &Lattice,
        inverse_masses: &[f64],
        scheme: Scheme,
        time_step: f64,
    ) -> Self {
        let square = time_step * time_step;
        let gain = |product: f64| match scheme {
            Scheme::Verlet => 0.0,
            Scheme::Pbd { iterations } => {
                let x = square * product;
                let n = f64::from(iterations.max(1));
                if x < 1e-12 {
                    square / n
                } else {
                    -(-x.ln_1p() / n).exp_m1() / product
                }
            }
            Scheme::Xpbd { .. } => 1.0 / (product + 1.0 / square),
        };
        if scheme == Scheme::Verlet {
            return Self {
                cells: Vec::new(),
                bonds: Vec::new(),
                memory: None,
            };
        }
        let mut cells = Vec::with_capacity(lattice.cells());
        let mut cell_rates = Vec::with_capacity(lattice.cells());
        for place in 0..lattice.cells() {
            let cell = lattice.cell(place);
            let weights = gather(inverse_masses, lattice.grid().corners(place));
            let mobility = mobility(&cell.rates(), &weights);
            let (own, rate) = cell_gain(&cell, &mobility, &gain);
            cells.push(own);
            cell_rates.push(rate / square);
        }
        let mut bonds = Vec::with_capacity(lattice.bonds().len());
        let mut bond_rates = Vec::with_capacity(lattice.bonds().len());
        for bond in lattice.bonds() {
            let k = bond.stiffness_n_per_mm;
            let own = gain(k * bond_mobility(bond, &ends(inverse_masses, bond)));
            bonds.push(k * own);
            bond_rates.push(own / square);
        }
        let memory = matches!(scheme, Scheme::Xpbd { .. }).then(|| Memory {
            cells: vec![[0.0; 5]; cells.len()],
            bonds: vec![0.0; bonds.len()],
            cell_rates,
            bond_rates,
        });
        Self {
            cells,
            bonds,
            memory,
        }
    }

    /// The forces XPBD's multipliers stand for, at displacements u.
    pub(super) fn multiplier_forces(
        &self,
        lattice: &Lattice,
        geometry: Geometry,
        u: &[f64],
        forces: &mut [f64],
    ) {
        forces.fill(0.0);
        let Some(memory) = &self.memory else { return };
        for (place, z) in memory.cells.iter().enumerate() {
            let cell = lattice.cell(place);
            let corners = lattice.grid().corners(place);
            let rates = match geometry {
                Geometry::Linear => cell.rates(),
                Geometry::Large => cell.large_measures(&gather(u, corners)).1,
            };
            for (rate, answer) in rates.iter().zip(cell.answers(z)) {
                for (corner, particle) in corners.into_iter().enumerate() {
                    forces[2 * particle] += answer * rate[2 * corner];
                    forces[2 * particle + 1] += answer * rate[2 * corner + 1];
                }
            }
        }
        for (bond, z) in lattice.bonds().iter().zip(&memory.bonds) {
            let (_, d) = match geometry {
                Geometry::Linear => bond.linear_stretch(&ends(u, bond)),
                Geometry::Large => bond.large_stretch(&ends(u, bond)),
            };
            let (_, parts) = bond.forces((*z, d));
            let [first, second] = bond.particles.map(|particle| 2 * particle as usize);
            forces[first] += parts[0];
            forces[first + 1] += parts[1];
            forces[second] += parts[2];
            forces[second + 1] += parts[3];
        }
    }
}

/// W = B M⁻¹ Bᵀ of a cell.
fn mobility(rates: &Rates, weights: &[f64; 8]) -> Matrix5 {
    Matrix5::from_fn(|row, column| {
        (0..8)
            .map(|place| rates[row][place] * weights[place] * rates[column][place])
            .sum()
    })
}

/// w₁ + w₂ along the bond.
fn bond_mobility(bond: &Bond, weights: &Ends) -> f64 {
    let length = bond.length();
    let [x, y] = bond.vector_mm.map(|part| (part / length).powi(2));
    x * (weights[0] + weights[2]) + y * (weights[1] + weights[3])
}

/// G = C Q g(Λ) Qᵀ Cᵀ, and D⁻¹ G.
fn cell_gain(cell: &Cell, mobility: &Matrix5, gain: &impl Fn(f64) -> f64) -> (Matrix5, Matrix5) {
    let moduli = cell.moduli();
    let moduli = Matrix5::from_fn(|row, column| moduli[row][column]);
    let Some(root) = moduli.cholesky() else {
        // Materials are stable, so moduli are positive; a cell without any holds nothing.
        return (Matrix5::zeros(), Matrix5::zeros());
    };
    let root = root.l();
    let eigen = (root.transpose() * mobility * root).symmetric_eigen();
    let gains = SVector::<f64, 5>::from_fn(|place, _| gain(eigen.eigenvalues[place].max(0.0)));
    let half = root * eigen.eigenvectors;
    let own = half * Matrix5::from_diagonal(&gains) * half.transpose();
    let inverse = moduli.try_inverse().unwrap_or_else(Matrix5::zeros);
    (own, inverse * own)
}
