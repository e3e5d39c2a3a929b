//! Contacts: geometry times stiffness times law.
//!
//! With n from body a to body b, overlap δ (positive when touching) and half-step velocities, a
//! contact pushes b with F = F_N n + F_T and a with −F, at arms r − δ/2 along the normal:
//!
//! - F_N and F_T by a [`law`], which owns what a contact remembers (its [`past`]); for a linear spring without bond
//!   F_N = k_N δ, never negative (G.1);
//! - torque on either body (r − δ/2) n × (−F) (G.2).
//!
//! Contacts live in [`blocks`] of [`LANES`], worked through as vectors: [`pairs`] are contacts of two
//! spheres, [`planes`] of a sphere and a plane, [`facets`] of a sphere and a triangle. Those of a patch make
//! up its [`lists`], behind which laws are types and before which they are not; which law is
//! [`chosen`] once. [`stiffness`] knows what the two bodies bring to a contact, of which the law's
//! normal spring makes its constants, [`tangents`] what shears. Below: [`walls`](crate::walls) and
//! [`motion`](crate::motion), of which it asks where things are and how they move. A block holds *candidates*,
//! some of which do not touch: they cost a look at the distance, and a candidate that stops
//! touching forgets its shear force.
//!
//! Source: [CundallStrack1979]; order of operations as in Yade's `ScGeom` and
//! `Law2_ScGeom_FrictPhys_CundallStrack`.
mod blocks;
pub(crate) mod chosen;
pub(crate) mod facets;
pub(crate) mod freedom;
pub(crate) mod law;
pub(crate) mod lists;
mod packed;
mod pairs;
pub(crate) mod past;
mod planes;
pub(crate) mod stiffness;
mod tangents;
pub(crate) mod touching;

use std::ops::Range;

use pulp::Simd;
use serde::{Deserialize, Serialize};

use crate::{
    numbers::{
        ahead::ask,
        lanes::{LANES, Lanes, Vectors},
        rows::{Gathered, Row, Scattered},
    },
    walls::{
        Face,
        facets::{Facets, Pose},
    },
};

/// Where the particles are and how they move: one row each.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kinematics<'a> {
    /// Centre [m] and radius [m].
    pub(crate) centres: &'a [Row],
    /// Velocity [m/s], half a step ago.
    pub(crate) velocities: &'a [Row],
    /// Angular velocity [rad/s], half a step ago.
    pub(crate) spins: &'a [Row],
    /// Δt of the step that brought the centres to where they are [s].
    pub(crate) last_step: f64,
    /// Δt of this step [s].
    pub(crate) time_step: f64,
}

impl Kinematics<'_> {
    /// Reads the rows of neighbouring particles in the order of memory. Contacts ask for them in
    /// another, and would wait for each that is not in the cache; with 100 000 spheres that took
    /// a fifth of the time.
    pub(crate) fn fetch(&self, particles: Range<usize>) {
        for rows in [self.centres, self.velocities, self.spins] {
            // one of each line of the cache
            let rows = rows.get(particles.clone()).unwrap_or_default().iter();
            let bits = rows.step_by(2).map(|row| row.0[0].to_bits());
            std::hint::black_box(bits.fold(0, |all, bits| all ^ bits));
        }
    }

    /// Asks for the rows of particles here and there.
    pub(crate) fn ask(&self, particles: &[u32]) {
        for particle in particles {
            for rows in [self.centres, self.velocities, self.spins] {
                if let Some(row) = rows.get(*particle as usize) {
                    ask(row);
                }
            }
        }
    }
}

/// All that the contacts of a step need to know of the scene.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scenery<'a> {
    pub(crate) kinematics: Kinematics<'a>,
    pub(crate) faces: &'a [Face],
    pub(crate) facets: &'a Facets,
    pub(crate) poses: &'a [Pose],
}

/// Part of the contacts of a block as they stand now.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touch<S: Simd> {
    /// From a to b.
    pub(crate) normal: Vectors<S>,
    /// δ [m].
    pub(crate) overlap: Lanes<S>,
    /// Distance at which the bodies just touch [m].
    pub(crate) reach: Lanes<S>,
    /// Constant of the normal spring: k_N [N/m] of a linear one.
    pub(crate) stiffness: Lanes<S>,
    /// k_T/k_N of the constants.
    pub(crate) shear_ratio: Lanes<S>,
    /// tan φ.
    pub(crate) friction: Lanes<S>,
    pub(crate) is_touching: S::m64s,
}

/// What a part of the contacts of a block does.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Push<S: Simd> {
    /// F_N [N]; of no meaning where the contact does not act.
    pub(crate) normal: Lanes<S>,
    /// F_T on b [N], zero where it does not act.
    pub(crate) shear: Vectors<S>,
    /// F_N tan φ [N], at which it slides, with F_N of the spring.
    pub(crate) limit: Lanes<S>,
    /// Of the spring [m]: δ, or the change of a bond's overlap.
    pub(crate) compression: Lanes<S>,
    /// On b of what resists rolling and twisting [N m], where there is any such thing; of no meaning
    /// where the contact does not act.
    pub(crate) moment: Option<Vectors<S>>,
    pub(crate) acts: S::m64s,
}

