//! A dashpot across the normal, beside a law with friction: what sticks comes to rest.
//!
//!   F_T ← F_T − c_T v_T while the bodies touch, |F_T| ≤ F_N tan φ (G.24)
//!   c_T = 2 β_T √(2/7 m* k_T), β_T = −ln e_T / √(π² + ln² e_T), 1/m* = 1/m_a + 1/m_b (G.25)
//!
//! F_T is that of the spring, cut back already, F_N the force of the spring along the normal, as for
//! sliding without the dashpot. What is remembered is the spring alone. A cut takes the sum to the nearest
//! force within the limit, where that of the spring is already: the dashpot never gives energy.
//!
//! Two spheres that stick and turn freely are a damped oscillator: with I = 2/5 m r² a force across the
//! normal moves the surfaces past each other by 1/m* (1 + 5/2), so that half a period leaves e_T of
//! the speed. For clumps, whose inertia depends on the place, 2/7 is an estimate; masses are those of
//! [`super::viscous`]. The k_T of [`super::HertzMindlin`] is that of the moment and c_T follows its root:
//! e_T is kept at a constant overlap, and approximate where the overlap changes during the swing.
//!
//! Source: the oscillator in any textbook.
use pulp::Simd;
use serde::{Deserialize, Serialize};

use super::{ContactForces, Lanewise, Law, Normal, Past, Push, Slip, Spring, Touch, coulomb::cut};
use crate::{
    contact::stiffness::Springs,
    numbers::{
        Vector,
        ahead::{ask, ask_all},
        lanes::{Array, Lanes, Vectors},
    },
};

/// A law with friction and a dashpot.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
#[repr(align(64))]
pub(crate) struct ViscousShear<F: Law> {
    law: F,
    /// c_T [N s/m], or what gives it with the overlap.
    dashpot: Array,
    /// F_T of spring and dashpot in the last step [N].
    shear: [Array; 3],
}

impl<F: Law> Law for ViscousShear<F> {
    type Normal = F::Normal;
    const IS_ROUGH: bool = F::IS_ROUGH;
    const FOLLOWS_NORMALS: bool = F::FOLLOWS_NORMALS;

    #[inline(always)]
    fn acting<S: Simd>(&self, simd: S, part: usize, touching: S::m64s) -> S::m64s {
        self.law.acting(simd, part, touching)
    }

    #[inline(always)]
    fn advance<S: Simd>(
        &mut self,
        simd: S,
        part: usize,
        touch: Touch<S>,
        slip: Slip<S>,
        time_step: f64,
    ) -> Push<S> {
        let push = self.law.advance(simd, part, touch, slip, time_step);
        let scale = F::Normal::dashpot(simd, &touch);
        let drag = (slip.velocity).scaled(Lanes::load(simd, &self.dashpot, part) * scale);
        let shear = cut(simd, push.shear - drag, push.limit);
        let shear = shear.only_if(touch.is_touching, Vectors::zero(simd));
        shear.store(&mut self.shear, part);
        Push { shear, ..push }
    }

    #[inline(always)]
    fn ask(&self) {
        self.law.ask();
        ask(&self.dashpot);
        ask_all(&self.shear);
    }

    #[inline(always)]
    fn forget<S: Simd>(&mut self, simd: S, part: usize) {
        self.law.forget(simd, part);
    }
}

impl<F: Law> Lanewise for ViscousShear<F> {
    fn past(&self, lane: usize) -> Past {
        self.law.past(lane)
    }

    fn start(&mut self, lane: usize, springs: &Springs, past: &Past) {
        self.law.start(lane, springs, past);
        self.dashpot[lane] = springs.dashpots[1];
    }

    fn remember(&mut self, lane: usize, past: &Past) {
        self.law.remember(lane, past);
    }

    fn forces(&self, lane: usize, spring: &Spring) -> ContactForces {
        let forces = self.law.forces(lane, spring);
        let scale = spring.dashpot::<F::Normal>();
        ContactForces {
            shear: Vector::from(self.shear.map(|array| array[lane])),
            dashpots: [forces.dashpots[0], self.dashpot[lane] * scale],
            ..forces
        }
    }
}
