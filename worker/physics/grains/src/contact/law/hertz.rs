//! Hertz-Mindlin contacts of elastic spheres.
//!
//! With effective moduli E* and G*, effective radius R* (that of the sphere at a flat wall),
//!
//!   F_N = 4/3 E* √R* δ^1.5, k_N = 2 E* √(R* δ) (G.15)
//!   k_T = 8 G* √(R* δ) (G.16)
//!   1/E* = Σ (1 − ν²)/E, 1/G* = Σ (2 − ν)/G with G = E/(2(1 + ν)), 1/R* = Σ 1/r
//!
//! The shear force grows by increments with the k_T of the moment, Mindlin's solution without slip;
//! when the overlap falls the shear force falls with k_T, since carrying it over to a softer spring
//! would make energy. Sliding is Coulomb's.
//!
//! Source: [Johnson1985] chapter 4 and 7; the fall of the shear force [Thornton2013], as in
//! LAMMPS's `mindlin_rescale`.
use loadframe_api::spec::granular_scene::hertz;
use pulp::Simd;

use super::{
    ContactForces, Kept, Lanewise, Law, Push, Slip, Touch,
    coulomb::{Coulomb, cut},
    kept,
    normal::{Normal, Spring},
};
use crate::{
    contact::packed::Columns,
    contact::past::Past,
    contact::stiffness::{Cement, Side, Springs},
    numbers::{
        ahead::ask,
        lanes::{Array, Lanes, Vectors},
    },
};

/// F_N = 4/3 E* √R* δ^1.5.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Hertz;

/// c of a dashpot along the normal over 2 β √(m* k_N): with k_N the tangent (G.15) it gives the
/// restitution asked for whatever the speed ([AntypovElliott2011]).
const DASHPOT: f64 = 0.912_870_929_175_276_9; // √(5/6)

impl Normal for Hertz {
    fn springs(a: &Side, b: &Side) -> Springs {
        let [a_solid, b_solid] = [a, b].map(|side| side.surface.solid());
        let root = hertz::effective_radius(a.curvature(), b.curvature()).sqrt();
        let modulus = hertz::effective_modulus(a_solid, b_solid);
        let shear_modulus = hertz::effective_shear_modulus(a_solid, b_solid);
        let stiffness = [2.0 * modulus * root, 8.0 * shear_modulus * root];
        let [along, across] = a.dashpots_with(b, stiffness);
        Springs {
            normal: 4.0 / 3.0 * modulus * root,
            ratio: 6.0 * shear_modulus / modulus,
            friction: a.friction_with(b),
            dashpots: [DASHPOT * along, across],
            resistance: a.resistance_with(b, stiffness[1]),
            // bonds stand on linear springs
            cement: Cement::default(),
        }
    }

    #[inline(always)]
    fn force<S: Simd>(_simd: S, touch: &Touch<S>) -> Lanes<S> {
        touch.stiffness * touch.overlap * touch.overlap.sqrt()
    }

    fn tangent(spring: &Spring) -> f64 {
        1.5 * spring.constant * spring.overlap.max(0.0).sqrt()
    }

    fn energy(spring: &Spring, _force_square: f64) -> f64 {
        0.4 * spring.constant * spring.overlap.max(0.0).powf(2.5)
    }

    fn shear(constant: f64, spring: &Spring) -> f64 {
        constant * spring.overlap.max(0.0).sqrt()
    }

    /// δ^¼: dashpots follow the roots of the tangents.
    #[inline(always)]
    fn dashpot<S: Simd>(_simd: S, touch: &Touch<S>) -> Lanes<S> {
        touch.overlap.sqrt().sqrt()
    }

    fn foreseen(own: &Side, speed: f64) -> f64 {
        let solid = own.surface.solid();
        let wall = hertz::effective_modulus(solid, hertz::RIGID);
        hertz::impact_stiffness(wall, own.radius, own.inverse_mass, speed)
    }
}

/// Hertz springs, Mindlin shear without slip, Coulomb friction.
#[derive(Clone, Debug, Default, PartialEq)]
#[repr(align(64))]
pub(crate) struct HertzMindlin {
    coulomb: Coulomb<Hertz, Kept>,
    /// √δ of the last step [√m].
    root: Array,
}

impl Law for HertzMindlin {
    type Normal = Hertz;
    const IS_ROUGH: bool = true;
    const FOLLOWS_NORMALS: bool = false;

    #[inline(always)]
    fn advance<S: Simd>(
        &mut self,
        simd: S,
        part: usize,
        touch: Touch<S>,
        slip: Slip<S>,
        time_step: f64,
    ) -> Push<S> {
        let zero = Lanes::splat(simd, 0.0);
        let root = touch.overlap.sqrt().only_if(touch.is_touching, zero);
        let before = Lanes::load(simd, &self.root, part);
        let kept = kept(simd, root, before);
        let turned = (self.coulomb).turned(simd, part, touch.normal, slip, time_step);
        let constant = touch.stiffness * touch.shear_ratio;
        let stiffness = constant * root * Lanes::splat(simd, time_step);
        let grown = turned.scaled(kept) - slip.velocity.scaled(stiffness);
        let normal = Hertz::force(simd, &touch);
        let limit = normal * touch.friction;
        let shear = cut(simd, grown, limit).only_if(touch.is_touching, Vectors::zero(simd));
        self.coulomb.keep(part, touch.normal, shear);
        root.store(&mut self.root, part);
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
        self.coulomb.ask();
        ask(&self.root);
    }

    #[inline(always)]
    fn forget<S: Simd>(&mut self, simd: S, part: usize) {
        self.coulomb.forget(simd, part);
        Lanes::splat(simd, 0.0).store(&mut self.root, part);
    }
}

impl Lanewise for HertzMindlin {
    fn past(&self, lane: usize) -> Past {
        Past {
            root: self.root[lane],
            ..self.coulomb.past(lane)
        }
    }

    fn remember(&mut self, lane: usize, past: &Past) {
        self.coulomb.remember(lane, past);
        self.root[lane] = past.root;
    }

    fn forces(&self, lane: usize, spring: &Spring) -> ContactForces {
        self.coulomb.forces(lane, spring)
    }

    fn show(&mut self, columns: &mut dyn Columns) {
        self.coulomb.show(columns);
        columns.numbers(&mut self.root);
    }
}
