//! Where the particles stand: lines of a rectangular grid, even or graded.
use loadframe_api::section::lines::{Fine, even_lines};

use crate::error::{CompositeError, finite, positive};

/// How the section is divided.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Division {
    /// So many equal cells along x and along y.
    Uniform { cells: [usize; 2] },
    /// So many cells along x and along y, as equal as they can be with particle lines on the faces of
    /// every ply and on the faces and ends of every fibre along an axis; along an axis with too few cells for that, equal.
    Fitted { cells: [usize; 2] },
    /// Particle lines on the faces of every ply and the faces and ends of every fibre along an axis, and cells no
    /// larger than a uniform division would have; in a fibre and a ply as small as `across` cells
    /// through it and beside a fibre's end, growing away from it.
    Graded { cells: [usize; 2], across: usize },
}

/// A place around which a graded division is finer: where a roller presses, say.
///
/// Cells within `half_width_mm` of it along either axis are no larger than `cell_mm`, and grow away
/// from there. A particle line passes through the place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Refinement {
    pub at_mm: [f64; 2],
    pub half_width_mm: f64,
    pub cell_mm: f64,
}

impl Refinement {
    pub(crate) fn checked(&self) -> Result<(), CompositeError> {
        for at in self.at_mm {
            finite("a refined place [mm]", at)?;
        }
        positive("the half width of a refined place [mm]", self.half_width_mm)?;
        positive("the size of cells at a refined place [mm]", self.cell_mm)?;
        Ok(())
    }

    /// The stretches on either side of the place.
    pub(crate) fn fine(&self, axis: usize) -> [Fine; 2] {
        let at = self.at_mm[axis];
        [[at - self.half_width_mm, at], [at, at + self.half_width_mm]].map(|between| Fine {
            between,
            size: self.cell_mm,
        })
    }
}

/// Lines of particles along both axes [mm], from 0 to the section's sides.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    x_mm: Vec<f64>,
    y_mm: Vec<f64>,
}

impl Grid {
    /// Equal cells.
    #[must_use]
    pub fn uniform([length_mm, height_mm]: [f64; 2], [columns, rows]: [usize; 2]) -> Self {
        Self {
            x_mm: even_lines(length_mm, columns),
            y_mm: even_lines(height_mm, rows),
        }
    }

    /// Cells between given lines [mm].
    ///
    /// # Errors
    /// When there are fewer than two lines along an axis, or they do not increase.
    pub fn of_lines(x_mm: Vec<f64>, y_mm: Vec<f64>) -> Result<Self, CompositeError> {
        for lines in [&x_mm, &y_mm] {
            if lines.len() < 2 || lines.iter().any(|line| !line.is_finite()) {
                return Err(CompositeError::OutOfRange {
                    quantity: "the number of grid lines along an axis",
                    given: lines.len() as f64,
                    allowed: "at least 2, all finite",
                });
            }
            if let Some(pair) = lines.windows(2).find(|pair| pair[1] <= pair[0]) {
                return Err(CompositeError::OutOfRange {
                    quantity: "the distance between neighbouring grid lines [mm]",
                    given: pair[1] - pair[0],
                    allowed: "above 0",
                });
            }
        }
        Ok(Self { x_mm, y_mm })
    }

    /// Lines of particles along x [mm].
    #[must_use]
    pub fn x_mm(&self) -> &[f64] {
        &self.x_mm
    }

    /// Lines of particles along y [mm].
    #[must_use]
    pub fn y_mm(&self) -> &[f64] {
        &self.y_mm
    }

    /// Cells along x.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.x_mm.len() - 1
    }

    /// Cells along y.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.y_mm.len() - 1
    }

    /// Number of cells.
    #[must_use]
    pub fn cells(&self) -> usize {
        self.columns() * self.rows()
    }

    /// Number of particles.
    #[must_use]
    pub fn particles(&self) -> usize {
        self.x_mm.len() * self.y_mm.len()
    }

    /// Number of the particle on line `i` along x and line `j` along y.
    #[must_use]
    pub fn particle(&self, i: usize, j: usize) -> usize {
        j * self.x_mm.len() + i
    }

    /// Place of a particle [mm].
    #[must_use]
    pub fn place_mm(&self, particle: usize) -> [f64; 2] {
        let per_row = self.x_mm.len();
        [self.x_mm[particle % per_row], self.y_mm[particle / per_row]]
    }

    /// The particles at a cell's corners, counterclockwise from the lower left.
    #[must_use]
    pub fn corners(&self, cell: usize) -> [usize; 4] {
        let (i, j) = (cell % self.columns(), cell / self.columns());
        let lower = self.particle(i, j);
        let upper = lower + self.x_mm.len();
        [lower, lower + 1, upper + 1, upper]
    }

    /// Width and height of a cell [mm].
    #[must_use]
    pub fn sides_mm(&self, cell: usize) -> [f64; 2] {
        let (i, j) = (cell % self.columns(), cell / self.columns());
        [
            self.x_mm[i + 1] - self.x_mm[i],
            self.y_mm[j + 1] - self.y_mm[j],
        ]
    }

    /// Middle of a cell [mm].
    #[must_use]
    pub fn middle_mm(&self, cell: usize) -> [f64; 2] {
        let (i, j) = (cell % self.columns(), cell / self.columns());
        [
            0.5 * (self.x_mm[i + 1] + self.x_mm[i]),
            0.5 * (self.y_mm[j + 1] + self.y_mm[j]),
        ]
    }

    /// The cell a point lies in, and where in it (0..1 along both sides); `None` outside.
    #[must_use]
    pub fn locate(&self, [x, y]: [f64; 2]) -> Option<(usize, [f64; 2])> {
        let (i, along) = within(&self.x_mm, x)?;
        let (j, up) = within(&self.y_mm, y)?;
        Some((j * self.columns() + i, [along, up]))
    }
}

/// A thin row's height over that of the row it is cut from.
const THIN: f64 = 0.1;

/// Lines with another one closely above each that lies on one of these faces.
pub(crate) fn with_thin_rows(lines: &[f64], faces: &[f64]) -> Vec<f64> {
    let side = lines[lines.len() - 1];
    let mut all = Vec::with_capacity(lines.len() + faces.len());
    for pair in lines.windows(2) {
        all.push(pair[0]);
        if faces
            .iter()
            .any(|face| (pair[0] - face).abs() < 1e-9 * side)
        {
            all.push(pair[0] + THIN * (pair[1] - pair[0]));
        }
    }
    all.push(side);
    all
}

/// Weights of a cell's four corners at a place inside it (0..1 along both sides).
pub(crate) fn corner_weights([a, b]: [f64; 2]) -> [f64; 4] {
    [(1.0 - a) * (1.0 - b), a * (1.0 - b), a * b, (1.0 - a) * b]
}

/// The interval between lines that holds a coordinate, and the share of the way through it.
pub(crate) fn within(lines: &[f64], coordinate: f64) -> Option<(usize, f64)> {
    let (first, last) = (*lines.first()?, *lines.last()?);
    // A point on an edge, written in decimals, may miss it by round-off.
    let slack = 1e-12 * (last - first);
    if !(coordinate >= first - slack && coordinate <= last + slack) {
        return None;
    }
    let after = lines.partition_point(|&line| line <= coordinate);
    let interval = after.clamp(1, lines.len() - 1) - 1;
    let share = (coordinate - lines[interval]) / (lines[interval + 1] - lines[interval]);
    Some((interval, share.clamp(0.0, 1.0)))
}
