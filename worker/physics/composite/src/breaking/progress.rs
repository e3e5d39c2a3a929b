//! Sums over cracks, and the last of them.
use serde::{Deserialize, Serialize};

use super::event::{Dissipated, Mode};
use super::part::BrokenPart;
use super::system::Loss;
use crate::lattice::Measures;

/// Sums over the events so far.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Progress {
    pub(super) events: u64,
    /// Of the drive, at the last event.
    pub(super) displacement_mm: f64,
    pub(super) peak_n: f64,
    pub(super) reach_mm: f64,
    pub(super) crack_area_mm2: f64,
    pub(super) contacts: u64,
    pub(super) contacts_kept: u64,
    /// Without the last event, whose part is known at the next.
    pub(super) dissipated: Dissipated,
    pub(super) pending: Option<Pending>,
}

/// The last crack.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Pending {
    pub(super) cell: u32,
    pub(super) part: BrokenPart,
    pub(super) mode: Mode,
    /// Of its cell at the event.
    pub(super) measures: Measures,
    pub(super) loss: Loss,
    /// What it takes if the drive is held [N mm].
    pub(super) held_n_mm: f64,
}
