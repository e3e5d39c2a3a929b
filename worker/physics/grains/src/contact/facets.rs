//! Contacts of a sphere and facets.
//!
//! The sphere is a, the facet b: n points from the centre to the nearest point of the triangle, at a
//! distance d; δ = r − d. A facet is like a plane ([`planes`](super::planes)), with the sphere's radius
//! as its own and (G.7). By Yade's rule it has twice that radius in the stiffness, and slip is that
//! of the surfaces in the middle of the overlap:
//!
//!   v = v_b − v_a − (r − δ/2) ω_a × n (G.20)
//!
//! Candidates are listed by sphere, so that one sphere's facets are looked at together and features
//! that they share count once ([`once`](crate::walls::facets::once)). Where they are is found one by
//! one: most end at their distance from the triangle's plane. The law then works in vectors, each as
//! soon as all spheres in it were looked at.
//!
//! Source: of (G.20) Yade's `Ig2_Facet_Sphere_ScGeom`.
use std::ops::Range;

use loadframe_api::surface::{Point, along, dot, minus};
use pulp::Simd;

use super::{
    Depths, Passage, Scenery, Slip, Touch,
    blocks::{Before, Block, Blocks, Ends},
    law::Law,
    packed::Columns,
    past::Past,
    stiffness::Springs,
};
use crate::{
    motion::Wrenches,
    numbers::{
        lanes::{Array, LANES, Lanes, Vectors, any, bits},
        rows::{Row, gather},
    },
    walls::facets::{
        FacetRule, Facets,
        once::{Near, last_heir},
    },
};

/// Spheres and facets of a block.
#[derive(Clone, Debug, Default)]
pub(super) struct Visits {
    pub(super) particles: [u32; LANES],
    pub(super) facets: [u32; LANES],
}

type FacetBlock<F> = Block<Visits, F>;

/// Candidates of a patch's spheres.
#[derive(Clone, Debug, Default)]
pub(super) struct FacetList<F: Law> {
    /// How many facets are near each sphere that has any.
    pub(super) visitors: Vec<u32>,
    /// Candidates of one sphere after those of another, without a gap.
    pub(super) list: Blocks<Visits, F>,
    /// What the sphere at work reaches.
    near: Vec<Near>,
    /// What counts of that in blocks that wait for their last sphere, by slot.
    reached: Vec<Near>,
}

impl Ends for Visits {
    type Lane = [u32; 2];

    /// It belongs to no sphere that is looked at.
    fn padding([particle, _]: [u32; 2]) -> Self {
        Self {
            particles: [particle; LANES],
            facets: [0; LANES],
        }
    }

    fn set(&mut self, lane: usize, ends: [u32; 2]) {
        [self.particles[lane], self.facets[lane]] = ends;
    }

    fn show(&mut self, columns: &mut dyn Columns) {
        columns.ends(&mut self.particles);
        columns.ends(&mut self.facets);
    }
}

/// Centres farther from a facet than this part of their radius are not asked whether they went through it:
/// in a step nothing moves by more than a tenth.
const NEAR_PASSING: f64 = 0.25;
/// |n·n_facet| of a centre that is before the face of a triangle, and not beside its edge.
const ON_FACE: f64 = 0.999;

/// A facet near a sphere, what they are made of, and what they remember.
pub(crate) type FacetCandidate = (u32, Springs, Option<Past>);

/// What the contacts of a patch with facets act on.
#[derive(Debug)]
pub(super) struct Sides<'a, S: Simd> {
    /// First particle of the patch.
    pub(super) first: usize,
    /// On its particles.
    pub(super) wrenches: &'a mut Wrenches,
    /// On each mesh [N]; the fourth number is the power of its turning [W].
    pub(super) on_meshes: &'a mut [[f64; 4]],
    pub(super) depths: &'a mut Depths<S>,
    pub(super) passed: &'a mut Vec<Passage>,
}

