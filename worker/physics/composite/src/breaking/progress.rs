//! Sums over cracks, and the last of them.
use serde::{Deserialize, Serialize};

use super::event::{Dissipated, Mode};
use super::part::BrokenPart;
use super::system::Loss;
use crate::lattice::Measures;

/// Sums over the events so far.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Progress {
    pub(super) events: u64,
    /// Of the drive, at the last event.
    pub(super) displacement_mm: f64,
    pub(super) peak_n: f64,
    pub(super) reach_mm: f64,
    pub(super) crack_area_mm2: f64,
    pub(super) contacts: u64,
    pub(super) contacts_kept: u64,
    /// How often faces of cracks met or parted, and how often they were given up.
    pub(super) turns: u64,
    pub(super) turns_left: u64,
    /// What the straight lines from event to event have too much because faces meet between [N mm].
    pub(super) closing_n_mm: f64,
    /// Without the last event, whose part is known at the next.
    pub(super) dissipated: Dissipated,
    pub(super) pending: Option<Pending>,
}

/// The last crack.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Pending {
    pub(super) part: BrokenPart,
    pub(super) mode: Mode,
    pub(super) loss: CellLoss,
    /// Of cells whose cracks closed or opened again since.
    pub(super) turned: Vec<CellLoss>,
    /// What it takes if the drive is held [N mm].
    pub(super) held_n_mm: f64,
}

/// What a cell lost at an event.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct CellLoss {
    pub(super) cell: u32,
    /// At the event.
    pub(super) measures: Measures,
    pub(super) loss: Loss,
}

impl CellLoss {
    /// ½ ε · (C - C') ε' V with the measures at the next event [N mm].
    pub(super) fn until(&self, next: &Measures) -> f64 {
        0.5 * self.loss.between(&self.measures, next)
    }
}
