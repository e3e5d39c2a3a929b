//! Springs along the normal: what they are made of, and what they make of an overlap.
//!
//! Each is a type of its own in a file of its own; [`Linear`] is here:
//!
//!   F_N = k_N δ, with two springs E 2r in series (T 3.3-3.8, 3.23)
use std::fmt::Debug;

use loadframe_api::spec::granular_scene::series_stiffness;
use pulp::{Scalar, Simd};

use super::Touch;
use crate::{
    contact::stiffness::{Side, Springs},
    numbers::lanes::{Lanes, Vectors},
};

/// The normal spring of one contact, as observers see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spring {
    /// Constant of the spring: k_N [N/m] of a linear one.
    pub(crate) constant: f64,
    /// k_T/k_N of the constants.
    pub(crate) shear_ratio: f64,
    /// Overlap beyond that without force [m].
    pub(crate) overlap: f64,
    /// Distance at which the bodies just touch [m].
    pub(crate) reach: f64,
}

/// A spring along the normal.
pub(crate) trait Normal:
    Clone + Copy + Debug + Default + PartialEq + Send + Sync + 'static
{
    /// Constants of the springs between two bodies.
    fn springs(a: &Side, b: &Side) -> Springs;

    /// F_N [N], of meaning for overlaps above 0.
    fn force<S: Simd>(simd: S, touch: &Touch<S>) -> Lanes<S>;

    /// dF_N/dδ [N/m].
    fn tangent(spring: &Spring) -> f64;

    /// ∫ F_N dδ [J], given the square of F_N.
    fn energy(spring: &Spring, force_square: f64) -> f64;

    /// Stiffness across the normal [N/m], from its constant.
    fn shear(constant: f64, _spring: &Spring) -> f64 {
        constant
    }

    /// What the constants of dashpots are multiplied with at this overlap: 1 for linear springs.
    fn dashpot<S: Simd>(simd: S, _touch: &Touch<S>) -> Lanes<S> {
        Lanes::splat(simd, 1.0)
    }

    /// Stiffness [N/m] of a contact that a body may come to: with its like, or with a rigid wall at
    /// `speed` [m/s], whichever is stiffer.
    fn foreseen(own: &Side, speed: f64) -> f64;
}

impl Spring {
    /// F_N [N]: the same arithmetic as in the blocks.
    pub(crate) fn force<N: Normal>(&self) -> f64 {
        let simd = Scalar::new();
        N::force(simd, &self.touch(simd)).value
    }

    /// Tangents k_N, k_T [N/m].
    pub(crate) fn tangents<N: Normal>(&self) -> [f64; 2] {
        let constant = self.shear_ratio * self.constant;
        [N::tangent(self), N::shear(constant, self)]
    }

    /// What the constants of dashpots are multiplied with.
    pub(crate) fn dashpot<N: Normal>(&self) -> f64 {
        let simd = Scalar::new();
        N::dashpot(simd, &self.touch(simd)).value
    }

    fn touch(&self, simd: Scalar) -> Touch<Scalar> {
        let splat = |value: f64| Lanes::splat(simd, value);
        Touch {
            normal: Vectors::zero(simd),
            overlap: splat(self.overlap),
            reach: splat(self.reach),
            stiffness: splat(self.constant),
            shear_ratio: splat(self.shear_ratio),
            friction: splat(0.0),
            is_touching: true,
        }
    }
}

/// F_N = k_N δ.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Linear;

impl Linear {
    /// k_N and k_T of two springs in series, and dashpots that give the restitutions they are asked for
    /// in every impact and every swing (see [`super::viscous`]).
    pub(super) fn between(a: &Side, b: &Side) -> Springs {
        let [first, second] = [a, b].map(|side| side.surface.stiffness(side.radius));
        let [first_ratio, second_ratio] = [a, b].map(|side| side.surface.stiffness_ratio);
        let normal = series_stiffness(first, second);
        let shear = series_stiffness(first * first_ratio, second * second_ratio);
        #[allow(clippy::float_cmp, reason = "of one material, or written alike")]
        let is_alike = first_ratio == second_ratio;
        Springs {
            normal,
            // the quotient would differ by a rounding from contact to contact
            ratio: if is_alike {
                first_ratio
            } else {
                shear / normal
            },
            friction: a.friction_with(b),
            dashpots: a.dashpots_with(b, [normal, shear]),
            resistance: a.resistance_with(b, shear),
            cement: a.cement_with(b),
        }
    }
}

impl Normal for Linear {
    fn springs(a: &Side, b: &Side) -> Springs {
        Self::between(a, b)
    }

    #[inline(always)]
    fn force<S: Simd>(_simd: S, touch: &Touch<S>) -> Lanes<S> {
        touch.stiffness * touch.overlap
    }

    fn tangent(spring: &Spring) -> f64 {
        spring.constant
    }

    fn energy(spring: &Spring, force_square: f64) -> f64 {
        0.5 * force_square / spring.constant
    }

    fn foreseen(own: &Side, _speed: f64) -> f64 {
        // a wall harder than the member would be: twice its own stiffness in series
        2.0 * own.surface.half_stiffness(own.radius)
    }
}
