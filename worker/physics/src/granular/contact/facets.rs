//! Contacts of a sphere and facets.
//!
//! The sphere is a, the facet b: n points from the centre to the nearest point of the triangle, at a
//! distance d; δ = r − d. A facet is like a plane ([`walls`](super::walls)), with the sphere's radius
//! as its own and (G.7). By Yade's rule it has twice that radius in the stiffness, and slip is that
//! of the surfaces in the middle of the overlap:
//!
//!   v = v_b − v_a − (r − δ/2) ω_a × n (G.20)
//!
//! Candidates are listed by sphere, so that one sphere's facets are looked at together and features
//! that they share count once ([`once`](super::super::facets::once)). Where they are is found one by
//! one: most end at their distance from the triangle's plane. The law then works in vectors.
//!
//! Source: of (G.20) Yade's `Ig2_Facet_Sphere_ScGeom`.
use loadframe_api::surface::{Point, along, dot};
use pulp::Simd;
use serde::{Deserialize, Serialize};

use super::{
    Scenery, Slip, Touch, Wrenches,
    law::{Law, Past},
    stiffness::Springs,
};
use crate::granular::{
    facets::{
        FacetRule,
        once::{Near, last_heir},
    },
    lanes::{Array, LANES, Lanes, Vectors, bits},
    rows::Row,
};

/// Facets near one sphere; of padding the number is [`NONE`].
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(bound = "")]
#[repr(align(64))]
pub(in crate::granular) struct FacetBlock<F: Law> {
    pub(in crate::granular) facets: [u32; LANES],
    /// Constant of the normal spring: k_N [N/m] of a linear one.
    pub(in crate::granular) stiffness: Array,
    pub(in crate::granular) law: F,
}

/// No facet.
pub(in crate::granular) const NONE: u32 = u32::MAX;

/// A sphere and how many blocks of facets are near it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(in crate::granular) struct Visitor {
    pub(in crate::granular) particle: u32,
    pub(in crate::granular) blocks: u32,
}

/// Candidates of a patch's spheres and which of them touched in the last step.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(bound = "")]
pub(in crate::granular) struct FacetList<F: Law> {
    pub(in crate::granular) visitors: Vec<Visitor>,
    /// Blocks of one visitor after those of another.
    pub(in crate::granular) blocks: Vec<FacetBlock<F>>,
    /// Bits by lane.
    pub(in crate::granular) touching: Vec<u8>,
    /// Candidates, padding not counted.
    pub(in crate::granular) count: usize,
    /// What the sphere at work reaches.
    #[serde(skip)]
    near: Vec<Near>,
}

/// A facet near a sphere, what they are made of, and what they remember.
pub(in crate::granular) type FacetCandidate = (u32, Springs, Option<Past>);

/// The facets of a block that a sphere touches, as the law wants them.
#[derive(Clone, Debug, Default)]
struct Touched {
    /// 1 where it touches, else 0.
    touches: Array,
    normal: [Array; 3],
    overlap: Array,
    /// Of the wall at the place of contact [m/s].
    velocity: [Array; 3],
    /// Factor α on the velocities.
    approach: Array,
    /// Arm of the sphere's spin [m].
    arm: Array,
}

impl<F: Law> Default for FacetBlock<F> {
    fn default() -> Self {
        Self {
            facets: [NONE; LANES],
            stiffness: [0.0; LANES],
            law: F::default(),
        }
    }
}

