//! A section laid out on its grid: what every cell holds.
use std::fmt;

use loadframe_api::section::fibre::{Band, fine_at_ends, refuse_overlap};
use loadframe_api::section::lines::{Fine, Towards, fitted_lines, graded_lines, pass_through};
use loadframe_harness::InterruptSource;

use crate::error::{CompositeError, positive};
use crate::material::{Material, Note, PlaneState};
use crate::section::bars::Bars;
use crate::section::described::{Ply, Section};
use crate::section::fit::{Fit, fit};
use crate::section::grid::{Division, Grid, Refinement, with_thin_rows};
use crate::section::ply::{Strip, faces_mm, shares_between, strip};
use crate::section::shares::{LEAST_SHARE, Part, shares};
use crate::stiffness::{Stiffness, laminate};

/// A section on its grid, ready to become a lattice.
#[derive(Debug, Clone)]
pub struct Layout {
    pub(crate) grid: Grid,
    pub(crate) thickness_mm: f64,
    pub(crate) bands: Vec<Band>,
    /// Plane stiffness of each cell, the laminate average of what it holds [MPa].
    pub(crate) stiffness: Vec<Stiffness>,
    /// Mean density of each cell [kg/m³].
    pub(crate) density: Vec<f64>,
    /// Share of each cell's area that is fibre.
    pub(crate) fibre_share: Vec<f64>,
    pub(crate) notes: Vec<(usize, Note)>,
    pub(crate) fit: Fit,
    pub(crate) state: PlaneState,
    /// What each ply is of, from the bottom; the matrix alone when there are none.
    pub(crate) plies: Vec<Constituent>,
    /// Faces of the plies from 0 to the section's height [mm].
    pub(crate) ply_faces_mm: Vec<f64>,
    /// What each band of fibre is of.
    pub(crate) fibres: Vec<Constituent>,
    /// Fibres in cells, by cell and then by band.
    pub(crate) parts: Vec<Part>,
    /// What slanted fibres bear along their axes, by cell.
    pub(crate) bars: Vec<Bars>,
}

/// What a ply or a band of fibre is of.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Constituent {
    /// Place of the material.
    pub(crate) material: usize,
    /// Whether it has an axis at all.
    pub(crate) is_orthotropic: bool,
    /// Angle of axis 1 out of the section's plane [°].
    pub(crate) out_of_plane_deg: f64,
    /// Angle of axis 1 to x in the section's plane [°].
    pub(crate) in_plane_deg: f64,
    /// In the section's axes [MPa].
    pub(crate) stiffness: Stiffness,
}

/// All bands of fibre, in the order of the fibres.
fn bands(section: &Section) -> Result<Vec<Band>, CompositeError> {
    let sides = [section.length_mm, section.height_mm];
    let fibres = section.fibres.iter().enumerate();
    fibres
        .map(|(place, fibre)| Band::new(place, fibre, sides))
        .collect()
}

/// How well the grid of a division follows a section, without laying out what its cells hold.
pub(super) fn fit_on(section: &Section, division: Division) -> Result<Fit, CompositeError> {
    let faces = faces_mm(&section.stack()?, section.height_mm);
    let bands = bands(section)?;
    let grid = divide(section, &faces, &bands, division, &[], &Default::default())?;
    Ok(fit(&grid, &faces_across(section, &faces, &bands), &bands))
}

/// So many cells are filled with their fibres before somebody may say that nobody wants them: some tenths of a
/// second where each holds hundreds.
const CELLS_BETWEEN_LOOKS: usize = 256;

/// How large a layout may be, and for how long it is wanted.
#[derive(Clone, Copy)]
pub struct Bounds<'a> {
    pub most_cells: usize,
    pub interrupt: &'a dyn InterruptSource,
}

impl fmt::Debug for Bounds<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_struct("Bounds")
            .field("most_cells", &self.most_cells)
            .finish_non_exhaustive()
    }
}

