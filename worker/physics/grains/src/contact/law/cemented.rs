//! Bonds that bend and twist, beside friction: beams of cement between spheres.
//!
//! A contact with the rest overlap δ₀ pushes and slides as any other, F_N = k_N (δ − δ₀) ≥ 0 under Coulomb
//! friction. Beside it an intact bond, made at the overlap δ_b, is a round beam of radius R̄ and length
//! L = r_a + r_b − δ_b,
//!
//!   F_b = EA/L (δ − δ_b) (G.32)
//!   F_s ← F_s − κEA/L Δt v_T, M_b ← M_b − EI/L Δt ω_r, M_t ← M_t − κEJ/L Δt ω_n (G.33)
//!   A = πR̄², I = πR̄⁴/4, J = πR̄⁴/2
//!
//! with forces and moments on b, ω = ω_b − ω_a, ω_n its part along the normal and ω_r the rest. F_s and
//! M_b are turned as a shear force is (G.3). v_T is that of the two centres and their spins over the
//! distance that they have: the slip of a contact, which is over r_a + r_b, times (r_a + r_b − δ)/(r_a + r_b).
//! It breaks as a whole when its outermost fibre does,
//!
//!   σ = −F_b/A + |M_b| R̄/I > σ_c or τ = |F_s|/A + |M_t| R̄/J > τ_c (G.34)
//!
//! and what is left is the contact, which keeps δ₀ until its spheres are apart.
//!
//! Source: [PotyondyCundall2004] equations 6 to 18; there L = r_a + r_b, and δ₀ = 0.
use std::f64::consts::PI;

use pulp::Simd;

use super::{
    ContactForces, Kept, Lanewise, Law, Linear, Push, Slip, Spring, Touch,
    coulomb::{Coulomb, cut},
    in_spring,
};
use crate::{
    contact::packed::Columns,
    contact::past::{Beam, Bond, Past},
    contact::stiffness::Springs,
    numbers::{
        Vector,
        ahead::{ask, ask_all},
        lanes::{Array, Lanes, Vectors},
    },
};

/// Friction, and beams for some.
#[derive(Clone, Debug, Default, PartialEq)]
#[repr(align(64))]
pub(crate) struct Cemented {
    coulomb: Coulomb<Linear, Kept>,
    /// δ₀ [m].
    rest: Array,
    /// δ_b and L [m].
    made: Array,
    length: Array,
    /// R̄ [m].
    radius: Array,
    /// EA/L [N/m].
    axial: Array,
    /// κ.
    ratio: Array,
    /// σ_c and τ_c [Pa].
    strengths: [Array; 2],
    /// F_s [N].
    shear: [Array; 3],
    /// M_b [N m], and M_t along the normal.
    bending: [Array; 3],
    twisting: Array,
    /// 1 for an intact bond, else 0.
    intact: Array,
}

impl Law for Cemented {
    type Normal = Linear;
    const IS_ROUGH: bool = true;
    const FOLLOWS_NORMALS: bool = false;
    const RESISTS_ROLLING: bool = true;

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
        let splat = |value: f64| Lanes::splat(simd, value);
        let load = |array: &Array| Lanes::<S>::load(simd, array, part);
        let (zero, one, none) = (splat(0.0), splat(1.0), Vectors::zero(simd));

        // the beam
        let was_intact = self.is_intact(simd, part);
        let radius = load(&self.radius);
        let square = radius * radius;
        let axial = load(&self.axial);
        let across = axial * load(&self.ratio);
        let stretch = touch.overlap - load(&self.made);
        let along = axial * stretch;
        let turn = |arrays: &[Array; 3]| {
            let before = Vectors::load(simd, arrays, part);
            (self.coulomb).turn(simd, part, before, touch.normal, slip, time_step)
        };
        let step = splat(time_step);
        let apart = (touch.reach - touch.overlap).over(touch.reach);
        let shear = turn(&self.shear) - slip.velocity.scaled(apart * across * step);
        let twist = slip.rolling.dot(touch.normal);
        let bend = slip.rolling - touch.normal.scaled(twist);
        let bending = turn(&self.bending) - bend.scaled(splat(0.25) * axial * square * step);
        let twisting = load(&self.twisting) - twist * (splat(0.5) * across * square * step);

