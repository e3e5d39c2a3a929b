//! The critical time step of a scene, from the stiffness of its contacts.
//!
//! Leapfrog is stable for Δt ≤ 2/ω_max. The highest frequency is bounded by the rows of the
//! stiffness matrix over the masses: for each body and axis i, with n the contact normal,
//!
//!   ω² ≤ Σ_c (k_N n_i² + k_T (1 − n_i²)) (1/m + 1/√(m m')) along the axis, (G.10)
//!   ω² ≤ Σ_c k_T (1 − n_i²) (1/m + r²/I) (1 + √(m/m')) about it, (G.11)
//!
//! where m' is the mass of the other body and the terms with it are left out when that body cannot
//! move; a single contact with a wall then gives 2√(m/K), and a pair of equal spheres √(2m/K),
//! which is exact. T takes the diagonal alone (3.36-3.39), Yade too, which is up to √2 less safe.
//! Stiffnesses are tangents at the present overlap.
//!
//! A plate, a wall of mass m_p that forces move, touches many bodies at once. With (x − y)² ≤
//! (1 + t) x² + (1 + 1/t) y² for any t > 0, its bodies move as against a wall that stands and is 1 + t
//! times as stiff, and it as against bodies that stand; the best t gives
//!
//!   ω² ≤ ω_b² + ω_p², ω_p² = Σ_c (k_N n_i² + k_T (1 − n_i²))/m_p (G.26)
//!
//! with ω_b² that of (G.10), (G.11) beside a wall that stands, and the largest ω_p² of all plates
//! along an axis that they follow. With one body it is exact.
//!
//! What resists rolling and twisting adds k_r (1 − n_i²) + k_t n_i² to the rows of (G.11), over 1/I and with
//! √(I/I') for √(m/m'); divided by the square of the smaller radius it is bounded as if it were
//! k_T.
//!
//! With dashpots, whose damping matrix over the masses has the bound D, built from them as ω² is from
//! the springs, the step must satisfy ω² Δt² + 4 D Δt < 4 (G.19), since the velocity that damps is
//! carried on from those of half a step and of one and a half ago (see
//! [`viscous`](crate::contact::law)). Dashpots against rolling use the spin of half a step ago as it is:
//! ω² Δt² + 2 D Δt < 4, so that they count half.
use loadframe_api::spec::granular_scene::{Body, GranularScene};
use serde::{Deserialize, Serialize};

use super::contact::Contact;
use crate::{
    contact::{freedom::Freedom, stiffness::Side},
    motion::critical_step,
    scene::model::Model,
    step::{engine::Engine, patch::Patch},
};

/// The critical step and the contact that sets it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Critical {
    /// [s].
    pub(crate) step: f64,
    /// Body whose frequency is the highest; walls are numbered after the bodies.
    pub(crate) body: u32,
    /// Its stiffest contact.
    pub(crate) partner: u32,
    /// Critical step of the body in the middle, of all that touch something [s], where all were looked at.
    pub(crate) median: Option<f64>,
}

/// What the contacts of a particle, or a body, add up to.
#[derive(Clone, Copy, Debug, Default)]
struct Rows {
    along: [f64; 3],
    about: [f64; 3],
    /// As both, of dashpots.
    damped: [[f64; 3]; 2],
    stiffest: (f64, u32),
}

/// What the contacts of a patch add up to for each particle, before it is divided by masses.
#[derive(Clone, Debug)]
pub(crate) struct PatchRows {
    /// Of its particles.
    own: Vec<Rows>,
    /// Of particles of later patches that it acts on.
    others: Vec<Rows>,
    /// Of walls.
    walls: Vec<Rows>,
}

/// Plates with what touches them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Plates {
    /// Of each wall: 1/m times its rows along the axes that it follows; nothing for one that stands.
    rows: Vec<Rows>,
}

impl Rows {
    /// A contact, with the terms of the other body as a factor.
    fn add(&mut self, contact: &Contact, factor: f64, partner: u32) {
        let [normal, shear] = contact.stiffness.map(|stiffness| factor * stiffness);
        let [normal_dashpot, shear_dashpot] = contact.dashpots.map(|dashpot| factor * dashpot);
        for axis in 0..3 {
            let square = contact.normal[axis].powi(2);
            self.along[axis] += normal * square + shear * (1.0 - square);
            self.about[axis] += shear * (1.0 - square);
            self.damped[0][axis] += normal_dashpot * square + shear_dashpot * (1.0 - square);
            self.damped[1][axis] += shear_dashpot * (1.0 - square);
            let across = factor / contact.radius.powi(2) * (1.0 - square);
            let along = factor / contact.radius.powi(2) * square;
            let [rolling, twisting] = contact.turning_stiffness;
            self.about[axis] += across * rolling + along * twisting;
            let [rolling, twisting] = contact.turning_dashpots;
            self.damped[1][axis] += 0.5 * (across * rolling + along * twisting);
        }
        if contact.stiffness[0] > self.stiffest.0 {
            self.stiffest = (contact.stiffness[0], partner);
        }
    }

