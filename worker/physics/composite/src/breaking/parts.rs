//! The parts of all cells of a layout, and the laws by which they crack.
use super::composition::bed;
use super::laws::{check, check_interface, law_of, law_of_faces};
use super::part::{BrokenPart, Law, Part};
use super::ply_faces::PlyFaces;
use super::saw::Saw;
use super::scatter::Drawn;
use super::{BetweenPlies, MaterialStrength};
use crate::error::CompositeError;
use crate::section::{Band, Grid, Layout, matrix_share};
use crate::stiffness::{Stiffness, compliance, turned_to};
use crate::strength::{Criterion, Limit};

/// How far outside a fibre its face is looked for, over the smallest side of a cell: a face on a line
/// of particles belongs to the cell beside the fibre.
const OUTSIDE: f64 = 1e-6;

/// Part of the chord through a cell's middle that a face must cross to belong to it.
const CROSSED: f64 = 0.5;

/// All parts, cell by cell and in each by stage.
#[derive(Debug, Clone)]
pub(crate) struct Parts {
    pub(crate) laws: Vec<Law>,
    pub(crate) all: Vec<Part>,
    /// Where each cell's parts begin; one more than there are cells.
    pub(crate) starts: Vec<u32>,
    /// Whether a crack of some part has no energy of its own.
    pub(crate) has_brittle: bool,
    /// Parts that are open from the start.
    pub(crate) open: Vec<u32>,
}

impl Parts {
    pub(crate) fn new(
        layout: &Layout,
        strengths: &[MaterialStrength],
        between_plies: &BetweenPlies,
        criterion: Criterion,
        drawn: &Drawn,
    ) -> Result<Self, CompositeError> {
        let constituents = || layout.plies.iter().chain(&layout.fibres);
        let needed = constituents().map(|c| c.material + 1).max().unwrap_or(0);
        if strengths.len() < needed {
            return Err(CompositeError::OutOfRange {
                quantity: "the number of strengths of materials",
                given: strengths.len() as f64,
                allowed: "one for every material",
            });
        }
        for strength in strengths {
            check(&strength.bulk)?;
            strength
                .interface
                .as_ref()
                .map_or(Ok(()), check_interface)?;
        }
        // of plies, then of fibres, then of the faces of fibres
        let mut laws = constituents()
            .map(|c| law_of(c, &strengths[c.material].bulk, criterion, layout.state))
            .collect::<Result<Vec<Law>, _>>()?;
        let mut face_laws = vec![None; layout.bands.len()];
        for (place, band) in layout.bands.iter().enumerate() {
            if let Some(strength) = &strengths[band.material].interface {
                face_laws[place] = Some(laws.len() as u32);
                laws.push(law_of_faces(band.material, band.axis, strength));
            }
        }
        let faces = faces(layout, &face_laws);
        let ply_faces = PlyFaces::new(layout, between_plies, &mut laws)?;

        let grid = &layout.grid;
        let mut parts = Self {
            all: Vec::with_capacity(grid.cells()),
            starts: Vec::with_capacity(grid.cells() + 1),
            has_brittle: false,
            open: Vec::new(),
            laws,
        };
        for cell in 0..grid.cells() {
            parts.starts.push(parts.all.len() as u32);
            let first = faces.partition_point(|face| face.0 < cell);
            let after = faces.partition_point(|face| face.0 <= cell);
            parts.add_cell(layout, cell, &faces[first..after], &face_laws, &ply_faces);
            parts.refuse_wide(grid, cell, layout.thickness_mm, drawn)?;
        }
        parts.starts.push(parts.all.len() as u32);
        let opened = parts.open.iter();
        let opened = opened.map(|place| &parts.all[*place as usize]);
        ply_faces.refuse_unopened(layout, opened)?;
        Ok(parts)
    }

    /// Places of a cell's parts.
    pub(crate) fn of(&self, cell: usize) -> std::ops::Range<usize> {
        self.starts[cell] as usize..self.starts[cell + 1] as usize
    }

