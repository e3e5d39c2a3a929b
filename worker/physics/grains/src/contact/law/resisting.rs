//! Resistance to rolling and twisting beside any law with spins: springs between the bodies that turn.
//!
//! With ω = ω_b − ω_a, its part ω_n along the normal n and the rest ω_r, moments on b grow by
//!
//!   M_r ← M_r − k_r Δt ω_r, |M_r| ≤ μ_r R F_N (G.28)
//!   M_t ← M_t − k_t Δt ω_n, |M_t| ≤ μ_t R F_N (G.29)
//!   k_r = k_t = β k_T R², 1/R = 1/r_a + 1/r_b (R = r at a wall)
//!
//! on a their opposites. M_r lies across the normal: before it grows it is turned with the mean spin
//! about the normal, as a shear force is (G.3), and laid across the normal of this step with the
//! length that it had. F_N is that of the spring. Where the shear spring softens, as Hertz's does when the
//! overlap falls, the moments fall with it: carried over they would make energy.
//!
//! Dashpots work beside these springs,
//!
//!   M_r ← M_r − c_r ω_r, |M_r| ≤ μ_r R F_N; along the normal alike (G.30)
//!   c = 2 η √(I k), 1/I = Σ 1/(7/5 m r²) for rolling, Σ 1/(2/5 m r²) for twisting
//!
//! where the sum over the bodies leaves walls out and what cannot turn (G.35). What is remembered is the
//! spring alone, and the cut takes the sum to the nearest moment within the limit: the dashpot never
//! gives energy, and a contact that yields has its limit and no more. Spins are those of half a step ago. For clumps,
//! whose inertia depends on the axis, I is an estimate.
//!
//! Source: [Ai2011], type C, whose dashpot rests too while the spring yields (f = 0); k_r of
//! [IwashitaOda1998]; twisting, and the same in space, [Luding2008].
use pulp::Simd;

use super::{ContactForces, Lanewise, Law, Normal, Push, Slip, Spring, Touch, coulomb::cut, kept};
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

/// Rolling and twisting, in this order.
type Both = [Array; 2];

/// A law and what resists rolling and twisting.
#[derive(Clone, Debug, Default, PartialEq)]
#[repr(align(64))]
pub(crate) struct Resisting<F: Law> {
    law: F,
    /// k_r and k_t [N m], or what gives them with the overlap.
    stiffness: Both,
    /// μ_r R and μ_t R [m].
    reach: Both,
    /// c [N m s], or what gives it with the overlap.
    dashpots: Both,
    /// M_r of the spring on b [N m].
    rolling: [Array; 3],
    /// M_t of the spring on b along the normal [N m].
    twisting: Array,
    /// k_T over its constant in the last step: 1 for linear springs, √δ for Hertz's.
    softness: Array,
    /// Moment of springs and dashpots on b in the last step [N m].
    moment: [Array; 3],
}

impl<F: Law> Resisting<F> {
    /// M_r of the last step, turned with the pair and laid across the normal.
    #[inline(always)]
    fn turned<S: Simd>(
        &self,
        simd: S,
        part: usize,
        normal: Vectors<S>,
        spins: Vectors<S>,
        time_step: f64,
    ) -> Vectors<S> {
        let before = Vectors::load(simd, &self.rolling, part);
        let length = before.dot(before);
        let twist = Lanes::splat(simd, 0.5 * time_step) * normal.dot(spins);
        let turned = before - before.cross(normal.scaled(twist));
        let across = turned - normal.scaled(turned.dot(normal));
        let left = across.dot(across);
        let longer = length.over(left).sqrt();
        // without a moment the quotient is not a number, and not taken
        let is_there = Lanes::splat(simd, 0.0).below(left);
        across.scaled(longer.only_if(is_there, Lanes::splat(simd, 1.0)))
    }
}

/// A moment along the normal cut back to `limit`.
#[inline(always)]
fn cut_along<S: Simd>(moment: Lanes<S>, limit: Lanes<S>) -> Lanes<S> {
    let moment = limit.only_if(limit.below(moment), moment);
    (-limit).only_if(moment.below(-limit), moment)
}

