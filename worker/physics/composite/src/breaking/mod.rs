//! Breaking of sections, event by event.
//!
//! The section is elastic between events. At every event one part of one cell (the matrix or a ply, a
//! fibre, the face between a fibre and what it lies in) meets its limit and loses a tooth of its
//! stiffness; the load factor at which that happens follows from one linear solution, and nothing is
//! iterated. This is *sequentially linear analysis* [RotsInvernizzi2004], [RotsBelletti2008]: loads are
//! proportional, displacements small, and the path follows by itself whatever the section does, snap-back
//! included.
//!
//! Known here: [`part`] what cracks and on which planes, [`laws`] by which limits, [`saw`] how it
//! softens, [`composition`] what a cell of cracked parts still bears, [`criterion`] which crack comes
//! next, [`closing`] which cracks bear pressure, [`ply_faces`] where plies part, [`contact`] what rollers do
//! to a section that breaks, [`system`] how the lattice answers. Not known: friction of the faces of a
//! crack, and that they crush each other ([`Totals::overloaded_cells`]); what happens at the ends of
//! fibres, where the assumption that layers share their strain does not hold.
//!
//! A crack dissipates in the triangle that its event and the next one span with the origin, so that
//! the work along the straight lines from event to event is elastic energy and dissipation exactly:
//! ½ ε · (C - C') ε' V with the strains ε of the cell at the event and ε' at the next. Cells whose cracks
//! close or open again have such a part too ([`Event::closing_n_mm`]), which is no dissipation.
//!
//! Measured on 100 by 30 cells with three fibres, their faces and scatter, one thread, by
//! `tests::speed` (events per second of processor time, for columns that a factor may carry):
//!
//! | columns | 0: factored for every event | 64 | 128 |
//! |---|---|---|---|
//! | brittle | 198 | 276 | 266 |
//! | ten teeth | 203 | 382 | 373 |
mod begun;
mod closing;
mod composition;
mod contact;
mod criterion;
mod curve;
mod event;
mod laws;
mod options;
mod part;
mod parts;
mod ply_faces;
mod progress;
mod saw;
mod scatter;
mod state;
mod system;
#[cfg(test)]
mod tests;

pub use begun::opened_lattice;
pub use contact::Pressed;
pub use curve::{Control, Machine, machine_curve};
pub use event::{Advance, Dissipated, EndReason, Event, Mode, Totals};
pub(crate) use laws::{check as check_strength, check_interface};
pub use options::{BetweenPlies, BreakingOptions, MaterialStrength, OpenFace, Specimen, Stop};
pub use part::BrokenPart;
pub(crate) use ply_faces::NO_MATERIAL;
pub use scatter::{Scatter, ScatterLaw};
pub use state::BreakingState;

use begun::{Begun, lost};
use composition::{Bearing, compose};
use contact::Contact;
use criterion::{Hit, cracked, first_crack};
use nalgebra::Vector3;
use options::check;
use part::Damage;
use parts::Parts;
use progress::{CellLoss, Pending, Progress};
use scatter::Drawn;
use system::{Loss, MOST_COLUMNS, System};

use crate::error::CompositeError;
use crate::lattice::{CellStiffness, Geometry, Lattice};
use crate::stiffness::Stiffness;

/// Part of the peak force below which nothing real is left.
const LEAST_FORCE: f64 = 1e-3;

/// A section that breaks.
#[derive(Debug)]
pub struct Breaking {
    options: BreakingOptions,
    teeth: u16,
    parts: Parts,
    /// Of every part.
    damage: Vec<Damage>,
    bearings: Vec<Bearing>,
    /// Of every cell [MPa].
    intact: Vec<Stiffness>,
    /// Lost part of every cell's stiffness.
    lost: Vec<f64>,
    system: System,
    contact: Option<Contact>,
    /// Parts and their damage when the system was factored, and after every crack since.
    base: Vec<(u32, Damage)>,
    since: Vec<(u32, Damage)>,
    progress: Progress,
    displacements_mm: Vec<f64>,
}