    fn add_cell(
        &mut self,
        layout: &Layout,
        cell: usize,
        faces: &[(usize, u32)],
        face_laws: &[Option<u32>],
        ply_faces: &PlyFaces<'_>,
    ) {
        let fibres = layout.parts_of(cell);
        let rest = matrix_share(fibres.iter().map(|part| part.share).sum());
        let first = self.all.len();
        let axis = |band: u32| layout.bands[band as usize].axis;
        let beside_matrix = fibres.first().map_or([1.0, 0.0], |part| axis(part.band));
        let mut add = |kind, law, stage, along, share, stiffness| {
            let beside = if kind == BrokenPart::Matrix {
                beside_matrix
            } else {
                along
            };
            self.all.push(Part {
                cell: cell as u32,
                kind,
                law,
                stage,
                along,
                beside,
                share,
                stiffness,
                bed: [0.0; 2],
                strength: 1.0,
                toughness: 1.0,
            });
        };
        if rest > 0.0 {
            for (ply, share) in layout.plies_of(cell / layout.grid.columns()) {
                let stiffness = layout.plies[ply].stiffness;
                let kind = BrokenPart::Matrix;
                add(kind, ply as u32, 0, [1.0, 0.0], rest * share, stiffness);
            }
            for face in ply_faces.of(cell / layout.grid.columns()) {
                let (kind, none) = (BrokenPart::PlyFace(face), Stiffness::zeros());
                add(kind, ply_faces.law, 0, [1.0, 0.0], 1.0, none);
            }
        }
        // one stage for every direction, in the order of the fibres' list, as in the layout's mean
        let mut bands: Vec<u32> = fibres
            .iter()
            .map(|part| part.band)
            .chain(faces.iter().map(|face| face.1))
            .collect();
        bands.sort_unstable();
        bands.dedup();
        let mut stage = 0;
        let mut done = vec![false; bands.len()];
        for place in 0..bands.len() {
            if done[place] {
                continue;
            }
            stage += 1;
            let along = axis(bands[place]);
            let mut here = Vec::new();
            for other in place..bands.len() {
                let towards = axis(bands[other]);
                let sine = along[0] * towards[1] - along[1] * towards[0];
                if !done[other] && sine.abs() < 1e-9 {
                    done[other] = true;
                    here.push(bands[other]);
                }
            }
            for &band in &here {
                if let Some(held) = fibres.iter().find(|part| part.band == band) {
                    let law = layout.plies.len() as u32 + band;
                    let stiffness = layout.fibres[band as usize].stiffness;
                    let kind = BrokenPart::Fibre(band);
                    add(kind, law, stage, along, held.share, stiffness);
                }
            }
            for &(_, band) in faces.iter().filter(|face| here.contains(&face.1)) {
                if let Some(law) = face_laws[band as usize] {
                    let kind = BrokenPart::Interface(band);
                    add(kind, law, stage, along, 1.0, Stiffness::zeros());
                }
            }
        }
        // a face softens against what lies beside it
        let layers: Vec<(f64, Stiffness)> = self.all[first..]
            .iter()
            .filter(|part| !part.is_face())
            .map(|part| (part.share, part.stiffness))
            .collect();
        for place in first..self.all.len() {
            let part = &mut self.all[place];
            if part.is_face() {
                part.bed = bed(&layers, part.along);
            }
            if ply_faces.is_open(layout, part) {
                self.open.push(place as u32);
            }
        }
    }

    /// Draws the strengths of a cell's parts, and refuses what holds more than its crack takes,
    /// whatever way it cracks.
    fn refuse_wide(
        &mut self,
        grid: &Grid,
        cell: usize,
        thickness_mm: f64,
        drawn: &Drawn,
    ) -> Result<(), CompositeError> {
        let first = self.starts[cell] as usize;
        let sides = grid.sides_mm(cell);
        let volume_mm3 = sides[0] * sides[1] * thickness_mm;
        drawn.draw(cell, volume_mm3, &mut self.all[first..]);
        for place in first..self.all.len() {
            let part = self.all[place];
            let law = self.laws[part.law as usize];
            for (plane, limits) in law.planes.iter().enumerate() {
                for (kind, limit) in limits.limits().enumerate() {
                    let Some(limit) = limit else { continue };
                    if limit.fracture_energy_n_per_mm.is_none() {
                        self.has_brittle = true;
                        continue;
                    }
                    let axis = law.axis.unwrap_or([1.0, 0.0]);
                    let normal = if plane == 0 {
                        axis
                    } else {
                        [-axis[1], axis[0]]
                    };
                    let width = match law.axis {
                        Some(_) => part.width_mm(sides, normal),
                        None => sides[0].max(sides[1]),
                    };
                    let modulus = part.modulus(axis, plane, kind == 2);
                    let room = part.room(&law, limit, modulus, width);
                    if Saw::new(1, room).is_none() {
                        let [x_mm, y_mm] = grid.middle_mm(cell);
                        return Err(CompositeError::CellTooLarge {
                            x_mm,
                            y_mm,
                            material: law.material.to_string(),
                            width_mm: width,
                            largest_mm: width * room,
                        });
                    }
                }
            }
        }
        Ok(())
    }
}

