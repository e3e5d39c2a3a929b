//! Shear laws. A scene without friction remembers nothing in its contacts and turns nothing.
//!
//! Coulomb friction by increments: the shear force of the last step is turned with the contact and
//! with the mean spin about the normal, grows by k_T times the slip of the step, and is cut back to
//! the cone,
//!
//!   F_T ← F_T − F_T × (n₀ × n) − F_T × (½Δt n₀·(ω_a + ω_b)) n₀ (G.3)
//!   F_T ← F_T − k_T Δt v_T, |F_T| ≤ F_N tan φ (G.4)
//!
//! with the normal n₀ of the last step. Both turns of (G.3) are done one after the other.
//!
//! Source: [CundallStrack1979] as written in Yade's `ScGeom::rotate`.
use std::fmt::Debug;

use pulp::Simd;
use serde::{Deserialize, Serialize, de::DeserializeOwned};

use super::{Slip, Touch};
use crate::granular::{
    Vector,
    lanes::{Array, Lanes, Vectors},
};

/// What a contact is told once, and its past.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::granular) struct Past {
    /// k_T [N/m].
    pub(in crate::granular) stiffness: f64,
    /// tan φ.
    pub(in crate::granular) friction: f64,
    /// n₀, from a to b.
    pub(in crate::granular) normal: Vector,
    /// F_T on b [N].
    pub(in crate::granular) shear: Vector,
}

/// A shear law for the contacts of a block.
pub(in crate::granular) trait Friction:
    Clone + Debug + Default + Send + Sync + Serialize + DeserializeOwned + 'static
{
    /// Whether there is a shear force at all.
    const IS_ROUGH: bool;

    /// Shear force on b after this step [N], zero where nothing touches.
    fn advance<S: Simd>(
        &mut self,
        simd: S,
        part: usize,
        touch: Touch<S>,
        slip: Slip<S>,
        time_step: f64,
    ) -> Vectors<S>;

    /// Nothing touches in this part of the block.
    fn forget<S: Simd>(&mut self, simd: S, part: usize);

    fn past(&self, lane: usize) -> Past;

    fn set_past(&mut self, lane: usize, past: &Past);
}

/// No friction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::granular) struct Frictionless;

/// Coulomb friction with its memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[repr(align(64))]
pub(in crate::granular) struct Coulomb {
    stiffness: Array,
    friction: Array,
    normal: [Array; 3],
    shear: [Array; 3],
}

impl Friction for Frictionless {
    const IS_ROUGH: bool = false;

    #[inline(always)]
    fn advance<S: Simd>(
        &mut self,
        simd: S,
        _part: usize,
        _touch: Touch<S>,
        _slip: Slip<S>,
        _time_step: f64,
    ) -> Vectors<S> {
        Vectors::zero(simd)
    }

    #[inline(always)]
    fn forget<S: Simd>(&mut self, _simd: S, _part: usize) {}

    fn past(&self, _lane: usize) -> Past {
        Past::default()
    }

    fn set_past(&mut self, _lane: usize, _past: &Past) {}
}

impl Friction for Coulomb {
    const IS_ROUGH: bool = true;

    #[inline(always)]
    fn advance<S: Simd>(
        &mut self,
        simd: S,
        part: usize,
        touch: Touch<S>,
        slip: Slip<S>,
        time_step: f64,
    ) -> Vectors<S> {
        let before = Vectors::load(simd, &self.normal, part);
        let mut shear = Vectors::load(simd, &self.shear, part);
        shear = shear - shear.cross(before.cross(touch.normal));
        let twist = Lanes::splat(simd, 0.5 * time_step) * before.dot(slip.spins);
        shear = shear - shear.cross(before.scaled(twist));
        let stiffness = Lanes::load(simd, &self.stiffness, part) * Lanes::splat(simd, time_step);
        shear = shear - slip.velocity.scaled(stiffness);

        let limit = touch.normal_force * Lanes::load(simd, &self.friction, part);
        let square = shear.dot(shear);
        // without shear force the quotient is not a number, and not taken
        let slides = (limit * limit).below(square);
        let back = limit.over(square.sqrt());
        shear = shear.scaled(back.only_if(slides, Lanes::splat(simd, 1.0)));

        shear = shear.only_if(touch.is_touching, Vectors::zero(simd));
        shear.store(&mut self.shear, part);
        touch.normal.store(&mut self.normal, part);
        shear
    }

    #[inline(always)]
    fn forget<S: Simd>(&mut self, simd: S, part: usize) {
        Vectors::zero(simd).store(&mut self.shear, part);
    }

    fn past(&self, lane: usize) -> Past {
        let vector = |arrays: &[Array; 3]| Vector::from(arrays.map(|array| array[lane]));
        Past {
            stiffness: self.stiffness[lane],
            friction: self.friction[lane],
            normal: vector(&self.normal),
            shear: vector(&self.shear),
        }
    }

    fn set_past(&mut self, lane: usize, past: &Past) {
        self.stiffness[lane] = past.stiffness;
        self.friction[lane] = past.friction;
        for axis in 0..3 {
            self.normal[axis][lane] = past.normal[axis];
            self.shear[axis][lane] = past.shear[axis];
        }
    }
}