impl<F: Law> Law for Resisting<F> {
    type Normal = F::Normal;
    const IS_ROUGH: bool = true;
    const FOLLOWS_NORMALS: bool = F::FOLLOWS_NORMALS;
    const RESISTS_ROLLING: bool = true;

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
        let none = Lanes::splat(simd, 0.0);
        let root = F::Normal::dashpot(simd, &touch);
        let softness = (root * root).only_if(touch.is_touching, none);
        let before = Lanes::load(simd, &self.softness, part);
        let kept = kept(simd, softness, before);
        softness.store(&mut self.softness, part);
        let step = softness * Lanes::splat(simd, time_step);
        let along = slip.rolling.dot(touch.normal);
        let across = slip.rolling - touch.normal.scaled(along);
        let force = F::Normal::force(simd, &touch);
        let both = |arrays: &Both, factor: Lanes<S>| {
            let [rolling, twisting] = arrays;
            [
                Lanes::load(simd, rolling, part) * factor,
                Lanes::load(simd, twisting, part) * factor,
            ]
        };
        let [growth, twist_growth] = both(&self.stiffness, step);
        let [limit, twist_limit] = both(&self.reach, force);
        let [drag, twist_drag] = both(&self.dashpots, root);

        let rolling = self.turned(simd, part, touch.normal, slip.spins, time_step);
        let rolling = rolling.scaled(kept) - across.scaled(growth);
        let rolling = cut(simd, rolling, limit).only_if(touch.is_touching, Vectors::zero(simd));
        rolling.store(&mut self.rolling, part);
        let twisting = Lanes::load(simd, &self.twisting, part) * kept;
        let twisting = cut_along(twisting - along * twist_growth, twist_limit);
        let twisting = twisting.only_if(touch.is_touching, none);
        twisting.store(&mut self.twisting, part);

        let rolling = cut(simd, rolling - across.scaled(drag), limit);
        let twisting = cut_along(twisting - along * twist_drag, twist_limit);
        let moment = rolling + touch.normal.scaled(twisting);
        let told = moment.only_if(touch.is_touching, Vectors::zero(simd));
        told.store(&mut self.moment, part);
        Push {
            moment: Some(moment),
            ..push
        }
    }

    #[inline(always)]
    fn ask(&self) {
        self.law.ask();
        for both in [&self.stiffness, &self.reach, &self.dashpots] {
            ask_all(both);
        }
        ask_all(&self.rolling);
        ask(&self.twisting);
        ask(&self.softness);
        ask_all(&self.moment);
    }

    #[inline(always)]
    fn forget<S: Simd>(&mut self, simd: S, part: usize) {
        self.law.forget(simd, part);
        let none = Lanes::splat(simd, 0.0);
        Vectors::zero(simd).store(&mut self.rolling, part);
        none.store(&mut self.twisting, part);
        none.store(&mut self.softness, part);
        Vectors::zero(simd).store(&mut self.moment, part);
    }
}

impl<F: Law> Lanewise for Resisting<F> {
    fn past(&self, lane: usize) -> Past {
        Past {
            rolling: Vector::from(self.rolling.map(|array| array[lane])),
            twisting: self.twisting[lane],
            root: self.softness[lane],
            ..self.law.past(lane)
        }
    }

    fn start(&mut self, lane: usize, springs: &Springs, past: &Past) {
        self.law.start(lane, springs, past);
        self.remember_turning(lane, past);
        let resistance = &springs.resistance;
        for way in 0..2 {
            self.stiffness[way][lane] = resistance.stiffness[way];
            self.reach[way][lane] = resistance.reach[way];
            self.dashpots[way][lane] = resistance.dashpots[way];
        }
    }

    fn remember(&mut self, lane: usize, past: &Past) {
        self.law.remember(lane, past);
        self.remember_turning(lane, past);
    }

    fn forces(&self, lane: usize, spring: &Spring) -> ContactForces {
        let root = spring.dashpot::<F::Normal>();
        ContactForces {
            rolling: Vector::from(self.rolling.map(|array| array[lane])),
            twisting: self.twisting[lane],
            moment: Some(Vector::from(self.moment.map(|array| array[lane]))),
            turning_stiffness: self.stiffness.map(|array| root * root * array[lane]),
            turning_dashpots: self.dashpots.map(|array| root * array[lane]),
            ..self.law.forces(lane, spring)
        }
    }

    fn show(&mut self, columns: &mut dyn Columns) {
        self.law.show(columns);
        for both in [&mut self.stiffness, &mut self.reach, &mut self.dashpots] {
            columns.all_numbers(both);
        }
        columns.all_numbers(&mut self.rolling);
        columns.numbers(&mut self.twisting);
        columns.numbers(&mut self.softness);
        columns.all_numbers(&mut self.moment);
    }
}

