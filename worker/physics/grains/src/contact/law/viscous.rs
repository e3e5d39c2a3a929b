//! Dashpots beside any law: impacts that give back a part of the speed, and what sticks comes to rest.
//!
//! *Along* the normal, while the bodies touch, with v_N the speed at which they part:
//!
//!   F_N ← F_N − c v_N (G.17)
//!   c = 2 β √(m* k_N), β = −ln e / √(π² + ln² e), 1/m* = 1/m_a + 1/m_b (G.18)
//!
//! v_N is that of the moment, at which the spring's overlap is known. Velocities are known in the middle of
//! steps, half a step ago and one and a half; the line through both gives it,
//!
//!   v_N = 3/2 v_N(−½ Δt) − 1/2 v_N(−3/2 Δt) (G.27)
//!
//! and where the bodies did not touch a step ago, the dashpot acts from where they met: with the
//! overlap δ for half a step and δ/|v_N|, at most a whole. (The velocity of half a step ago by itself
//! takes too much: asked 0.1, it gave 0.077 at 0.2 of the critical step.) What a step's raster leaves is in the
//! guide, by presets.
//!
//! A linear spring with this dashpot is the damped oscillator; after half a period, when the bodies
//! part, the speed is e times that of the impact, whatever it was. For Hertz's spring k_N is the
//! tangent and c is multiplied with √(5/6), which makes e independent of the speed as well. With
//! many contacts at once each has its own dashpot. The spheres part when they no longer overlap: just
//! before, the dashpot pulls a little, as the closed form supposes. Sliding is limited by the force
//! of the spring alone, which is never negative. A body that cannot move counts as infinitely heavy, a
//! clump's member with the mass of its clump, and what is held in part with what is left of its
//! freedom along the normal and across it (G.35).
//!
//! *Across* the normal, beside a law with friction: what sticks would ring on its shear spring.
//!
//!   F_T ← F_T − c_T v_T while the bodies touch, |F_T| ≤ F_N tan φ (G.24)
//!   c_T = 2 β_T √(2/7 m* k_T), β_T = −ln e_T / √(π² + ln² e_T) (G.25)
//!
//! F_T is that of the spring, cut back already, F_N the force of the spring along the normal, as for
//! sliding without the dashpot. What is remembered is the spring alone. A cut takes the sum to the nearest
//! force within the limit, where that of the spring is already: the dashpot never gives energy.
//! Two spheres that stick and turn freely are a damped oscillator: with I = 2/5 m r² a force across the
//! normal moves the surfaces past each other by 1/m* (1 + 5/2), so that half a period leaves e_T of
//! the speed. For clumps, whose inertia depends on the place, 2/7 is an estimate. The k_T of
//! [`super::HertzMindlin`] is that of the moment and c_T follows its root: e_T is kept at a constant
//! overlap, and approximate where the overlap changes during the swing.
//!
//! Source: the oscillator in any textbook; for Hertz [Tsuji1992], [AntypovElliott2011].
use std::fmt::Debug;

use pulp::Simd;

use super::{ContactForces, Lanewise, Law, Normal, Push, Slip, Spring, Touch, coulomb::cut};
use crate::{
    contact::packed::Columns,
    contact::past::Past,
    contact::stiffness::Springs,
    numbers::{
        Vector,
        ahead::{ask, ask_all},
        lanes::{Array, Lanes, Vectors},
    },
};

/// A law and a dashpot.
#[derive(Clone, Debug, Default, PartialEq)]
#[repr(align(64))]
pub(crate) struct Viscous<F: Law, D: Dashpot> {
    law: F,
    /// c or c_T [N s/m], or what gives it with the overlap.
    constant: Array,
    dashpot: D,
}

