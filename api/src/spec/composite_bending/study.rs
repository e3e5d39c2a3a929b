//! What an accuracy study varies in a test of a section.
use super::{
    BondStiffness, CompositeBending, Exact, Geometry, Grid, Knobs, Lattice, Paper, Solver,
};
use crate::spec_trait::Studied;
use crate::study::Knob;

/// Cells along both sides in those of the spec; the last is the reference.
const CELLS: [&str; 4] = ["0.25", "0.5", "1", "2"];
const FINEST: &str = "4";

/// Results that are compared: all that do not describe the grid itself.
const COMPARED: [&str; 14] = [
    "mean_top_deflection",
    "mean_bottom_deflection",
    "deflection_ratio",
    "strain_energy",
    "effective_modulus",
    "effective_poisson_ratio",
    "effective_shear_modulus",
    "flexural_modulus",
    "max_force",
    "deflection",
    "flexural_stress",
    "interlaminar_shear_stress",
    "natural_frequency",
    "peak_deflection",
];

impl Studied for CompositeBending {
    fn knobs(&self) -> Vec<Knob> {
        let accuracy = self.accuracy.knobs();
        let mut knobs = vec![Knob::new(
            "cells",
            "cells along both sides in those of the spec, a number above 0",
            1,
            &CELLS,
            FINEST,
        )];
        if self.plies.is_empty() && self.grid().graded_cells_per_fibre.is_none() {
            knobs.push(Knob::new(
                "lattice",
                "what holds the particles together: exact, paper_p_wave or paper_bare",
                lattice_word(&self.lattice),
                &["paper_p_wave", "paper_bare"],
                "exact",
            ));
        }
        if self.test.history.is_none() && self.test.way().is_some_and(|way| way.flexure().is_none())
        {
            knobs.push(Knob::new(
                "solver",
                "the way to rest: static, verlet, pbd or xpbd",
                solver_word(accuracy.solver),
                &["verlet", "pbd", "xpbd"],
                "static",
            ));
            knobs.push(Knob::new(
                "geometry",
                "how displacements are measured: linear or large",
                match accuracy.geometry {
                    Geometry::Linear => "linear",
                    Geometry::Large => "large",
                },
                &["linear"],
                "large",
            ));
        }
        knobs
    }

    fn turn(&mut self, knob: &str, value: &str) -> Option<()> {
        match knob {
            "cells" => {
                let factor: f64 = value.parse().ok().filter(|factor| *factor > 0.0)?;
                let grid = self.grid();
                let scaled = |count: u32| (f64::from(count) * factor).round().max(1.0) as u32;
                self.grid = Some(Grid {
                    cells: grid.cells.map(scaled),
                    equal_cells: grid.equal_cells,
                    graded_cells_per_fibre: grid.graded_cells_per_fibre.map(scaled),
                });
            }
            "lattice" => {
                let paper = |stiffness| {
                    let bonds = match self.lattice {
                        Lattice::Paper(paper) => paper.bonds,
                        Lattice::Exact(_) => super::BondPattern::default(),
                    };
                    Lattice::Paper(Paper { stiffness, bonds })
                };
                self.lattice = match value {
                    "exact" => Lattice::Exact(Exact {}),
                    "paper_p_wave" => paper(BondStiffness::PWave),
                    "paper_bare" => paper(BondStiffness::Bare),
                    _ => return None,
                };
            }
            "solver" => {
                let solvers = [Solver::Static, Solver::Verlet, Solver::Pbd, Solver::Xpbd];
                let solver = solvers
                    .into_iter()
                    .find(|solver| solver_word(*solver) == value)?;
                self.change_knobs(|knobs| knobs.solver = solver);
            }
            "geometry" => {
                let geometry = match value {
                    "linear" => Geometry::Linear,
                    "large" => Geometry::Large,
                    _ => return None,
                };
                self.change_knobs(|knobs| knobs.geometry = geometry);
            }
            _ => return None,
        }
        Some(())
    }

    fn single(&mut self, seed: u64) {
        self.seed = seed;
        self.output.picture = false;
    }

    fn compares(result: &str) -> bool {
        COMPARED.contains(&result)
    }
}

impl CompositeBending {
    /// Changes the knobs of accuracy; the grid stays what it was.
    fn change_knobs(&mut self, change: impl FnOnce(&mut Knobs)) {
        self.grid = Some(self.grid());
        self.accuracy.change(change);
    }
}

fn lattice_word(lattice: &Lattice) -> &'static str {
    match lattice {
        Lattice::Exact(_) => "exact",
        Lattice::Paper(paper) => match paper.stiffness {
            BondStiffness::PWave => "paper_p_wave",
            BondStiffness::Bare => "paper_bare",
        },
    }
}

fn solver_word(solver: Solver) -> &'static str {
    match solver {
        Solver::Static => "static",
        Solver::Verlet => "verlet",
        Solver::Pbd => "pbd",
        Solver::Xpbd => "xpbd",
    }
}
