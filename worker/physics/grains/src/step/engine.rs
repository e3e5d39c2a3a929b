//! A scene in motion, and its step.
//!
//! One file, long as it is: a step is right only in the order of its parts.
use std::{ops::Range, sync::Arc};

use loadframe_api::spec::granular_scene::GranularScene;
use loadframe_harness::{Interrupt, InterruptSource};
use loadframe_numerics::Team;

use super::{
    alone::{Seen, Through},
    listing::{self, Listing, memories::Memories},
    patch::{BodyLoad, Patch, on_wall},
    shares::{share, shares},
    state::State,
};
use crate::{
    contact::{Scenery, WATCHES, chosen::Chosen, lists::Lists},
    geometry::neighbours::skin::Skin,
    motion::{Drive, Wrenches, clump::Members},
    numbers::Vector,
    scene::{
        model::{Model, build},
        reserve::Reserve,
        specimen::Specimen,
    },
    walls::facets::{Pose, search::Search},
};

/// Lists between two sorts along the curve: neighbours in space drift apart in memory slowly.
const LISTS_PER_SORT: u64 = 8;

/// Patches of a wave for each thread: fewer and the threads wait for each other more often than
/// they save, more and the caches do not hold them.
const WAVE: usize = 8;

/// A scene in motion.
#[derive(Debug)]
pub(crate) struct Engine {
    pub(crate) model: Model,
    pub(crate) law: Chosen,
    /// What acts on every body now [m/s²]: that of the model, and what shakes the scene.
    pub(crate) gravity: Vector,
    pub(crate) state: State,
    /// Of each patch.
    pub(crate) contact_lists: Vec<Box<dyn Lists>>,
    /// Bodies that are not in the scene yet.
    pub(crate) reserve: Reserve,
    /// What each patch does to particles of later ones.
    halos: Vec<Wrenches>,
    /// Forces on the patches at work when all are worked through one after the other, or wave by
    /// wave: the same few arrays for all stay in the caches.
    scratch: Vec<Wrenches>,
    /// Forces on bodies in this step beside weights and contacts.
    pub(crate) loads: Vec<BodyLoad>,
    pub(crate) search: Search,
    pub(crate) team: Arc<Team>,
}

impl Engine {
    /// # Errors
    /// The interrupt that ended it early.
    pub(crate) fn new(
        spec: &GranularScene,
        law: Chosen,
        specimen: &Specimen<'_>,
        team: Team,
        interrupt: &dyn InterruptSource,
    ) -> Result<Self, Interrupt> {
        let (model, particles, clumps) = build(spec, specimen, interrupt)?;
        let faces = model.planes.iter().map(|plane| plane.face).collect();
        let state = State {
            particles,
            clumps,
            faces,
            poses: vec![Pose::default(); model.facets.meshes.len()],
            friction_factor: 1.0,
            stiffness_factor: 1.0,
            cohesion_factor: model.cohesion_factor,
            ..State::default()
        };
        let mut engine = Self {
            gravity: model.gravity,
            model,
            law,
            state,
            contact_lists: Vec::new(),
            reserve: Reserve::default(),
            halos: Vec::new(),
            scratch: vec![Wrenches::default()],
            loads: Vec::new(),
            search: Search::default(),
            team: Arc::new(team),
        };
        let state = &mut engine.state;
        engine.reserve = Reserve::split_off(specimen, &mut state.particles, &mut state.clumps);
        state.skin = Skin::new(&state.particles.centres);
        Ok(engine)
    }

    /// Goes on from `state`, with the lists of its patches.
    pub(crate) fn resume(&mut self, state: State, contact_lists: Vec<Box<dyn Lists>>) {
        self.model.stiffen(state.stiffness_factor);
        self.model.cohesion_factor = state.cohesion_factor;
        self.state = state;
        self.contact_lists = contact_lists;
        self.halos = vec![Wrenches::default(); self.state.patches.len()];
    }

    /// Candidates in the lists.
    pub(crate) fn candidates(&self) -> u64 {
        let counts = self.contact_lists.iter().map(|lists| lists.candidates());
        counts.sum::<usize>() as u64
    }