        // its outermost fibre; without a beam the quotients are not numbers, and not taken
        let area = splat(PI) * square;
        let fibre = |force: Lanes<S>, moment: Lanes<S>| (force + moment.over(radius)).over(area);
        let size = |vector: Vectors<S>| vector.dot(vector).sqrt();
        let tension = fibre(zero - along, splat(4.0) * size(bending));
        let twisted = (twisting * twisting).sqrt();
        let sheared = fibre(size(shear), splat(2.0) * twisted);
        let [tensile, shearing] = [load(&self.strengths[0]), load(&self.strengths[1])];
        let breaks = simd.or_m64s(tensile.below(tension), shearing.below(sheared));
        let intact = zero.only_if(breaks, one.only_if(was_intact, zero));
        intact.store(&mut self.intact, part);
        let is_intact = zero.below(intact);
        let held = shear.only_if(is_intact, none);
        let bending = bending.only_if(is_intact, none);
        let twisting = twisting.only_if(is_intact, zero);
        held.store(&mut self.shear, part);
        bending.store(&mut self.bending, part);
        twisting.store(&mut self.twisting, part);

        // the contact
        let rest = load(&self.rest);
        let spring = touch.stiffness * (touch.overlap - rest);
        let pushes = spring.only_if(zero.below(spring), zero);
        let grown = self.coulomb.grown(simd, part, &touch, slip, time_step);
        let limit = pushes * touch.friction;
        let acts = simd.or_m64s(touch.is_touching, is_intact);
        let sliding = cut(simd, grown, limit).only_if(acts, none);
        rest.only_if(acts, zero).store(&mut self.rest, part);
        self.coulomb.keep(part, touch.normal, sliding);

        let compression = touch.overlap - rest;
        // what broke does not pull
        let pulled = (-compression).only_if(is_intact, zero);
        Push {
            normal: pushes + along.only_if(is_intact, zero),
            shear: sliding + held,
            limit,
            compression: compression.only_if(zero.below(compression), pulled),
            acts,
            moment: Some(bending + touch.normal.scaled(twisting)),
        }
    }

    #[inline(always)]
    fn ask(&self) {
        self.coulomb.ask();
        for array in [
            &self.rest,
            &self.made,
            &self.radius,
            &self.axial,
            &self.ratio,
            &self.twisting,
            &self.intact,
        ] {
            ask(array);
        }
        ask_all(&self.strengths);
        ask_all(&self.shear);
        ask_all(&self.bending);
    }

    #[inline(always)]
    fn forget<S: Simd>(&mut self, simd: S, part: usize) {
        self.coulomb.forget(simd, part);
        Lanes::splat(simd, 0.0).store(&mut self.rest, part);
    }
}

impl Lanewise for Cemented {
    fn past(&self, lane: usize) -> Past {
        let vector = |arrays: &[Array; 3]| Vector::from(arrays.map(|array| array[lane]));
        Past {
            rolling: vector(&self.bending),
            twisting: self.twisting[lane],
            bond: Bond {
                is_intact: self.intact[lane] > 0.0,
                strength: [0.0; 2],
                rest: self.rest[lane],
                beam: Beam {
                    rest: self.made[lane],
                    length: self.length[lane],
                    shear: vector(&self.shear),
                },
            },
            ..self.coulomb.past(lane)
        }
    }

    fn start(&mut self, lane: usize, springs: &Springs, past: &Past) {
        self.remember(lane, past);
        let cement = &springs.cement;
        let length = self.length[lane];
        self.axial[lane] = if length > 0.0 {
            cement.section / length
        } else {
            0.0
        };
        self.radius[lane] = cement.radius;
        self.ratio[lane] = cement.ratio;
        for (array, strength) in self.strengths.iter_mut().zip(cement.strengths) {
            array[lane] = strength;
        }
    }

