//! A patch: some two thousand particles that are neighbours, with their contacts.
//!
//! Patches are what threads share out. A step has two phases: first every patch works through its
//! contacts, adding to its own particles and keeping in its [`Halo`] what acts on others'; then
//! every patch fetches what is for it from the halos, in a fixed order, and moves its bodies. How a
//! scene is cut into patches depends on the scene alone, so that results do not know how many
//! threads there were.
use std::ops::Range;

use pulp::{Arch, Simd, WithSimd};
use serde::{Deserialize, Serialize};

use super::{
    Vector,
    contact::{
        Kinematics, Wrenches,
        facets::{FacetList, Scenery},
        law::Law,
        pairs::{Halo, PairList},
        walls::{Face, WallList},
    },
    facets::{Facets, Pose},
    motion::{
        Drive,
        clump::{Clump, Members, Rotation},
        spheres::{PartlyFixed, Spheres, Turning},
    },
    rows::Row,
};

/// Neighbouring particles and the contacts whose first particle is one of them.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(bound = "")]
pub(super) struct Patch<F: Law> {
    pub(super) particles: Range<usize>,
    pub(super) clumps: Range<usize>,
    /// Contacts within the patch.
    pub(super) inner: PairList<F>,
    /// Contacts with particles of later patches.
    pub(super) outer: PairList<F>,
    /// Contacts by plane.
    pub(super) walls: Vec<WallList<F>>,
    /// Contacts with the facets of all meshes.
    pub(super) facets: FacetList<F>,
    /// Its spheres that are fixed in part.
    pub(super) partly_fixed: Vec<PartlyFixed>,
    /// What to fetch from the halos of earlier patches, patch by patch.
    pub(super) incoming: Vec<Incoming>,
    /// On its particles, from the last step that was observed.
    #[serde(skip)]
    pub(super) wrenches: Wrenches,
    /// On each wall, planes before meshes, from the last step [N]; the fourth number is the power of a
    /// mesh's turning [W].
    pub(super) wall_forces: Vec<[f64; 4]>,
}

/// Entries of a halo that act on particles of a patch.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Incoming {
    pub(super) patch: usize,
    /// Place in the halo, and particle counted from the patch's first.
    pub(super) entries: Vec<[u32; 2]>,
}

/// The first phase for one patch.
pub(super) struct Push<'a, F: Law> {
    pub(super) patch: &'a mut Patch<F>,
    pub(super) halo: &'a mut Halo,
    pub(super) kinematics: Kinematics<'a>,
    pub(super) faces: &'a [Face],
    pub(super) facets: &'a Facets,
    pub(super) poses: &'a [Pose],
    pub(super) time_step: f64,
}

impl<F: Law> Push<'_, F> {
    /// Works through the contacts in the widest vectors of this machine.
    pub(super) fn run(self) {
        Arch::new().dispatch(self);
    }
}

impl<F: Law> WithSimd for Push<'_, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self {
            patch,
            halo,
            kinematics,
            faces,
            facets,
            poses,
            time_step,
        } = self;
        let first = patch.particles.start;
        let wrenches = &mut patch.wrenches;
        wrenches.clear(patch.particles.len(), F::IS_ROUGH);
        (patch.inner).push_inner(simd, kinematics, first, wrenches, time_step);
        (patch.outer).push_outer(simd, kinematics, first, wrenches, halo, time_step);
        patch.wall_forces.clear();
        for (list, face) in patch.walls.iter_mut().zip(faces) {
            let force = list.push(simd, face, kinematics, first, wrenches, time_step);
            patch.wall_forces.push(force);
        }
        patch
            .wall_forces
            .resize(faces.len() + poses.len(), [0.0; 4]);
        let scenery = Scenery {
            facets,
            poses,
            kinematics,
            time_step,
        };
        let on_meshes = &mut patch.wall_forces[faces.len()..];
        (patch.facets).push(simd, scenery, first, wrenches, on_meshes);
    }
}

