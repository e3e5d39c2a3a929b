//! The bonds of the paper: one stiffness for each pair of materials.
//!
//! Each particle is of the material it stands in; a fibre thinner than a cell takes the particles
//! nearest to its axis, so that it is a chain of bonds. A bond is of the fibre's material when both
//! its particles are of that fibre material, else of the matrix. Its spring constant is the
//! modulus of the rule times the section's thickness, the same along edges and diagonals, and the
//! same for edges on the boundary.
//!
//! Source: [SizayaTsivilsky2020]. Its formula for the stiffness has lost all but its numerator
//! E (1 - ν); [`BondStiffness`] has both readings. Neither converges to the elastic body, see the
//! tests: use the exact lattice for that.
use crate::error::CompositeError;
use crate::lattice::Bond;
use crate::section::{Band, Layout, Section};

/// Which particles are bonded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BondPattern {
    /// Edges and both diagonals.
    Cross,
    /// Edges and the diagonal from the lower left.
    OneDiagonal,
    /// Edges alone; cells fold.
    Edges,
}

/// What stands for the stiffness of a bond.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BondStiffness {
    /// E (1 - ν) / ((1 + ν)(1 - 2ν)), the modulus under hindered contraction.
    PWave,
    /// E (1 - ν), as the paper's text has come down.
    Bare,
}

/// The paper's rule.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PaperRule {
    pub stiffness: BondStiffness,
    pub pattern: BondPattern,
}

impl BondStiffness {
    /// Modulus of a bond [MPa].
    fn modulus(self, (e, nu): (f64, f64)) -> Result<f64, CompositeError> {
        match self {
            Self::Bare if nu < 1.0 => Ok(e * (1.0 - nu)),
            Self::PWave if nu < 0.5 && nu > -1.0 => {
                Ok(e * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu)))
            }
            _ => Err(CompositeError::OutOfRange {
                quantity: "the Poisson ratio in the paper's rule",
                given: nu,
                allowed: "above -1 and below 0.5",
            }),
        }
    }
}

/// How far two sides of a cell may differ and still be those of a square.
const SQUARE: f64 = 1e-6;

pub(super) fn bonds(
    section: &Section,
    layout: &Layout,
    rule: PaperRule,
) -> Result<Vec<Bond>, CompositeError> {
    if !section.plies.is_empty() {
        return Err(CompositeError::OutOfRange {
            quantity: "the number of plies in the paper's lattice",
            given: section.plies.len() as f64,
            allowed: "0: it knows fibres in one matrix; choose the exact lattice",
        });
    }
    let grid = &layout.grid;
    let [width_mm, _] = grid.sides_mm(0);
    for cell in 0..grid.cells() {
        let [a, b] = grid.sides_mm(cell);
        if (a - width_mm).abs() > SQUARE * width_mm || (b - width_mm).abs() > SQUARE * width_mm {
            return Err(CompositeError::NotSquare {
                width_mm: a,
                height_mm: b,
            });
        }
    }
    let springs = section
        .materials
        .iter()
        .map(|substance| {
            let modulus = rule.stiffness.modulus(substance.material.along())?;
            Ok(modulus * section.thickness_mm)
        })
        .collect::<Result<Vec<_>, CompositeError>>()?;
    let materials: Vec<usize> = (0..grid.particles())
        .map(|particle| {
            layout
                .bands
                .iter()
                .find(|band| holds(band, grid.place_mm(particle), width_mm))
                .map_or(section.matrix, |band| band.material)
        })
        .collect();
    let between = |first: usize, second: usize| {
        let material = if materials[first] == materials[second] {
            materials[first]
        } else {
            section.matrix
        };
        let (from, to) = (grid.place_mm(first), grid.place_mm(second));
        Bond {
            particles: [first as u32, second as u32],
            stiffness_n_per_mm: springs[material],
            vector_mm: [to[0] - from[0], to[1] - from[1]],
        }
    };
    let (columns, rows) = (grid.columns(), grid.rows());
    let mut bonds = Vec::with_capacity(4 * grid.particles());
    for j in 0..=rows {
        for i in 0..=columns {
            let here = grid.particle(i, j);
            if i < columns {
                bonds.push(between(here, grid.particle(i + 1, j)));
            }
            if j < rows {
                bonds.push(between(here, grid.particle(i, j + 1)));
            }
            if i < columns && j < rows {
                if rule.pattern != BondPattern::Edges {
                    bonds.push(between(here, grid.particle(i + 1, j + 1)));
                }
                if rule.pattern == BondPattern::Cross {
                    bonds.push(between(grid.particle(i + 1, j), grid.particle(i, j + 1)));
                }
            }
        }
    }
    Ok(bonds)
}

/// Whether a particle is of a fibre: inside its band, or of a thinner fibre one of the particles
/// nearest to its axis. Of two equally near ones the one above (or to the left) is taken.
fn holds(band: &Band, place: [f64; 2], pitch: f64) -> bool {
    let [along, across] = band.distances(place);
    let slack = 1e-9 * pitch;
    let nearest = 0.5 * pitch * band.axis[0].abs().max(band.axis[1].abs());
    let beside = if band.half_thickness_mm + slack >= nearest {
        across.abs() <= band.half_thickness_mm + slack
    } else {
        across > -nearest + slack && across <= nearest + slack
    };
    beside && along.abs() <= band.half_length_mm + slack
}
