//! The scene that a test is, and what its stages are.
mod building;
mod composing;
mod loads;

use std::collections::BTreeMap;

use super::super::granular_scene::{Generate, GranularScene, Region, Settle, Volume};
use super::{Compaction, Tamping, Walls, grains::SpheresFirst, materials::AGGREGATE};

/// What a stage of a test does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    Pour,
    Settle,
    /// Clumps take the places of spheres.
    Replace,
    Compact,
    Tamp,
    Cut,
    Place,
    Stiffen,
    /// The smallest force acts.
    Seat,
    Load,
}

/// A stage of the load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// Number of its block, from 0.
    pub block: usize,
    /// Number of its cycle, or of the first of them, from 0.
    pub cycle: usize,
    pub course: Course,
}

/// How a stage of the load goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Course {
    /// The force swings: T [s] and cycles.
    Swing { period: f64, cycles: u32 },
    /// A machine goes down until this force [N], beside the wall's weight.
    Down { force: f64 },
    /// And up again.
    Up,
}

/// A bed's layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// Where grains are poured, from their lowest place on. The region is made as high as it must be.
    pub footprint: Volume,
    /// What is to be filled, between grains and with them [m³].
    pub volume: f64,
}

/// A part of the bed in which porosity is measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Slice {
    /// Name of the scene's region.
    pub name: String,
    /// Lower and upper height [m].
    pub heights: [f64; 2],
}

/// A test as a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Script {
    pub scene: GranularScene,
    /// Whether a plate presses a bed that cannot give way sideways.
    pub is_oedometer: bool,
    /// What each stage does.
    pub phases: Vec<Phase>,
    /// What loads, by the name that its columns of the scene's curve begin with.
    pub wall: String,
    /// Its number when it is a body: a sleeper of spheres.
    pub body: Option<u32>,
    /// Place of the rail from the middle of a sleeper that tilts [m].
    pub rail: Option<[f64; 3]>,
    /// Height of its lower face at the start [m].
    pub wall_height: f64,
    /// Walls below and around the bed.
    pub walls: Walls,
    /// Middle of the rectangle around that area, x and y [m].
    pub middle: [f64; 2],
    /// Area under it [m²].
    pub loaded_area: f64,
    /// What each stage of the load is, by number of the stage.
    pub loads: BTreeMap<usize, Load>,
    /// Force of the wall's weight, beside the load [N].
    pub weight: f64,
    pub slices: Vec<Slice>,
    /// The slices together, and what stands out above them.
    pub bed: Slice,
    template: Generate,
    spheres_first: Option<SpheresFirst>,
    placed_fraction: f64,
    largest_diameter: f64,
    settle: Settle,
    compaction: Option<Compaction>,
    tamping: Option<Tamping>,
    overfill: f64,
}

/// g [m/s²].
const GRAVITY: f64 = 9.81;
/// The region that holds the whole bed under the wall.
pub const BED: &str = "bed";

impl Layer {
    /// Area over which it is poured [m²].
    fn area(&self) -> f64 {
        let [lower, upper] = self.footprint.bounds();
        self.footprint.volume() / (upper[2] - lower[2])
    }
}

impl Slice {
    /// Volume in it [m³] below a wall of an area [m²] at a height [m].
    pub fn room(&self, area: f64, height: f64) -> f64 {
        let [lower, upper] = self.heights;
        area * (upper.min(height) - lower).max(0.0)
    }

    fn region(&self, [low, high]: [[f64; 2]; 2]) -> Region {
        let [bottom, top] = self.heights;
        Region {
            name: self.name.clone(),
            low_m: Some([low[0], low[1], bottom]),
            high_m: Some([high[0], high[1], top]),
            // a sleeper of spheres is none of the bed
            material: Some(AGGREGATE.to_owned()),
        }
    }
}

impl Phase {
    /// Word for tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pour => "pour",
            Self::Settle => "settle",
            Self::Replace => "replace",
            Self::Compact => "compact",
            Self::Tamp => "tamp",
            Self::Cut => "cut",
            Self::Place => "place",
            Self::Stiffen => "stiffen",
            Self::Seat => "seat",
            Self::Load => "load",
        }
    }
}