    /// Others, times a factor along the axes and one about them.
    fn join(&mut self, other: &Self, along: f64, about: f64) {
        for axis in 0..3 {
            self.along[axis] += along * other.along[axis];
            self.about[axis] += about * other.about[axis];
            self.damped[0][axis] += along * other.damped[0][axis];
            self.damped[1][axis] += about * other.damped[1][axis];
        }
        if other.stiffest.0 > self.stiffest.0 {
            self.stiffest = other.stiffest;
        }
    }

    /// Dashpots do nothing along degrees of freedom that are held. They are made for the mass that is left
    /// there, which is larger than the one of these rows.
    fn hold(&mut self, is_held: impl Fn(usize) -> bool) {
        for degree in (0..6).filter(|degree| is_held(*degree)) {
            self.damped[degree / 3][degree % 3] = 0.0;
        }
    }

    /// ω² [1/s²] and D [1/s] of a body whose rows, over its mass, these are.
    fn bounds(&self) -> [f64; 2] {
        let most = |rows: &[f64]| rows.iter().copied().fold(0.0, f64::max);
        let square = most(&self.along).max(most(&self.about));
        [square, most(self.damped.as_flattened())]
    }

    /// The critical step of a body [s] beside plates of these bounds; `None` for one that nothing holds.
    fn critical_step(&self, [plate_square, plate_damped]: [f64; 2]) -> Option<f64> {
        let [square, damped] = self.bounds();
        (square > 0.0).then(|| critical_step(square + plate_square, damped + plate_damped))
    }
}

impl PatchRows {
    pub(crate) fn new(patch: &Patch, walls: usize) -> Self {
        Self {
            own: vec![Rows::default(); patch.particles.len()],
            others: vec![Rows::default(); patch.others.len()],
            walls: vec![Rows::default(); walls],
        }
    }

    /// A contact of the patch whose rows these are.
    pub(crate) fn add(&mut self, contact: &Contact, patch: &Patch, model: &Model) {
        let [a, b] = contact.bodies;
        let (particle, other) = contact.particles;
        if let Some(wall) = (b as usize).checked_sub(model.masses.len()) {
            self.walls[wall].add(contact, 1.0, a);
        }
        for (body, partner, particle) in [(a, b, Some(particle)), (b, a, other)] {
            let Some(particle) = particle.filter(|_| model.can_move(body)) else {
                continue;
            };
            let coupling = if model.can_move(partner) {
                let [own, other] = [body, partner].map(|body| model.masses[body as usize]);
                (own / other).sqrt()
            } else {
                0.0
            };
            let row = if patch.particles.contains(&particle) {
                &mut self.own[particle - patch.particles.start]
            } else {
                let place = (patch.others).partition_point(|other| (*other as usize) < particle);
                &mut self.others[place]
            };
            row.add(contact, 1.0 + coupling, partner);
        }
    }
}

impl Plates {
    /// ω_p² [1/s²] of a wall along the axes that it follows.
    pub(crate) fn square(&self, wall: usize) -> f64 {
        self.rows[wall].bounds()[0]
    }

    /// The wall of the largest ω_p², and its bounds.
    fn worst(&self) -> (usize, [f64; 2]) {
        let bounds = self.rows.iter().map(Rows::bounds).enumerate();
        bounds.fold((0, [0.0; 2]), |(wall, most), (other, bounds)| {
            let worst = if bounds[0] > most[0] { other } else { wall };
            (worst, [0, 1].map(|of: usize| most[of].max(bounds[of])))
        })
    }
}

impl Engine {
    /// What the rows of all patches make of the plates.
    pub(crate) fn plates_with(&self, rows: &[PatchRows]) -> Plates {
        let walls = (0..self.wall_count()).map(|wall| {
            let mut own = Rows::default();
            let Some(load) = self.motion_of(wall).load else {
                return own;
            };
            for patch in rows {
                own.join(&patch.walls[wall], 1.0 / load.mass, 0.0);
            }
            for axis in (0..3).filter(|axis| !load.free[*axis]) {
                (own.along[axis], own.damped[0][axis]) = (0.0, 0.0);
            }
            own
        });
        Plates {
            rows: walls.collect(),
        }
    }