    /// Bodies stand still in every degree of freedom that forces change.
    pub(crate) fn halt(&mut self) {
        let state = &mut self.state;
        let particles = &mut state.particles;
        // the fourth numbers are inverse masses and inertias, 0 for what no force moves
        for (rows, first) in [(&mut particles.velocities, 0), (&mut particles.spins, 3)] {
            for (row, fixed) in rows.iter_mut().zip(&particles.fixed) {
                for axis in 0..3 {
                    if row.0[3] > 0.0 && fixed >> (first + axis) & 1 == 0 {
                        row.0[axis] = 0.0;
                    }
                }
            }
        }
        for clump in &mut state.clumps {
            clump.halt();
            let members = &mut Members {
                centres: &mut particles.centres,
                velocities: &mut particles.velocities,
                spins: &mut particles.spins,
            };
            clump.place(members, 0);
        }
        state.speed_bound = 0.0;
    }

    /// Memory of the lists of candidates [bytes].
    pub(crate) fn contact_bytes(&self) -> u64 {
        let bytes = self.contact_lists.iter().map(|lists| lists.bytes());
        bytes.sum::<usize>() as u64
    }

    /// One step of Δt [s].
    pub(crate) fn step(&mut self, time_step: f64) {
        if !self.state.is_listed {
            self.list();
        }
        // calling the others together takes longer than a patch does
        if self.team.is_alone() || self.state.patches.len() < 2 {
            self.step_alone(time_step);
        } else {
            let team = Arc::clone(&self.team);
            team.gather(|| self.step_in_waves(time_step, &team));
        }
    }

    /// Both phases, patch by patch, while a patch is in the cache. A patch looks at its own
    /// particles and those of later patches only, and fetches from earlier ones, so that moving it
    /// at once changes nothing.
    fn step_alone(&mut self, time_step: f64) {
        let drive = self.drive(time_step);
        let state = &mut self.state;
        let is_rough = self.model.is_rough;
        let mut speed_square = 0.0_f64;
        let patches = state.patches.iter_mut().zip(&mut self.contact_lists);
        for (number, (patch, lists)) in patches.enumerate() {
            std::mem::swap(&mut patch.wrenches, &mut self.scratch[0]);
            let scenery = Scenery {
                kinematics: state.particles.kinematics(state.last_step, time_step),
                faces: &state.faces,
                facets: &self.model.facets,
                poses: &state.poses,
            };
            patch.push(lists.as_mut(), scenery, &mut self.halos[number], is_rough);
            let bodies = share(&mut state.particles, &mut state.clumps, patch);
            let speed = patch.advance(
                bodies,
                &self.halos,
                &drive,
                self.model.rotation,
                &self.loads,
            );
            speed_square = speed_square.max(speed);
            std::mem::swap(&mut patch.wrenches, &mut self.scratch[0]);
        }
        self.finish(time_step, speed_square);
    }

    /// Both phases, wave by wave, so that what moves a patch's bodies is still in the caches. As in
    /// [`Engine::step_alone`] no patch looks at an earlier one.
    fn step_in_waves(&mut self, time_step: f64, team: &Team) {
        let count = self.state.patches.len();
        // equally long waves, and as many patches for every thread
        let waves = count.div_ceil(WAVE * team.threads());
        let wave = count.div_ceil(waves).next_multiple_of(team.threads());
        self.scratch.resize_with(wave, Wrenches::default);
        let mut speed_square = 0.0_f64;
        for first in (0..count).step_by(wave) {
            let patches = first..(first + wave).min(count);
            self.swap_wrenches(patches.clone());
            self.push_patches(patches.clone(), time_step);
            speed_square = speed_square.max(self.advance_patches(patches.clone(), time_step));
            self.swap_wrenches(patches);
        }
        self.finish(time_step, speed_square);
    }

    /// Lets patches work with wrenches that stay in the caches, or gives them back theirs.
    fn swap_wrenches(&mut self, patches: Range<usize>) {
        let patches = self.state.patches[patches].iter_mut();
        for (patch, scratch) in patches.zip(&mut self.scratch) {
            std::mem::swap(&mut patch.wrenches, scratch);
        }
    }

    fn drive(&self, time_step: f64) -> Drive {
        Drive {
            time_step,
            gravity: self.gravity,
            damping: self.model.damping,
        }
    }

    /// The first phase of a step: forces from where the bodies are.
    pub(crate) fn push(&mut self, time_step: f64) {
        if !self.state.is_listed {
            self.list();
        }
        self.push_patches(0..self.state.patches.len(), time_step);
    }

