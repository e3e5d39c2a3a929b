//! From fibres and matrix to a composite: effective constants of a periodic cross section.
//!
//! A [`UnitCell`] is a rectangle of the plane of 2 and 3, across fibres that run along 1, repeated
//! without end: an array, measured places, or [random ones](fibre_places). From the bottom up:
//! `pixels` lays a grid over it and `phase` says what a pixel cut by a face is, the laminate of both
//! sides [GelebartOuaki2015]; `cells` is a pixel's answer to the displacements of its four corners,
//! `torus` the grid they are on, `spectrum` the uniform body's equations solved by Fourier transforms,
//! and `balance` finds equilibrium with it as preconditioner. [`Effective`] puts six load cases
//! together (ε₁₁, ε₂₂, ε₃₃, γ₂₃ in generalised plane strain, γ₁₂ and γ₁₃ along the fibres);
//! [`Errors`] come from coarser grids, [`bounds`] stand beside the result, [`Onset`] builds on it.
//!
//! Displacements at corners and not strains are the unknowns, unlike in [MoulinecSuquet1998]: with
//! these finite elements [LeuteLadeckyFalsafi2022] nothing rings where stiffness jumps, and a uniform
//! body's equations are still a convolution.
//!
//! Faces are bonded, everything is linear, and all fibres are of one material. Jobs, specs and files
//! are not known here.
mod balance;
pub mod bounds;
mod cells;
mod constants;
mod effective;
mod onset;
mod phase;
mod pixels;
mod places;
mod refined;
mod spectrum;
#[cfg(test)]
mod tests;
mod torus;

pub use constants::Constants;
pub use effective::{Effective, Load};
pub use onset::{Onset, Part, PhaseStrength, Site, Strengths};
pub use places::{Randomness, fibre_places};
pub use refined::Errors;

use std::f64::consts::PI;

use crate::error::{CompositeError, finite, positive};
use crate::material::{Material, Note};
use phase::Space;

/// Pixels along a side.
const FEWEST: usize = 4;
const MOST: usize = 2_048;

/// Part of a fibre's diameter by which fibres may overlap: coordinates in decimals that touch.
const TOUCH: f64 = 1e-9;

/// A fibre along 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoundFibre {
    /// Place of its axis along 2 and 3 [mm]; taken back into the cell when it lies outside.
    pub centre_mm: [f64; 2],
    pub diameter_mm: f64,
}

/// Which of the two materials.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    Matrix,
    Fibre,
}

/// Stiffnesses of matrix and fibre, and what had to be assumed for them.
type Described = ([Space; 2], Vec<(Phase, Note)>);

/// A cross section that repeats along 2 and 3; all fibres run along 1.
#[derive(Debug, Clone, PartialEq)]
pub struct UnitCell {
    /// Sides along 2 and 3 [mm].
    pub size_mm: [f64; 2],
    /// With its axis 1 along the fibres.
    pub matrix: Material,
    /// With its axis 1 along itself.
    pub fibre: Material,
    pub fibres: Vec<RoundFibre>,
}

impl UnitCell {
    /// Fibres on a square array: one in the middle of a square.
    ///
    /// # Errors
    /// When the fraction is not above 0 and at most π/4, or the diameter is not positive.
    pub fn square(
        matrix: Material,
        fibre: Material,
        fraction: f64,
        diameter_mm: f64,
    ) -> Result<Self, CompositeError> {
        positive("a fibre's diameter [mm]", diameter_mm)?;
        let side = diameter_mm
            * (PI
                / (4.0
                    * within(
                        fraction,
                        PI / 4.0,
                        "above 0 and at most π/4 = 0.785398 in a square array",
                    )?))
            .sqrt();
        Ok(Self {
            size_mm: [side; 2],
            matrix,
            fibre,
            fibres: vec![RoundFibre {
                centre_mm: [side / 2.0; 2],
                diameter_mm,
            }],
        })
    }

