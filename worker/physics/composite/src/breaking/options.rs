//! What is broken, how, and until when.
use super::contact::Pressed;
use super::scatter::Scatter;
use crate::error::{CompositeError, positive};
use crate::section::Layout;
use crate::strength::{Criterion, InterfaceStrength, Strength};
use crate::supports::Supports;

/// What is broken, and by what.
#[derive(Debug, Clone, Copy)]
pub struct Specimen<'a> {
    pub layout: &'a Layout,
    /// Prescribed displacements are those at load factor 1.
    pub supports: &'a Supports,
    /// On every displacement at load factor 1 [N], as [`Load::add_to`](crate::load::Load::add_to) writes.
    pub load_n: &'a [f64],
    /// By place of the material.
    pub strengths: &'a [MaterialStrength],
    pub between_plies: &'a BetweenPlies,
    /// Rollers whose forces the load is, if there are some: they follow as the section breaks.
    pub rollers: Option<&'a Pressed>,
}

/// What holds neighbouring plies together.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BetweenPlies {
    /// What their faces bear; `None`: they hold.
    pub interface: Option<InterfaceStrength>,
    /// Faces that were never bonded: they slide, bear pressure, and open where they are pulled.
    pub open: Vec<OpenFace>,
}

/// A stretch of a face between plies that was never bonded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OpenFace {
    /// Place of the ply beneath it, from the bottom.
    pub above_ply: usize,
    /// Along the section [mm]; it covers the cells whose middle lies within.
    pub between_mm: [f64; 2],
}

/// Limits of a material.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MaterialStrength {
    pub bulk: Strength,
    /// Of the faces of its fibres.
    pub interface: Option<InterfaceStrength>,
}

/// How a section is broken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BreakingOptions {
    /// What limits of materials are compared with, and are. Those of interfaces, which have no thickness,
    /// are stresses always.
    pub criterion: Criterion,
    pub scatter: Option<Scatter>,
    /// Of every crack with a fracture energy, 1 to 1000. More follow the softening more closely: the
    /// energy is known within 18 % for 10 and 5 % for 40, see [`Totals::saw_error`].
    pub teeth: u32,
    pub seed: u64,
    pub stop: Stop,
}

impl Default for BreakingOptions {
    fn default() -> Self {
        Self {
            criterion: Criterion::Stress,
            scatter: None,
            teeth: 10,
            seed: 1,
            stop: Stop::default(),
        }
    }
}

/// When breaking ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// When the force at the largest displacement so far has fallen below this part of its peak; 0 to
    /// below 1. Below a thousandth it is what broken cells keep for the equations' sake that bears,
    /// and breaking ends in any case.
    pub force_fraction: f64,
    /// After so many events.
    pub events: u64,
    /// Before the drive moves further than this.
    pub displacement_mm: Option<f64>,
}

impl Default for Stop {
    fn default() -> Self {
        Self {
            force_fraction: 0.1,
            events: 100_000,
            displacement_mm: None,
        }
    }
}

/// Checks options; the number of teeth.
pub(super) fn check(options: &BreakingOptions) -> Result<u16, CompositeError> {
    const MOST_TEETH: u16 = 1000;
    let teeth = u16::try_from(options.teeth)
        .ok()
        .filter(|teeth| (1..=MOST_TEETH).contains(teeth));
    let Some(teeth) = teeth else {
        return Err(CompositeError::OutOfRange {
            quantity: "the number of teeth of softening",
            given: f64::from(options.teeth),
            allowed: "from 1 to 1000",
        });
    };
    let fraction = options.stop.force_fraction;
    if !(0.0..1.0).contains(&fraction) {
        return Err(CompositeError::OutOfRange {
            quantity: "the part of the peak force at which breaking ends",
            given: fraction,
            allowed: "from 0 to below 1",
        });
    }
    if let Some(most) = options.stop.displacement_mm {
        positive("the displacement at which breaking ends [mm]", most)?;
    }
    Ok(teeth)
}
