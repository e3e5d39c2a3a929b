//! The exact lattice seen as springs: which force each edge and each diagonal carries.
//!
//! Six bars join four particles, and their forces can balance any forces the cell exerts; one state
//! of self-stress is left open. It is fixed as the lattice of springs would have it: the diagonals
//! carry the sum of forces that springs of the stiffness
//!
//! k_d = t C₆₆ l² / (2 a b), l² = a² + b²   (4)
//!
//! would. For an aligned orthotropic cell this is the cross lattice of edge and diagonal springs
//! and an area term, whose share the edges carry here; for square cells
//! k₁ₓ = t (C₁₁ - C₁₂), k₁ᵧ = t (C₂₂ - C₁₂), k₂ = t C₆₆ and κ = t (C₁₂ - C₆₆) per unit of area,
//! to which the test in this folder compares. Of off-axis fibres C₁₆ and C₂₆ have no spring; their
//! stress is carried all the same.
use crate::lattice::{Geometry, Lattice, gather};

/// Forces in the bonds of a cell [N], tension positive.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CellBonds {
    pub bottom: f64,
    pub top: f64,
    pub left: f64,
    pub right: f64,
    /// From the lower left to the upper right.
    pub rising: f64,
    /// From the upper left to the lower right.
    pub falling: f64,
}

/// Forces in all bonds [N], each edge with the parts of both its cells.
#[derive(Debug, Clone)]
pub struct BondForces {
    /// Edges along x, row of particles by row: columns × (rows + 1).
    pub along_x: Vec<f64>,
    /// Edges along y: (columns + 1) × rows.
    pub along_y: Vec<f64>,
    /// Diagonals of each cell, rising and falling.
    pub diagonals: Vec<[f64; 2]>,
}

impl Lattice {
    /// Bond forces of one cell; `None` in the paper's lattice.
    #[must_use]
    pub fn cell_bonds(&self, geometry: Geometry, place: usize, u: &[f64]) -> Option<CellBonds> {
        let [xx, yy, xy] = self.stress(geometry, place, u)?;
        let cell = self.cell(place);
        let corners = gather(u, self.grid().corners(place));
        let measures = match geometry {
            Geometry::Linear => cell.measures(&corners),
            Geometry::Large => cell.large_measures(&corners).0,
        };
        let [a, b] = cell.sides;
        let t = self.thickness_mm();
        let length = a.hypot(b);
        // Shear by the difference of the diagonals, their sum by (4).
        let difference = xy * t * length;
        let sum = t * cell.stiffness[(2, 2)] * length / (a * b)
            * (a * a * measures[0] + b * b * measures[1]);
        let edge_x = 0.5 * (xx * t * b - sum * a / length);
        let edge_y = 0.5 * (yy * t * a - sum * b / length);
        // The hourglass pulls one edge as it pushes the other.
        let [.., bend_x, bend_y] = cell.answers(&measures);
        Some(CellBonds {
            bottom: edge_x - bend_x,
            top: edge_x + bend_x,
            left: edge_y - bend_y,
            right: edge_y + bend_y,
            rising: 0.5 * (sum + difference),
            falling: 0.5 * (sum - difference),
        })
    }

    /// Bond forces of the whole lattice; `None` in the paper's, whose bonds are its own.
    #[must_use]
    pub fn bond_forces_in_cells(&self, geometry: Geometry, u: &[f64]) -> Option<BondForces> {
        let (columns, rows) = (self.grid().columns(), self.grid().rows());
        let mut forces = BondForces {
            along_x: vec![0.0; columns * (rows + 1)],
            along_y: vec![0.0; (columns + 1) * rows],
            diagonals: vec![[0.0; 2]; columns * rows],
        };
        for j in 0..rows {
            for i in 0..columns {
                let place = j * columns + i;
                let bonds = self.cell_bonds(geometry, place, u)?;
                forces.along_x[place] += bonds.bottom;
                forces.along_x[place + columns] += bonds.top;
                let left = j * (columns + 1) + i;
                forces.along_y[left] += bonds.left;
                forces.along_y[left + 1] += bonds.right;
                forces.diagonals[place] = [bonds.rising, bonds.falling];
            }
        }
        Some(forces)
    }
}