impl<F: Law> FacetList<F> {
    /// Adds the forces on the particles of a patch that begins with `first`, and to `on_meshes` the
    /// force on each mesh [N] and the power of its turning [W].
    #[inline(always)]
    pub(in crate::granular) fn push<S: Simd>(
        &mut self,
        simd: S,
        scenery: Scenery<'_>,
        first: usize,
        wrenches: &mut Wrenches,
        on_meshes: &mut [[f64; 4]],
    ) {
        let mut end = 0;
        for visitor in &self.visitors {
            let range = end..end + visitor.blocks as usize;
            end = range.end;
            let particle = visitor.particle as usize;
            let sphere = &scenery.kinematics.centres[particle];
            let blocks = &mut self.blocks[range.clone()];
            let touching = &mut self.touching[range];
            reach(scenery, sphere, blocks, &mut self.near);
            if self.near.is_empty() && touching.iter().all(|bits| *bits == 0) {
                continue;
            }
            if scenery.facets.rule == FacetRule::Once && self.near.len() > 1 {
                scenery
                    .facets
                    .settle(scenery.poses, &mut self.near, sphere.0[3]);
                if F::IS_ROUGH {
                    hand_over(&self.near, blocks, touching);
                }
            }
            for (number, (block, touching)) in blocks.iter_mut().zip(touching).enumerate() {
                let slots = number * LANES..(number + 1) * LANES;
                let here =
                    |near: &&Near| slots.contains(&(near.slot as usize)) && near.heir.is_none();
                let touched = scenery.touched(sphere, self.near.iter().filter(here));
                let facets = block.facets;
                *touching = block.advance(
                    simd,
                    scenery,
                    particle,
                    &touched,
                    *touching,
                    #[inline(always)]
                    |lane: usize, force: [f64; 4], moment: [f64; 4]| {
                        if touched.touches[lane] == 0.0 {
                            return;
                        }
                        wrenches.forces[particle - first].subtract(force);
                        if F::IS_ROUGH {
                            wrenches.torques[particle - first].subtract(moment);
                        }
                        let facet = &scenery.facets.facets[facets[lane] as usize];
                        let on_mesh = &mut on_meshes[facet.mesh as usize];
                        for axis in 0..3 {
                            on_mesh[axis] += force[axis];
                        }
                        let pose = &scenery.poses[facet.mesh as usize];
                        if pose.is_turning() {
                            let place = touched.place(sphere, lane);
                            let velocity = pose.turning_velocity(&place);
                            on_mesh[3] += dot(&[force[0], force[1], force[2]], &velocity);
                        }
                    },
                );
            }
        }
    }

    /// Sphere, facet, block and lane of the contacts that touched in the last step.
    pub(in crate::granular) fn touching(
        &self,
    ) -> impl Iterator<Item = (usize, &FacetBlock<F>, usize)> {
        let spheres = self.visitors.iter().flat_map(|visitor| {
            std::iter::repeat_n(visitor.particle as usize, visitor.blocks as usize)
        });
        let blocks = self.blocks.iter().zip(&self.touching);
        spheres.zip(blocks).flat_map(|(sphere, (block, touching))| {
            super::touching_lanes(*touching).map(move |lane| (sphere, block, lane))
        })
    }
}

impl<F: Law> FacetList<F> {
    /// Adds a sphere with its candidates, if it has any.
    pub(super) fn add(&mut self, particle: u32, candidates: &[FacetCandidate]) {
        let first = self.blocks.len();
        for (slot, (facet, springs, past)) in candidates.iter().enumerate() {
            let lane = slot % LANES;
            if lane == 0 {
                self.blocks.push(FacetBlock::default());
                self.touching.push(0);
            }
            self.count += 1;
            if let (Some(block), Some(touching)) =
                (self.blocks.last_mut(), self.touching.last_mut())
            {
                block.facets[lane] = *facet;
                block.stiffness[lane] = springs.normal;
                block.law.start(lane, springs, &past.unwrap_or_default());
                *touching |= u8::from(past.is_some()) << lane;
            }
        }
        let blocks = (self.blocks.len() - first) as u32;
        if blocks > 0 {
            self.visitors.push(Visitor { particle, blocks });
        }
    }
}

/// What a sphere reaches of its candidates.
fn reach<F: Law>(
    scenery: Scenery<'_>,
    sphere: &Row,
    blocks: &[FacetBlock<F>],
    near: &mut Vec<Near>,
) {
    near.clear();
    for (number, block) in blocks.iter().enumerate() {
        for (lane, facet) in block.facets.iter().enumerate() {
            if *facet != NONE {
                let slot = (number * LANES + lane) as u32;
                near.extend((scenery.facets).reach(scenery.poses, sphere, slot, *facet));
            }
        }
    }
}

/// What takes a contact's place takes over what it remembers.
fn hand_over<F: Law>(near: &[Near], blocks: &mut [FacetBlock<F>], touching: &mut [u8]) {
    for place in 0..near.len() {
        let heir = last_heir(near, place);
        let [own, next] = [place, heir].map(|place| near[place].slot as usize);
        let bit = |slot: usize| 1_u8 << (slot % LANES);
        let is_taken = |touching: &[u8], slot: usize| touching[slot / LANES] & bit(slot) != 0;
        if heir == place || !is_taken(touching, own) || is_taken(touching, next) {
            continue;
        }
        let past = blocks[own / LANES].law.past(own % LANES);
        blocks[next / LANES].law.remember(next % LANES, &past);
        touching[next / LANES] |= bit(next);
    }
}

