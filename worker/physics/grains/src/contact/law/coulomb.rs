//! Springs across the normal that slide: Coulomb friction by increments.
//!
//! F_N is the normal spring's. The shear force of the last step is turned with the contact and with the mean spin
//! about the normal, grows by k_T times the slip of the step, and is cut back to the cone,
//!
//!   F_T ← F_T − F_T × (n₀ × n), F_T ← F_T − F_T × (½Δt n₀·(ω_a + ω_b)) n₀ (G.3)
//!   F_T ← F_T − k_T Δt v_T, |F_T| ≤ F_N tan φ (G.4)
//!
//! with the normal n₀ of the last step.
//!
//! Source: [CundallStrack1979] as written in Yade's `ScGeom::rotate`.
use std::marker::PhantomData;

use pulp::Simd;

use super::super::{packed::Columns, past::Past};
use super::{ContactForces, Lanewise, Law, Normal, Normals, Push, Slip, Spring, Touch};
use crate::numbers::{
    Vector,
    ahead::ask_all,
    lanes::{Array, Lanes, Vectors},
};

/// Coulomb friction with its memory.
#[derive(Clone, Debug, Default, PartialEq)]
#[repr(align(64))]
pub(crate) struct Coulomb<N: Normal, M: Normals> {
    shear: [Array; 3],
    normals: M,
    normal_spring: PhantomData<N>,
}

impl<N: Normal, M: Normals> Coulomb<N, M> {
    /// The shear force of the last step, turned with the contact (G.3).
    #[inline(always)]
    pub(super) fn turned<S: Simd>(
        &self,
        simd: S,
        part: usize,
        normal: Vectors<S>,
        slip: Slip<S>,
        time_step: f64,
    ) -> Vectors<S> {
        let shear = Vectors::load(simd, &self.shear, part);
        self.turn(simd, part, shear, normal, slip, time_step)
    }

    /// A vector of the last step that turns with the contact (G.3).
    #[inline(always)]
    pub(super) fn turn<S: Simd>(
        &self,
        simd: S,
        part: usize,
        vector: Vectors<S>,
        normal: Vectors<S>,
        slip: Slip<S>,
        time_step: f64,
    ) -> Vectors<S> {
        let before = self.normals.before(simd, part, slip.last_normal);
        let vector = vector - vector.cross(before.cross(normal));
        let twist = Lanes::splat(simd, 0.5 * time_step) * before.dot(slip.spins);
        vector - vector.cross(before.scaled(twist))
    }

    /// The shear force turned and grown (G.3), (G.4), not cut.
    #[inline(always)]
    pub(super) fn grown<S: Simd>(
        &self,
        simd: S,
        part: usize,
        touch: &Touch<S>,
        slip: Slip<S>,
        time_step: f64,
    ) -> Vectors<S> {
        let shear = self.turned(simd, part, touch.normal, slip, time_step);
        let stiffness = touch.stiffness * touch.shear_ratio;
        let growth = slip
            .velocity
            .scaled(stiffness * Lanes::splat(simd, time_step));
        shear - growth
    }

    /// Keeps what the next step needs.
    #[inline(always)]
    pub(super) fn keep<S: Simd>(&mut self, part: usize, normal: Vectors<S>, shear: Vectors<S>) {
        shear.store(&mut self.shear, part);
        self.normals.keep(part, normal);
    }
}

/// A shear force cut back to `limit`.
#[inline(always)]
pub(super) fn cut<S: Simd>(simd: S, shear: Vectors<S>, limit: Lanes<S>) -> Vectors<S> {
    let square = shear.dot(shear);
    // without shear force the quotient is not a number, and not taken
    let slides = (limit * limit).below(square);
    let back = limit.over(square.sqrt());
    shear.scaled(back.only_if(slides, Lanes::splat(simd, 1.0)))
}

impl<N: Normal, M: Normals> Law for Coulomb<N, M> {
    type Normal = N;
    const IS_ROUGH: bool = true;
    const FOLLOWS_NORMALS: bool = M::FOLLOW;

    #[inline(always)]
    fn advance<S: Simd>(
        &mut self,
        simd: S,
        part: usize,
        touch: Touch<S>,
        slip: Slip<S>,
        time_step: f64,
    ) -> Push<S> {
        let shear = self.grown(simd, part, &touch, slip, time_step);
        let normal = N::force(simd, &touch);
        let limit = normal * touch.friction;
        let shear = cut(simd, shear, limit).only_if(touch.is_touching, Vectors::zero(simd));
        self.keep(part, touch.normal, shear);
        Push {
            normal,
            shear,
            limit,
            compression: touch.overlap,
            acts: touch.is_touching,
            moment: None,
        }
    }

    #[inline(always)]
    fn ask(&self) {
        ask_all(&self.shear);
        self.normals.ask();
    }

    #[inline(always)]
    fn forget<S: Simd>(&mut self, simd: S, part: usize) {
        Vectors::zero(simd).store(&mut self.shear, part);
    }
}

impl<N: Normal, M: Normals> Lanewise for Coulomb<N, M> {
    fn past(&self, lane: usize) -> Past {
        Past {
            normal: self.normals.at(lane),
            shear: Vector::from(self.shear.map(|array| array[lane])),
            ..Past::default()
        }
    }

    fn remember(&mut self, lane: usize, past: &Past) {
        self.normals.set(lane, past.normal);
        for axis in 0..3 {
            self.shear[axis][lane] = past.shear[axis];
        }
    }

    fn forces(&self, lane: usize, spring: &Spring) -> ContactForces {
        let constant = spring.shear_ratio * spring.constant;
        ContactForces::spring::<N>(spring, constant, self.past(lane).shear)
    }

    fn show(&mut self, columns: &mut dyn Columns) {
        columns.all_numbers(&mut self.shear);
        self.normals.show(columns);
    }
}