/// A way in which a dashpot works, and its force in the last step.
pub(crate) trait Dashpot:
    Clone + Debug + Default + PartialEq + Send + Sync + 'static
{
    /// Place of its constant among those of [`Springs::dashpots`].
    const WAY: usize;

    /// Adds its force to what the law does, given its constant at this overlap.
    fn act<S: Simd>(
        &mut self,
        simd: S,
        part: usize,
        constant: Lanes<S>,
        meeting: (&Touch<S>, &Slip<S>),
        push: Push<S>,
        time_step: f64,
    ) -> Push<S>;

    /// Asks for its memory.
    fn ask(&self);

    /// They do not touch.
    fn forget<S: Simd>(&mut self, simd: S, part: usize);

    /// Adds what it remembers of a lane.
    fn tell(&self, lane: usize, past: &mut Past);

    /// Sets it.
    fn remember(&mut self, lane: usize, past: &Past);

    /// The same for an observer.
    fn add(&self, lane: usize, forces: &mut ContactForces);

    /// Shows all that it keeps.
    fn show(&mut self, columns: &mut dyn Columns);
}

/// Along the normal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(64))]
pub(crate) struct Along {
    /// −c v_N in the last step [N].
    force: Array,
    /// v_N in the middle of the step before, where they touched then [m/s].
    velocity: Array,
    /// 1 where they did.
    touched: Array,
}

/// Across the normal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(64))]
pub(crate) struct Across {
    /// F_T of spring and dashpot in the last step [N].
    shear: [Array; 3],
    /// v_T in the middle of the step before, where they touched then [m/s].
    velocity: [Array; 3],
    /// 1 where they did.
    touched: Array,
}

impl Dashpot for Along {
    const WAY: usize = 0;

    #[inline(always)]
    fn act<S: Simd>(
        &mut self,
        simd: S,
        part: usize,
        constant: Lanes<S>,
        (touch, slip): (&Touch<S>, &Slip<S>),
        push: Push<S>,
        time_step: f64,
    ) -> Push<S> {
        let splat = |value: f64| Lanes::splat(simd, value);
        let (none, half, one) = (splat(0.0), splat(0.5), splat(1.0));
        let known = slip.approach;
        let before = Lanes::load(simd, &self.velocity, part);
        let now = known + half * (known - before);
        // since they met: δ/Δt + |v|/2 instead of |v|, where that is less
        let way = half * known * Lanes::splat(simd, time_step);
        let is_new = touch.overlap.below(-way);
        let since = half * known - touch.overlap.over(Lanes::splat(simd, time_step));
        let first = since.only_if(is_new, known);
        let is_known = none.below(Lanes::load(simd, &self.touched, part));
        let velocity = now.only_if(is_known, first);
        known.store(&mut self.velocity, part);
        one.only_if(touch.is_touching, none)
            .store(&mut self.touched, part);
        let drag = constant * velocity;
        let drag = (-drag).only_if(touch.is_touching, none);
        drag.store(&mut self.force, part);
        Push {
            normal: push.normal + drag,
            ..push
        }
    }

    #[inline(always)]
    fn ask(&self) {
        ask(&self.force);
        ask(&self.velocity);
        ask(&self.touched);
    }

    #[inline(always)]
    fn forget<S: Simd>(&mut self, simd: S, part: usize) {
        Lanes::splat(simd, 0.0).store(&mut self.touched, part);
    }

    fn tell(&self, lane: usize, past: &mut Past) {
        past.approach = (self.touched[lane] > 0.0).then_some(self.velocity[lane]);
    }

    fn remember(&mut self, lane: usize, past: &Past) {
        self.touched[lane] = f64::from(u8::from(past.approach.is_some()));
        self.velocity[lane] = past.approach.unwrap_or_default();
    }

    fn add(&self, lane: usize, forces: &mut ContactForces) {
        forces.force += self.force[lane];
    }

    fn show(&mut self, columns: &mut dyn Columns) {
        columns.numbers(&mut self.force);
        columns.numbers(&mut self.velocity);
        columns.numbers(&mut self.touched);
    }
}

impl Dashpot for Across {
    const WAY: usize = 1;

