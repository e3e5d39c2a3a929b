//! What is tested: a rectangle of matrix or of plies, with bands of fibre in it.
//!
//! A [`Section`] is what a user describes; [`Section::layout`] checks it and makes the [`Layout`],
//! the grid of particles with what every cell holds. How a cell answers to strain is not known here.
mod bars;
mod described;
mod fit;
mod grid;
mod layout;
mod ply;
mod shares;
#[cfg(test)]
mod tests;

pub(crate) use bars::{Bars, along};
pub use described::{Ply, Section, Substance};
pub use fit::Fit;
pub use grid::{Division, Grid, Refinement};
pub(crate) use grid::{corner_weights, within};
pub use layout::{Bounds, Layout};
pub(crate) use layout::{Constituent, matrix_share};
pub(crate) use loadframe_api::section::fibre::Band;
pub use loadframe_api::section::fibre::Fibre;
pub use loadframe_api::section::lines::Towards;
pub(crate) use ply::faces_mm;

use loadframe_harness::Uninterrupted;

use crate::error::{CompositeError, finite, positive};

/// Of a layout that is made whatever it takes.
pub(crate) const UNBOUNDED: Bounds<'static> = Bounds {
    most_cells: usize::MAX,
    interrupt: &Uninterrupted,
};

impl Section {
    /// Checks the section and lays the grid over it.
    ///
    /// # Errors
    /// What is wrong with the description: lengths, materials, plies that miss the height, fibres
    /// outside or over each other.
    pub fn layout(&self, division: Division) -> Result<Layout, CompositeError> {
        self.layout_refined(division, &[], &Default::default())
    }

    /// How well the grid of a division follows what lies in the section.
    ///
    /// # Errors
    /// As [`Section::layout`].
    pub fn fit(&self, division: Division) -> Result<Fit, CompositeError> {
        layout::fit_on(self, division)
    }

    /// As [`Section::layout`], with a graded division made finer around places and towards corners.
    ///
    /// # Errors
    /// As [`Section::layout`]; and when a uniform division is to be refined.
    pub fn layout_refined(
        &self,
        division: Division,
        refinements: &[Refinement],
        corners: &[Towards; 2],
    ) -> Result<Layout, CompositeError> {
        self.layout_within(division, refinements, corners, false, UNBOUNDED)
    }

    /// As [`Section::layout_refined`], of plies that can come apart: a thin row of cells lies above
    /// every face between plies that a line of particles follows, so that an open face takes little of
    /// the bending of the ply it lies in.
    ///
    /// # Errors
    /// As [`Section::layout_refined`].
    pub fn layout_parting(
        &self,
        division: Division,
        refinements: &[Refinement],
        corners: &[Towards; 2],
    ) -> Result<Layout, CompositeError> {
        self.layout_within(division, refinements, corners, true, UNBOUNDED)
    }

    /// As [`Section::layout_parting`] or [`Section::layout_refined`], within bounds.
    ///
    /// # Errors
    /// As [`Section::layout_refined`]; [`CompositeError::TooManyCells`] and [`CompositeError::GivenUp`].
    pub fn layout_within(
        &self,
        division: Division,
        refinements: &[Refinement],
        corners: &[Towards; 2],
        is_parting: bool,
        bounds: Bounds<'_>,
    ) -> Result<Layout, CompositeError> {
        self.checked()?;
        Layout::new(self, division, refinements, corners, is_parting, bounds)
    }

    fn checked(&self) -> Result<(), CompositeError> {
        positive("the section's length [mm]", self.length_mm)?;
        positive("the section's height [mm]", self.height_mm)?;
        positive("the section's thickness [mm]", self.thickness_mm)?;
        finite("the matrix angle [°]", self.matrix_angle_deg)?;
        Ok(())
    }
}
