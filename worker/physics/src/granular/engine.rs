//! The state of a scene and its step.
use loadframe_api::spec::granular_scene::GranularScene;
use serde::{Deserialize, Serialize};

use super::{
    contact::{Wrenches, law::Law, pairs::Halo, walls::Face},
    listing::{self, Memories},
    motion::{Drive, clump::Clump},
    neighbours::skin::Skin,
    particles::Particles,
    patch::{Bodies, Patch, Push},
    scene::{Model, build},
};
use crate::parallel::Team;

/// Lists between two sorts along the curve: neighbours in space drift apart in memory slowly.
const LISTS_PER_SORT: u64 = 8;

/// What changes during a run, all of it.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(bound = "")]
pub(super) struct State<F: Law> {
    pub(super) particles: Particles,
    pub(super) clumps: Vec<Clump>,
    pub(super) faces: Vec<Face>,
    pub(super) patches: Vec<Patch<F>>,
    skin: Skin,
    /// Whether the lists hold for the next step.
    is_listed: bool,
    /// Steps done.
    pub(super) step: u64,
    /// [s].
    pub(super) time: f64,
    /// Δt of the last step [s].
    last_step: f64,
    /// Lists made.
    pub(super) lists: u64,
    /// Work that moving planes have done on the bodies [J].
    pub(super) plane_work: f64,
    /// Bonds made at the start.
    pub(super) bonds_made: u64,
    /// Farthest that one of them stretches before it breaks [m].
    longest_stretch: f64,
    /// Upper bound of the speeds after the last step [m/s].
    pub(super) speed_bound: f64,
}

/// A scene in motion.
#[derive(Debug)]
pub(super) struct Engine<F: Law> {
    pub(super) model: Model,
    pub(super) state: State<F>,
    halos: Vec<Halo>,
    /// Forces on the patch at work when patches are worked through one after the other: one array
    /// for all stays in the cache.
    scratch: Wrenches,
    team: Team,
}

impl<F: Law> Engine<F> {
    pub(super) fn new(spec: &GranularScene, team: Team) -> Self {
        let (model, particles, clumps) = build(spec);
        let faces = model.planes.iter().map(|plane| plane.face).collect();
        let state = State {
            skin: Skin::new(&particles.centres),
            particles,
            clumps,
            faces,
            ..State::default()
        };
        Self {
            model,
            state,
            halos: Vec::new(),
            scratch: Wrenches::default(),
            team,
        }
    }

    /// Goes on from `state`.
    pub(super) fn resume(&mut self, state: State<F>) {
        self.state = state;
        self.halos = vec![Halo::default(); self.state.patches.len()];
    }

    /// Candidates in the lists.
    pub(super) fn candidates(&self) -> u64 {
        let patches = self.state.patches.iter();
        let counts = patches.map(|patch| patch.inner.count + patch.outer.count);
        counts.sum::<usize>() as u64
    }

    /// One step of Δt [s].
    pub(super) fn step(&mut self, time_step: f64) {
        if self.team.is_alone() {
            self.step_alone(time_step);
        } else {
            self.push(time_step);
            self.advance(time_step);
        }
    }

    /// Both phases, patch by patch, while a patch is in the cache. A patch looks at its own
    /// particles and those of later patches only, and fetches from earlier ones, so that moving it
    /// at once changes nothing.
    fn step_alone(&mut self, time_step: f64) {
        if !self.state.is_listed {
            self.list();
        }
        let drive = self.drive(time_step);
        let state = &mut self.state;
        let mut speed_square = 0.0_f64;
        for (number, patch) in state.patches.iter_mut().enumerate() {
            std::mem::swap(&mut patch.wrenches, &mut self.scratch);
            let push = Push {
                patch: &mut *patch,
                halo: &mut self.halos[number],
                kinematics: state.particles.kinematics(state.last_step),
                faces: &state.faces,
                time_step,
            };
            push.run();
            let bodies = share(&mut state.particles, &mut state.clumps, patch);
            let speed = patch.advance(bodies, &self.halos, &drive, self.model.rotation);
            speed_square = speed_square.max(speed);
            std::mem::swap(&mut patch.wrenches, &mut self.scratch);
        }
        self.finish(time_step, speed_square);
    }

    fn drive(&self, time_step: f64) -> Drive {
        Drive {
            time_step,
            gravity: self.model.gravity,
            damping: self.model.damping,
        }
    }

    /// The first phase of a step: forces from where the bodies are.
    pub(super) fn push(&mut self, time_step: f64) {
        if !self.state.is_listed {
            self.list();
        }
        let state = &mut self.state;
        let kinematics = state.particles.kinematics(state.last_step);
        let faces = &state.faces;
        let work = state
            .patches
            .iter_mut()
            .zip(&mut self.halos)
            .map(|(patch, halo)| Push {
                patch,
                halo,
                kinematics,
                faces,
                time_step,
            });
        self.team.map(work.collect(), Push::run);
    }

