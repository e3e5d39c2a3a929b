//! What breaking tells: one event for every tooth of every crack.
use serde::{Deserialize, Serialize};

use super::part::BrokenPart;

/// How a part broke.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    Tension,
    Compression,
    Shear,
}

/// A part of a cell lost a tooth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// From 1.
    pub number: u64,
    /// λ: of the loads or displacements that were given.
    pub factor: f64,
    /// Of the drive [mm]: for forces the displacement that does their work, Σ f·u over their size; else
    /// by how much what is held moves apart.
    pub displacement_mm: f64,
    /// Of the drive [N]: the size of the forces' sum, of half of all forces where they balance each
    /// other; for displacements the reactions' work over the displacement.
    pub force_n: f64,
    pub cell: usize,
    pub part: BrokenPart,
    pub mode: Mode,
    /// Shear's part of the criterion: 0 pure normal, 1 pure shear.
    pub shear_share: f64,
    /// Normal of the crack.
    pub normal: [f64; 2],
    /// Teeth that are broken now; as many as there are: the crack is open.
    pub tooth: u32,
    /// Elastic energy at the event [N mm].
    pub elastic_n_mm: f64,
    /// What the section gives away by this event while the drive is held [N mm].
    pub energy_released_n_mm: f64,
    /// All that was dissipated on the path to this event [N mm].
    pub dissipated_n_mm: f64,
    /// Work along the straight lines to this event that is neither elastic nor dissipated, because faces of
    /// cracks meet between events [N mm].
    pub closing_n_mm: f64,
    /// Area of the crack that this event opened, 0 unless it was the last tooth [mm²].
    pub crack_area_mm2: f64,
}

/// What an advance came to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Advance {
    Broke(Event),
    Ended(EndReason),
}

/// Why breaking ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum EndReason {
    /// No load breaks anything more.
    NothingBreaks,
    /// At the largest displacement there was, the force fell below the given part of its peak.
    ForceFell,
    /// As many events as were allowed.
    Events,
    /// The drive would move further than it was to.
    Displacement,
}

/// Energy that was dissipated [N mm], by what broke.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Dissipated {
    pub matrix_n_mm: f64,
    pub fibres_n_mm: f64,
    pub interfaces_n_mm: f64,
    /// Between plies.
    pub ply_faces_n_mm: f64,
    /// The same energy, by how it broke.
    pub tension_n_mm: f64,
    pub compression_n_mm: f64,
    pub shear_n_mm: f64,
}

impl Dissipated {
    /// All of it [N mm].
    #[must_use]
    pub fn total_n_mm(&self) -> f64 {
        self.matrix_n_mm + self.fibres_n_mm + self.interfaces_n_mm + self.ply_faces_n_mm
    }

    pub(crate) fn add(&mut self, part: BrokenPart, mode: Mode, energy_n_mm: f64) {
        match part {
            BrokenPart::Matrix => self.matrix_n_mm += energy_n_mm,
            BrokenPart::Fibre(_) => self.fibres_n_mm += energy_n_mm,
            BrokenPart::Interface(_) => self.interfaces_n_mm += energy_n_mm,
            BrokenPart::PlyFace(_) => self.ply_faces_n_mm += energy_n_mm,
        }
        match mode {
            Mode::Tension => self.tension_n_mm += energy_n_mm,
            Mode::Compression => self.compression_n_mm += energy_n_mm,
            Mode::Shear => self.shear_n_mm += energy_n_mm,
        }
    }
}

/// Sums over all events.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Totals {
    pub events: u64,
    /// With the last event taken as at a held drive.
    pub dissipated: Dissipated,
    /// Of open cracks [mm²].
    pub crack_area_mm2: f64,
    /// Cells with an open crack.
    pub broken_cells: u64,
    /// Cells with a crack that was open and whose faces press on each other at the last event.
    pub closed_cells: u64,
    /// Of those, cells with more pressure than their material bears, which is not followed.
    pub overloaded_cells: u64,
    /// How often faces of cracks were to meet or part and it was not found which do.
    pub turns_left: u64,
    /// Cells whose open crack is pressed at the last event: its faces overlap, which was not hindered.
    /// Where there are many, what the section bears in compression is underestimated.
    pub overlapping_cells: u64,
    /// By how much they overlap: the volume of overlap over that of overlap and openings together, at
    /// the last event; 0 where nothing overlaps.
    pub overlap_share: f64,
    /// The largest overlap [mm].
    pub overlap_mm: f64,
    /// How often the contact with rollers was found anew for the broken section, and how often that
    /// failed, so that the forces kept the proportions they had.
    pub contacts: u64,
    pub contacts_kept: u64,
    pub peak_force_n: f64,
    /// Largest displacement of the drive at an event [mm].
    pub reach_mm: f64,
    /// Largest part of a fracture energy by which a crack's may be off, from the number of teeth.
    pub saw_error: f64,
    /// Largest width of a cracked cell over the length of the process zone, h f² / (E G). A crack that
    /// grows takes more than its fracture energy by about 0.8 of this, measured on a double cantilever
    /// beam: cells of an eighth of the process zone are within 10 %.
    pub coarseness: f64,
    /// Something breaks without a fracture energy: what its cracks take follows the size of cells.
    pub energy_follows_grid: bool,
}
