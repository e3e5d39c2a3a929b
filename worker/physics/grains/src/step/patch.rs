//! A patch: some two thousand particles that are neighbours, with their contacts.
//!
//! Patches are what threads share out. A step has two phases: first every patch works through its
//! contacts, adding to its own particles and summing in its halo what acts on others'; then
//! every patch fetches what is for it from the halos, in a fixed order, and moves its bodies. How a
//! scene is cut into patches depends on the scene alone, so that results do not know how many
//! threads there were.
use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::alone::Shortest;
use crate::{
    contact::{
        Deepest, Passage, Scenery,
        lists::{Acting, Lists},
    },
    motion::{
        Drive, Wrenches,
        clump::{Clump, Members, Rotation},
        spheres::{PartlyFixed, Spheres, Turning},
        splitting::Turns,
    },
    numbers::{Vector, lanes::LANES, rows::Row},
};

/// Neighbouring particles; their contacts, those whose first particle is one of them, are in its
/// [`Lists`].
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Patch {
    pub(crate) particles: Range<usize>,
    pub(crate) clumps: Range<usize>,
    /// Its spheres that are fixed in part.
    pub(crate) partly_fixed: Vec<PartlyFixed>,
    /// Particles of later patches that it acts on: those of its halo, in order.
    pub(crate) others: Vec<u32>,
    /// What to fetch from the halos of earlier patches, patch by patch.
    pub(crate) incoming: Vec<Incoming>,
    /// On its particles, from the last step that was observed.
    #[serde(skip)]
    pub(crate) wrenches: Wrenches,
    /// On each wall, planes before meshes, from the last step [N]; the fourth number is the power of a
    /// mesh's turning [W].
    pub(crate) wall_forces: Vec<[f64; 4]>,
    /// Of its contacts since they were listed.
    pub(crate) deepest: Deepest,
    pub(crate) shortest: Shortest,
    /// Stiffness [N/m] and dashpots [N s/m] of all its candidates at each wall together; empty where no wall
    /// follows forces.
    pub(crate) at_plates: Vec<[f64; 2]>,
    /// What went through walls in the last step.
    #[serde(skip)]
    pub(crate) passed: Vec<Passage>,
}

/// The part of a halo that acts on particles of a patch.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Incoming {
    pub(crate) patch: usize,
    /// The first place in its halo.
    pub(crate) place: usize,
    /// On which it acts, counted from the patch's first.
    pub(crate) particles: Vec<u32>,
}

/// The bodies of one patch, for the second phase.
pub(crate) struct Bodies<'a> {
    pub(crate) centres: &'a mut [Row],
    pub(crate) velocities: &'a mut [Row],
    pub(crate) spins: &'a mut [Row],
    pub(crate) clumps: &'a mut [Clump],
    /// Body of each particle.
    pub(crate) owners: &'a [u32],
}

/// A force on a body beside its weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BodyLoad {
    pub(crate) body: u32,
    /// [N].
    pub(crate) force: Vector,
    /// About the centre of mass of a clump, where it acts elsewhere [N m].
    pub(crate) torque: Option<Vector>,
}

impl Patch {
    /// The first phase.
    pub(crate) fn push(
        &mut self,
        lists: &mut dyn Lists,
        scenery: Scenery<'_>,
        halo: &mut Wrenches,
        is_rough: bool,
    ) {
        self.wrenches.clear(self.particles.len(), is_rough);
        self.passed.clear();
        self.wall_forces.clear();
        let walls = scenery.faces.len() + scenery.poses.len();
        self.wall_forces.resize(walls, [0.0; 4]);
        // a bed of one patch was here a step ago
        if self.particles.len() < scenery.kinematics.centres.len() {
            scenery.kinematics.fetch(self.particles.clone());
        }
        halo.clear(self.others.len(), is_rough);
        let acting = Acting {
            first: self.particles.start,
            wrenches: &mut self.wrenches,
            halo,
            on_walls: &mut self.wall_forces,
            deepest: &mut self.deepest,
            passed: &mut self.passed,
        };
        lists.push(scenery, acting);
    }

    /// What its contacts were does not count.
    pub(crate) fn forget(&mut self) {
        self.deepest = Deepest::default();
    }

