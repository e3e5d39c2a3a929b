//! Spec of a test of a composite's section: fibres or plies in a matrix, as particles on a grid.
//!
//! A rectangle in the plane of x (along its length) and y (up), its origin in the lower left corner,
//! is held and loaded; the particles' lattice answers ([SizayaTsivilsky2020] and its corrected form).
//! Lengths are in mm, forces in N, moduli and stresses in MPa, angles in degrees.
//!
//! The parts, each in its own file: what the section is made of ([`Material`], [`Fibre`], [`Ply`]),
//! what is done to it ([`Test`]), and how exactly ([`Grid`], [`Lattice`], [`Accuracy`]).
mod accuracy;
pub(super) mod checks;
mod estimate;
mod job_kind;
mod learned;
mod lines;
mod lowest;
mod material;
mod results;
mod rollers;
mod study;
mod test;

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use accuracy::{Accuracy, Geometry, Grid, Knobs, MOTION_RESIDUAL, Solver};
pub use material::{Interface, Isotropic, Limit, Material, Orthotropic, Strength};
pub use test::{
    Axis, Breaking, Control, Criterion, DoubleCantilever, Driven, Face, Flexure, Grips, History,
    HistoryLoad, Load, LoadPlace, Patch, Scatter, Shear, Support, SupportWord, Supports, Tension,
    Test, Way,
};

/// A virtual test of a composite's section.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CompositeBending {
    /// Version of this spec's format.
    #[schemars(range(min = 1, max = 1))]
    pub version: u32,
    /// Seed of every random stream of the test.
    #[serde(default = "one")]
    #[schemars(range(max = 9_007_199_254_740_991_u64))]
    pub seed: u64,
    pub section: Section,
    /// Materials by name.
    #[schemars(extend("maxProperties" = 1000))]
    pub materials: BTreeMap<String, Material>,
    /// Name of the material between the fibres. May be left out where `plies` fill the section.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub matrix: Option<String>,
    /// Angle of the matrix material's axis 1 to x.
    #[serde(default)]
    #[schemars(range(min = -360.0, max = 360.0), extend("x-unit" = "°"))]
    pub matrix_angle_deg: f64,
    /// Layers that fill the section from the bottom to the top, in place of a matrix.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 1000))]
    pub plies: Vec<Ply>,
    /// What the faces between plies bear, all alike, where the test lets things break; left out, plies
    /// hold together.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ply_interface: Option<Interface>,
    /// Stretches of faces between plies that are open from the start, as a film leaves them. No two of
    /// one face overlap.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 1000))]
    pub delaminations: Vec<Delamination>,
    /// Fibres, one by one.
    #[serde(default)]
    #[schemars(length(max = 10_000))]
    pub fibres: Vec<Fibre>,
    /// Cells between the particles. Left out, it follows from `accuracy`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub grid: Option<Grid>,
    #[serde(default)]
    pub lattice: Lattice,
    pub test: Test,
    /// Points at which displacements are written to `points.csv`.
    #[serde(default)]
    #[schemars(
        length(max = 10_000),
        inner(inner(range(min = 0.0, max = 1e6))),
        extend("x-unit" = "mm")
    )]
    pub probes_mm: Vec<[f64; 2]>,
    #[serde(default)]
    pub accuracy: Accuracy,
    #[serde(default)]
    pub output: Output,
}

/// The rectangle that is tested.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Section {
    /// Along x.
    #[schemars(range(min = 1e-6, max = 1e6), extend("x-unit" = "mm"))]
    pub length_mm: f64,
    /// Along y.
    #[schemars(range(min = 1e-6, max = 1e6), extend("x-unit" = "mm"))]
    pub height_mm: f64,
    /// Out of the plane; the width of a bent specimen.
    #[schemars(range(min = 1e-6, max = 1e6), extend("x-unit" = "mm"))]
    pub thickness_mm: f64,
    pub state: State,
}

/// What is known of the direction out of the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// A thin sheet or a narrow strip: no stress out of the plane.
    PlaneStress,
    /// A long body: no strain out of the plane.
    PlaneStrain,
}

/// A straight fibre: a band through a point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Fibre {
    /// Name of its material, whose axis 1 lies along the fibre.
    pub material: String,
    /// A point on its axis; the middle of it when it has a length.
    #[schemars(inner(range(min = -1e6, max = 1e6)), extend("x-unit" = "mm"))]
    pub through_mm: [f64; 2],
    /// Angle of its axis to x.
    #[schemars(range(min = -360.0, max = 360.0), extend("x-unit" = "°"))]
    pub angle_deg: f64,
    /// Across its axis.
    #[schemars(range(min = 1e-6, max = 1e6), extend("x-unit" = "mm"))]
    pub thickness_mm: f64,
    /// Along its axis; left out, it runs from edge to edge of the section.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-6, max = 1e7), extend("x-unit" = "mm"))]
    pub length_mm: Option<f64>,
}

