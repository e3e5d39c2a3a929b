//! What is held, and where to.
//!
//! [`Supports`] says for every displacement of the lattice whether it is prescribed. They are made
//! from what a user says of the four faces, or displacement by displacement.
use nalgebra::Matrix3;

use crate::error::{CompositeError, finite};
use crate::section::Grid;

/// A face of the section.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Face {
    Left,
    Right,
    Bottom,
    Top,
}

/// What holds a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FaceSupport {
    /// Neither axis can move.
    Clamped,
    /// Both can.
    Free,
    /// No displacement across the face; along it the face slides.
    Rolling,
    /// Displacement along x and along y [mm] where it is prescribed.
    PerAxis([Option<f64>; 2]),
}

/// Which displacements are prescribed, and their values [mm].
#[derive(Debug, Clone, PartialEq)]
pub struct Supports {
    prescribed: Vec<Option<f64>>,
}

impl Face {
    /// All faces.
    pub const ALL: [Self; 4] = [Self::Left, Self::Right, Self::Bottom, Self::Top];

    /// The axis along which the face runs: 0 for x, 1 for y.
    #[must_use]
    pub fn along(self) -> usize {
        match self {
            Self::Left | Self::Right => 1,
            Self::Bottom | Self::Top => 0,
        }
    }

    /// Lines of particles along the face [mm].
    #[must_use]
    pub fn lines_mm(self, grid: &Grid) -> &[f64] {
        match self {
            Self::Left | Self::Right => grid.y_mm(),
            Self::Bottom | Self::Top => grid.x_mm(),
        }
    }

    /// The particle of the face on a line.
    #[must_use]
    pub fn particle(self, grid: &Grid, line: usize) -> usize {
        match self {
            Self::Left => grid.particle(0, line),
            Self::Right => grid.particle(grid.columns(), line),
            Self::Bottom => grid.particle(line, 0),
            Self::Top => grid.particle(line, grid.rows()),
        }
    }
}

impl FaceSupport {
    fn prescribed(self, face: Face) -> [Option<f64>; 2] {
        match self {
            Self::Clamped => [Some(0.0); 2],
            Self::Free => [None; 2],
            Self::Rolling => match face.along() {
                0 => [None, Some(0.0)],
                _ => [Some(0.0), None],
            },
            Self::PerAxis(prescribed) => prescribed,
        }
    }
}

impl Supports {
    /// Nothing is held.
    #[must_use]
    pub fn none(grid: &Grid) -> Self {
        Self {
            prescribed: vec![None; 2 * grid.particles()],
        }
    }

    /// Held at 0 where said.
    pub(crate) fn held_at(held: &[bool]) -> Self {
        let prescribed = held.iter().map(|held| held.then_some(0.0)).collect();
        Self { prescribed }
    }

    /// Faces are held, each as said.
    ///
    /// # Errors
    /// When two faces ask a common corner for different displacements.
    pub fn of_faces(grid: &Grid, faces: &[(Face, FaceSupport)]) -> Result<Self, CompositeError> {
        let mut supports = Self::none(grid);
        for &(face, support) in faces {
            for (axis, value) in support.prescribed(face).into_iter().enumerate() {
                let Some(value) = value else { continue };
                for line in 0..face.lines_mm(grid).len() {
                    supports.hold(grid, face.particle(grid, line), axis, value)?;
                }
            }
        }
        Ok(supports)
    }

    /// Prescribes the displacement of a particle along an axis (0 for x, 1 for y) [mm].
    ///
    /// # Errors
    /// When it is already prescribed otherwise, or not finite.
    pub fn hold(
        &mut self,
        grid: &Grid,
        particle: usize,
        axis: usize,
        value_mm: f64,
    ) -> Result<(), CompositeError> {
        finite("a prescribed displacement [mm]", value_mm)?;
        let place = &mut self.prescribed[2 * particle + axis];
        if let Some(already) = *place
            && (already - value_mm).abs() > 1e-12 * already.abs().max(value_mm.abs())
        {
            let [x_mm, y_mm] = grid.place_mm(particle);
            return Err(CompositeError::Contradiction {
                axis: ['x', 'y'][axis],
                x_mm,
                y_mm,
                first_mm: already,
                second_mm: value_mm,
            });
        }
        *place = Some(value_mm);
        Ok(())
    }

    /// The prescribed displacement, if it is.
    #[must_use]
    pub fn prescribed(&self, displacement: usize) -> Option<f64> {
        self.prescribed[displacement]
    }

    /// Whether a displacement is prescribed.
    #[must_use]
    pub fn is_held(&self, displacement: usize) -> bool {
        self.prescribed[displacement].is_some()
    }

    /// All displacements, the prescribed ones with their values, the others 0.
    #[must_use]
    pub fn displacements(&self) -> Vec<f64> {
        self.prescribed
            .iter()
            .map(|value| value.unwrap_or(0.0))
            .collect()
    }

    /// By how much what is held moves apart along both axes, what stands still counted with it: the root of the
    /// squares of both [mm]. Of one face that is moved it is the length of its way, of two that part along an
    /// axis the sum of theirs.
    #[must_use]
    pub fn reach_mm(&self) -> f64 {
        let mut between = [[0.0_f64; 2]; 2];
        for (displacement, value) in self.prescribed.iter().enumerate() {
            let [low, high] = &mut between[displacement % 2];
            let value = value.unwrap_or(0.0);
            (*low, *high) = (low.min(value), high.max(value));
        }
        let [x, y] = between.map(|[low, high]| high - low);
        x.hypot(y)
    }

    /// Whether the section could move as a whole.
    ///
    /// The three rigid motions, measured at what is held, must be independent: the determinant of
    /// their Gram matrix, with rotations measured in the section's size, is nowhere near 0.
    ///
    /// # Errors
    /// Naming the motion that is left.
    pub fn refuse_rigid_motion(&self, grid: &Grid) -> Result<(), CompositeError> {
        let size = grid.x_mm()[grid.columns()].max(grid.y_mm()[grid.rows()]);
        let mut gram = Matrix3::<f64>::zeros();
        for (displacement, value) in self.prescribed.iter().enumerate() {
            if value.is_some() {
                let [x, y] = grid.place_mm(displacement / 2);
                let motion = if displacement % 2 == 0 {
                    [1.0, 0.0, -y / size]
                } else {
                    [0.0, 1.0, x / size]
                };
                for row in 0..3 {
                    for column in 0..3 {
                        gram[(row, column)] += motion[row] * motion[column];
                    }
                }
            }
        }
        const LOOSE: f64 = 1e-12;
        let eigen = gram.symmetric_eigen();
        let weakest = eigen.eigenvalues.imin();
        if eigen.eigenvalues[weakest] > LOOSE {
            return Ok(());
        }
        let motion = eigen.eigenvectors.column(weakest);
        let motion = match motion.iamax() {
            0 => "move along x",
            1 => "move along y",
            _ => "turn",
        };
        Err(CompositeError::Unsupported { motion })
    }
}
