//! Contacts of a sphere and a plane.
//!
//! The sphere is a, the plane b: n is the plane's normal into the wall, δ = r − h with height h of
//! the centre above the plane, and the plane has the sphere's radius as its own (stiffness, slip):
//!
//!   v = α (v_b − v_a) − r ω_a × n, α = 2r/(2r − δ) (G.7)
//!
//! All candidates of a block touch the same plane, so that the normal is one for all and never
//! turns. Source: Yade's `Ig2_Wall_Sphere_ScGeom`.
use pulp::Simd;

use super::{
    Deepest, Depths, Kinematics, Passage, Slip, Touch,
    blocks::{Before, Block, Blocks, Ends},
    law::Law,
    packed::Columns,
};
use crate::{
    motion::Wrenches,
    numbers::{
        lanes::{LANES, Lanes, Vectors, any, bits},
        rows::gather,
    },
    walls::Face,
};

/// Spheres of a block.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Visitors(pub(super) [u32; LANES]);

type WallBlock<F> = Block<Visitors, F>;

/// Candidates of one plane.
#[derive(Clone, Debug, Default)]
pub(super) struct WallList<F: Law> {
    pub(super) list: Blocks<Visitors, F>,
}

impl Ends for Visitors {
    type Lane = u32;

    /// It has no stiffness.
    fn padding(particle: u32) -> Self {
        Self([particle; LANES])
    }

    fn set(&mut self, lane: usize, particle: u32) {
        self.0[lane] = particle;
    }

    fn show(&mut self, columns: &mut dyn Columns) {
        columns.ends(&mut self.0);
    }
}

impl<F: Law> WallList<F> {
    /// Adds the forces on the particles; returns the force on the plane [N].
    #[inline(always)]
    pub(super) fn push<S: Simd>(
        &mut self,
        simd: S,
        face: &Face,
        kinematics: Kinematics<'_>,
        first: usize,
        wrenches: &mut Wrenches,
        depths: &mut Depths<S>,
    ) -> [f64; 4] {
        let mut on_plane = [0.0; 4];
        for number in 0..self.list.blocks.len() {
            let (block, touching, before) = self.list.take(number);
            let Visitors(particles) = block.ends;
            *touching = block.advance(
                simd,
                face,
                kinematics,
                before,
                depths,
                #[inline(always)]
                |lane: usize, force: [f64; 4], moment: [f64; 4], _: Option<[f64; 4]>| {
                    let particle = particles[lane] as usize - first;
                    wrenches.forces[particle].subtract(force);
                    if F::IS_ROUGH {
                        wrenches.torques[particle].subtract(moment);
                    }
                    for (sum, part) in on_plane.iter_mut().zip(force) {
                        *sum += part;
                    }
                },
            );
        }
        on_plane
    }

    /// Adds the particles whose centres went behind the plane in the last step; `wall` is its number. Only
    /// where a contact of the patch was ever as deep is there anything to look for.
    pub(super) fn see_passages(
        &self,
        face: &Face,
        kinematics: Kinematics<'_>,
        wall: u32,
        deepest: &Deepest,
        passed: &mut Vec<Passage>,
    ) {
        if deepest.ratio < 1.0 {
            return;
        }
        let blocks = self.list.blocks.iter().zip(&self.list.state.touching);
        for (block, bits) in blocks {
            for lane in (0..LANES).filter(|lane| bits >> lane & 1 == 1) {
                let particle = block.ends.0[lane];
                let height = face.height(&kinematics.centres[particle as usize].0);
                let velocity = kinematics.velocities[particle as usize].0[face.axis];
                let parting = (velocity - face.motion.velocity[face.axis]) * face.facing;
                let before = height - kinematics.last_step * parting;
                if height < 0.0 && before >= 0.0 {
                    passed.push(Passage { particle, wall });
                }
            }
        }
    }
}

impl<F: Law> WallBlock<F> {
    /// Advances the contacts by a step. Gives `act` the force on the plane and its moment about the
    /// particle's centre, see [`Push::against_wall`](super::Push). Returns which lanes touch.
    #[inline(always)]
    fn advance<S: Simd>(
        &mut self,
        simd: S,
        face: &Face,
        kinematics: Kinematics<'_>,
        before: Before<'_>,
        depths: &mut Depths<S>,
        mut act: impl FnMut(usize, [f64; 4], [f64; 4], Option<[f64; 4]>),
    ) -> u8 {
        let normal = Vectors::splat(simd, face.normal());
        let none = Lanes::splat(simd, 0.0);
        let mut touching = 0;
        for part in 0..LANES / S::F64_LANES {
            let sphere = gather(simd, kinematics.centres, &self.ends.0, part);
            let radius = sphere.fourth;
            let along = [sphere.vector.x, sphere.vector.y, sphere.vector.z][face.axis];
            let height =
                (along - Lanes::splat(simd, face.position)) * Lanes::splat(simd, face.facing);
            let stiffness = Lanes::load(simd, &self.stiffness, part);
            // padding has no stiffness, and touches nothing
            let is_touching = simd.and_m64s(height.at_most(radius), none.below(stiffness));
            if !any::<S>(is_touching) {
                if before.touched != 0 {
                    self.law.forget(simd, part);
                }
                continue;
            }
            let overlap = radius - height;
            let [shear_ratio, friction] = before.tangent.load(simd, part);
            let touch = Touch {
                normal,
                overlap,
                reach: radius + radius,
                stiffness,
                shear_ratio,
                friction,
                is_touching,
            };
            let mut slip = Slip::none(simd);
            if F::FEELS_SPEED {
                let velocity = gather(simd, kinematics.velocities, &self.ends.0, part).vector;
                let plane = Vectors::splat(simd, face.motion.velocity);
                let relative = plane - velocity;
                slip.approach = relative.dot(normal);
                if F::IS_ROUGH {
                    let spin = gather(simd, kinematics.spins, &self.ends.0, part).vector;
                    let twice = radius + radius;
                    let velocity = relative.scaled(twice.over(twice - overlap))
                        - spin.scaled(radius).cross(normal);
                    slip.velocity = velocity - normal.scaled(velocity.dot(normal));
                    slip.spins = spin;
                    slip.last_normal = normal;
                    if F::RESISTS_ROLLING {
                        slip.rolling = Vectors::zero(simd) - spin;
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