    /// The second phase: the forces move the bodies.
    pub(super) fn advance(&mut self, time_step: f64) {
        let drive = self.drive(time_step);
        let state = &mut self.state;
        let (halos, rotation) = (&self.halos, self.model.rotation);
        let work = shares(&mut state.particles, &mut state.clumps, &mut state.patches);
        let speeds = self.team.map(work, |(patch, bodies)| {
            patch.advance(bodies, halos, &drive, rotation)
        });
        self.finish(time_step, speeds.into_iter().fold(0.0, f64::max));
    }

    /// Planes, time, and whether the lists hold, after the bodies moved.
    fn finish(&mut self, time_step: f64, speed_square: f64) {
        let drive = self.drive(time_step);
        let state = &mut self.state;
        state.speed_bound = speed_square.sqrt();
        let mut plane_way = 0.0_f64;
        for (plane, face) in state.faces.iter_mut().enumerate() {
            let force = forces(&state.patches, plane)[face.axis];
            if let Some(load) = face.load {
                let acceleration = (load.force + force) / load.mass;
                face.velocity += time_step * drive.damped(acceleration, face.velocity);
            }
            state.plane_work -= force * face.velocity * time_step;
            face.position += time_step * face.velocity;
            plane_way = plane_way.max((time_step * face.velocity).abs());
        }
        state.step += 1;
        state.time += time_step;
        state.last_step = time_step;
        let way = state.speed_bound * time_step;
        state.is_listed = (state.skin).holds_after(way, plane_way, &state.particles.centres);
    }

    /// Force of all bodies on a plane in the last step [N].
    pub(super) fn plane_force(&self, plane: usize) -> [f64; 3] {
        forces(&self.state.patches, plane)
    }

    /// Searches for candidates anew.
    pub(super) fn list(&mut self) {
        let state = &mut self.state;
        let memories = if state.lists == 0 {
            Memories::none()
        } else {
            Memories::of(&state.patches, &state.particles)
        };
        // in the old order, as the way is measured from
        state.skin.renew(&state.particles.centres);
        if state.lists.is_multiple_of(LISTS_PER_SORT) {
            listing::sort(&mut state.particles, &mut state.clumps);
        }
        let skin = state.skin.width;
        state.patches = listing::list(
            &self.model,
            &state.faces,
            &state.particles,
            &state.clumps,
            // bonded spheres are listed however far their bonds stretch
            skin + state.longest_stretch,
            &memories,
        );
        if state.lists == 0 {
            let bonds = state.patches.iter().flat_map(Patch::bonds);
            for (strength, stiffness) in bonds {
                state.longest_stretch = state.longest_stretch.max(strength / stiffness);
                state.bonds_made += 1;
            }
        }
        state.skin.start(&state.particles.centres);
        state.is_listed = true;
        state.lists += 1;
        self.halos.resize_with(state.patches.len(), Halo::default);
    }
}

/// Force of all bodies on a plane in the last step [N].
fn forces<F: Law>(patches: &[Patch<F>], plane: usize) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for patch in patches {
        for (sum, part) in sum.iter_mut().zip(patch.plane_forces[plane]) {
            *sum += part;
        }
    }
    sum
}

/// A patch's own bodies.
fn share<'a, F: Law>(
    particles: &'a mut Particles,
    clumps: &'a mut [Clump],
    patch: &Patch<F>,
) -> Bodies<'a> {
    let range = patch.particles.clone();
    let turning = if F::IS_ROUGH { range.clone() } else { 0..0 };
    Bodies {
        centres: &mut particles.centres[range.clone()],
        velocities: &mut particles.velocities[range],
        spins: &mut particles.spins[turning],
        clumps: &mut clumps[patch.clumps.clone()],
    }
}

/// Hands every patch its own bodies.
fn shares<'a, F: Law>(
    particles: &'a mut Particles,
    clumps: &'a mut [Clump],
    patches: &'a mut [Patch<F>],
) -> Vec<(&'a mut Patch<F>, Bodies<'a>)> {
    let mut centres = particles.centres.as_mut_slice();
    let mut velocities = particles.velocities.as_mut_slice();
    let mut spins = particles.spins.as_mut_slice();
    let mut clumps = clumps;
    let mut shares = Vec::with_capacity(patches.len());
    for patch in patches {
        let rows = patch.particles.len();
        let bodies = Bodies {
            centres: take(&mut centres, rows),
            velocities: take(&mut velocities, rows),
            spins: take(&mut spins, if F::IS_ROUGH { rows } else { 0 }),
            clumps: take(&mut clumps, patch.clumps.len()),
        };
        shares.push((patch, bodies));
    }
    shares
}

/// Splits off the first `count` items.
fn take<'a, T>(items: &mut &'a mut [T], count: usize) -> &'a mut [T] {
    let (first, rest) = std::mem::take(items).split_at_mut(count);
    *items = rest;
    first
}
