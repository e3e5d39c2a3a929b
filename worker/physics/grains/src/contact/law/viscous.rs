//! A dashpot along the normal, beside any law: impacts that give back a part of the speed.
//!
//!   F_N ← F_N − c v_N while the bodies touch, with v_N the speed at which they part (G.17)
//!   c = 2 β √(m* k_N), β = −ln e / √(π² + ln² e), 1/m* = 1/m_a + 1/m_b (G.18)
//!
//! A linear spring with this dashpot is the damped oscillator; after half a period, when the bodies
//! part, the speed is e times that of the impact, whatever it was. For Hertz's spring k_N is the
//! tangent and c is multiplied with √(5/6), which makes e independent of the speed as well. With
//! many contacts at once each has its own dashpot. The spheres part when they no longer overlap: just
//! before, the dashpot pulls a little, as the closed form supposes. Sliding is limited by the force
//! of the spring alone, which is never negative. A body that cannot move counts as infinitely heavy, a
//! clump's member with the mass of its clump. What sticks rings on its shear spring all the same:
//! [`super::viscous_shear`] is the dashpot across the normal.
//!
//! Source: the oscillator in any textbook; for Hertz [Tsuji1992], [AntypovElliott2011].
use pulp::Simd;
use serde::{Deserialize, Serialize};

use super::{ContactForces, Lanewise, Law, Normal, Past, Push, Slip, Spring, Touch};
use crate::{
    contact::stiffness::Springs,
    numbers::{
        ahead::ask,
        lanes::{Array, Lanes},
    },
};

/// A law and a dashpot.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
#[repr(align(64))]
pub(crate) struct Viscous<F: Law> {
    law: F,
    /// c [N s/m], or what gives it with the overlap.
    dashpot: Array,
    /// −c v_N in the last step [N].
    force: Array,
}

impl<F: Law> Law for Viscous<F> {
    type Normal = F::Normal;
    const IS_ROUGH: bool = F::IS_ROUGH;
    const FOLLOWS_NORMALS: bool = F::FOLLOWS_NORMALS;
    const FEELS_SPEED: bool = true;

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
        let scale = F::Normal::dashpot(simd, &touch);
        let drag = Lanes::load(simd, &self.dashpot, part) * scale * slip.approach;
        let drag = (-drag).only_if(touch.is_touching, Lanes::splat(simd, 0.0));
        drag.store(&mut self.force, part);
        let push = self.law.advance(simd, part, touch, slip, time_step);
        Push {
            normal: push.normal + drag,
            ..push
        }
    }

    #[inline(always)]
    fn ask(&self) {
        self.law.ask();
        ask(&self.dashpot);
        ask(&self.force);
    }

    #[inline(always)]
    fn forget<S: Simd>(&mut self, simd: S, part: usize) {
        self.law.forget(simd, part);
    }
}

impl<F: Law> Lanewise for Viscous<F> {
    fn past(&self, lane: usize) -> Past {
        self.law.past(lane)
    }

    fn start(&mut self, lane: usize, springs: &Springs, past: &Past) {
        self.law.start(lane, springs, past);
        self.dashpot[lane] = springs.dashpots[0];
    }

    fn remember(&mut self, lane: usize, past: &Past) {
        self.law.remember(lane, past);
    }

    fn forces(&self, lane: usize, spring: &Spring) -> ContactForces {
        let forces = self.law.forces(lane, spring);
        let scale = spring.dashpot::<F::Normal>();
        ContactForces {
            force: forces.force + self.force[lane],
            dashpots: [self.dashpot[lane] * scale, forces.dashpots[1]],
            ..forces
        }
    }
}