    /// The critical step of the contacts that these are the rows of; `None` when none of them moves
    /// anything.
    pub(crate) fn critical_step(&self, rows: Vec<PatchRows>, plates: &Plates) -> Option<Critical> {
        let (wall, plate) = plates.worst();
        let rows = rows.into_iter().map(|rows| (rows.own, rows.others));
        let (own, others): (Vec<_>, Vec<_>) = rows.unzip();
        let work = self.state.patches.iter().zip(own);
        let found = self.team.map(work.collect(), |(patch, mut own)| {
            for incoming in &patch.incoming {
                let rows = &others[incoming.patch][incoming.place..];
                for (particle, row) in incoming.particles.iter().zip(rows) {
                    own[*particle as usize].join(row, 1.0, 1.0);
                }
            }
            self.critical_steps(patch, &own, plate)
        });
        let found = || found.iter().flatten();
        let order = |a: &&Critical, b: &&Critical| {
            (a.step.total_cmp(&b.step)).then_with(|| a.body.cmp(&b.body))
        };
        let of_plate = || {
            let [square, damped] = plate;
            let body = (self.model.masses.len() + wall) as u32;
            (square > 0.0).then(|| Critical {
                step: critical_step(square, damped),
                body,
                partner: plates.rows[wall].stiffest.1,
                median: None,
            })
        };
        let Some(critical) = found().min_by(order) else {
            return of_plate();
        };
        let mut steps: Vec<f64> = found().map(|body| body.step).collect();
        let middle = steps.len() / 2;
        Some(Critical {
            median: Some(*steps.select_nth_unstable_by(middle, f64::total_cmp).1),
            ..*critical
        })
    }

    /// Of each body of a patch that moves and touches something, given the rows of its particles.
    /// `plate` are the bounds of the worst plate.
    fn critical_steps(&self, patch: &Patch, rows: &[Rows], plate: [f64; 2]) -> Vec<Critical> {
        let (model, particles) = (&self.model, &self.state.particles);
        let first = patch.particles.start;
        let clumps = &self.state.clumps[patch.clumps.clone()];
        let mut found = Vec::with_capacity(rows.len());
        let mut add = |body: u32, row: &Rows| {
            found.extend(row.critical_step(plate).map(|step| Critical {
                step,
                body,
                partner: row.stiffest.1,
                median: None,
            }));
        };
        for place in patch.single_spheres(clumps).flatten() {
            let body = particles.owners[first + place];
            if model.is_movable[body as usize] {
                let radius = particles.centres[first + place].0[3];
                let freedom = 1.0 / model.masses[body as usize];
                let turning = radius.powi(2) / model.sphere_inertias[body as usize];
                let mut row = Rows::default();
                row.join(&rows[place], freedom, freedom + turning);
                let fixed = particles.fixed[first + place];
                row.hold(|degree| fixed >> degree & 1 == 1);
                add(body, &row);
            }
        }
        for clump in clumps {
            if model.is_movable[clump.body as usize] {
                let freedom = 1.0 / clump.mass;
                let mut row = Rows::default();
                for member in clump.members() {
                    let turning = clump.turning(&particles.centres[member]);
                    row.join(&rows[member - first], freedom, freedom + turning);
                }
                row.hold(|degree| clump.fixed[degree]);
                add(clump.body, &row);
            }
        }
        found
    }

    /// Smallest critical step of any one contact that may come at this speed [s], of materials as stiff as
    /// the spec says; `plates` as of [`GranularScene::critical_step_of_one_contact`].
    pub(crate) fn foreseen(
        &self,
        spec: &GranularScene,
        bodies: &[Body],
        speed: f64,
        plates: &[f64],
    ) -> f64 {
        let of_spheres = spec.critical_step_of_one_contact(bodies, speed, plates);
        let plate = plates.iter().copied().fold(0.0, f64::max);
        let of_clumps = self.critical_step_of_clumps(speed, plate);
        of_spheres
            .map(|critical| critical.step)
            .into_iter()
            .chain(of_clumps)
            .fold(f64::INFINITY, f64::min)
    }

    /// The critical step of any one contact of a clump's member with its like, at this `speed`
    /// [m/s], beside a plate of this 1/m [1/kg]; `None` without clumps that move.
    fn critical_step_of_clumps(&self, speed: f64, plate: f64) -> Option<f64> {
        let all = [
            (&self.state.particles, &self.state.clumps),
            (&self.reserve.particles, &self.reserve.clumps),
        ];
        let clumps = all
            .into_iter()
            .flat_map(|(particles, clumps)| clumps.iter().map(move |clump| (particles, clump)))
            .filter(|(_, clump)| self.model.is_movable[clump.body as usize]);
        let steps = clumps.flat_map(|(particles, clump)| {
            // by offsets, whose bits no turn changes: a run that is resumed finds the same
            let members = clump.members().zip(&clump.offsets);
            members.map(move |(member, offset)| {
                let radius = particles.centres[member].0[3];
                let surface = self.model.first_surfaces[usize::from(particles.surfaces[member])];
                let own = Side {
                    surface,
                    radius,
                    is_flat: false,
                    inverse_mass: 1.0 / clump.mass,
                    freedom: Freedom::WHOLE,
                };
                let stiffness = surface.turning_bound() * (self.law.foreseen)(&own, speed);
                let freedom = own.inverse_mass + clump.turning_by(offset, radius) + plate;
                let step = 2.0 / (stiffness * freedom).sqrt();
                surface.damped_step(step, clump.mass * freedom)
            })
        });
        steps.min_by(f64::total_cmp)
    }
}