/// The facets of a block that are touched, as the law wants them.
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

impl<F: Law> FacetList<F> {
    /// Adds the forces on both sides.
    #[inline(always)]
    pub(super) fn push<S: Simd>(&mut self, simd: S, scenery: Scenery<'_>, mut sides: Sides<'_, S>) {
        let (mut slot, mut pushed) = (0, 0);
        for visitor in 0..self.visitors.len() {
            slot = self.look(scenery, self.visitors[visitor], slot);
            let is_last = slot == self.list.state.count;
            let whole = if is_last {
                self.list.blocks.len()
            } else {
                slot / LANES
            };
            for block in pushed..whole {
                self.push_block(simd, scenery, block, &mut sides);
            }
            pushed = whole;
        }
    }

    /// Finds out which facets a sphere touches, so many of whose candidates begin at `slot`; returns
    /// where they end.
    fn look(&mut self, scenery: Scenery<'_>, candidates: u32, slot: usize) -> usize {
        let particle = self.list.blocks[slot / LANES].ends.particles[slot % LANES];
        let sphere = &scenery.kinematics.centres[particle as usize];
        let end = slot + candidates as usize;
        self.near.clear();
        for slot in slot..end {
            let facet = self.list.blocks[slot / LANES].ends.facets[slot % LANES];
            let near = (scenery.facets).reach(scenery.poses, sphere, slot as u32, facet);
            self.near.extend(near);
        }
        if scenery.facets.rule == FacetRule::Once && self.near.len() > 1 {
            (scenery.facets).settle(scenery.poses, &mut self.near, sphere.0[3]);
            if F::IS_ROUGH || F::FEELS_SPEED {
                hand_over(scenery.facets, &self.near, &mut self.list);
            }
        }
        if scenery.facets.rule == FacetRule::Once && F::IS_ROUGH && self.list.has_frictions() {
            self.take_friction_along(scenery, sphere, slot..end);
        }
        let counting = self.near.iter().filter(|near| near.heir.is_none());
        self.reached.extend(counting);
        end
    }

    /// Gives the friction of a contact that the sphere left in this step to the one it came to: a light contact
    /// of a fast sphere is so small that it reaches both triangles in no step. The springs of such a
    /// contact are strained anew within a step of sliding; nothing else is handed over.
    fn take_friction_along(&mut self, scenery: Scenery<'_>, sphere: &Row, slots: Range<usize>) {
        let (list, near) = (&mut self.list, &self.near);
        let is_new = |list: &Blocks<Visits, F>, near: &Near| {
            near.heir.is_none() && !list.touched(near.slot as usize)
        };
        // hardly ever
        if !near.iter().any(|near| is_new(list, near)) {
            return;
        }
        let facets = scenery.facets;
        for left in slots {
            if !list.touched(left) || near.iter().any(|near| near.slot as usize == left) {
                continue;
            }
            let facet = list.blocks[left / LANES].ends.facets[left % LANES];
            let Some(next) = facets.goes_on(scenery.poses, sphere, facet, near) else {
                continue;
            };
            let next = &near[last_heir(near, next)];
            if is_new(list, next) && facets.surface_of(facet) == facets.surface_of(next.facet) {
                list.hand_friction(left, next.slot as usize);
            }
        }
    }