    fn remember(&mut self, lane: usize, past: &Past) {
        self.coulomb.remember(lane, past);
        let bond = &past.bond;
        self.rest[lane] = bond.rest;
        self.made[lane] = bond.beam.rest;
        self.length[lane] = bond.beam.length;
        self.twisting[lane] = past.twisting;
        for axis in 0..3 {
            self.shear[axis][lane] = bond.beam.shear[axis];
            self.bending[axis][lane] = past.rolling[axis];
        }
        self.intact[lane] = f64::from(u8::from(bond.is_intact));
    }

    fn forces(&self, lane: usize, spring: &Spring) -> ContactForces {
        let is_bonded = self.intact[lane] > 0.0;
        let contact = Spring {
            overlap: spring.overlap - self.rest[lane],
            ..*spring
        };
        let forces = self.coulomb.forces(lane, &contact);
        if !is_bonded {
            return ContactForces {
                spring_force: forces.force.max(0.0),
                force: forces.force.max(0.0),
                compression: forces.compression.max(0.0),
                ..forces
            };
        }
        let past = self.past(lane);
        let square = self.radius[lane].powi(2);
        let axial = self.axial[lane];
        let across = axial * self.ratio[lane];
        let along = axial * (spring.overlap - self.made[lane]);
        let shear = past.bond.beam.shear;
        let pushes = forces.force.max(0.0);
        let [normal, sliding] = forces.stiffness;
        let held = in_spring(along * along, axial)
            + in_spring(shear.norm_squared(), across)
            + in_spring(pushes * pushes, normal)
            + in_spring(forces.spring_shear.norm_squared(), sliding);
        ContactForces {
            // their energies are held
            spring_force: 0.0,
            spring_shear: Vector::zeros(),
            force: pushes + along,
            shear: forces.shear + shear,
            stiffness: [normal + axial, sliding + across],
            rolling: past.rolling,
            twisting: past.twisting,
            turning_stiffness: [0.25 * axial * square, 0.5 * across * square],
            held,
            is_bonded,
            ..forces
        }
    }

    fn show(&mut self, columns: &mut dyn Columns) {
        self.coulomb.show(columns);
        for array in [
            &mut self.rest,
            &mut self.made,
            &mut self.length,
            &mut self.radius,
            &mut self.axial,
            &mut self.ratio,
            &mut self.twisting,
            &mut self.intact,
        ] {
            columns.numbers(array);
        }
        columns.all_numbers(&mut self.strengths);
        columns.all_numbers(&mut self.shear);
        columns.all_numbers(&mut self.bending);
    }
}