impl Layout {
    pub(super) fn new(
        section: &Section,
        division: Division,
        refinements: &[Refinement],
        corners: &[Towards; 2],
        is_parting: bool,
        bounds: Bounds<'_>,
    ) -> Result<Self, CompositeError> {
        let stack = section.stack()?;
        let faces = faces_mm(&stack, section.height_mm);
        let bands = bands(section)?;
        refuse_overlap(&bands)?;
        let mut grid = divide(section, &faces, &bands, division, refinements, corners)?;
        if is_parting && !matches!(division, Division::Uniform { .. }) {
            let y_mm = with_thin_rows(grid.y_mm(), &faces[1..faces.len() - 1]);
            grid = Grid::of_lines(grid.x_mm().to_vec(), y_mm)?;
        }
        if grid.cells() > bounds.most_cells {
            return Err(CompositeError::TooManyCells {
                cells: grid.cells(),
                most: bounds.most_cells,
            });
        }
        let fit = fit(&grid, &faces_across(section, &faces, &bands), &bands);

        for substance in &section.materials {
            substance.material.stiffness(section.state)?;
            positive("a density [kg/m³]", substance.density_kg_per_m3)?;
        }
        let mut notes: Vec<(usize, Note)> = Vec::new();
        let mut stiffness_of = |ply: &Ply| {
            let (stiffness, assumed) = section.ply_stiffness(ply, section.state)?;
            for note in assumed {
                let told = (ply.material, note);
                if !notes.contains(&told) {
                    notes.push(told);
                }
            }
            let material = section.materials[ply.material].material;
            Ok(Constituent {
                material: ply.material,
                is_orthotropic: matches!(material, Material::Orthotropic(_)),
                out_of_plane_deg: ply.angle_deg,
                in_plane_deg: ply.in_plane_angle_deg,
                stiffness,
            })
        };
        let plies = stack
            .iter()
            .map(&mut stiffness_of)
            .collect::<Result<Vec<_>, CompositeError>>()?;
        let fibres = bands
            .iter()
            .map(|band| {
                stiffness_of(&Ply {
                    material: band.material,
                    thickness_mm: 2.0 * band.half_thickness_mm,
                    angle_deg: 0.0,
                    in_plane_angle_deg: band.angle_deg,
                })
            })
            .collect::<Result<Vec<_>, CompositeError>>()?;
        notes.sort_by_key(|(place, _)| *place);

        let density_of = |place: usize| section.materials[place].density_kg_per_m3;
        let densities: Vec<f64> = stack.iter().map(|ply| density_of(ply.material)).collect();
        let ply_stiffness: Vec<Stiffness> = plies.iter().map(|ply| ply.stiffness).collect();
        let mut stiffness = Vec::with_capacity(grid.cells());
        let mut density = Vec::with_capacity(grid.cells());
        for pair in grid.y_mm().windows(2) {
            let Strip {
                stiffness: held,
                density: mean,
            } = strip(
                [pair[0], pair[1]],
                &faces,
                &ply_stiffness,
                &densities,
                LEAST_SHARE,
            );
            stiffness.resize(stiffness.len() + grid.columns(), held);
            density.resize(density.len() + grid.columns(), mean);
        }
        let mut fibre_share = vec![0.0; grid.cells()];
        let parts = shares(&grid, &bands, bounds.interrupt)?;
        let mut bars = Vec::new();
        for (place, held) in parts.chunk_by(|a, b| a.cell == b.cell).enumerate() {
            if place.is_multiple_of(CELLS_BETWEEN_LOOKS) && bounds.interrupt.is_cancelled() {
                return Err(CompositeError::GivenUp);
            }
            let cell = held[0].cell as usize;
            let whole: f64 = held.iter().map(|part| part.share).sum();
            let rest = matrix_share(whole);
            let fibres_here = held.iter().map(|part| {
                let band = part.band as usize;
                (&bands[band], &fibres[band].stiffness, part.moments)
            });
            bars.extend(Bars::of(held[0].cell, &stiffness[cell], fibres_here));
            stiffness[cell] = mixture(stiffness[cell], rest, held, &bands, &fibres);
            fibre_share[cell] = whole.min(1.0);
            density[cell] = rest * density[cell]
                + held
                    .iter()
                    .map(|part| part.share * density_of(bands[part.band as usize].material))
                    .sum::<f64>();
        }
        Ok(Self {
            grid,
            thickness_mm: section.thickness_mm,
            bands,
            stiffness,
            density,
            fibre_share,
            notes,
            fit,
            state: section.state,
            plies,
            ply_faces_mm: faces,
            fibres,
            parts,
            bars,
        })
    }

    /// The fibres that a cell holds.
    pub(crate) fn parts_of(&self, cell: usize) -> &[Part] {
        let first = self
            .parts
            .partition_point(|part| (part.cell as usize) < cell);
        let after = self
            .parts
            .partition_point(|part| (part.cell as usize) <= cell);
        &self.parts[first..after]
    }

    /// The plies that a row of cells cuts, with their shares of its height.
    pub(crate) fn plies_of(&self, row: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let y = self.grid.y_mm();
        shares_between([y[row], y[row + 1]], &self.ply_faces_mm, LEAST_SHARE)
    }

    /// The grid of particles.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Plane stiffness of each cell [MPa].
    #[must_use]
    pub fn stiffness(&self) -> &[Stiffness] {
        &self.stiffness
    }

    /// How well the grid follows faces of plies and fibres.
    #[must_use]
    pub fn fit(&self) -> Fit {
        self.fit
    }

    /// Share of each cell's area that is fibre.
    #[must_use]
    pub fn fibre_share(&self) -> &[f64] {
        &self.fibre_share
    }

    /// Constants that were not given and what was taken for them, by place of the material.
    #[must_use]
    pub fn notes(&self) -> &[(usize, Note)] {
        &self.notes
    }
}