    fn push_patches(&mut self, range: Range<usize>, time_step: f64) {
        let state = &mut self.state;
        let is_rough = self.model.is_rough;
        let scenery = Scenery {
            kinematics: state.particles.kinematics(state.last_step, time_step),
            faces: &state.faces,
            facets: &self.model.facets,
            poses: &state.poses,
        };
        let patches = state.patches[range.clone()].iter_mut();
        let patches = patches.zip(&mut self.contact_lists[range.clone()]);
        let work = patches.zip(&mut self.halos[range]).collect();
        self.team.map(work, |((patch, lists), halo)| {
            patch.push(lists.as_mut(), scenery, halo, is_rough);
        });
    }

    /// Finds out what touches, and what acts on bodies, between two steps; nothing moves.
    pub(crate) fn push_still(&mut self) {
        self.push(0.0);
        let state = &mut self.state;
        // shear forces were turned to the present normals
        state.last_step = 0.0;
        // whether this counts is said by the step that follows
        state.patches.iter_mut().for_each(Patch::forget);
        let owners = &state.particles.owners;
        for patch in &mut state.patches {
            let clumps = &state.clumps[patch.clumps.clone()];
            let owners = &owners[patch.particles.clone()];
            patch.gather(&self.halos, &self.loads, clumps, owners);
        }
    }

    /// The second phase: the forces move the bodies.
    pub(crate) fn advance(&mut self, time_step: f64) {
        let patches = 0..self.state.patches.len();
        let speed_square = self.advance_patches(patches, time_step);
        self.finish(time_step, speed_square);
    }

    /// Returns the square of an upper bound of the speeds.
    fn advance_patches(&mut self, range: Range<usize>, time_step: f64) -> f64 {
        let drive = self.drive(time_step);
        let state = &mut self.state;
        let (halos, rotation, loads) = (&self.halos, self.model.rotation, &self.loads);
        let patches = &mut state.patches[range];
        let work = shares(&mut state.particles, &mut state.clumps, patches);
        let speeds = self.team.map_back(work, |(patch, bodies)| {
            patch.advance(bodies, halos, &drive, rotation, loads)
        });
        speeds.into_iter().fold(0.0, f64::max)
    }

    /// Walls, time, and whether the lists hold, after the bodies moved.
    fn finish(&mut self, time_step: f64, speed_square: f64) {
        let drive = self.drive(time_step);
        let state = &mut self.state;
        state.speed_bound = speed_square.sqrt();
        for patch in &mut state.patches {
            if WATCHES {
                (state.seen).see(&self.law, patch.deepest, &mut patch.shortest, time_step);
            }
            for passage in patch.passed.drain(..) {
                let body = state.particles.owners[passage.particle as usize];
                let through = state.through.entry(passage.wall).or_insert(Through {
                    passages: 0,
                    body,
                    step: state.step + 1,
                });
                through.passages += 1;
            }
        }
        let mut wall_way = 0.0_f64;
        for (plane, face) in state.faces.iter_mut().enumerate() {
            let force = on_wall(&state.patches, plane);
            let before = face.motion.velocity;
            face.motion
                .accelerate(&drive, &[force[0], force[1], force[2]]);
            state.wall_work -= work(&force, &before, &face.motion.velocity) * time_step;
            face.motion.advance(time_step);
            // along itself a plane comes no closer to anything
            let way = time_step * face.motion.velocity[face.axis];
            face.position += way;
            wall_way = wall_way.max(way.abs());
        }
        let meshes = state.poses.iter_mut().zip(&self.model.facets.meshes);
        for (wall, (pose, mesh)) in (state.faces.len()..).zip(meshes) {
            if pose.motion.is_moving() || pose.is_turning() {
                let force = on_wall(&state.patches, wall);
                let before = pose.motion.velocity;
                pose.motion
                    .accelerate(&drive, &[force[0], force[1], force[2]]);
                let power = work(&force, &before, &pose.motion.velocity) + force[3];
                state.wall_work -= power * time_step;
                wall_way = wall_way.max(time_step * pose.speed(mesh));
                pose.advance(time_step);
            }
        }
        state.step += 1;
        state.time += time_step;
        state.last_step = time_step;
        let way = state.speed_bound * time_step;
        state.is_listed = (state.skin).holds_after(way, wall_way, &state.particles.centres);
    }