/// A homogeneous layer along x.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ply {
    /// Name of its material, whose axis 1 lies along its fibres.
    pub material: String,
    /// Along y.
    #[schemars(range(min = 1e-6, max = 1e6), extend("x-unit" = "mm"))]
    pub thickness_mm: f64,
    /// The ply's angle in its laminate: 0 lies along x, 90 out of the section's plane.
    #[serde(default)]
    #[schemars(range(min = -360.0, max = 360.0), extend("x-unit" = "°"))]
    pub angle_deg: f64,
    /// A turn of its fibres within the section's plane, after the other.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[schemars(range(min = -360.0, max = 360.0), extend("x-unit" = "°"))]
    pub in_plane_angle_deg: f64,
}

/// A stretch of the face between two plies that is open from the start.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Delamination {
    /// The ply beneath it, counted from 1 at the bottom.
    #[schemars(range(min = 1, max = 999), extend("x-unit" = "1"))]
    pub above_ply: u32,
    /// Where it begins along x. Its ends move to the nearest lines of particles.
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "mm"))]
    pub from_mm: f64,
    /// Where it ends along x.
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "mm"))]
    pub to_mm: f64,
}

/// What holds the particles together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Lattice {
    /// Crossed bonds with the terms that make any material exact in uniform strain.
    Exact(Exact),
    /// The springs of [SizayaTsivilsky2020], which are too stiff; for comparison.
    Paper(Paper),
}

/// Nothing is to be chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Exact {}

/// The rules of the paper where its text leaves a choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Paper {
    pub stiffness: BondStiffness,
    #[serde(default)]
    pub bonds: BondPattern,
}

/// Stiffness of a bond over thickness, by the material of its particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BondStiffness {
    /// E(1 − ν)/((1 + ν)(1 − 2ν)).
    PWave,
    /// E(1 − ν).
    Bare,
}

/// Which neighbours are bonded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BondPattern {
    /// Along the edges and both diagonals of every cell.
    #[default]
    Cross,
    /// Along the edges and one diagonal.
    OneDiagonal,
    /// Along the edges only: such a lattice folds.
    Edges,
}

/// What is written beside the results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Displacements in the pictures over the true ones. Left out: so that the largest is a tenth of
    /// the smaller side.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e9), extend("x-unit" = "1"))]
    pub deformation_factor: Option<f64>,
    /// Whether the section's picture is written.
    pub picture: bool,
}

impl Default for Output {
    fn default() -> Self {
        Self {
            deformation_factor: None,
            picture: true,
        }
    }
}

impl Default for Lattice {
    fn default() -> Self {
        Self::Exact(Exact {})
    }
}

impl From<State> for crate::section::material::PlaneState {
    fn from(state: State) -> Self {
        match state {
            State::PlaneStress => Self::Stress,
            State::PlaneStrain => Self::Strain,
        }
    }
}

impl CompositeBending {
    /// The grid that is asked for, or that `accuracy` stands for.
    pub fn grid(&self) -> Grid {
        self.grid.unwrap_or_else(|| {
            self.accuracy
                .grid([self.section.length_mm, self.section.height_mm])
        })
    }

    /// Names of the curve's columns.
    pub fn columns(&self) -> &'static [&'static str] {
        if self.test.breaking.is_some() {
            &["deflection_mm", "force_n", "events", "dissipated_n_mm"]
        } else if self.test.history.is_some() {
            &[
                "time_s",
                "mean_top_deflection_mm",
                "mean_bottom_deflection_mm",
                "kinetic_energy_n_mm",
                "strain_energy_n_mm",
            ]
        } else if self.test.way().is_some_and(|way| way.flexure().is_some()) {
            &[
                "deflection_mm",
                "force_n",
                "load_fraction",
                "roller_displacement_mm",
                "flexural_strain",
                "flexural_stress_mpa",
            ]
        } else {
            &[
                "deflection_mm",
                "force_n",
                "load_fraction",
                "mean_top_deflection_mm",
                "mean_bottom_deflection_mm",
                "strain_energy_n_mm",
            ]
        }
    }
}

fn one() -> u64 {
    1
}

#[allow(clippy::float_cmp, reason = "what was written as 0")]
fn is_zero(angle: &f64) -> bool {
    *angle == 0.0
}