    /// Adds the forces of a block's contacts, the first of those reached.
    #[inline(always)]
    fn push_block<S: Simd>(
        &mut self,
        simd: S,
        scenery: Scenery<'_>,
        number: usize,
        sides: &mut Sides<'_, S>,
    ) {
        let next = (number + 1) * LANES;
        let end = (self.reached).partition_point(|near| (near.slot as usize) < next);
        let (block, touching, before) = self.list.take(number);
        if end == 0 && *touching == 0 {
            return;
        }
        let (particles, facets) = (block.ends.particles, block.ends.facets);
        let touched = scenery.touched(&particles, &self.reached[..end], sides.passed);
        *touching = block.advance(
            simd,
            scenery,
            &touched,
            before,
            sides.depths,
            #[inline(always)]
            |lane: usize, force: [f64; 4], moment: [f64; 4], resisting: Option<[f64; 4]>| {
                if touched.touches[lane] == 0.0 {
                    return;
                }
                let particle = particles[lane] as usize;
                let own = particle - sides.first;
                sides.wrenches.forces[own].subtract(force);
                if F::IS_ROUGH {
                    sides.wrenches.torques[own].subtract(moment);
                }
                let facet = &scenery.facets.facets[facets[lane] as usize];
                let on_mesh = &mut sides.on_meshes[facet.mesh as usize];
                for axis in 0..3 {
                    on_mesh[axis] += force[axis];
                }
                let pose = &scenery.poses[facet.mesh as usize];
                if pose.is_turning() {
                    let place = touched.place(&scenery.kinematics.centres[particle], lane);
                    let velocity = pose.turning_velocity(&place);
                    on_mesh[3] += dot(&[force[0], force[1], force[2]], &velocity);
                    if let Some([x, y, z, _]) = resisting {
                        on_mesh[3] += dot(&[x, y, z], &pose.spin());
                    }
                }
            },
        );
        self.reached.drain(..end);
    }
}

impl<F: Law> FacetList<F> {
    /// Adds a sphere with its candidates, if it has any.
    pub(super) fn add(&mut self, particle: u32, candidates: &[FacetCandidate]) {
        for (facet, springs, past) in candidates {
            self.list.add([particle, *facet], springs, past.as_ref());
        }
        if !candidates.is_empty() {
            self.visitors.push(candidates.len() as u32);
        }
    }

    pub(super) fn finish(&mut self) {
        self.visitors.shrink_to_fit();
        self.list.finish();
    }

    /// Memory [bytes].
    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.visitors.as_slice()) + self.list.bytes()
    }
}

/// What takes a contact's place takes over what it remembers.
fn hand_over<F: Law>(facets: &Facets, near: &[Near], list: &mut Blocks<Visits, F>) {
    for place in 0..near.len() {
        let heir = last_heir(near, place);
        let [own, next] = [place, heir].map(|place| near[place].slot as usize);
        let bit = |slot: usize| 1_u8 << (slot % LANES);
        let touching = &mut list.state.touching;
        let is_taken = |touching: &[u8], slot: usize| touching[slot / LANES] & bit(slot) != 0;
        if heir == place || !is_taken(touching, own) || is_taken(touching, next) {
            continue;
        }
        let past = list.blocks[own / LANES].law.past(own % LANES);
        list.blocks[next / LANES].law.remember(next % LANES, &past);
        touching[next / LANES] |= bit(next);
        // on one material it may only be another where contacts keep theirs; another rubs in its own way
        let [from, to] = [place, heir].map(|place| facets.surface_of(near[place].facet));
        if F::IS_ROUGH && from == to {
            list.hand_friction(own, next);
        }
    }
}

impl Scenery<'_> {
    /// What a block's particles touch, and which of them went through it in the last step.
    fn touched(
        &self,
        particles: &[u32; LANES],
        reached: &[Near],
        passed: &mut Vec<Passage>,
    ) -> Touched {
        let mut touched = Touched::default();
        for near in reached {
            let lane = near.slot as usize % LANES;
            let radius = self.kinematics.centres[particles[lane] as usize].0[3];
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
            if near.distance < NEAR_PASSING * radius
                && self.has_passed(particles[lane], near, &velocity)
            {
                let mesh = self.facets.facets[near.facet as usize].mesh;
                let wall = self.faces.len() as u32 + mesh;
                passed.push(Passage {
                    particle: particles[lane],
                    wall,
                });
            }
            for (axis, velocity) in velocity.into_iter().enumerate() {
                touched.normal[axis][lane] = near.normal[axis];
                touched.velocity[axis][lane] = velocity;
            }
        }
        touched
    }
}

