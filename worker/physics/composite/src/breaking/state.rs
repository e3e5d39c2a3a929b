//! What a checkpoint keeps of breaking, and sums over its events.
use serde::{Deserialize, Serialize};

use super::Breaking;
use super::event::Totals;
use super::part::{Damage, PlaneDamage};
use super::progress::Progress;
use super::saw::Saw;
use crate::error::CompositeError;

/// Where breaking is: the damage of parts and the sums, from which it goes on with the same bytes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BreakingState {
    /// Number of parts, by which a state of another section is known.
    parts: u64,
    base: Vec<(u32, Damage)>,
    since: Vec<(u32, Damage)>,
    progress: Progress,
    displacements_mm: Vec<f64>,
}

impl Breaking {
    /// What a checkpoint keeps.
    #[must_use]
    pub fn state(&self) -> BreakingState {
        BreakingState {
            parts: self.parts.all.len() as u64,
            base: self.base.clone(),
            since: self.since.clone(),
            progress: self.progress,
            displacements_mm: self.displacements_mm.clone(),
        }
    }

    /// Goes on from a state of the same specimen and options, whatever came before: factors the system
    /// as it was factored last, and takes the same cracks from it in the same order.
    ///
    /// # Errors
    /// [`CompositeError::OtherSize`] when it is of another section.
    pub fn resume(&mut self, state: BreakingState) -> Result<(), CompositeError> {
        let count = self.parts.all.len();
        let mut kept = state.base.iter().chain(&state.since);
        if state.parts != count as u64
            || state.displacements_mm.len() != self.displacements_mm.len()
            || kept.any(|(place, damage)| {
                *place as usize >= count
                    || damage.planes.iter().any(|plane| plane.level > self.teeth)
            })
            || state
                .progress
                .pending
                .is_some_and(|pending| pending.cell as usize >= self.intact.len())
        {
            return Err(CompositeError::OtherSize);
        }
        let mut cells: Vec<usize> = Vec::new();
        for (place, damage) in self.damage.iter_mut().enumerate() {
            if !damage.is_none() {
                let part = self.parts.all[place];
                *damage = Damage::none(&self.parts.laws[part.law as usize]);
                cells.push(part.cell as usize);
            }
        }
        for &(place, damage) in &state.base {
            self.damage[place as usize] = damage;
            cells.push(self.parts.all[place as usize].cell as usize);
        }
        cells.sort_unstable();
        cells.dedup();
        let stiffness: Vec<_> = cells
            .into_iter()
            .map(|cell| (cell, self.composed(cell)))
            .collect();
        self.system.restart(stiffness.into_iter())?;
        for &(place, damage) in &state.since {
            self.damage[place as usize] = damage;
            let cell = self.parts.all[place as usize].cell as usize;
            let stiffness = self.composed(cell);
            self.system.soften(cell, stiffness)?;
        }
        self.base = state.base;
        self.since = state.since;
        self.progress = state.progress;
        self.displacements_mm = state.displacements_mm;
        Ok(())
    }

    /// Sums over all events so far.
    #[must_use]
    pub fn totals(&self) -> Totals {
        let progress = &self.progress;
        let mut dissipated = progress.dissipated;
        if let Some(last) = progress.pending {
            dissipated.add(last.part, last.mode, last.held_n_mm);
        }
        let (mut broken_cells, mut overlapping_cells) = (0, 0);
        let (mut saw_error, mut coarseness) = (0.0_f64, 0.0_f64);
        for cell in 0..self.intact.len() {
            let (mut is_broken, mut is_overlapping) = (false, false);
            for place in self.parts.of(cell) {
                for (plane, state) in self.damage[place].planes.iter().enumerate() {
                    if state.level == 0 {
                        continue;
                    }
                    for saw in self.saws(place, plane, state) {
                        saw_error = saw_error.max(saw.error());
                        coarseness = coarseness.max(2.0 / saw.room());
                    }
                    is_broken |= state.level >= self.teeth;
                    is_overlapping |= state.opened > 0
                        && !state.is_crushed
                        && self.normal_stress(cell, place, plane) < 0.0;
                }
            }
            broken_cells += u64::from(is_broken);
            overlapping_cells += u64::from(is_overlapping);
        }
        Totals {
            events: progress.events,
            dissipated,
            crack_area_mm2: progress.crack_area_mm2,
            broken_cells,
            overlapping_cells,
            peak_force_n: progress.peak_n,
            reach_mm: progress.reach_mm,
            saw_error,
            coarseness,
            energy_follows_grid: self.parts.has_brittle,
        }
    }

    /// The saws of a plane that has begun to crack; none of a brittle one.
    fn saws(&self, place: usize, plane: usize, state: &PlaneDamage) -> impl Iterator<Item = Saw> {
        let limits = self.parts.laws[self.parts.all[place].law as usize].planes[plane];
        let across = if state.is_crushed {
            limits.compression
        } else {
            limits.tension
        };
        let (state, teeth) = (*state, self.teeth);
        [across, limits.shear]
            .into_iter()
            .enumerate()
            .filter(|(_, limit)| {
                limit.is_some_and(|limit| limit.fracture_energy_n_per_mm.is_some())
            })
            .map(move |(kind, _)| state.saw(teeth, kind))
    }

    /// Across a plane at load factor 1 [MPa], after the last event.
    fn normal_stress(&self, cell: usize, place: usize, plane: usize) -> f64 {
        let measures = self.system.measures(cell);
        (0..3)
            .map(|part| self.bearings[place].stress[(plane, part)] * measures[part])
            .sum()
    }
}