impl Breaking {
    /// Before any load.
    ///
    /// # Errors
    /// When a limit or an option is out of its range; [`CompositeError::CellTooLarge`];
    /// [`CompositeError::MixedDrive`] and [`CompositeError::NoDrive`]; when the supports leave the
    /// section loose, or the equations do not fit into memory.
    pub fn new(specimen: Specimen, options: BreakingOptions) -> Result<Self, CompositeError> {
        Self::carrying(specimen, options, MOST_COLUMNS)
    }

    /// As [`Breaking::new`], with a number of columns that a factor may carry.
    fn carrying(
        specimen: Specimen,
        options: BreakingOptions,
        most_columns: usize,
    ) -> Result<Self, CompositeError> {
        let teeth = check(&options)?;
        let layout = specimen.layout;
        let drawn = Drawn::new(options.scatter.as_ref(), options.seed)?;
        let (strengths, between) = (specimen.strengths, specimen.between_plies);
        let parts = Parts::new(layout, strengths, between, options.criterion, &drawn)?;
        let mut begun = Begun::new(layout, &parts, teeth);
        let lattice = std::mem::replace(&mut begun.lattice, Lattice::exact(layout));
        let contact = specimen
            .rollers
            .map(|pressed| Contact::new(&lattice, pressed));
        let system = System::new(lattice, specimen.supports, specimen.load_n, most_columns)?;
        let mut breaking = Self {
            options,
            teeth,
            damage: begun.damage,
            bearings: begun.bearings,
            intact: layout.stiffness().to_vec(),
            lost: begun.lost,
            base: Vec::new(),
            since: Vec::new(),
            progress: Progress::default(),
            displacements_mm: vec![0.0; system.displacements().len()],
            contact: contact.transpose()?,
            parts,
            system,
        };
        breaking.keep_base();
        breaking.meet()?;
        Ok(breaking)
    }

    /// On to the next event, or the reason why there is none; asked again, the same reason.
    ///
    /// # Errors
    /// When the equations have no solution, or a displacement is not finite.
    pub fn advance(&mut self) -> Result<Advance, CompositeError> {
        if self.progress.events >= self.options.stop.events {
            return Ok(Advance::Ended(EndReason::Events));
        }
        let Some((place, hit)) = self.next()? else {
            return Ok(Advance::Ended(EndReason::NothingBreaks));
        };
        let [unit_mm, unit_n] = self.system.response();
        let factor = hit.factor;
        let (displacement_mm, force_n) = (factor * unit_mm, factor * unit_n);
        if !displacement_mm.is_finite() || !force_n.is_finite() {
            return Err(CompositeError::NotFinite {
                quantity: "the displacement or the force of the drive",
                step: self.progress.events + 1,
            });
        }
        if let Some(reason) = self.ends(displacement_mm, unit_n / unit_mm) {
            return Ok(Advance::Ended(reason));
        }

        // what the last crack took is known now
        let part = self.parts.all[place];
        let cell = part.cell as usize;
        if let Some(last) = self.progress.pending.take() {
            let until = |loss: &CellLoss| {
                let now = self.system.measures(loss.cell as usize);
                loss.until(&now.map(|m| factor * m))
            };
            self.progress.closing_n_mm += last.turned.iter().map(until).sum::<f64>();
            let energy = until(&last.loss);
            self.progress.dissipated.add(last.part, last.mode, energy);
        }
        for (at, unit) in self
            .displacements_mm
            .iter_mut()
            .zip(self.system.displacements())
        {
            *at = factor * unit;
        }
        let elastic_n_mm = factor * factor * self.system.energy();
        let measures = self.system.measures(cell).map(|m| factor * m);

        // the crack
        let mode = if hit.shear_share > 0.5 {
            Mode::Shear
        } else if hit.is_pressed {
            Mode::Compression
        } else {
            Mode::Tension
        };
        let damage = self.cracked(place, &hit)?;
        let plane = damage.planes[hit.plane];
        let loss = self.change(place, damage)?;
        self.progress.pending = Some(Pending {
            part: part.kind,
            mode,
            loss: CellLoss {
                cell: part.cell,
                measures,
                loss,
            },
            turned: Vec::new(),
            held_n_mm: 0.0,
        });
        self.meet()?;

        // what it releases while the drive is held: ½ d (F - F')
        let [unit_mm, unit_n] = self.system.response();
        let held_n = unit_n / unit_mm * displacement_mm;
        let energy_released_n_mm = 0.5 * displacement_mm * (force_n - held_n);
        let is_opened = plane.level >= self.teeth;
        let crack_area_mm2 = if is_opened { plane.area_mm2 } else { 0.0 };
        let progress = &mut self.progress;
        progress.events += 1;
        progress.displacement_mm = displacement_mm;
        progress.peak_n = progress.peak_n.max(force_n);
        progress.reach_mm = progress.reach_mm.max(displacement_mm);
        progress.crack_area_mm2 += crack_area_mm2;
        if let Some(pending) = &mut progress.pending {
            pending.held_n_mm = energy_released_n_mm;
        }
        Ok(Advance::Broke(Event {
            number: progress.events,
            factor,
            displacement_mm,
            force_n,
            cell,
            part: part.kind,
            mode,
            shear_share: hit.shear_share,
            normal: damage.normal(hit.plane),
            tooth: u32::from(plane.level),
            elastic_n_mm,
            energy_released_n_mm,
            dissipated_n_mm: progress.dissipated.total_n_mm(),
            closing_n_mm: progress.closing_n_mm,
            crack_area_mm2,
        }))
    }

