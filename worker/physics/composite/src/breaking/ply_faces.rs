//! Faces between plies: which cells they belong to, and where they are open from the start.
use super::BetweenPlies;
use super::laws::{check_interface, law_of_faces};
use super::part::{BrokenPart, Law, Part};
use crate::error::CompositeError;
use crate::section::{Layout, within};
use loadframe_api::section::lines::pass_through;

/// Stands for the material of what has none.
pub(crate) const NO_MATERIAL: usize = usize::MAX;

/// How far above a face its cell is looked for, over the section's height: a face on a line of
/// particles belongs to the cells above it.
const ABOVE: f64 = 1e-7;

/// The faces of a section's plies that can part.
pub(crate) struct PlyFaces<'a> {
    given: &'a BetweenPlies,
    /// Row of cells of every face, from the bottom; none where plies hold together.
    rows: Vec<usize>,
    /// Place of their law.
    pub(crate) law: u32,
}

impl<'a> PlyFaces<'a> {
    /// Adds their law to those there are.
    ///
    /// # Errors
    /// When a limit is out of its range, or a face is open that is none or cannot part.
    pub(crate) fn new(
        layout: &Layout,
        given: &'a BetweenPlies,
        laws: &mut Vec<Law>,
    ) -> Result<Self, CompositeError> {
        let law = laws.len() as u32;
        let inner = layout.plies.len() - 1;
        for open in &given.open {
            if given.interface.is_none() || open.above_ply >= inner {
                return Err(CompositeError::OutOfRange {
                    quantity: "the ply beneath an open face",
                    given: open.above_ply as f64,
                    allowed: "one with a ply above it, in a section whose ply faces have strengths",
                });
            }
        }
        let Some(strength) = &given.interface else {
            return Ok(Self {
                given,
                rows: Vec::new(),
                law,
            });
        };
        check_interface(strength)?;
        laws.push(law_of_faces(NO_MATERIAL, [1.0, 0.0], strength));
        let lines = layout.grid.y_mm();
        let above = ABOVE * lines[lines.len() - 1];
        let faces = &layout.ply_faces_mm[1..=inner];
        if let Some(&y_mm) = faces.iter().find(|face| !pass_through(lines, &[**face])) {
            return Err(CompositeError::FaceInsideCells { y_mm });
        }
        let rows = faces
            .iter()
            .filter_map(|face| within(lines, face + above).map(|(row, _)| row))
            .collect();
        Ok(Self { given, rows, law })
    }

    /// Faces in a row of cells, by the place of the ply beneath.
    pub(crate) fn of(&self, row: usize) -> impl Iterator<Item = u32> + '_ {
        let all = self.rows.iter().enumerate();
        all.filter(move |(_, at)| **at == row)
            .map(|(face, _)| face as u32)
    }

    /// Whether a part is open from the start.
    pub(crate) fn is_open(&self, layout: &Layout, part: &Part) -> bool {
        let BrokenPart::PlyFace(face) = part.kind else {
            return false;
        };
        let [x, _] = layout.grid.middle_mm(part.cell as usize);
        self.given.open.iter().any(|open| {
            let [from, to] = open.between_mm;
            open.above_ply == face as usize && from <= x && x <= to
        })
    }

    /// A stretch in which no cell has its middle would be open in the spec only.
    pub(crate) fn refuse_unopened<'p>(
        &self,
        layout: &Layout,
        opened: impl Iterator<Item = &'p Part> + Clone,
    ) -> Result<(), CompositeError> {
        for open in &self.given.open {
            let [from, to] = open.between_mm;
            let is_opened = opened.clone().any(|part| {
                let [x, _] = layout.grid.middle_mm(part.cell as usize);
                part.kind == BrokenPart::PlyFace(open.above_ply as u32) && from <= x && x <= to
            });
            if !is_opened {
                return Err(CompositeError::OutOfRange {
                    quantity: "the length of an open face between plies [mm]",
                    given: to - from,
                    allowed: "at least a cell of the grid, with matrix or ply in it",
                });
            }
        }
        Ok(())
    }
}