/// A particle whose centre went through a wall in the last step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Passage {
    pub(crate) particle: u32,
    /// Planes before meshes.
    pub(crate) wall: u32,
}

/// Whether every step watches its contacts, for what `quality` tells of them. Only the benchmark of what
/// that costs is built without: whoever runs jobs refuses to be compiled with such a build.
pub const WATCHES: bool = !cfg!(feature = "unwatched");

/// Largest compression over the smaller radius that contacts had, step by step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Deepest {
    pub(crate) ratio: f64,
}

impl Deepest {
    /// Takes in what contacts had in a step: the largest is the same in any order.
    #[inline(always)]
    fn take_in<S: Simd>(&mut self, depths: Depths<S>) {
        let mut lanes = [0.0; LANES];
        depths.0.store(&mut lanes, 0);
        self.ratio = lanes.into_iter().fold(self.ratio, f64::max);
    }
}

/// Largest compression over the smaller radius of the contacts of a list, lane by lane.
#[derive(Clone, Copy, Debug)]
struct Depths<S: Simd>(Lanes<S>);

impl<S: Simd> Depths<S> {
    /// Of no contact.
    #[inline(always)]
    fn none(simd: S) -> Self {
        Self(Lanes::splat(simd, 0.0))
    }
}

/// How the surfaces of a part of a block move past each other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slip<S: Simd> {
    /// Velocity of b relative to a along the normal: negative when they come closer [m/s].
    pub(crate) approach: Lanes<S>,
    /// Velocity of b's contact point relative to a's, across the normal [m/s].
    pub(crate) velocity: Vectors<S>,
    /// Sum of both spins [rad/s].
    pub(crate) spins: Vectors<S>,
    /// n₀, for a law that does not keep it.
    pub(crate) last_normal: Vectors<S>,
    /// Spin of b less that of a, for a law that resists rolling [rad/s].
    pub(crate) rolling: Vectors<S>,
}

impl<S: Simd> Slip<S> {
    /// Nothing slips, or nobody asks.
    #[inline(always)]
    fn none(simd: S) -> Self {
        Self {
            approach: Lanes::splat(simd, 0.0),
            velocity: Vectors::zero(simd),
            spins: Vectors::zero(simd),
            last_normal: Vectors::zero(simd),
            rolling: Vectors::zero(simd),
        }
    }
}

impl<S: Simd> Push<S> {
    /// Tells `depths` of contacts with these smaller radii: four instructions that nothing waits for. A comparison
    /// with the deepest known and a branch took twice the instructions.
    #[inline(always)]
    fn tell(&self, simd: S, radius: Lanes<S>, depths: &mut Depths<S>) {
        if !WATCHES {
            return;
        }
        let ratio = self.compression.over(radius);
        let ratio = ratio.only_if(self.acts, Lanes::splat(simd, 0.0));
        depths.0 = ratio.or_larger(depths.0);
    }

    /// Gives `act` what a part of a block of spheres at walls does, lane by lane: the force on the
    /// wall and its moment about the centre of the sphere of this radius (G.2), and what resists
    /// rolling, which is in that moment.
    #[inline(always)]
    fn against_wall(
        &self,
        simd: S,
        part: usize,
        touch: &Touch<S>,
        radius: Lanes<S>,
        act: &mut impl FnMut(usize, [f64; 4], [f64; 4], Option<[f64; 4]>),
    ) {
        let fourth = Lanes::splat(simd, 0.0);
        let arm = radius - Lanes::splat(simd, 0.5) * touch.overlap;
        let vector = touch.normal.scaled(self.normal) + self.shear;
        let force = Gathered { vector, fourth }.masked(simd, self.acts);
        let mut vector = touch.normal.cross(self.shear).scaled(arm);
        if let Some(resisting) = self.moment {
            vector = vector + resisting;
        }
        let moment = Gathered { vector, fourth }.masked(simd, self.acts);
        let (force, moment) = (force.scatter(simd), moment.scatter(simd));
        let resisting = self.moment_rows(simd);
        for lane in 0..S::F64_LANES {
            let resisting = Scattered::row_of(resisting.as_ref(), lane);
            let contact = part * S::F64_LANES + lane;
            act(contact, force.row(lane), moment.row(lane), resisting);
        }
    }

    /// What resists rolling, by contact; zero where it does not act.
    #[inline(always)]
    fn moment_rows(&self, simd: S) -> Option<Scattered<S>> {
        let vector = self.moment?;
        let fourth = Lanes::splat(simd, 0.0);
        let moment = Gathered { vector, fourth };
        Some(moment.masked(simd, self.acts).scatter(simd))
    }
}