impl Cemented {
    #[inline(always)]
    fn is_intact<S: Simd>(&self, simd: S, part: usize) -> S::m64s {
        Lanes::splat(simd, 0.0).below(Lanes::load(simd, &self.intact, part))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::stiffness::{Cement, Resistance};
    use pulp::Scalar;

    /// A beam of R̄ = 0.1 m, EA = 1e4 N and L = 0.5 m: EA/L = 2e4 N/m, κEA/L = 1e4 N/m,
    /// EI/L = 2e4 · 0.01/4 = 50 N m, κEJ/L = 1e4 · 0.01/2 = 50 N m.
    fn beam(strengths: [f64; 2]) -> Cemented {
        let mut law = Cemented::default();
        let springs = Springs {
            normal: 1e5,
            ratio: 0.3,
            friction: 0.5,
            dashpots: [0.0; 2],
            resistance: Resistance::default(),
            cement: Cement {
                radius: 0.1,
                section: 1e4,
                ratio: 0.5,
                strengths,
            },
        };
        let past = Past {
            normal: Vector::x(),
            bond: Bond {
                is_intact: true,
                beam: Beam {
                    length: 0.5,
                    ..Beam::default()
                },
                ..Bond::default()
            },
            ..Past::default()
        };
        law.start(0, &springs, &past);
        law
    }

    /// A step of 1 s along x with this overlap, slip of b and difference of spins: force and moment on b.
    fn step(law: &mut Cemented, overlap: f64, slip: Vector, spin: Vector) -> Option<[Vector; 2]> {
        let simd = Scalar::new();
        let splat = |value: f64| Lanes::splat(simd, value);
        let vectors = |vector: Vector| Vectors::splat(simd, vector.into());
        let touch = Touch {
            normal: vectors(Vector::x()),
            overlap: splat(overlap),
            reach: splat(0.5),
            stiffness: splat(1e5),
            shear_ratio: splat(0.3),
            friction: splat(0.5),
            is_touching: overlap >= 0.0,
        };
        let slip = Slip {
            approach: splat(0.0),
            velocity: vectors(slip),
            spins: Vectors::zero(simd),
            last_normal: vectors(Vector::x()),
            rolling: vectors(spin),
        };
        let push = law.advance(simd, 0, touch, slip, 1.0);
        let vector = |v: Vectors<Scalar>| Vector::new(v.x.value, v.y.value, v.z.value);
        push.acts.then(|| {
            let moment = push.moment.expect("moments");
            [
                push.normal.value * Vector::x() + vector(push.shear),
                vector(moment),
            ]
        })
    }

    #[test]
    fn a_beam_pulls_shears_bends_and_twists() {
        let mut law = beam([1e9; 2]);
        let spin = Vector::new(2e-3, 1e-3, 0.0);
        let slip = Vector::new(0.0, 0.0, 1e-3);
        let [force, moment] = step(&mut law, -1e-3, slip, spin).expect("it holds");
        // the distance is 0.501 of 0.5 m: F_s = 1e4 · 1e-3 · 1.002
        let expected = Vector::new(-2e4 * 1e-3, 0.0, -1e4 * 1e-3 * 1.002);
        assert!((force - expected).norm() < 1e-12, "{force}");
        let expected = Vector::new(-50.0 * 2e-3, -50.0 * 1e-3, 0.0);
        assert!((moment - expected).norm() < 1e-15, "{moment}");
        // ½F²/k each, and the moments'
        let spring = Spring {
            constant: 1e5,
            shear_ratio: 0.3,
            overlap: -1e-3,
            reach: 0.5,
        };
        let energy = law.forces(0, &spring).tangential_energy();
        let expected =
            0.5 * (20.0_f64.powi(2) / 2e4 + 10.02_f64.powi(2) / 1e4) + 0.5 * 50.0 * (4e-6 + 1e-6);
        assert!((energy - expected).abs() < 1e-15, "{energy} {expected}");
    }

    #[test]
    fn compressed_it_acts_beside_the_contact_with_its_friction() {
        let mut law = beam([1e9; 2]);
        let slip = Vector::new(0.0, 1.0, 0.0);
        let [force, _] = step(&mut law, 1e-3, slip, Vector::zeros()).expect("it holds");
        // (1e5 + 2e4) · 1e-3 along; 1e4 · 0.998 of the beam and 0.5 · 100 N of friction across
        let expected = Vector::new(120.0, -(1e4 * 0.998 + 50.0), 0.0);
        assert!((force - expected).norm() < 1e-9, "{force}");
    }

    #[test]
    fn it_breaks_by_the_stress_of_its_outermost_fibre() {
        let (area, radius) = (PI * 0.01, 0.1);
        // F/A + 4M/(πR̄³), and F_s/A + 2M_t/(πR̄³)
        let tension = 20.0 / area + 4.0 * 0.05 / (PI * radius * radius * radius);
        let shear = 10.02 / area + 2.0 * 0.1 / (PI * radius * radius * radius);
        let spin = Vector::new(2e-3, 1e-3, 0.0);
        let slip = Vector::new(0.0, 0.0, 1e-3);
        for (part, strengths) in [(0, [tension, 1e9]), (1, [1e9, shear])] {
            for (factor, holds) in [(1.0 + 1e-12, true), (1.0 - 1e-12, false)] {
                let mut strengths = strengths;
                strengths[part] *= factor;
                let mut law = beam(strengths);
                let acts = step(&mut law, -1e-3, slip, spin);
                assert_eq!(acts.is_some(), holds, "{part} {factor}");
                let past = law.past(0);
                assert_eq!(past.bond.is_intact, holds);
                assert_eq!(past.rolling.norm() > 0.0, holds);
            }
        }
    }
}
