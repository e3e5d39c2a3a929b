//! Spec of a unit cell: fibres in a matrix, seen along them, repeated without end.
//!
//! From the constants of two materials and the places of fibres follow the constants of the composite,
//! those that a ply of a [`super::composite_bending`] job takes. Fibres run along axis 1; the cell lies
//! across them, axis 2 to the right and axis 3 up. Lengths are in mm, moduli and stresses in MPa.
mod accuracy;
mod checks;
mod estimate;
mod job_kind;
mod results;
mod study;

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{composite_bending::Material, repeats::one_repeat};
pub use accuracy::{Accuracy, Knobs};

/// The effective constants of a unidirectional composite.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CompositeCell {
    /// Version of this spec's format.
    #[schemars(range(min = 1, max = 1))]
    pub version: u32,
    /// Seed of the fibres' places; further repeats take seeds that follow from it.
    #[serde(default = "one")]
    #[schemars(range(max = 9_007_199_254_740_991_u64))]
    pub seed: u64,
    /// Materials by name.
    #[schemars(extend("maxProperties" = 1000))]
    pub materials: BTreeMap<String, Material>,
    /// Name of the material between the fibres.
    pub matrix: String,
    /// Name of the fibres' material, whose axis 1 lies along them.
    pub fibre: String,
    pub arrangement: Arrangement,
    /// Cells with fibres in other random places, over which results scatter. More than one needs a
    /// random arrangement.
    #[serde(default = "one_repeat")]
    #[schemars(range(min = 1, max = 1000), extend("x-unit" = "1"))]
    pub repeats: u32,
    #[serde(default)]
    pub accuracy: Accuracy,
    #[serde(default)]
    pub output: Output,
}

/// Where the fibres are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Arrangement {
    /// In places drawn from the seed, none over another.
    Random(Random),
    /// One in every square.
    Square(Regular),
    /// Each in the middle of six.
    Hexagonal(Regular),
    /// As measured, from a micrograph perhaps.
    Measured(Measured),
}

/// Fibres of one diameter in random places of a square cell, as large as their fraction makes it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Random {
    /// Volume of fibres over that of the composite.
    #[schemars(range(min = 0.001, max = 0.7), extend("x-unit" = "1"))]
    pub fibre_fraction: f64,
    /// Fibres in the cell. Fewer than some 30 make constants of a cell that differ along 2 and 3.
    #[schemars(range(min = 1, max = 1_000), extend("x-unit" = "1"))]
    pub fibres: u32,
    #[schemars(range(min = 1e-6, max = 1e6), extend("x-unit" = "mm"))]
    pub diameter_mm: f64,
    /// Least gap between fibres over their diameter.
    #[serde(default = "least_gap")]
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1"))]
    pub least_gap: f64,
}

/// Fibres of one diameter in a regular array.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Regular {
    /// Volume of fibres over that of the composite: below π/4 in squares, π/(2√3) in hexagons.
    #[schemars(range(min = 0.001, max = 0.907), extend("x-unit" = "1"))]
    pub fibre_fraction: f64,
    #[schemars(range(min = 1e-6, max = 1e6), extend("x-unit" = "mm"))]
    pub diameter_mm: f64,
}

/// Fibres one by one in a rectangle that repeats.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Measured {
    /// Along axes 2 and 3.
    #[schemars(inner(range(min = 1e-6, max = 1e6)), extend("x-unit" = "mm"))]
    pub size_mm: [f64; 2],
    #[schemars(length(min = 1, max = 1_000))]
    pub fibres: Vec<RoundFibre>,
}

/// A fibre's cross-section.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RoundFibre {
    /// From the cell's lower left corner. What reaches over an edge comes in at the other side.
    #[schemars(inner(range(min = -1e6, max = 1e6)), extend("x-unit" = "mm"))]
    pub centre_mm: [f64; 2],
    #[schemars(range(min = 1e-6, max = 1e6), extend("x-unit" = "mm"))]
    pub diameter_mm: f64,
}

/// What is written beside the results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Whether the first cell's picture is written, with its stresses under a pull across the fibres.
    pub picture: bool,
}

impl Default for Output {
    fn default() -> Self {
        Self { picture: true }
    }
}

impl Arrangement {
    /// The cell's sides [mm].
    pub fn size_mm(&self) -> [f64; 2] {
        let area = |diameter: f64| 0.25 * std::f64::consts::PI * diameter * diameter;
        match self {
            Self::Random(random) => {
                let area = f64::from(random.fibres) * area(random.diameter_mm);
                [(area / random.fibre_fraction).sqrt(); 2]
            }
            Self::Square(regular) => {
                [(area(regular.diameter_mm) / regular.fibre_fraction).sqrt(); 2]
            }
            // two fibres in a rectangle of 1 to the root of 3
            Self::Hexagonal(regular) => {
                let short = (2.0 * area(regular.diameter_mm)
                    / (regular.fibre_fraction * 3.0_f64.sqrt()))
                .sqrt();
                [short, 3.0_f64.sqrt() * short]
            }
            Self::Measured(measured) => measured.size_mm,
        }
    }

    /// The smallest fibre's diameter [mm].
    pub fn least_diameter_mm(&self) -> f64 {
        match self {
            Self::Random(random) => random.diameter_mm,
            Self::Square(regular) | Self::Hexagonal(regular) => regular.diameter_mm,
            Self::Measured(measured) => measured
                .fibres
                .iter()
                .map(|fibre| fibre.diameter_mm)
                .fold(f64::INFINITY, f64::min),
        }
    }

    /// Volume of fibres over that of the composite.
    pub fn fibre_fraction(&self) -> f64 {
        match self {
            Self::Random(random) => random.fibre_fraction,
            Self::Square(regular) | Self::Hexagonal(regular) => regular.fibre_fraction,
            Self::Measured(measured) => {
                let squares = measured
                    .fibres
                    .iter()
                    .map(|fibre| fibre.diameter_mm.powi(2));
                let [width, height] = measured.size_mm;
                0.25 * std::f64::consts::PI * squares.sum::<f64>() / (width * height)
            }
        }
    }
}

impl CompositeCell {
    /// The knobs of accuracy, those of a preset for the cell at hand.
    pub fn chosen_knobs(&self) -> Knobs {
        let longest = self.arrangement.size_mm().into_iter().fold(0.0, f64::max);
        let fibres_along = longest / self.arrangement.least_diameter_mm();
        accuracy::knobs_for(&self.accuracy, fibres_along)
    }

    /// Cells of the grid along axes 2 and 3: as many as `accuracy` puts through a fibre, in multiples of
    /// four, so that they can be halved twice.
    pub fn cells(&self) -> [u32; 2] {
        let knobs = self.chosen_knobs();
        let cell = self.arrangement.least_diameter_mm() / f64::from(knobs.cells_per_fibre);
        self.arrangement.size_mm().map(|side| {
            let fours = (side / (4.0 * cell)).ceil().clamp(4.0, 1e6);
            4 * fours as u32
        })
    }
}

fn one() -> u64 {
    1
}

/// Carbon fibres in a press come as near as some hundredths of their diameter.
fn least_gap() -> f64 {
    0.02
}