    /// The second phase. Returns the square of an upper bound of the speeds.
    pub(crate) fn advance(
        &mut self,
        bodies: Bodies<'_>,
        halos: &[Wrenches],
        drive: &Drive,
        rotation: Rotation,
        loads: &[BodyLoad],
    ) -> f64 {
        self.gather(halos, loads, bodies.clumps, bodies.owners);
        let first = self.particles.start;
        // before the members move: their arms are those of the forces
        for clumps in bodies.clumps.chunks_mut(LANES) {
            let mut turns = Turns::new(drive.time_step);
            let mut is_turning = [false; LANES];
            for (lane, clump) in clumps.iter_mut().enumerate() {
                let [mut force, mut torque] = clump.wrench(&self.wrenches, bodies.centres, first);
                for load in loads.iter().filter(|load| load.body == clump.body) {
                    force += load.force;
                    torque += load.torque.unwrap_or_default();
                }
                is_turning[lane] = clump.advance(drive, rotation, force, torque);
                turns.set(lane, clump);
            }
            turns.run();
            for (lane, clump) in clumps.iter_mut().enumerate() {
                if is_turning[lane] {
                    turns.give(lane, clump);
                }
            }
        }
        for sphere in &mut self.partly_fixed {
            sphere.note(bodies.centres, bodies.velocities, bodies.spins);
        }
        let mut squares = [0.0_f64; 3];
        for range in self.single_spheres(bodies.clumps) {
            if !bodies.spins.is_empty() {
                let turning = Turning {
                    drive,
                    torques: &self.wrenches.torques[range.clone()],
                    spins: &mut bodies.spins[range.clone()],
                };
                turning.advance();
            }
            let spheres = Spheres {
                drive,
                forces: &self.wrenches.forces[range.clone()],
                velocities: &mut bodies.velocities[range.clone()],
                centres: &mut bodies.centres[range],
            };
            for (most, square) in squares.iter_mut().zip(spheres.advance()) {
                *most = most.max(square);
            }
        }
        let mut speed_square: f64 = squares.iter().sum();
        for sphere in &self.partly_fixed {
            let step = drive.time_step;
            sphere.hold(step, bodies.centres, bodies.velocities, bodies.spins);
        }
        for clump in bodies.clumps {
            let members = &mut Members {
                centres: &mut *bodies.centres,
                velocities: &mut *bodies.velocities,
                spins: &mut *bodies.spins,
            };
            speed_square = speed_square.max(clump.place(members, first));
        }
        speed_square
    }

    /// Ranges of the particles that are no members of these clumps, counted from the patch's first.
    pub(crate) fn single_spheres(&self, clumps: &[Clump]) -> impl Iterator<Item = Range<usize>> {
        let first = self.particles.start;
        let mut next = first;
        let end = self.particles.end..self.particles.end;
        let members = clumps.iter().map(Clump::members).chain([end]);
        let gaps = members.map(move |members| {
            let gap = next - first..members.start - first;
            next = members.end;
            gap
        });
        gaps.filter(|gap| !gap.is_empty())
    }

    /// Completes the wrenches on its particles: what earlier patches do to them, and the loads on its
    /// bodies that are spheres. `clumps` and `owners`, the body of each particle, are its own.
    pub(crate) fn gather(
        &mut self,
        halos: &[Wrenches],
        loads: &[BodyLoad],
        clumps: &[Clump],
        owners: &[u32],
    ) {
        self.fetch(halos);
        // few bodies have one
        for load in loads {
            let is_clump = clumps.iter().any(|clump| clump.body == load.body);
            let place = owners.iter().position(|owner| *owner == load.body);
            if let Some(place) = place.filter(|_| !is_clump) {
                let [x, y, z] = load.force.into();
                self.wrenches.forces[place].add([x, y, z, 0.0]);
            }
        }
    }

    /// Adds what earlier patches do to its particles.
    fn fetch(&mut self, halos: &[Wrenches]) {
        for incoming in &self.incoming {
            let places = incoming.place..incoming.place + incoming.particles.len();
            let halo = &halos[incoming.patch];
            for (particle, place) in incoming.particles.iter().zip(places) {
                let particle = *particle as usize;
                self.wrenches.forces[particle].add(halo.forces[place].0);
                if let Some(torque) = halo.torques.get(place) {
                    self.wrenches.torques[particle].add(torque.0);
                }
            }
        }
    }
}

/// Force of all bodies on a wall in the last step [N], and the power of its turning [W].
pub(crate) fn on_wall(patches: &[Patch], wall: usize) -> [f64; 4] {
    let mut sum = [0.0; 4];
    for patch in patches {
        for (sum, part) in sum.iter_mut().zip(patch.wall_forces[wall]) {
            *sum += part;
        }
    }
    sum
}