impl Part {
    /// Modulus [MPa] against which a plane softens, in normal or shear, with the first plane's normal
    /// along `axis`.
    pub(crate) fn modulus(&self, axis: [f64; 2], plane: usize, is_shear: bool) -> f64 {
        if self.is_face() {
            return self.bed[usize::from(is_shear)];
        }
        let [c, s] = axis;
        let soft = compliance(&turned_to(&self.stiffness, [c, -s]));
        let place = if is_shear { 2 } else { plane };
        1.0 / soft[(place, place)]
    }

    /// 2 E G / (f² h) of a limit: how much wider the part could be. 0 of a brittle one.
    pub(crate) fn room(&self, law: &Law, limit: Limit, modulus: f64, width_mm: f64) -> f64 {
        let stress = self.stress(law, limit, modulus);
        let energy = limit.fracture_energy_n_per_mm.unwrap_or(0.0) * self.toughness;
        2.0 * modulus * energy / (stress * stress * width_mm)
    }

    /// The limit as a stress [MPa].
    pub(crate) fn stress(&self, law: &Law, limit: Limit, modulus: f64) -> f64 {
        let of_stress = match law.criterion {
            Criterion::Stress => limit.limit,
            Criterion::Strain => limit.limit * modulus,
        };
        of_stress * self.strength
    }
}

/// Cells that the faces of fibres belong to, with the fibre's place, sorted. A face of a fibre twice
/// in a cell counts once: both soften alike.
fn faces(layout: &Layout, laws: &[Option<u32>]) -> Vec<(usize, u32)> {
    let grid = &layout.grid;
    let smallest = [grid.x_mm(), grid.y_mm()]
        .into_iter()
        .flat_map(|lines| lines.windows(2).map(|pair| pair[1] - pair[0]))
        .fold(f64::INFINITY, f64::min);
    let mut found = Vec::new();
    for (place, band) in layout.bands.iter().enumerate() {
        if laws[place].is_none() {
            continue;
        }
        let distance = band.half_thickness_mm + OUTSIDE * smallest;
        for side in [-1.0, 1.0] {
            cells_along(grid, band, side * distance, |cell| {
                found.push((cell, place as u32));
            });
        }
    }
    found.sort_unstable();
    found
}

/// Visits the cells that a line beside a fibre's axis crosses by more than half.
fn cells_along(grid: &Grid, band: &Band, across_mm: f64, mut visit: impl FnMut(usize)) {
    let [c, s] = band.axis;
    let from = [
        band.through_mm[0] - across_mm * s,
        band.through_mm[1] + across_mm * c,
    ];
    let (x, y) = (grid.x_mm(), grid.y_mm());
    for row in 0..grid.rows() {
        // the stretch of the line within the row, then within each column
        let within = stretch(
            [-band.half_length_mm, band.half_length_mm],
            from[1],
            s,
            [y[row], y[row + 1]],
        );
        if within[0] >= within[1] {
            continue;
        }
        for column in 0..grid.columns() {
            let both = stretch(within, from[0], c, [x[column], x[column + 1]]);
            let sides = [x[column + 1] - x[column], y[row + 1] - y[row]];
            let chord = (sides[0] / c.abs()).min(sides[1] / s.abs());
            if both[1] - both[0] > CROSSED * chord {
                visit(row * grid.columns() + column);
            }
        }
    }
}

/// The part of a stretch of a line, start + t rate, that lies between two values.
fn stretch([from, to]: [f64; 2], start: f64, rate: f64, [low, high]: [f64; 2]) -> [f64; 2] {
    if rate.abs() < f64::EPSILON {
        return if start >= low && start < high {
            [from, to]
        } else {
            [0.0, 0.0]
        };
    }
    let (a, b) = ((low - start) / rate, (high - start) / rate);
    [from.max(a.min(b)), to.min(a.max(b))]
}