/// The average of a cell: fibres of one direction are layers with the matrix between them, exact
/// for any number of them. Of several plies in one cell the matrix is their average, and fibres
/// take away from all of them alike: an estimate, which a graded grid, with one ply in each row,
/// does not need. Where fibres of different directions meet in one cell, those of the
/// next direction are layers in the average of matrix and those before: the order is that of the
/// fibres' list, and the result an estimate.
fn mixture(
    matrix: Stiffness,
    matrix_share: f64,
    held: &[Part],
    bands: &[Band],
    fibres: &[Constituent],
) -> Stiffness {
    let mut background = matrix;
    let mut background_share = matrix_share;
    let mut done = vec![false; held.len()];
    for first in 0..held.len() {
        if done[first] {
            continue;
        }
        let axis = bands[held[first].band as usize].axis;
        let mut layers = Vec::with_capacity(held.len() + 1);
        if background_share > 0.0 {
            layers.push((background_share, background));
        }
        for (other, part) in held.iter().enumerate().skip(first) {
            let towards = bands[part.band as usize].axis;
            let sine = axis[0] * towards[1] - axis[1] * towards[0];
            if !done[other] && sine.abs() < 1e-9 {
                done[other] = true;
                layers.push((part.share, fibres[part.band as usize].stiffness));
                background_share += part.share;
            }
        }
        background = laminate(&layers, bands[held[first].band as usize].angle_deg);
    }
    background
}

/// Share of a cell beside its fibres, which fill it but for round-off or leave room for matrix.
pub(crate) fn matrix_share(fibres: f64) -> f64 {
    if fibres > 1.0 - LEAST_SHARE {
        0.0
    } else {
        1.0 - fibres
    }
}

/// Faces and ends of fibres along an axis and faces of plies, across x and across y [mm].
fn faces_across(section: &Section, ply_faces: &[f64], bands: &[Band]) -> [Vec<f64>; 2] {
    [0, 1].map(|axis| {
        let along = bands.iter().filter(|band| band.is_across(axis));
        let mut faces: Vec<f64> = along
            .flat_map(|band| {
                let middle = band.through_mm[axis];
                [
                    middle - band.half_thickness_mm,
                    middle + band.half_thickness_mm,
                ]
            })
            .collect();
        let ends = bands.iter().filter_map(|band| band.ends_along(axis));
        faces.extend(ends.flatten());
        if axis == 1 && !section.plies.is_empty() {
            faces.extend(ply_faces);
        }
        faces
    })
}

fn divide(
    section: &Section,
    ply_faces: &[f64],
    bands: &[Band],
    division: Division,
    refinements: &[Refinement],
    corners: &[Towards; 2],
) -> Result<Grid, CompositeError> {
    let sides = [section.length_mm, section.height_mm];
    let (Division::Uniform { cells } | Division::Fitted { cells } | Division::Graded { cells, .. }) =
        division;
    for count in cells {
        if count == 0 || count > 1 << 15 {
            return Err(CompositeError::OutOfRange {
                quantity: "the number of cells along a side",
                given: count as f64,
                allowed: "from 1 to 32768",
            });
        }
    }
    let Division::Graded { across, .. } = division else {
        if !refinements.is_empty() {
            return Err(CompositeError::OutOfRange {
                quantity: "the number of refined places of a division that is not graded",
                given: refinements.len() as f64,
                allowed: "0: only a graded division has cells of different sizes",
            });
        }
        let equal = Grid::uniform(sides, cells);
        if matches!(division, Division::Uniform { .. }) {
            return Ok(equal);
        }
        let faces = faces_across(section, ply_faces, bands);
        let lines = |axis: usize, equal: &[f64]| {
            if pass_through(equal, &faces[axis]) {
                equal.to_vec()
            } else {
                fitted_lines(sides[axis], &faces[axis], cells[axis])
                    .unwrap_or_else(|| equal.to_vec())
            }
        };
        return Grid::of_lines(lines(0, equal.x_mm()), lines(1, equal.y_mm()));
    };
    if across == 0 {
        return Err(CompositeError::OutOfRange {
            quantity: "the number of cells across a fibre",
            given: 0.0,
            allowed: "at least 1",
        });
    }
    for refinement in refinements {
        refinement.checked()?;
    }
    let lines = |axis: usize| {
        let across = across as u32;
        let mut fine: Vec<Fine> = bands
            .iter()
            .filter_map(|band| band.fine_across(axis, across))
            .collect();
        fine.extend(fine_at_ends(bands, axis, sides, across));
        if axis == 1 && !section.plies.is_empty() {
            let plies = ply_faces.windows(2);
            fine.extend(plies.map(|pair| Fine::through([pair[0], pair[1]], across)));
        }
        fine.extend(
            refinements
                .iter()
                .flat_map(|refinement| refinement.fine(axis)),
        );
        let largest = sides[axis] / cells[axis] as f64;
        graded_lines(sides[axis], &fine, largest, &corners[axis])
    };
    Grid::of_lines(lines(0), lines(1))
}
