//! What a run has recorded so far, and what tells whether to believe it.
use serde::{Deserialize, Serialize};

use super::fragments::FragmentRow;
use crate::{
    observe::{measure::Measure, survey::Reading, time_step::Critical},
    step::alone::Seen,
};

/// Everything a run has to say at its end, beside the state of its bodies.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Journal {
    /// Stage being worked on.
    pub(crate) stage: usize,
    /// Steps done in it.
    pub(crate) stage_steps: u64,
    /// Whether the bodies have come to rest in a stage that waits for it.
    pub(crate) is_settled: bool,
    /// Stages in which the largest overlap and the largest step over the critical one were.
    pub(crate) worst_stages: [usize; 2],
    /// The worst when that was last asked.
    pub(crate) noted: Worst,
    /// Stages that waited for rest in vain.
    pub(crate) unsettled_stages: Vec<usize>,
    /// Largest error of the force on a servo at the end of its stage, over the force asked for, and where.
    pub(crate) servo: Option<ServoError>,
    /// When it began [s].
    pub(crate) stage_start: f64,
    /// Δt of the next step [s].
    pub(crate) time_step: f64,
    /// How often the steps between two looks are halved now.
    pub(crate) look_halvings: u32,
    /// Rows of `curve.csv`, `bodies.csv` and `contacts.csv`, one after the other.
    pub(crate) curve: Vec<f64>,
    pub(crate) bodies: Vec<f64>,
    pub(crate) contacts: Vec<f64>,
    /// Rows of `fragments.csv`.
    pub(crate) fragments: Vec<FragmentRow>,
    /// Pairs of bodies whose bonds held at the last row, in order.
    pub(crate) bonds: Vec<[u32; 2]>,
    /// Rows of `broken_bonds.csv`.
    pub(crate) breaks: Vec<f64>,
    /// Stages at whose ends the map of voids was measured, with the solid volume in each cell [m³].
    pub(crate) voids: Vec<(usize, Vec<f64>)>,
    /// Batches of the present stage, and grains that came in with them.
    pub(crate) batches: u64,
    pub(crate) supplied: usize,
    /// Stages that ended before all was in, and how many grains were left.
    pub(crate) not_inserted: Vec<(usize, usize)>,
    /// Spheres that clumps have replaced.
    pub(crate) replacements: Vec<Replacement>,
    /// Bodies that were taken out, and their mass [kg].
    pub(crate) removed_bodies: u64,
    pub(crate) removed_mass: f64,
    /// Step and time of each snapshot.
    pub(crate) snapshots: Vec<(u64, f64)>,
    pub(crate) worst: Worst,
    pub(crate) balance: Balance,
    pub(crate) driving: Driving,
    /// From the last observation.
    pub(crate) last: Reading,
    /// Sum over steps of the candidates looked at.
    pub(crate) candidate_steps: u64,
}

/// What a stage that replaced spheres did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Replacement {
    pub(crate) stage: usize,
    pub(crate) spheres: u64,
    /// Mass of the spheres, and of the clumps [kg].
    pub(crate) masses: [f64; 2],
    /// Largest compression over the smaller radius when the clumps were there.
    pub(crate) overlap_ratio: f64,
}

/// How far a servo was from its force when its stage ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ServoError {
    /// |F − F₁|/F₁.
    pub(crate) ratio: f64,
    pub(crate) stage: usize,
    /// Number of the wall.
    pub(crate) wall: usize,
}

/// The worst of looks, and of every step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Worst {
    /// Compression over the smaller radius.
    pub(crate) overlap_ratio: f64,
    /// Δt over the critical step.
    pub(crate) step_ratio: f64,
    /// What was critical then.
    pub(crate) critical: Option<Critical>,
}

/// What round-off may make of one ratio reckoned in two ways.
const ROUND_OFF: f64 = 1e-12;

/// Energy that came from nowhere.
///
/// E − W, with the energy E of the bodies and the work W of driven planes, can only fall: friction
/// and damping take energy, nothing gives. What it rises above its lowest value so far was made
/// by the integration. While a scene is shaken nothing is added: that work is not measured. Far from the
/// origin places are coarse: what their rounding in every step so far may have made is no sign.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Balance {
    /// Looks that were added.
    pub(crate) looks: u64,
    lowest: Option<f64>,
    /// Largest rise [J].
    pub(crate) created: f64,
    /// Largest kinetic and elastic energy, or work [J].
    pub(crate) scale: f64,
}

/// Means over the looks at driven stages, which tell whether the bodies follow without inertia. Each
/// look weighs as much as its pressure: what moves before anything is pressed does not count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Driving {
    /// Σ p [Pa].
    pressure: f64,
    /// Σ I p and Σ of the unbalanced force ratio times p [Pa].
    inertial_number: f64,
    unbalanced: f64,
}

impl Journal {
    /// Of the stage, as people count.
    pub(crate) fn number(&self) -> usize {
        self.stage + 1
    }
}

impl Balance {
    pub(crate) fn add(&mut self, reading: &Reading, work: f64, steps: u64) {
        self.looks += 1;
        let rounding = reading.rounding * steps as f64;
        let left = reading.kinetic + reading.elastic + reading.gravitational - work;
        let lowest = self.lowest.map_or(left, |lowest| lowest.min(left));
        self.lowest = Some(lowest);
        self.created = self.created.max(left - lowest - rounding);
        self.scale = self
            .scale
            .max(reading.kinetic + reading.elastic)
            .max(work.abs());
    }

    /// Work that is not measured begins: what is left afterwards is a new beginning.
    pub(crate) fn pause(&mut self) {
        self.lowest = None;
    }

    /// Bodies came or went, and with them this energy [J].
    pub(crate) fn shift(&mut self, energy: f64) {
        self.lowest = self.lowest.map(|lowest| lowest + energy);
    }

    /// Created energy over the scale.
    pub(crate) fn created_ratio(&self) -> f64 {
        if self.created > 0.0 {
            self.created / self.scale
        } else {
            0.0
        }
    }
}

impl Driving {
    /// Adds a look at the whole scene.
    pub(crate) fn add(&mut self, scene: &Measure, unbalanced: Option<f64>) {
        let pressure = scene.pressure();
        if let (Some(number), Some(ratio)) = (scene.inertial_number(), unbalanced) {
            self.pressure += pressure;
            self.inertial_number += number * pressure;
            self.unbalanced += ratio * pressure;
        }
    }

    /// Mean inertial number and unbalanced force ratio; `None` when nothing was pressed.
    pub(crate) fn means(&self) -> Option<[f64; 2]> {
        let sums = [self.inertial_number, self.unbalanced];
        (self.pressure > 0.0).then(|| sums.map(|sum| sum / self.pressure))
    }
}

impl Worst {
    /// The same with what every step had, contact by contact.
    pub(crate) fn with(&self, seen: &Seen) -> Self {
        let mut worst = Self {
            overlap_ratio: self.overlap_ratio.max(seen.overlap_ratio),
            ..*self
        };
        if let Some((step, [body, partner])) = seen.critical
            && seen.step_ratio > self.step_ratio * (1.0 + ROUND_OFF)
        {
            worst.step_ratio = seen.step_ratio;
            worst.critical = Some(Critical {
                step,
                body,
                partner,
                median: None,
            });
        }
        worst
    }

    pub(crate) fn see_step(&mut self, time_step: f64, critical: Option<Critical>) {
        if let Some(critical) = critical {
            let ratio = time_step / critical.step;
            if ratio > self.step_ratio {
                self.step_ratio = ratio;
                self.critical = Some(critical);
            }
        }
    }
}