/// The bodies of one patch, for the second phase.
pub(super) struct Bodies<'a> {
    pub(super) centres: &'a mut [Row],
    pub(super) velocities: &'a mut [Row],
    pub(super) spins: &'a mut [Row],
    pub(super) clumps: &'a mut [Clump],
    /// Body of each particle.
    pub(super) owners: &'a [u32],
}

/// A force on a body's centre of mass beside its weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BodyLoad {
    pub(super) body: u32,
    /// [N].
    pub(super) force: Vector,
}

impl<F: Law> Patch<F> {
    /// Strength a_N [N] and spring k_N [N/m] of each intact bond.
    pub(super) fn bonds(&self) -> impl Iterator<Item = (f64, f64)> {
        let held = self.inner.touching().chain(self.outer.touching());
        let bonds = held.map(|(block, lane)| (block.law.past(lane).bond, block.stiffness[lane]));
        let intact = bonds.filter(|(bond, _)| bond.is_intact);
        intact.map(|(bond, stiffness)| (bond.strength[0], stiffness))
    }

    /// Multiplies tan φ of all contacts.
    pub(super) fn rub(&mut self, factor: f64) {
        let pairs = self.inner.blocks.iter_mut().chain(&mut self.outer.blocks);
        pairs.for_each(|block| block.law.rub(factor));
        let walls = self.walls.iter_mut().flat_map(|list| &mut list.blocks);
        walls.for_each(|block| block.law.rub(factor));
        let facets = self.facets.blocks.iter_mut();
        facets.for_each(|block| block.law.rub(factor));
    }

    /// The second phase. Returns the square of an upper bound of the speeds.
    pub(super) fn advance(
        &mut self,
        bodies: Bodies<'_>,
        halos: &[Halo],
        drive: &Drive,
        rotation: Rotation,
        loads: &[BodyLoad],
    ) -> f64 {
        self.fetch(halos);
        let first = self.particles.start;
        self.load_spheres(&bodies, loads);
        // before the members move: their arms are those of the forces
        for clump in &mut *bodies.clumps {
            let [mut force, torque] = clump.wrench(&self.wrenches, bodies.centres, first);
            for load in loads.iter().filter(|load| load.body == clump.body) {
                force += load.force;
            }
            clump.advance(drive, rotation, force, torque);
        }
        for sphere in &mut self.partly_fixed {
            sphere.note(bodies.centres, bodies.velocities, bodies.spins);
        }
        if F::IS_ROUGH {
            let turning = Turning {
                drive,
                torques: &self.wrenches.torques,
                spins: &mut *bodies.spins,
            };
            turning.advance();
        }
        let spheres = Spheres {
            drive,
            forces: &self.wrenches.forces,
            velocities: &mut *bodies.velocities,
            centres: &mut *bodies.centres,
        };
        let mut speed_square: f64 = spheres.advance().iter().sum();
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

    /// Adds the loads on bodies that are spheres; few bodies have one.
    fn load_spheres(&mut self, bodies: &Bodies<'_>, loads: &[BodyLoad]) {
        for load in loads {
            let is_clump = bodies.clumps.iter().any(|clump| clump.body == load.body);
            let place = bodies.owners.iter().position(|owner| *owner == load.body);
            if let Some(place) = place.filter(|_| !is_clump) {
                let [x, y, z] = load.force.into();
                self.wrenches.forces[place].add([x, y, z, 0.0]);
            }
        }
    }

    fn fetch(&mut self, halos: &[Halo]) {
        for incoming in &self.incoming {
            let halo = &halos[incoming.patch];
            for [place, particle] in &incoming.entries {
                let (place, particle) = (*place as usize, *particle as usize);
                self.wrenches.forces[particle].add(halo.forces[place].0);
                if F::IS_ROUGH {
                    self.wrenches.torques[particle].add(halo.torques[place].0);
                }
            }
        }
    }
}
