//! Plies: the layers of a laminate, homogenised, from the bottom face to the top.
use crate::error::{CompositeError, finite, positive};
use crate::material::{Note, PlaneState};
use crate::section::described::{Ply, Section};
use crate::stiffness::{Stiffness, laminate, turned};

/// How far the thicknesses of plies may miss the section's height, as a share of it.
const STACK_SLACK: f64 = 1e-9;

impl Section {
    /// The plies, or the matrix as the only one.
    ///
    /// # Errors
    /// When a ply has no thickness, an angle is not finite, or they do not fill the height.
    pub(crate) fn stack(&self) -> Result<Vec<Ply>, CompositeError> {
        if self.plies.is_empty() {
            return Ok(vec![Ply {
                material: self.matrix,
                thickness_mm: self.height_mm,
                angle_deg: 0.0,
                in_plane_angle_deg: self.matrix_angle_deg,
            }]);
        }
        if self.matrix_angle_deg != 0.0 {
            return Err(CompositeError::OutOfRange {
                quantity: "the matrix angle [°] of a section of plies",
                given: self.matrix_angle_deg,
                allowed: "0: every ply has angles of its own",
            });
        }
        for ply in &self.plies {
            positive("a ply's thickness [mm]", ply.thickness_mm)?;
            finite("a ply's angle [°]", ply.angle_deg)?;
            finite("a ply's angle in the plane [°]", ply.in_plane_angle_deg)?;
        }
        let total_mm: f64 = self.plies.iter().map(|ply| ply.thickness_mm).sum();
        if (total_mm - self.height_mm).abs() > STACK_SLACK * self.height_mm {
            return Err(CompositeError::PliesMissHeight {
                total_mm,
                height_mm: self.height_mm,
            });
        }
        Ok(self.plies.clone())
    }

    /// Plane stiffness of a ply in the section's axes [MPa], and what had to be assumed for it.
    pub(crate) fn ply_stiffness(
        &self,
        ply: &Ply,
        state: PlaneState,
    ) -> Result<(Stiffness, Vec<Note>), CompositeError> {
        let substance = self
            .materials
            .get(ply.material)
            .ok_or(CompositeError::OutOfRange {
                quantity: "the place of a material in the list",
                given: ply.material as f64,
                allowed: "less than the number of materials",
            })?;
        let (stiffness, notes) = substance
            .material
            .stiffness_out_of_plane(state, ply.angle_deg)?;
        Ok((turned(&stiffness, ply.in_plane_angle_deg), notes))
    }
}

/// Faces of a stack's plies from 0 to the section's height [mm].
pub(crate) fn faces_mm(stack: &[Ply], height_mm: f64) -> Vec<f64> {
    let mut faces = vec![0.0];
    let mut at = 0.0;
    for ply in stack {
        at += ply.thickness_mm;
        faces.push(at);
    }
    // What the sum of thicknesses misses is round-off of the description.
    faces[stack.len()] = height_mm;
    faces
}

/// A horizontal strip of a stack: the exact average of the layers it cuts.
pub(crate) struct Strip {
    pub(crate) stiffness: Stiffness,
    pub(crate) density: f64,
}

/// The strip between two heights, of plies with the given faces, stiffnesses and densities. A part
/// of less than `least` of it is round-off.
pub(crate) fn strip(
    [lower, upper]: [f64; 2],
    faces: &[f64],
    stiffness: &[Stiffness],
    density: &[f64],
    least: f64,
) -> Strip {
    let mut layers = Vec::new();
    let mut mean = 0.0;
    let mut whole = 0.0;
    for (place, share) in shares_between([lower, upper], faces, least) {
        layers.push((share, stiffness[place]));
        mean += share * density[place];
        whole += share;
    }
    Strip {
        density: mean / whole,
        stiffness: laminate(&layers, 0.0),
    }
}

/// The layers between two heights, with their shares of the stretch. One of less than `least` is
/// round-off.
pub(crate) fn shares_between(
    [lower, upper]: [f64; 2],
    faces: &[f64],
    least: f64,
) -> impl Iterator<Item = (usize, f64)> + '_ {
    faces
        .windows(2)
        .enumerate()
        .filter_map(move |(place, pair)| {
            let share = (pair[1].min(upper) - pair[0].max(lower)) / (upper - lower);
            (share > least).then_some((place, share))
        })
}