impl<F: Law> Resisting<F> {
    fn remember_turning(&mut self, lane: usize, past: &Past) {
        for axis in 0..3 {
            self.rolling[axis][lane] = past.rolling[axis];
        }
        self.twisting[lane] = past.twisting;
        self.softness[lane] = past.root;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::law::{Coulomb, Kept, Linear};
    use pulp::Scalar;

    /// Steps a contact by Δt of 1e-4 s with this normal and these spins.
    fn step(law: &mut Resisting<Coulomb<Linear, Kept>>, normal: Vector, spins: [Vector; 2]) {
        let simd = Scalar::new();
        let splat = |value: f64| Lanes::splat(simd, value);
        let vectors = |vector: Vector| Vectors::splat(simd, vector.into());
        let touch = Touch {
            normal: vectors(normal),
            overlap: splat(1e-5),
            reach: splat(0.02),
            stiffness: splat(1e6),
            shear_ratio: splat(0.3),
            friction: splat(0.5),
            is_touching: true,
        };
        let slip = Slip {
            approach: splat(0.0),
            velocity: Vectors::zero(simd),
            spins: vectors(spins[0] + spins[1]),
            last_normal: vectors(normal),
            rolling: vectors(spins[1] - spins[0]),
        };
        law.advance(simd, 0, touch, slip, 1e-4);
    }

    /// A pair that turns as a whole takes its moments along: both lengths stay, and M_r points as it would on
    /// a solid.
    #[test]
    fn moments_turn_with_the_pair() {
        let mut law = Resisting::<Coulomb<Linear, Kept>>::default();
        (law.stiffness[0][0], law.stiffness[1][0]) = (20.0, 20.0);
        (law.reach[0][0], law.reach[1][0]) = (1.0, 1.0);
        let normal = Vector::new(0.0, 0.0, 1.0);
        // M_r = −k_r Δt ω_r, M_t = −k_t Δt ω_n
        step(
            &mut law,
            normal,
            [Vector::zeros(), Vector::new(30.0, 0.0, -50.0)],
        );
        let spin = Vector::new(40.0, -20.0, 70.0);
        for number in 1..=500 {
            let turn = nalgebra::Rotation3::new(spin * (1e-4 * f64::from(number)));
            step(&mut law, turn * normal, [spin; 2]);
        }
        let turn = nalgebra::Rotation3::new(spin * 0.05);
        let past = law.past(0);
        let expected = turn * Vector::new(-0.06, 0.0, 0.0);
        assert!((past.rolling.norm() - 0.06).abs() < 1e-14, "{past:?}");
        assert!((past.twisting - 0.1).abs() < 1e-15, "{past:?}");
        // turned by 4 rad in 500 steps of first order
        assert!(
            (past.rolling - expected).norm() < 0.06 * 1e-2,
            "{past:?} {expected:?}"
        );
    }

    /// M = −(k Δt + c) ω: what observers are told has the dashpots in it, what is remembered has not.
    #[test]
    fn moments_are_told_with_their_dashpots() {
        let mut law = Resisting::<Coulomb<Linear, Kept>>::default();
        (law.stiffness[0][0], law.stiffness[1][0]) = (20.0, 30.0);
        (law.dashpots[0][0], law.dashpots[1][0]) = (4e-3, 7e-3);
        (law.reach[0][0], law.reach[1][0]) = (1.0, 1.0);
        let normal = Vector::new(0.0, 0.0, 1.0);
        step(
            &mut law,
            normal,
            [Vector::zeros(), Vector::new(3.0, 0.0, 5.0)],
        );
        let spring = Spring {
            constant: 1e6,
            shear_ratio: 0.3,
            overlap: 1e-5,
            reach: 0.02,
        };
        let told = law.forces(0, &spring).moment.expect("moments");
        let expected = Vector::new(-(2e-3 + 4e-3) * 3.0, 0.0, -(3e-3 + 7e-3) * 5.0);
        assert!((told - expected).norm() < 1e-16, "{told:?}");
        assert!((law.past(0).twisting + 3e-3 * 5.0).abs() < 1e-16);
    }

    #[test]
    fn moments_end_at_their_limits() {
        let mut law = Resisting::<Coulomb<Linear, Kept>>::default();
        (law.stiffness[0][0], law.stiffness[1][0]) = (20.0, 20.0);
        (law.reach[0][0], law.reach[1][0]) = (1e-3, 2e-3);
        let normal = Vector::new(0.0, 0.0, 1.0);
        step(
            &mut law,
            normal,
            [Vector::zeros(), Vector::new(0.0, 30.0, 50.0)],
        );
        let past = law.past(0);
        // F_N = 1e6 N/m · 1e-5 m
        assert!(
            (past.rolling - Vector::new(0.0, -0.01, 0.0)).norm() < 1e-17,
            "{past:?}"
        );
        assert!((past.twisting + 0.02).abs() < 1e-17, "{past:?}");
    }
}