    /// Displacements at the last event [mm], x and y by turns; 0 before the first.
    #[must_use]
    pub fn displacements_mm(&self) -> &[f64] {
        &self.displacements_mm
    }

    /// Of every cell the part of its stiffness that is lost, in the strain of which it lost most:
    /// 0 intact, 1 broken.
    #[must_use]
    pub fn damage(&self) -> &[f64] {
        &self.lost
    }

    /// Force [N] and displacements [mm] where the drive stands at a displacement [mm], with all cracks there
    /// are so far.
    #[must_use]
    pub fn held_at(&self, displacement_mm: f64) -> (f64, Vec<f64>) {
        let [unit_mm, unit_n] = self.system.response();
        let factor = displacement_mm / unit_mm;
        let displacements = self.system.displacements().iter();
        (
            factor * unit_n,
            displacements.map(|unit| factor * unit).collect(),
        )
    }

    /// Stress of every cell [MPa] under displacements [mm], with all cracks there are so far: xx, yy, xy.
    #[must_use]
    pub fn stresses_mpa(&self, displacements_mm: &[f64]) -> Vec<[f64; 3]> {
        let lattice = &self.system.lattice;
        let stress = |cell| lattice.stress(Geometry::Linear, cell, displacements_mm);
        (0..self.intact.len())
            .map(|cell| stress(cell).unwrap_or_default())
            .collect()
    }

    /// How often the equations were factored.
    #[must_use]
    pub fn factors(&self) -> u64 {
        self.system.factors
    }

    /// The next crack, under forces of rollers that fit the section as it is then.
    fn next(&mut self) -> Result<Option<(usize, Hit)>, CompositeError> {
        /// The factor of the next crack changes with the contact, and the contact with it.
        const ROUNDS: u32 = 4;
        for _ in 0..ROUNDS {
            let first = self.first();
            let (Some((_, hit)), Some(contact)) = (first, &mut self.contact) else {
                return Ok(first);
            };
            let factor = hit.factor;
            let [unit_mm, _] = self.system.response();
            let unit = self.system.displacements();
            let is_known = !factor.is_finite()
                || !contact.is_stale(&self.system.load, unit, factor, (factor * unit_mm).abs());
            if is_known {
                return Ok(first);
            }
            match contact.found(&self.system.lattice, factor) {
                Ok(load) => {
                    contact.factor = factor;
                    self.progress.contacts += 1;
                    self.system.reload(&load)?;
                    self.keep_base();
                    self.meet()?;
                }
                // of cells that are nearly gone round-off may decide: told with the result
                Err(_) => {
                    self.progress.contacts_kept += 1;
                    return Ok(first);
                }
            }
        }
        Ok(self.first())
    }

