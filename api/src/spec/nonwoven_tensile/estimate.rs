//! What a nonwoven tensile test takes: counted work over measured speed.
use super::{Fabric, Jaws, Lattice, NonwovenTensile};
use crate::{Calibration, Estimate};

impl Lattice {
    /// Lattice points, jaw points not counted: rows alternate between n_x and n_x + 1.
    pub fn nodes(&self) -> u64 {
        let (columns, rows, layers) = self.sizes();
        (rows * columns + rows / 2) * layers
    }

    /// Bonds, those between two held nodes left out.
    pub fn bonds(&self) -> u64 {
        let (columns, rows, layers) = self.sizes();
        let in_rows = rows * columns - rows.div_ceil(2);
        let diagonals = 2 * columns * rows.saturating_sub(1);
        let upright = (rows * columns + rows / 2) * (layers - 1);
        let all = (in_rows + diagonals) * layers + upright;
        match self.jaws {
            Jaws::HalfBond => all + 4 * columns * layers,
            Jaws::ClampedRows => all - 2 * ((columns - 1) * layers + columns * (layers - 1)),
        }
    }

    fn sizes(&self) -> (u64, u64, u64) {
        (
            self.points_per_row.into(),
            self.rows.into(),
            self.layers.into(),
        )
    }
}

impl Fabric {
    /// Free and held nodes of the lattice or network.
    pub fn nodes(&self) -> u64 {
        match self {
            Self::Lattice(lattice) => lattice.nodes(),
            Self::Network(network) => network.nodes_mm.len() as u64,
        }
    }

    /// Bonds of the lattice or network.
    pub fn bonds(&self) -> u64 {
        match self {
            Self::Lattice(lattice) => lattice.bonds(),
            Self::Network(network) => network.bonds.len() as u64,
        }
    }
}

pub(super) fn estimate(spec: &NonwovenTensile, calibration: &Calibration) -> Estimate {
    let bonds = spec.fabric.bonds() as f64;
    let steps = spec.test.steps() as f64;
    let evaluations = bonds * steps * 100.0;
    Estimate {
        wall_s: evaluations / calibration.bond_evaluations_per_s,
        memory_mb: 20.0 + bonds * 500e-6,
        disk_mb: 0.1 + bonds * 40e-6 * (steps / f64::from(spec.output.snapshot_every_steps.max(1))),
        calibrated: false,
    }
}