    /// Fibres on a hexagonal array: two in a rectangle of sides 1 : √3, neighbours along 2.
    ///
    /// # Errors
    /// When the fraction is not above 0 and at most π/(2√3), or the diameter is not positive.
    pub fn hexagonal(
        matrix: Material,
        fibre: Material,
        fraction: f64,
        diameter_mm: f64,
    ) -> Result<Self, CompositeError> {
        positive("a fibre's diameter [mm]", diameter_mm)?;
        let root = 3.0_f64.sqrt();
        let side = diameter_mm
            * (PI
                / (2.0
                    * root
                    * within(
                        fraction,
                        PI / (2.0 * root),
                        "above 0 and at most π/(2√3) = 0.906899 in a hexagonal array",
                    )?))
            .sqrt();
        let size_mm = [side, root * side];
        let fibre_at = |share: f64| RoundFibre {
            centre_mm: size_mm.map(|side| share * side),
            diameter_mm,
        };
        Ok(Self {
            size_mm,
            matrix,
            fibre,
            fibres: vec![fibre_at(0.25), fibre_at(0.75)],
        })
    }

    /// Share of the cell that is fibre.
    #[must_use]
    pub fn fraction(&self) -> f64 {
        let area: f64 = self
            .fibres
            .iter()
            .map(|fibre| PI / 4.0 * fibre.diameter_mm * fibre.diameter_mm)
            .sum();
        area / (self.size_mm[0] * self.size_mm[1])
    }

    /// Checks the cell and the grid: stiffnesses of matrix and fibre, and what had to be assumed.
    fn checked(&self, grid: [usize; 2]) -> Result<Described, CompositeError> {
        positive("the unit cell's size along 2 [mm]", self.size_mm[0])?;
        positive("the unit cell's size along 3 [mm]", self.size_mm[1])?;
        for count in grid {
            if !(FEWEST..=MOST).contains(&count) {
                return Err(CompositeError::OutOfRange {
                    quantity: "the number of pixels along a side of the unit cell",
                    given: count as f64,
                    allowed: "from 4 to 2048",
                });
            }
        }
        for fibre in &self.fibres {
            positive("a fibre's diameter [mm]", fibre.diameter_mm)?;
            finite("a fibre's place along 2 [mm]", fibre.centre_mm[0])?;
            finite("a fibre's place along 3 [mm]", fibre.centre_mm[1])?;
        }
        self.refuse_overlap()?;
        let (matrix, of_matrix) = self.matrix.stiffness_of_space()?;
        let (fibre, of_fibre) = self.fibre.stiffness_of_space()?;
        let told = |phase: Phase| move |note: Note| (phase, note);
        let notes = of_matrix
            .into_iter()
            .map(told(Phase::Matrix))
            .chain(of_fibre.into_iter().map(told(Phase::Fibre)))
            .collect();
        Ok(([matrix, fibre], notes))
    }

    /// Finds two fibres that share a place, images across the edges included.
    fn refuse_overlap(&self) -> Result<(), CompositeError> {
        for (first, fibre) in self.fibres.iter().enumerate() {
            // its own image is a side away
            let side = self.size_mm[0].min(self.size_mm[1]);
            let pairs = self.fibres[first + 1..].iter().enumerate();
            let others = pairs.map(|(offset, other)| {
                let apart = periodic(fibre.centre_mm, other.centre_mm, self.size_mm);
                (first + 1 + offset, apart, other.diameter_mm)
            });
            for (second, apart, diameter) in
                std::iter::once((first, side, fibre.diameter_mm)).chain(others)
            {
                let overlap_mm = 0.5 * (fibre.diameter_mm + diameter) - apart;
                if overlap_mm > TOUCH * diameter.min(fibre.diameter_mm) {
                    return Err(CompositeError::RoundFibresOverlap {
                        first,
                        second,
                        overlap_mm,
                    });
                }
            }
        }
        Ok(())
    }
}

/// Distance [mm] of two points of a periodic cell, by the nearest image.
fn periodic(from: [f64; 2], to: [f64; 2], size: [f64; 2]) -> f64 {
    let [d2, d3] = [0, 1].map(|axis| {
        let d = to[axis] - from[axis];
        d - size[axis] * (d / size[axis]).round()
    });
    (d2 * d2 + d3 * d3).sqrt()
}

fn within(given: f64, most: f64, allowed: &'static str) -> Result<f64, CompositeError> {
    if given > 0.0 && given <= most {
        return Ok(given);
    }
    Err(CompositeError::OutOfRange {
        quantity: "the fraction of fibres",
        given,
        allowed,
    })
}
