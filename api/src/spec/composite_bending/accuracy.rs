//! How finely the section is divided and how its rest is found.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::accuracy::{self, Preset};

/// How exactly: a preset's name or its knobs.
pub type Accuracy = accuracy::Accuracy<Knobs>;

/// Cells of the grid, at whose corners the particles are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Grid {
    /// Cells along x and along y: as equal as they can be with lines of particles on the faces of plies
    /// and the faces and ends of fibres along an axis. Along an axis with fewer cells than those ask for, equal.
    #[schemars(inner(range(min = 1, max = 32_768)), extend("x-unit" = "1"))]
    pub cells: [u32; 2],
    /// Keeps all cells equal, whatever lies in them, as the paper's lattice does. Faces of stiff fibres
    /// that cut cells make a coarse grid too soft or too stiff by tens of per cent.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub equal_cells: bool,
    /// Puts lines of particles on the faces of plies and the faces and ends of fibres along an axis, with so many
    /// cells through each and as small ones beside ends; `cells` then says how large cells may be away from them. Left out: equal cells.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 1000), extend("x-unit" = "1"))]
    pub graded_cells_per_fibre: Option<u32>,
}

/// The knobs of accuracy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Knobs {
    pub solver: Solver,
    pub geometry: Geometry,
    /// Equal steps of the load, of which each is a point of the curve; a step that finds no
    /// equilibrium is halved.
    #[schemars(range(min = 1, max = 10_000), extend("x-unit" = "1"))]
    pub load_steps: u32,
    /// Largest unbalanced force over the largest force on a particle, at which rest is reached. Left
    /// out: 1e-9 (`static`), 1e-7 (the others).
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-13, max = 0.1), extend("x-unit" = "1"))]
    pub residual: Option<f64>,
    /// τ of `verlet`, `pbd` and `xpbd`. Left out: 0.9 of the stable step of springs, three times
    /// that for `xpbd`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-15, max = 1e3), extend("x-unit" = "s"))]
    pub time_step_s: Option<f64>,
    /// Sweeps over all bonds in a time step of `pbd` and `xpbd`.
    #[schemars(range(min = 1, max = 1000), extend("x-unit" = "1"))]
    pub iterations: u32,
    /// c of a drag −c m v on every particle, in `verlet`, `pbd` and `xpbd`. Left out, `verlet` takes that
    /// under which the slowest vibration just does not swing on its way to rest, and particles of `pbd` and
    /// `xpbd` are stopped whenever their kinetic energy has passed a peak; in a test in time nothing is damped
    /// then.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e12), extend("x-unit" = "1/s"))]
    pub damping_per_s: Option<f64>,
    /// Time steps after which motion that does not come to rest is given up.
    #[schemars(range(min = 1, max = 1_000_000_000_u64), extend("x-unit" = "1"))]
    pub step_limit: u64,
}

/// Residual at which rest is reached by motion, unless another is asked for: a tenth of a per mille
/// of the deflection on grids of up to 1 000 particles.
pub const MOTION_RESIDUAL: f64 = 1e-7;

/// The way to the result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Solver {
    /// Solves the equations of equilibrium.
    #[default]
    Static,
    /// Moves the particles under the forces of springs, until they rest or for a time.
    Verlet,
    /// Moves the particles and shifts both ends of each bond ([SizayaTsivilsky2020]); what the
    /// shifts leave unbalanced is added to the load until all rests where `static` would.
    Pbd,
    /// The same with a memory of the force the shifts stand for ([MacklinMuellerChentanez2016]).
    Xpbd,
}

/// How displacements are measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Geometry {
    /// As small: everything is proportional to the load.
    #[default]
    Linear,
    /// Rotations of any size, small strains.
    Large,
}

impl Default for Knobs {
    fn default() -> Self {
        Self {
            solver: Solver::default(),
            geometry: Geometry::default(),
            load_steps: 1,
            residual: None,
            time_step_s: None,
            iterations: 4,
            damping_per_s: None,
            step_limit: 10_000_000,
        }
    }
}

impl accuracy::Knobs for Knobs {
    const PRESETS: &'static str =
        "Named choices: of the grid where it is left out, and of nothing else.";

    fn of(_: Preset) -> Self {
        Self::default()
    }
}

/// Cells through a fibre or ply in the presets' grids.
const PER_FIBRE: u32 = 2;

impl Accuracy {
    /// The grid for a section of the given sides, where none is given.
    pub(super) fn grid(&self, sides_mm: [f64; 2]) -> Grid {
        match self {
            Self::Preset(preset) => preset_grid(*preset, sides_mm),
            Self::Knobs(_) => preset_grid(Preset::Standard, sides_mm),
        }
    }
}

/// The grid that a preset stands for, of square cells away from fibres, plies and corners.
///
/// How wrong each is, the guide's table `composite_presets` says.
pub(super) fn preset_grid(preset: Preset, sides_mm: [f64; 2]) -> Grid {
    // through the shorter side, and along the longer one
    let [shorter, longer] = match preset {
        Preset::Draft => [8.0, 50.0],
        Preset::Standard => [16.0, 200.0],
        Preset::Reference => [32.0, 300.0],
    };
    let short = sides_mm[0].min(sides_mm[1]);
    let long = sides_mm[0].max(sides_mm[1]);
    let cell = (short / shorter).min(long / longer);
    Grid {
        cells: sides_mm.map(|side| ((side / cell).round().clamp(1.0, 32_768.0)) as u32),
        equal_cells: false,
        graded_cells_per_fibre: Some(PER_FIBRE),
    }
}