    /// The part that cracks first as the load factor grows. Of those that crack together the first in
    /// the order of cells, so that round-off does not choose.
    fn first(&self) -> Option<(usize, Hit)> {
        const TOGETHER: f64 = 1e-10;
        let mut first: Option<(usize, Hit)> = None;
        for cell in 0..self.intact.len() {
            let [xx, yy, xy, ..] = self.system.measures(cell);
            let strain = Vector3::new(xx, yy, xy);
            for place in self.parts.of(cell) {
                let part = &self.parts.all[place];
                let law = &self.parts.laws[part.law as usize];
                if law.is_unbreakable() {
                    continue;
                }
                let bears = self.bearings[place].of(&strain);
                let hit = first_crack(part, law, &self.damage[place], self.teeth, bears);
                if let Some(hit) = hit
                    && first.is_none_or(|(_, known)| hit.factor < known.factor * (1.0 - TOGETHER))
                {
                    first = Some((place, hit));
                }
            }
        }
        first
    }

    fn ends(&self, displacement_mm: f64, stiffness: f64) -> Option<EndReason> {
        let stop = &self.options.stop;
        if stop
            .displacement_mm
            .is_some_and(|most| displacement_mm > most)
        {
            return Some(EndReason::Displacement);
        }
        let least = stop.force_fraction.max(LEAST_FORCE) * self.progress.peak_n;
        (stiffness * self.progress.reach_mm < least).then_some(EndReason::ForceFell)
    }

    /// Gives a part another damage; what its cell lost.
    fn change(&mut self, place: usize, damage: Damage) -> Result<Loss, CompositeError> {
        let cell = self.parts.all[place].cell as usize;
        self.damage[place] = damage;
        let stiffness = self.composed(cell);
        let (loss, is_new) = self.system.alter(cell, stiffness)?;
        if is_new {
            self.keep_base();
        } else {
            self.since.push((place as u32, damage));
        }
        Ok(loss)
    }

    /// What a part is after a crack.
    fn cracked(&self, place: usize, hit: &Hit) -> Result<Damage, CompositeError> {
        let part = &self.parts.all[place];
        let law = &self.parts.laws[part.law as usize];
        let lattice = &self.system.lattice;
        let (cell, grid) = (part.cell as usize, lattice.grid());
        cracked(
            part,
            law,
            &self.damage[place],
            self.teeth,
            grid.sides_mm(cell),
            lattice.thickness_mm(),
            hit,
        )
        .map_err(|[width_mm, largest_mm]| {
            let [x_mm, y_mm] = grid.middle_mm(cell);
            CompositeError::CellTooLarge {
                x_mm,
                y_mm,
                material: law.material.to_string(),
                width_mm,
                largest_mm,
            }
        })
    }

    /// What a cell is left with, as damaged as its parts are.
    fn composed(&mut self, cell: usize) -> CellStiffness {
        let of = self.parts.of(cell);
        let is_intact = self.damage[of.clone()].iter().all(Damage::is_none);
        let composed = compose(
            &self.parts.all[of.clone()],
            &self.parts.laws,
            &self.damage[of.clone()],
            self.teeth,
            &mut self.bearings[of],
        );
        // to the last bit, as it was before
        let left = if is_intact {
            CellStiffness {
                stiffness: self.intact[cell],
                along_fibres: 1.0,
            }
        } else {
            composed
        };
        self.lost[cell] = if is_intact {
            0.0
        } else {
            lost(&self.intact[cell], &left.stiffness)
        };
        left
    }

    /// Remembers the damage with which the system is factored.
    fn keep_base(&mut self) {
        self.since.clear();
        self.base.clear();
        let damaged = self.damage.iter().enumerate().filter(|(_, d)| !d.is_none());
        self.base
            .extend(damaged.map(|(place, damage)| (place as u32, *damage)));
    }
}
