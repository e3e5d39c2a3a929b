//! Bonds that break, then friction.
//!
//! An intact bond has the rest overlap δ₀ and pulls as well as it pushes,
//!
//!   F_N = k_N (δ − δ₀), broken when −F_N > a_N (G.12)
//!   F_T by increments as without a bond, broken when |F_T| > max(0, a_T + F_N tan φ) (G.13)
//!
//! with strengths a = c min(r_a, r_b)² for cohesions c [Pa]. A contact whose bond broke is an
//! ordinary one, F_N = k_N (δ − δ₀) ≥ 0 under Coulomb friction; it keeps δ₀ until its spheres are
//! apart, since they may have been bonded deep inside each other.
//!
//! Source: T 3.34; Yade's `Law2_ScGeom6D_CohFrictPhys_CohesionMoment` without moments, whose bonds
//! have δ₀ = 0.
use pulp::Simd;

use super::super::{
    packed::Columns,
    past::{Beam, Bond, Past},
};
use super::{
    ContactForces, Kept, Lanewise, Law, Linear, Push, Slip, Spring, Touch,
    coulomb::{Coulomb, cut},
};
use crate::numbers::{
    ahead::ask,
    lanes::{Array, Lanes, Vectors},
};

/// Friction, and bonds for some.
#[derive(Clone, Debug, Default, PartialEq)]
#[repr(align(64))]
pub(crate) struct Bonded {
    coulomb: Coulomb<Linear, Kept>,
    /// a_N [N].
    normal_strength: Array,
    /// a_T [N].
    shear_strength: Array,
    /// δ₀ [m].
    rest: Array,
    /// 1 for an intact bond, else 0.
    intact: Array,
}

impl Law for Bonded {
    type Normal = Linear;
    const IS_ROUGH: bool = true;
    const FOLLOWS_NORMALS: bool = false;

    #[inline(always)]
    fn acting<S: Simd>(&self, simd: S, part: usize, touching: S::m64s) -> S::m64s {
        simd.or_m64s(touching, self.is_intact(simd, part))
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
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let was_intact = self.is_intact(simd, part);
        let rest = Lanes::load(simd, &self.rest, part);
        let stretch = touch.overlap - rest;
        let spring = touch.stiffness * stretch;
        let grown = self.coulomb.grown(simd, part, &touch, slip, time_step);

        let holds = Lanes::load(simd, &self.normal_strength, part);
        let is_torn = holds.below(-spring);
        let limit = Lanes::load(simd, &self.shear_strength, part) + spring * touch.friction;
        let limit = limit.only_if(zero.below(limit), zero);
        let is_sheared = (limit * limit).below(grown.dot(grown));
        let breaks = simd.or_m64s(is_torn, is_sheared);
        let intact = one.only_if(was_intact, zero);
        let intact = zero.only_if(breaks, intact);
        intact.store(&mut self.intact, part);
        let is_intact = zero.below(intact);

        let pushes = spring.only_if(zero.below(spring), zero);
        let normal = spring.only_if(is_intact, pushes);
        let limit = pushes * touch.friction;
        let sliding = cut(simd, grown, limit);
        let acts = simd.or_m64s(touch.is_touching, is_intact);
        // what broke does not pull
        let pulled = (-stretch).only_if(is_intact, zero);
        let compression = stretch.only_if(zero.below(stretch), pulled);
        let shear = grown
            .only_if(is_intact, sliding)
            .only_if(acts, Vectors::zero(simd));
        rest.only_if(acts, zero).store(&mut self.rest, part);
        self.coulomb.keep(part, touch.normal, shear);
        Push {
            normal,
            shear,
            limit,
            compression,
            acts,
            moment: None,
        }
    }

    #[inline(always)]
    fn ask(&self) {
        self.coulomb.ask();
        for array in [
            &self.normal_strength,
            &self.shear_strength,
            &self.rest,
            &self.intact,
        ] {
            ask(array);
        }
    }

    #[inline(always)]
    fn forget<S: Simd>(&mut self, simd: S, part: usize) {
        self.coulomb.forget(simd, part);
        Lanes::splat(simd, 0.0).store(&mut self.rest, part);
    }
}

impl Lanewise for Bonded {
    fn past(&self, lane: usize) -> Past {
        Past {
            bond: Bond {
                is_intact: self.intact[lane] > 0.0,
                strength: [self.normal_strength[lane], self.shear_strength[lane]],
                rest: self.rest[lane],
                beam: Beam::default(),
            },
            ..self.coulomb.past(lane)
        }
    }

    fn remember(&mut self, lane: usize, past: &Past) {
        self.coulomb.remember(lane, past);
        [self.normal_strength[lane], self.shear_strength[lane]] = past.bond.strength;
        self.rest[lane] = past.bond.rest;
        self.intact[lane] = f64::from(u8::from(past.bond.is_intact));
    }

    fn forces(&self, lane: usize, spring: &Spring) -> ContactForces {
        let is_bonded = self.intact[lane] > 0.0;
        let spring = Spring {
            overlap: spring.overlap - self.rest[lane],
            ..*spring
        };
        let forces = self.coulomb.forces(lane, &spring);
        // what broke does not pull
        let pushing = |value: f64| if is_bonded { value } else { value.max(0.0) };
        ContactForces {
            spring_force: pushing(forces.force),
            force: pushing(forces.force),
            compression: pushing(forces.compression),
            is_bonded,
            ..forces
        }
    }

    fn show(&mut self, columns: &mut dyn Columns) {
        self.coulomb.show(columns);
        columns.numbers(&mut self.normal_strength);
        columns.numbers(&mut self.shear_strength);
        columns.numbers(&mut self.rest);
        columns.numbers(&mut self.intact);
    }
}

impl Bonded {
    #[inline(always)]
    fn is_intact<S: Simd>(&self, simd: S, part: usize) -> S::m64s {
        Lanes::splat(simd, 0.0).below(Lanes::load(simd, &self.intact, part))
    }
}
