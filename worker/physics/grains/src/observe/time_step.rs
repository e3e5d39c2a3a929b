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
//! Stiffnesses are tangents at the present overlap. With dashpots, whose damping matrix over the
//! masses has the bound D, built from them as ω² is from the springs, the step must satisfy
//! ω² Δt² + 2 D Δt < 4 (G.19), since the velocities that damp are those of half a step ago.
use loadframe_api::spec::granular_scene::{Body, GranularScene};
use serde::{Deserialize, Serialize};

use super::contact::Contact;
use crate::{
    contact::stiffness::Side,
    motion::critical_step,
    scene::model::Model,
    step::{engine::Engine, patch::Patch},
};

/// The critical step and the contact that sets it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Critical {
    /// [s].
    pub(crate) step: f64,
    /// Body whose frequency is the highest.
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

    /// The critical step of a body [s] whose rows, over its mass, these are; `None` for one that
    /// nothing holds.
    fn critical_step(&self) -> Option<f64> {
        let most = |rows: &[f64]| rows.iter().copied().fold(0.0, f64::max);
        let square = most(&self.along).max(most(&self.about));
        let damped = most(self.damped.as_flattened());
        (square > 0.0).then(|| critical_step(square, damped))
    }
}

impl PatchRows {
    pub(crate) fn new(patch: &Patch) -> Self {
        Self {
            own: vec![Rows::default(); patch.particles.len()],
            others: vec![Rows::default(); patch.others.len()],
        }
    }

    /// A contact of the patch whose rows these are.
    pub(crate) fn add(&mut self, contact: &Contact, patch: &Patch, model: &Model) {
        let [a, b] = contact.bodies;
        let (particle, other) = contact.particles;
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

impl Engine {
    /// The critical step of the contacts that these are the rows of; `None` when none of them moves
    /// anything.
    pub(crate) fn critical_step(&self, rows: Vec<PatchRows>) -> Option<Critical> {
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
            self.critical_steps(patch, &own)
        });
        let found = || found.iter().flatten();
        let order = |a: &&Critical, b: &&Critical| {
            (a.step.total_cmp(&b.step)).then_with(|| a.body.cmp(&b.body))
        };
        let critical = found().min_by(order)?;
        let mut steps: Vec<f64> = found().map(|body| body.step).collect();
        let middle = steps.len() / 2;
        Some(Critical {
            median: Some(*steps.select_nth_unstable_by(middle, f64::total_cmp).1),
            ..*critical
        })
    }

    /// Of each body of a patch that moves and touches something, given the rows of its particles.
    fn critical_steps(&self, patch: &Patch, rows: &[Rows]) -> Vec<Critical> {
        let (model, particles) = (&self.model, &self.state.particles);
        let first = patch.particles.start;
        let clumps = &self.state.clumps[patch.clumps.clone()];
        let mut found = Vec::with_capacity(rows.len());
        let mut add = |body: u32, row: &Rows| {
            found.extend(row.critical_step().map(|step| Critical {
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
                add(clump.body, &row);
            }
        }
        found
    }

    /// Smallest critical step of any one contact that may come at this speed [s].
    pub(crate) fn foreseen(&self, spec: &GranularScene, bodies: &[Body], speed: f64) -> f64 {
        let of_spheres = spec.critical_step_of_one_contact(bodies, speed);
        let of_clumps = self.critical_step_of_clumps(speed);
        of_spheres
            .map(|critical| critical.step)
            .into_iter()
            .chain(of_clumps)
            .fold(f64::INFINITY, f64::min)
    }

    /// The critical step of any one contact of a clump's member with its like, at this `speed`
    /// [m/s]; `None` without clumps that move.
    fn critical_step_of_clumps(&self, speed: f64) -> Option<f64> {
        let all = [
            (&self.state.particles, &self.state.clumps),
            (&self.reserve.particles, &self.reserve.clumps),
        ];
        let clumps = all
            .into_iter()
            .flat_map(|(particles, clumps)| clumps.iter().map(move |clump| (particles, clump)))
            .filter(|(_, clump)| self.model.is_movable[clump.body as usize]);
        let steps = clumps.flat_map(|(particles, clump)| {
            clump.members().map(move |member| {
                let radius = particles.centres[member].0[3];
                let surface = self.model.surfaces[usize::from(particles.surfaces[member])];
                let own = Side {
                    surface,
                    radius,
                    is_flat: false,
                    inverse_mass: 1.0 / clump.mass,
                };
                let stiffness = (self.law.foreseen)(&own, speed);
                let freedom = own.inverse_mass + clump.turning(&particles.centres[member]);
                let step = 2.0 / (stiffness * freedom).sqrt();
                surface.damped_step(step, clump.mass * freedom)
            })
        });
        steps.min_by(f64::total_cmp)
    }
}
