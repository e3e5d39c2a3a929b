//! A section as a user describes it.
use loadframe_api::section::fibre::Fibre;

use crate::material::{Material, PlaneState};

/// A rectangular section of a composite; x runs along its length, y up, the origin is its lower
/// left corner.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    pub length_mm: f64,
    pub height_mm: f64,
    /// Out of the plane.
    pub thickness_mm: f64,
    pub state: PlaneState,
    /// All materials with their densities; matrix and fibres name them by place.
    pub materials: Vec<Substance>,
    /// Which material lies between the fibres, where there are no plies.
    pub matrix: usize,
    /// Angle of the matrix material's axis 1 to x [°].
    pub matrix_angle_deg: f64,
    /// From the bottom face to the top, as thick together as the section is high; none: the matrix
    /// fills the section.
    pub plies: Vec<Ply>,
    pub fibres: Vec<Fibre>,
}

/// A material and its density.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Substance {
    pub material: Material,
    /// Matters to motion only, never to an equilibrium.
    pub density_kg_per_m3: f64,
}

/// A layer of a laminate over the whole length of the section.
///
/// Its fibres lie at `angle_deg` in the plane of the layer, which stands upright on the section's,
/// as a laminate's stacking sequence has it: 0° along x, 90° across the section's plane. A waviness
/// in the section's plane turns what results by `in_plane_angle_deg` about z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ply {
    /// Which of the section's materials it is of.
    pub material: usize,
    /// Along y [mm].
    pub thickness_mm: f64,
    /// Angle of its fibres to x, a turn about y [°].
    pub angle_deg: f64,
    /// Then a turn about z [°].
    pub in_plane_angle_deg: f64,
}
