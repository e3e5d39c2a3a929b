//! Rollers, and what they do to a section.
use crate::error::{CompositeError, finite, positive};
use crate::section::{Grid, within};
use crate::solve::equilibrium::Equilibrium;
use crate::supports::Face;

/// A rigid cylinder whose axis crosses the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Roller {
    /// The face it lies against.
    pub face: Face,
    /// Where along the face [mm].
    pub at_mm: f64,
    pub radius_mm: f64,
}

/// A roller that has advanced from where it just touches the undeformed face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PressedRoller {
    pub roller: Roller,
    /// Along the inward normal, positive into the section [mm].
    pub advance_mm: f64,
}

/// What a roller does to the section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RollerContact {
    /// Along the inward normal [mm].
    pub advance_mm: f64,
    /// Pressing, along the inward normal [N].
    pub force_n: f64,
    /// Number of particles that carry it.
    pub particles: usize,
    /// The first and the last of them along the face [mm]; none where it does not touch.
    pub between_mm: Option<[f64; 2]>,
    /// Mean place of the force along the face [mm]; the roller's own where it does not touch.
    pub centre_mm: f64,
    /// Twice the root mean square distance of the force from its mean place [mm]: the half width of
    /// a contact under Hertz's pressure, known better than to a particle.
    pub half_width_mm: f64,
}

/// A lattice at rest between rollers.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactEquilibrium {
    /// Its reactions hold the forces of rollers beside those of supports.
    pub equilibrium: Equilibrium,
    /// In the order of the rollers given.
    pub rollers: Vec<RollerContact>,
    /// Sets of touching particles that were tried.
    pub rounds: u64,
}

impl Roller {
    /// The axis across its face.
    pub(super) fn normal(&self) -> usize {
        1 - self.face.along()
    }

    /// The inward normal's component along [`Roller::normal`].
    pub(super) fn inward(&self) -> f64 {
        match self.face {
            Face::Bottom | Face::Left => 1.0,
            Face::Top | Face::Right => -1.0,
        }
    }

    /// Distance of the roller from a place along its face while it just touches [mm]; `None` out of
    /// its reach.
    pub(super) fn gap(&self, at_mm: f64) -> Option<f64> {
        let distance = at_mm - self.at_mm;
        let radius = self.radius_mm;
        let square = (radius - distance) * (radius + distance);
        // R - √(R² - d²) without cancellation.
        (square > 0.0).then(|| distance * distance / (radius + square.sqrt()))
    }

    pub(super) fn checked(&self, grid: &Grid) -> Result<(), CompositeError> {
        positive("a roller's radius [mm]", self.radius_mm)?;
        finite("a roller's place [mm]", self.at_mm)?;
        if within(self.face.lines_mm(grid), self.at_mm).is_none() {
            let mut place = grid.place_mm(self.face.particle(grid, 0));
            place[self.face.along()] = self.at_mm;
            return Err(CompositeError::OutsideSection {
                what: "a roller",
                x_mm: place[0],
                y_mm: place[1],
            });
        }
        Ok(())
    }
}

/// How well the equilibrium must obey (8), as a share of the largest force or displacement. A thin
/// sandwich with a core a thousand times softer, on cells from 0.01 mm to 1 mm, reaches 2e-7.
const OBEYED: f64 = 1e-5;

/// Whether a share by which (8) or (9) is missed is small enough.
///
/// # Errors
/// [`CompositeError::ContactUnsettled`].
pub(super) fn obeyed(share: f64) -> Result<(), CompositeError> {
    if share <= OBEYED {
        Ok(())
    } else {
        Err(CompositeError::ContactUnsettled { share })
    }
}
