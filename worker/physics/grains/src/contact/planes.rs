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
use serde::{Deserialize, Serialize};

use super::{
    Deepest, Kinematics, Slip, Touch,
    law::{Law, Past},
    stiffness::Springs,
    tangents::{Tangent, Tangents},
};
use crate::{
    motion::Wrenches,
    numbers::{
        lanes::{Array, LANES, Lanes, Vectors, bits},
        rows::gather,
    },
    walls::Face,
};

/// Candidates in vectors; padding has no stiffness.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(bound = "")]
#[repr(align(64))]
pub(crate) struct WallBlock<F: Law> {
    pub(crate) particles: [u32; LANES],
    /// Constant of the normal spring: k_N [N/m] of a linear one.
    pub(crate) stiffness: Array,
    pub(crate) law: F,
}

/// Candidates of one plane and which of them touched in the last step.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(bound = "")]
pub(crate) struct WallList<F: Law> {
    pub(crate) blocks: Vec<WallBlock<F>>,
    /// Bits by lane.
    pub(crate) touching: Vec<u8>,
    pub(super) tangents: Tangents,
    /// Candidates, padding not counted.
    pub(crate) count: usize,
}

impl<F: Law> WallList<F> {
    /// Adds the forces on the particles; returns the force on the plane [N].
    #[inline(always)]
    pub(crate) fn push<S: Simd>(
        &mut self,
        simd: S,
        face: &Face,
        kinematics: Kinematics<'_>,
        first: usize,
        wrenches: &mut Wrenches,
        deepest: &mut Deepest,
    ) -> [f64; 4] {
        let mut on_plane = [0.0; 4];
        let blocks = self.blocks.iter_mut().zip(&mut self.touching);
        for (number, (block, touching)) in blocks.enumerate() {
            let tangent = self.tangents.of::<F>(number);
            let particles = block.particles;
            let touched = *touching;
            *touching = block.advance(
                simd,
                face,
                kinematics,
                tangent,
                touched,
                deepest,
                #[inline(always)]
                |lane: usize, force: [f64; 4], moment: [f64; 4]| {
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
}

impl<F: Law> WallList<F> {
    /// Memory [bytes].
    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.blocks.as_slice()) + self.tangents.bytes()
    }

    /// Adds a candidate, as a list of pairs does.
    pub(super) fn add(&mut self, particle: u32, springs: &Springs, past: Option<&Past>) {
        let lane = self.count % LANES;
        if lane == 0 {
            let block = WallBlock {
                particles: [particle; LANES],
                ..WallBlock::default()
            };
            self.blocks.push(block);
            self.touching.push(0);
        }
        self.tangents.set::<F>(self.count / LANES, lane, springs);
        self.count += 1;
        if let (Some(block), Some(touching)) = (self.blocks.last_mut(), self.touching.last_mut()) {
            block.particles[lane] = particle;
            block.stiffness[lane] = springs.normal;
            let remembered = past.copied().unwrap_or_default();
            block.law.start(lane, springs, &remembered);
            *touching |= u8::from(past.is_some()) << lane;
        }
    }
}

impl<F: Law> WallBlock<F> {
    /// Advances the contacts by a step. Gives `act` the force on the plane and its moment about the
    /// particle's centre. Returns which lanes touch.
    #[inline(always)]
    fn advance<S: Simd>(
        &mut self,
        simd: S,
        face: &Face,
        kinematics: Kinematics<'_>,
        tangent: Tangent<'_>,
        touched: u8,
        deepest: &mut Deepest,
        mut act: impl FnMut(usize, [f64; 4], [f64; 4]),
    ) -> u8 {
        let normal = Vectors::splat(simd, face.normal());
        let none = Lanes::splat(simd, 0.0);
        let mut touching = 0;
        for part in 0..LANES / S::F64_LANES {
            let sphere = gather(simd, kinematics.centres, &self.particles, part);
            let radius = sphere.fourth;
            let along = [sphere.vector.x, sphere.vector.y, sphere.vector.z][face.axis];
            let height =
                (along - Lanes::splat(simd, face.position)) * Lanes::splat(simd, face.facing);
            let stiffness = Lanes::load(simd, &self.stiffness, part);
            // padding has no stiffness, and touches nothing
            let is_touching = simd.and_m64s(height.at_most(radius), none.below(stiffness));
            if bits::<S>(is_touching, 0) == 0 {
                if touched != 0 {
                    self.law.forget(simd, part);
                }
                continue;
            }
            let overlap = radius - height;
            let [shear_ratio, friction] = tangent.load(simd, part);
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
                let velocity = gather(simd, kinematics.velocities, &self.particles, part).vector;
                let plane = Vectors::splat(simd, face.motion.velocity);
                let relative = plane - velocity;
                slip.approach = relative.dot(normal);
                if F::IS_ROUGH {
                    let spin = gather(simd, kinematics.spins, &self.particles, part).vector;
                    let twice = radius + radius;
                    let velocity = relative.scaled(twice.over(twice - overlap))
                        - spin.scaled(radius).cross(normal);
                    slip.velocity = velocity - normal.scaled(velocity.dot(normal));
                    slip.spins = spin;
                    slip.last_normal = normal;
                }
            }
            let push = self
                .law
                .advance(simd, part, touch, slip, kinematics.time_step);
            touching |= bits::<S>(push.acts, part);
            push.tell(simd, radius, deepest);
            push.against_wall(simd, part, &touch, radius, &mut act);
        }
        touching
    }
}
