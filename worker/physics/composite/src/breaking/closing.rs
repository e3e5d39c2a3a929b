//! Cracks that close bear pressure, and part again when they are pulled.
//!
//! A crack has two faces; they overlap nowhere, and press on each other without friction where they meet:
//! its opening w and the stress σ across it obey w ≥ 0, σ ≤ 0, w σ = 0 beside what softening bears at
//! w > 0. All states between two events are one state times the load factor, so that these conditions do
//! not change along the way: which faces meet is asked after every crack and whenever the loads change
//! their proportions, for the state at load factor 1. Faces that are pressed while they are open meet and
//! get the normal stiffness of the whole back; faces that meet and are pulled part, with the stiffness that
//! softening has left them. This is the active set of a problem of least energy [LawsonHanson1974], which is
//! convex, so that there is one answer; all that are wrong turn at once, and one by one, the worst first,
//! where that goes in circles.
//!
//! A crack that closes between two events is not on the straight line between them:
//! [`Event::closing_n_mm`](super::Event::closing_n_mm) is the difference of the work.
use super::Breaking;
use super::progress::CellLoss;
use crate::error::CompositeError;
use crate::lattice::gather;
use crate::strength::Criterion;
use nalgebra::Vector3;

/// Rounds in which all faces that are wrong turn at once, and rounds at all.
const TOGETHER: u32 = 8;
const ROUNDS: u32 = 200;
/// Part of the largest stress that strains of a cell could have across a crack, below which it is neither
/// pulled nor pressed.
const NOTHING: f64 = 1e-6;

/// A plane of a part whose faces are on the wrong side.
struct Wrong {
    place: usize,
    plane: usize,
    /// Stress across it, or what its overlap would be as a stress of the whole [MPa].
    size: f64,
}

impl Breaking {
    /// Lets faces of cracks meet and part until all are right at load factor 1.
    pub(super) fn meet(&mut self) -> Result<(), CompositeError> {
        for round in 0..ROUNDS {
            let mut wrong = self.wrong();
            if wrong.is_empty() {
                return Ok(());
            }
            if round >= TOGETHER {
                let worst = wrong.iter().map(|one| one.size).fold(0.0, f64::max);
                wrong.retain(|one| one.size >= worst);
                wrong.truncate(1);
            }
            for one in wrong {
                self.turn(&one)?;
            }
        }
        self.progress.turns_left += 1;
        Ok(())
    }

    fn wrong(&self) -> Vec<Wrong> {
        let mut wrong = Vec::new();
        for (place, damage) in self.damage.iter().enumerate() {
            for (plane, state) in damage.planes.iter().enumerate() {
                if !state.has_faces() {
                    continue;
                }
                let [stress, least] = self.across(place, plane);
                let is_wrong = if state.is_closed {
                    stress > least
                } else {
                    stress < -least
                };
                if is_wrong {
                    // what is left of an open crack bears so much less
                    let [normal, _] = state.softness(self.teeth, true);
                    wrong.push(Wrong {
                        place,
                        plane,
                        size: stress.abs() * (1.0 + normal),
                    });
                }
            }
        }
        wrong
    }

    /// Stress across a plane at load factor 1, and what is nothing beside its cell's strains [MPa].
    fn across(&self, place: usize, plane: usize) -> [f64; 2] {
        let [xx, yy, xy, ..] = self.system.measures(self.parts.all[place].cell as usize);
        let strain = Vector3::new(xx, yy, xy);
        let bears = self.bearings[place].stress.row(plane);
        [(bears * strain)[0], NOTHING * bears.amax() * strain.amax()]
    }

    fn turn(&mut self, wrong: &Wrong) -> Result<(), CompositeError> {
        let cell = self.parts.all[wrong.place].cell;
        let mut damage = self.damage[wrong.place];
        let plane = &mut damage.planes[wrong.plane];
        plane.is_closed = !plane.is_closed;
        let loss = self.change(wrong.place, damage)?;
        self.progress.turns += 1;
        let lattice = &self.system.lattice;
        let corners = gather(
            &self.displacements_mm,
            lattice.grid().corners(cell as usize),
        );
        let measures = lattice.cell(cell as usize).measures(&corners);
        if let Some(pending) = &mut self.progress.pending {
            pending.turned.push(CellLoss {
                cell,
                measures,
                loss,
            });
        }
        Ok(())
    }

    /// Whether faces that meet press on each other, at the last event, by more than their part bears in
    /// compression.
    pub(super) fn is_overloaded(&self, cell: usize, place: usize, plane: usize) -> bool {
        let part = &self.parts.all[place];
        let law = &self.parts.laws[part.law as usize];
        let Some(limit) = law.planes[plane].compression else {
            return false;
        };
        let [unit_mm, _] = self.system.response();
        let factor = self.progress.displacement_mm / unit_mm;
        let [xx, yy, xy, ..] = self.system.measures(cell);
        let strain = Vector3::new(xx, yy, xy) * factor;
        let bearing = &self.bearings[place];
        let measured = match law.criterion {
            Criterion::Stress => (bearing.stress.row(plane) * strain)[0],
            Criterion::Strain => (bearing.strain.row(plane) * strain)[0],
        };
        -measured > limit.limit * part.strength
    }
}