impl Scenery<'_> {
    /// The facets that count among those of one block.
    fn touched<'n>(&self, sphere: &Row, near: impl Iterator<Item = &'n Near>) -> Touched {
        let mut touched = Touched::default();
        let radius = sphere.0[3];
        for near in near {
            let lane = near.slot as usize % LANES;
            let overlap = radius - near.distance;
            touched.touches[lane] = 1.0;
            touched.overlap[lane] = overlap;
            (touched.approach[lane], touched.arm[lane]) = match self.facets.rule {
                FacetRule::Once => ((radius + radius) / (radius + radius - overlap), radius),
                FacetRule::Each => (1.0, radius - 0.5 * overlap),
            };
            let pose = &self.poses[self.facets.facets[near.facet as usize].mesh as usize];
            let velocity = if pose.is_turning() {
                let turning = pose.turning_velocity(&near.point);
                along(&turning, &pose.motion.velocity, 1.0)
            } else {
                pose.motion.velocity
            };
            for (axis, velocity) in velocity.into_iter().enumerate() {
                touched.normal[axis][lane] = near.normal[axis];
                touched.velocity[axis][lane] = velocity;
            }
        }
        touched
    }
}

impl Touched {
    /// Where the sphere touches in this lane [m].
    fn place(&self, sphere: &Row, lane: usize) -> Point {
        let [x, y, z, radius] = sphere.0;
        let normal = [0, 1, 2].map(|axis: usize| self.normal[axis][lane]);
        along(&[x, y, z], &normal, radius - self.overlap[lane])
    }
}

impl<F: Law> FacetBlock<F> {
    /// Advances the contacts by a step. Gives `act` the force on the facet and its moment about the
    /// particle's centre. Returns which lanes touch.
    #[inline(always)]
    fn advance<S: Simd>(
        &mut self,
        simd: S,
        scenery: Scenery<'_>,
        particle: usize,
        touched: &Touched,
        before: u8,
        mut act: impl FnMut(usize, [f64; 4], [f64; 4]),
    ) -> u8 {
        let (kinematics, time_step) = (scenery.kinematics, scenery.time_step);
        let none = Lanes::splat(simd, 0.0);
        let radius = Lanes::splat(simd, kinematics.centres[particle].0[3]);
        let mut touching = 0;
        for part in 0..LANES / S::F64_LANES {
            let is_touching = none.below(Lanes::load(simd, &touched.touches, part));
            if bits::<S>(is_touching, 0) == 0 {
                if before != 0 {
                    self.law.forget(simd, part);
                }
                continue;
            }
            let normal = Vectors::load(simd, &touched.normal, part);
            let overlap = Lanes::load(simd, &touched.overlap, part);
            let touch = Touch {
                normal,
                overlap,
                reach: radius + radius,
                stiffness: Lanes::load(simd, &self.stiffness, part),
                is_touching,
            };
            let mut slip = Slip::none(simd);
            if F::FEELS_SPEED {
                let of_sphere = |rows: &[Row]| {
                    let [x, y, z, _] = rows[particle].0;
                    Vectors::splat(simd, [x, y, z])
                };
                let wall = Vectors::load(simd, &touched.velocity, part);
                let relative = wall - of_sphere(kinematics.velocities);
                slip.approach = relative.dot(normal);
                if F::IS_ROUGH {
                    let spin = of_sphere(kinematics.spins);
                    let approach = Lanes::load(simd, &touched.approach, part);
                    let arm = Lanes::load(simd, &touched.arm, part);
                    let velocity = relative.scaled(approach) - spin.scaled(arm).cross(normal);
                    slip.velocity = velocity - normal.scaled(velocity.dot(normal));
                    slip.spins = spin;
                }
            }
            let push = self.law.advance(simd, part, touch, slip, time_step);
            touching |= bits::<S>(push.acts, part);
            push.against_wall(simd, part, &touch, radius, &mut act);
        }
        touching
    }
}
