//! What a checkpoint keeps of breaking, and sums over its events.
use serde::{Deserialize, Serialize};

use super::Breaking;
use super::composition::face;
use super::event::Totals;
use super::part::{BrokenPart, Damage, PlaneDamage};
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
    /// Forces of rollers at load factor 1 [N], and the factor at which they were found; none without
    /// rollers that follow.
    contact: Option<(f64, Vec<(u32, f64)>)>,
}

impl Breaking {
    /// What a checkpoint keeps.
    #[must_use]
    pub fn state(&self) -> BreakingState {
        BreakingState {
            parts: self.parts.all.len() as u64,
            base: self.base.clone(),
            since: self.since.clone(),
            progress: self.progress.clone(),
            displacements_mm: self.displacements_mm.clone(),
            contact: self.contact.as_ref().map(|contact| {
                let load = self.system.load.iter().enumerate();
                let pressed = load.filter(|(_, force)| **force != 0.0);
                let forces = pressed.map(|(place, force)| (place as u32, *force));
                (contact.factor, forces.collect())
            }),
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
            || (state.progress.pending.iter())
                .flat_map(|pending| pending.turned.iter().chain([&pending.loss]))
                .any(|loss| loss.cell as usize >= self.intact.len())
            || state.contact.is_some() != self.contact.is_some()
            || (state.contact.iter().flat_map(|(_, forces)| forces))
                .any(|(place, _)| *place as usize >= self.displacements_mm.len())
        {
            return Err(CompositeError::OtherSize);
        }
        if let (Some((factor, forces)), Some(contact)) = (state.contact, &mut self.contact) {
            contact.factor = factor;
            self.system.load.fill(0.0);
            for (place, force) in forces {
                self.system.load[place as usize] = force;
            }
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
            self.system.alter(cell, stiffness)?;
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
        if let Some(last) = &progress.pending {
            dissipated.add(last.part, last.mode, last.held_n_mm);
        }
        let (mut broken_cells, mut overlapping_cells) = (0, 0);
        let (mut closed_cells, mut overloaded_cells) = (0, 0);
        let (mut saw_error, mut coarseness) = (0.0_f64, 0.0_f64);
        let (mut overlap, mut opening, mut overlap_mm) = (0.0, 0.0, 0.0_f64);
        for cell in 0..self.intact.len() {
            let (mut is_broken, mut is_overlapping) = (false, false);
            let (mut is_closed, mut is_overloaded) = (false, false);
            for place in self.parts.of(cell) {
                for (plane, state) in self.damage[place].planes.iter().enumerate() {
                    if state.level == 0 {
                        continue;
                    }
                    // what was never bonded has no softening
                    let is_unbonded = self.parts.open.binary_search(&(place as u32)).is_ok();
                    for saw in self.saws(place, plane, state).filter(|_| !is_unbonded) {
                        saw_error = saw_error.max(saw.error());
                        // a crack between plies grows along them, through cells of any height
                        let part = &self.parts.all[place];
                        let sides = self.system.lattice.grid().sides_mm(cell);
                        let longer = if matches!(part.kind, BrokenPart::PlyFace(_)) {
                            (sides[0] / sides[1]).max(1.0)
                        } else {
                            1.0
                        };
                        coarseness = coarseness.max(2.0 * longer / saw.room());
                    }
                    is_broken |= state.level >= self.teeth;
                    if !state.has_faces() {
                        continue;
                    }
                    if state.is_closed {
                        is_closed |= !is_unbonded;
                        is_overloaded |= self.is_overloaded(cell, place, plane);
                        continue;
                    }
                    // of a crack that is only as wide as round-off nothing is known
                    let [width_mm, volume] = self.opening(cell, place, plane);
                    is_overlapping |= width_mm < 0.0;
                    overlap_mm = overlap_mm.max(-width_mm);
                    if volume < 0.0 {
                        overlap -= volume;
                    } else {
                        opening += volume;
                    }
                }
            }
            broken_cells += u64::from(is_broken);
            overlapping_cells += u64::from(is_overlapping);
            closed_cells += u64::from(is_closed);
            overloaded_cells += u64::from(is_overloaded);
        }
        Totals {
            events: progress.events,
            dissipated,
            crack_area_mm2: progress.crack_area_mm2,
            broken_cells,
            closed_cells,
            overloaded_cells,
            turns_left: progress.turns_left,
            overlapping_cells,
            overlap_share: if overlap > 0.0 {
                overlap / (overlap + opening)
            } else {
                0.0
            },
            overlap_mm,
            contacts: progress.contacts,
            contacts_kept: progress.contacts_kept,
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

    /// How far a crack is open [mm], and the volume of that [mm³], where the drive is at the last event
    /// and with the crack of that event: the compliance of the crack times the stress across it, over
    /// the width of its part. Below 0 its faces overlap.
    fn opening(&self, cell: usize, place: usize, plane: usize) -> [f64; 2] {
        let [unit_mm, _] = self.system.response();
        let factor = self.progress.displacement_mm / unit_mm;
        let measures = self.system.measures(cell);
        let stress: f64 = (0..3)
            .map(|part| self.bearings[place].stress[(plane, part)] * measures[part])
            .sum();
        let (part, damage) = (&self.parts.all[place], &self.damage[place]);
        let soft = if part.is_face() {
            face(part, damage, self.teeth)[0]
        } else {
            let slides = part.slides(&self.parts.laws[part.law as usize], plane);
            let [normal, _] = damage.planes[plane].softness(self.teeth, slides);
            normal / part.modulus(damage.axis, plane, false)
        };
        let lattice = &self.system.lattice;
        let sides = lattice.grid().sides_mm(cell);
        let strain = factor * stress * soft;
        let width_mm = part.width_mm(sides, damage.normal(plane));
        let volume = part.share * sides[0] * sides[1] * lattice.thickness_mm();
        [strain * width_mm, strain * volume]
    }
}