    /// The steps since the scene was seen like this do not count.
    pub(crate) fn unsee(&mut self, seen: Seen) {
        self.state.seen = seen;
        self.state.patches.iter_mut().for_each(Patch::forget);
    }

    /// Force of all bodies on a wall, planes before meshes, in the last step [N].
    pub(crate) fn wall_force(&self, wall: usize) -> [f64; 3] {
        let [x, y, z, _] = on_wall(&self.state.patches, wall);
        [x, y, z]
    }

    /// The lists have to be made anew before the next step.
    pub(crate) fn drop_lists(&mut self) {
        self.state.is_listed = false;
    }

    /// Sets what tan φ of all contacts is multiplied with, from the next step on.
    pub(crate) fn rub(&mut self, factor: f64) {
        let state = &mut self.state;
        if state.friction_factor.to_bits() != factor.to_bits() {
            state.friction_factor = factor;
            // contacts are told their friction when they are listed
            state.is_listed = false;
        }
    }

    /// Searches for candidates anew.
    pub(crate) fn list(&mut self) {
        let memories = if self.state.lists == 0 {
            Memories::none()
        } else {
            self.memories()
        };
        self.list_with(&memories);
    }

    /// What the contacts of the last step remember.
    pub(crate) fn memories(&self) -> Memories {
        if self.model.is_rough || self.model.is_viscous {
            Memories::of(&self.team, &self.contact_lists, &self.state.particles)
        } else {
            Memories::default()
        }
    }

    /// The same after bodies came or went.
    pub(crate) fn relist(&mut self, memories: Memories) {
        self.state.skin = Skin::new(&self.state.particles.centres);
        self.list_with(&memories);
    }

    pub(crate) fn list_with(&mut self, memories: &Memories) {
        let (plates, followers) = (self.plates(), self.followers());
        let walls_held = self.walls_held();
        let state = &mut self.state;
        // in the old order, as the way is measured from
        state.skin.renew(&state.particles.centres);
        if state.lists.is_multiple_of(LISTS_PER_SORT) {
            listing::sort(&mut state.particles, &mut state.clumps);
        }
        let held = listing::sides::held(&state.particles, &state.clumps);
        let skin = state.skin.width;
        let facets = &self.model.facets;
        if !facets.facets.is_empty() {
            let radii = state.particles.centres.iter().map(|centre| centre.0[3]);
            (self.search).prepare(facets, radii.fold(0.0, f64::max) + skin);
        }
        // what only looks made before the first step has not begun
        let keeps_friction = self.model.keeps_friction && state.step > 0;
        let listing = Listing {
            law: &self.law,
            model: &self.model,
            held: &held,
            plates: &plates,
            walls_held: &walls_held,
            followers: &followers,
            faces: &state.faces,
            poses: &state.poses,
            search: &self.search,
            particles: &state.particles,
            memories,
            kept_friction: keeps_friction.then_some(state.friction_factor),
            skin,
        };
        (state.patches, self.contact_lists) = listing.list(&state.clumps, &self.team);
        if state.friction_factor < 1.0 && !keeps_friction {
            let factor = state.friction_factor;
            (self.contact_lists)
                .iter_mut()
                .for_each(|lists| lists.rub(factor));
        }
        if memories.makes_bonds() {
            let mut held = 0;
            for lists in &self.contact_lists {
                lists.see(&mut |touching| {
                    held += u64::from(touching.law.past(touching.lane).bond.is_intact);
                });
            }
            state.bonds_made += held - memories.intact_bonds();
        }
        state.skin.start(&state.particles.centres);
        state.is_listed = true;
        state.lists += 1;
        (self.halos).resize_with(state.patches.len(), Wrenches::default);
        self.tell_servos();
    }
}

/// F·v [W] with the mean of the velocities half a step before and after the force: on a plate that swings
/// on a spring nothing is left over then, step by step.
fn work(force: &[f64; 4], before: &[f64; 3], after: &[f64; 3]) -> f64 {
    if !WATCHES {
        return 0.0;
    }
    let axes = 0..3;
    axes.map(|axis| force[axis] * 0.5 * (before[axis] + after[axis]))
        .sum()
}