    #[inline(always)]
    fn act<S: Simd>(
        &mut self,
        simd: S,
        part: usize,
        constant: Lanes<S>,
        (touch, slip): (&Touch<S>, &Slip<S>),
        push: Push<S>,
        _time_step: f64,
    ) -> Push<S> {
        let splat = |value: f64| Lanes::splat(simd, value);
        let (none, half, one) = (splat(0.0), splat(0.5), splat(1.0));
        let before = Vectors::load(simd, &self.velocity, part);
        let change = (slip.velocity - before).scaled(half);
        let is_known = none.below(Lanes::load(simd, &self.touched, part));
        let change = change.only_if(is_known, Vectors::zero(simd));
        slip.velocity.store(&mut self.velocity, part);
        one.only_if(touch.is_touching, none)
            .store(&mut self.touched, part);
        let drag = (slip.velocity + change).scaled(constant);
        let shear = cut(simd, push.shear - drag, push.limit);
        let shear = shear.only_if(touch.is_touching, Vectors::zero(simd));
        shear.store(&mut self.shear, part);
        Push { shear, ..push }
    }

    #[inline(always)]
    fn ask(&self) {
        ask_all(&self.shear);
        ask_all(&self.velocity);
        ask(&self.touched);
    }

    #[inline(always)]
    fn forget<S: Simd>(&mut self, simd: S, part: usize) {
        Lanes::splat(simd, 0.0).store(&mut self.touched, part);
    }

    fn tell(&self, lane: usize, past: &mut Past) {
        let velocity = Vector::from(self.velocity.map(|array| array[lane]));
        past.slip = (self.touched[lane] > 0.0).then_some(velocity);
    }

    fn remember(&mut self, lane: usize, past: &Past) {
        self.touched[lane] = f64::from(u8::from(past.slip.is_some()));
        let slip = past.slip.unwrap_or_default();
        for axis in 0..3 {
            self.velocity[axis][lane] = slip[axis];
        }
    }

    fn add(&self, lane: usize, forces: &mut ContactForces) {
        forces.shear = Vector::from(self.shear.map(|array| array[lane]));
    }

    fn show(&mut self, columns: &mut dyn Columns) {
        columns.all_numbers(&mut self.shear);
        columns.all_numbers(&mut self.velocity);
        columns.numbers(&mut self.touched);
    }
}

impl<F: Law, D: Dashpot> Law for Viscous<F, D> {
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
        let push = self.law.advance(simd, part, touch, slip, time_step);
        let constant = Lanes::load(simd, &self.constant, part) * F::Normal::dashpot(simd, &touch);
        (self.dashpot).act(simd, part, constant, (&touch, &slip), push, time_step)
    }

    #[inline(always)]
    fn ask(&self) {
        self.law.ask();
        ask(&self.constant);
        self.dashpot.ask();
    }

    #[inline(always)]
    fn forget<S: Simd>(&mut self, simd: S, part: usize) {
        self.law.forget(simd, part);
        self.dashpot.forget(simd, part);
    }
}

impl<F: Law, D: Dashpot> Lanewise for Viscous<F, D> {
    fn past(&self, lane: usize) -> Past {
        let mut past = self.law.past(lane);
        self.dashpot.tell(lane, &mut past);
        past
    }

    fn start(&mut self, lane: usize, springs: &Springs, past: &Past) {
        self.law.start(lane, springs, past);
        self.dashpot.remember(lane, past);
        self.constant[lane] = springs.dashpots[D::WAY];
    }

    fn remember(&mut self, lane: usize, past: &Past) {
        self.law.remember(lane, past);
        self.dashpot.remember(lane, past);
    }

    fn forces(&self, lane: usize, spring: &Spring) -> ContactForces {
        let mut forces = self.law.forces(lane, spring);
        forces.dashpots[D::WAY] = self.constant[lane] * spring.dashpot::<F::Normal>();
        self.dashpot.add(lane, &mut forces);
        forces
    }

    fn show(&mut self, columns: &mut dyn Columns) {
        self.law.show(columns);
        columns.numbers(&mut self.constant);
        self.dashpot.show(columns);
    }
}