impl Scenery<'_> {
    /// Spins of the walls of these facets [rad/s].
    fn spins(&self, facets: &[u32; LANES]) -> [Array; 3] {
        let mut spins = [[0.0; LANES]; 3];
        for (lane, facet) in facets.iter().enumerate() {
            let mesh = self.facets.facets[*facet as usize].mesh;
            let spin = self.poses[mesh as usize].spin();
            for axis in 0..3 {
                spins[axis][lane] = spin[axis];
            }
        }
        spins
    }

    /// Whether a sphere's centre went through the face of a facet in the last step; the wall has this
    /// velocity there [m/s]. A centre that goes by outside an edge has its normal along the triangle.
    #[cold]
    fn has_passed(&self, particle: u32, near: &Near, wall: &Point) -> bool {
        let facet = &self.facets.facets[near.facet as usize];
        let upward = self.poses[facet.mesh as usize].direction(&facet.normal);
        let facing = -dot(&near.normal, &upward);
        let [x, y, z, _] = self.kinematics.velocities[particle as usize].0;
        let parting = dot(&minus(&[x, y, z], wall), &upward);
        let height = facing * near.distance;
        let before = height - self.kinematics.last_step * parting;
        facing.abs() > ON_FACE && height * before < 0.0
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
    /// particle's centre, see [`Push::against_wall`](super::Push). Returns which lanes touch.
    #[inline(always)]
    fn advance<S: Simd>(
        &mut self,
        simd: S,
        scenery: Scenery<'_>,
        touched: &Touched,
        before: Before<'_>,
        depths: &mut Depths<S>,
        mut act: impl FnMut(usize, [f64; 4], [f64; 4], Option<[f64; 4]>),
    ) -> u8 {
        let kinematics = scenery.kinematics;
        let none = Lanes::splat(simd, 0.0);
        let mut touching = 0;
        for part in 0..LANES / S::F64_LANES {
            let is_touching = none.below(Lanes::load(simd, &touched.touches, part));
            if !any::<S>(is_touching) {
                if before.touched != 0 {
                    self.law.forget(simd, part);
                }
                continue;
            }
            let radius = gather(simd, kinematics.centres, &self.ends.particles, part).fourth;
            let normal = Vectors::load(simd, &touched.normal, part);
            let overlap = Lanes::load(simd, &touched.overlap, part);
            let [shear_ratio, friction] = before.tangent.load(simd, part);
            let touch = Touch {
                normal,
                overlap,
                reach: radius + radius,
                stiffness: Lanes::load(simd, &self.stiffness, part),
                shear_ratio,
                friction,
                is_touching,
            };
            let mut slip = Slip::none(simd);
            if F::FEELS_SPEED {
                let velocity =
                    gather(simd, kinematics.velocities, &self.ends.particles, part).vector;
                let wall = Vectors::load(simd, &touched.velocity, part);
                let relative = wall - velocity;
                slip.approach = relative.dot(normal);
                if F::IS_ROUGH {
                    let spin = gather(simd, kinematics.spins, &self.ends.particles, part).vector;
                    let approach = Lanes::load(simd, &touched.approach, part);
                    let arm = Lanes::load(simd, &touched.arm, part);
                    let velocity = relative.scaled(approach) - spin.scaled(arm).cross(normal);
                    slip.velocity = velocity - normal.scaled(velocity.dot(normal));
                    slip.spins = spin;
                    if F::RESISTS_ROLLING {
                        let wall = scenery.spins(&self.ends.facets);
                        slip.rolling = Vectors::load(simd, &wall, part) - spin;
                    }
                }
            }
            let push = self
                .law
                .advance(simd, part, touch, slip, kinematics.time_step);
            touching |= bits::<S>(push.acts, part);
            push.tell(simd, radius, depths);
            push.against_wall(simd, part, &touch, radius, &mut act);
        }
        touching
    }
}
