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
use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{
    contact::stiffness::Side, engine::Engine, motion::clump::Clump, observe::Contact, rows::Row,
};

/// The critical step and the contact that sets it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Critical {
    /// [s].
    pub(super) step: f64,
    /// Body whose frequency is the highest.
    pub(super) body: u32,
    /// Its stiffest contact.
    pub(super) partner: u32,
    /// Critical step of the body in the middle, of all that touch something [s].
    pub(super) median: f64,
}

/// What a body's contacts add up to.
#[derive(Clone, Copy, Debug, Default)]
struct Rows {
    along: [f64; 3],
    about: [f64; 3],
    /// As both, of dashpots.
    damped: [[f64; 3]; 2],
    stiffest: (f64, u32),
}

impl Engine {
    /// The critical step of these contacts; `None` when none of them moves anything.
    pub(super) fn critical_step(&self, contacts: &[Contact]) -> Option<Critical> {
        let bodies = self.model.masses.len();
        let mut rows = vec![Rows::default(); bodies];
        let clumps = self.clumps_by_body();
        for contact in contacts {
            for (own, other) in [(0, 1), (1, 0)] {
                let [body, partner] = [own, other].map(|side| contact.bodies[side]);
                let place = body as usize;
                if place >= bodies || !self.model.is_movable[place] {
                    continue;
                }
                let mass = self.model.masses[place];
                let coupling = match self.model.masses.get(partner as usize) {
                    Some(other) if self.model.is_movable[partner as usize] => (mass / other).sqrt(),
                    _ => 0.0,
                };
                let particle = if own == 0 {
                    Some(contact.particles.0)
                } else {
                    contact.particles.1
                };
                let turning = particle.map_or(0.0, |particle| self.turning(&clumps, particle));
                let [normal, shear] = contact.stiffness;
                let [normal_dashpot, shear_dashpot] = contact.dashpots;
                let row = &mut rows[place];
                for axis in 0..3 {
                    let square = contact.normal[axis].powi(2);
                    let stiffness = normal * square + shear * (1.0 - square);
                    row.along[axis] += stiffness / mass * (1.0 + coupling);
                    let damping = normal_dashpot * square + shear_dashpot * (1.0 - square);
                    row.damped[0][axis] += damping / mass * (1.0 + coupling);
                    row.about[axis] +=
                        shear * (1.0 - square) * (1.0 / mass + turning) * (1.0 + coupling);
                    row.damped[1][axis] +=
                        shear_dashpot * (1.0 - square) * (1.0 / mass + turning) * (1.0 + coupling);
                }
                if normal > row.stiffest.0 {
                    row.stiffest = (normal, partner);
                }
            }
        }
        let mut critical: Option<Critical> = None;
        let mut steps = Vec::new();
        for (body, row) in (0..).zip(&rows) {
            let square = row
                .along
                .iter()
                .chain(&row.about)
                .fold(0.0, |most: f64, next| most.max(*next));
            let damped = row
                .damped
                .as_flattened()
                .iter()
                .fold(0.0, |most: f64, next| most.max(*next));
            let step = if damped > 0.0 {
                // the root of (G.19)
                4.0 / (damped + (damped * damped + 4.0 * square).sqrt())
            } else {
                2.0 / square.sqrt()
            };
            if square > 0.0 {
                steps.push(step);
            }
            if square > 0.0 && critical.is_none_or(|found| step < found.step) {
                critical = Some(Critical {
                    step,
                    body,
                    partner: row.stiffest.1,
                    median: step,
                });
            }
        }
        if let Some(critical) = &mut critical {
            let middle = steps.len() / 2;
            critical.median = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
        }
        critical
    }

    /// The critical step of any one contact of a clump's member with its like, at this `speed`
    /// [m/s]; `None` without clumps that move.
    pub(super) fn critical_step_of_clumps(&self, speed: f64) -> Option<f64> {
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

    /// Arm² over inertia of a contact of a particle, at most [1/kg].
    fn turning(&self, clumps: &BTreeMap<u32, &Clump>, particle: usize) -> f64 {
        let centre = &self.state.particles.centres[particle];
        let owner = self.state.particles.owners[particle];
        match clumps.get(&owner) {
            Some(clump) => clump.turning(centre),
            None => centre.0[3].powi(2) / self.model.sphere_inertias[owner as usize],
        }
    }

    fn clumps_by_body(&self) -> BTreeMap<u32, &Clump> {
        let clumps = self.state.clumps.iter();
        clumps.map(|clump| (clump.body, clump)).collect()
    }
}

impl Clump {
    /// Arm² over inertia of a contact of a member, at most [1/kg].
    fn turning(&self, member: &Row) -> f64 {
        let arm = (member.vector() - self.centre).norm() + member.0[3];
        arm.powi(2) / self.inertia.min()
    }
}
