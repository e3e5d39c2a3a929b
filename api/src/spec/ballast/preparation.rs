//! How a bed is made before it is loaded.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::super::granular_scene::{Axis, Equal};

/// Layer by layer, grains are poured in, settle, and what stands above the layer's height is taken out.
///
/// An oedometer's bed is compacted under its plate, that of a box test as a whole, around and under its
/// sleeper, as in [Dubina2014] 4.2.1 and 5.2; a rail bed's layers before each is cut, as in chapter 6.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Preparation {
    /// Volume of grains poured over what a layer holds at a porosity of 0.4.
    #[schemars(range(min = 1.0, max = 3.0), extend("x-unit" = "1"))]
    pub overfill: f64,
    /// Mean resultant force on a grain over the mean contact force, below which a bed has settled.
    #[schemars(range(min = 1e-6, max = 0.5), extend("x-unit" = "1"))]
    pub unbalanced_force_ratio: f64,
    /// A bed that has not settled by then goes on as it is, with a warning.
    #[schemars(range(min = 1e-3, max = 1e3), extend("x-unit" = "s"))]
    pub longest_settling_s: f64,
    /// `null` leaves a bed as it was poured.
    pub compaction: Option<Compaction>,
    /// Grains that are rigid clumps are poured as spheres, and when a layer of them has settled, each is
    /// replaced by a clump, turned at random, and the layer settles again before it is cut or shaken. The
    /// sizes of grains are then those of the spheres. Left out, clumps are poured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub poured_as_spheres: Option<PouredAsSpheres>,
    /// A wall that swings up and down, after the bed has been shaken, if it is; left out, none does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tamping: Option<Tamping>,
}

/// How the clumps of a bed take the places of spheres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PouredAsSpheres {
    /// What a clump has in common with its sphere. Clumps of equal size lie looser than the spheres did and
    /// sink, so more spheres are poured; those of equal mass are pushed out of each other before they settle.
    #[serde(skip_serializing_if = "Equal::is_size")]
    pub equal: Equal,
}

/// A wall beats the bed, or shakes it from below: about the place it is at, z goes by A (cos 2πft − 1) for
/// the wall that loads, which lifts off where the bed does not follow, and by A sin 2πft for the base. It
/// does whole swings, so that it ends where it began; what loads comes down on the bed after that.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Tamping {
    #[serde(default)]
    pub by: Tamper,
    /// f.
    #[schemars(range(min = 0.1, max = 1e4), extend("x-unit" = "Hz"))]
    pub frequency_hz: f64,
    /// A: the wall that loads goes 2A down into the bed.
    #[schemars(range(min = 1e-7, max = 1.0), extend("x-unit" = "m"))]
    pub amplitude_m: f64,
    /// Up to a whole number of swings.
    #[schemars(range(min = 1e-3, max = 1e3), extend("x-unit" = "s"))]
    pub time_s: f64,
    /// What tan φ is multiplied with meanwhile.
    #[serde(default = "unchanged")]
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1"))]
    pub friction_factor: f64,
}

/// What swings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Tamper {
    /// The wall that loads: a plate, or a sleeper with flat faces.
    #[default]
    Plate,
    /// The wall below the bed: a vibrating table without its sides.
    Base,
}

/// Shaking along x and y in turn, or along other axes, while grains slide more easily.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Compaction {
    #[schemars(range(min = 0.0, max = 1e4), extend("x-unit" = "m/s2"))]
    pub acceleration_m_per_s2: f64,
    #[schemars(range(min = 0.1, max = 1e4), extend("x-unit" = "Hz"))]
    pub frequency_hz: f64,
    #[schemars(range(min = 1e-3, max = 1e3), extend("x-unit" = "s"))]
    pub time_s: f64,
    /// Axes along which it is shaken, in turn: `["z"]` is a vertical vibrator.
    #[serde(skip_serializing_if = "is_across")]
    #[schemars(length(min = 1, max = 100))]
    pub axes: Vec<Axis>,
    /// What tan φ is multiplied with meanwhile.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1"))]
    pub friction_factor: f64,
}

impl Default for Preparation {
    fn default() -> Self {
        Self {
            overfill: 1.1,
            unbalanced_force_ratio: 0.03,
            longest_settling_s: 2.0,
            compaction: Some(Compaction::default()),
            poured_as_spheres: None,
            tamping: None,
        }
    }
}

/// The source says what it does and that friction falls by an order of magnitude, not how hard and
/// how long it shakes; a vibrating table shakes at some g and some ten hertz. After 1 s an oedometer's
/// bed keeps a tenth of its way, nearly nothing, as the source says of shaken ones; after 3 s, none.
impl Default for Compaction {
    fn default() -> Self {
        Self {
            acceleration_m_per_s2: 9.81,
            frequency_hz: 20.0,
            time_s: 1.0,
            axes: vec![Axis::X, Axis::Y],
            friction_factor: 0.1,
        }
    }
}

fn unchanged() -> f64 {
    1.0
}

fn is_across(axes: &[Axis]) -> bool {
    axes == [Axis::X, Axis::Y]
}
