//! Motion of spheres.
//!
//! A sphere's inertia is the same about every axis, so translation and rotation are one formula.
//! Rows are worked through two at a time, component by component, without a branch; a component
//! with inverse mass zero is fixed, or belongs to a clump's member, which its clump moves.
use pulp::{Arch, Simd, WithSimd};

use super::{Drive, Vector};
use crate::granular::{
    lanes::{Array, LANES, Lanes},
    rows::Row,
};

/// Spheres under forces, for one step.
pub(in crate::granular) struct Spheres<'a> {
    pub(in crate::granular) drive: &'a Drive,
    pub(in crate::granular) forces: &'a [Row],
    pub(in crate::granular) inverse_masses: &'a [Row],
    pub(in crate::granular) velocities: &'a mut [Row],
    pub(in crate::granular) centres: &'a mut [Row],
}

/// The same spheres under torques.
pub(in crate::granular) struct Turning<'a> {
    pub(in crate::granular) drive: &'a Drive,
    pub(in crate::granular) torques: &'a [Row],
    pub(in crate::granular) inverse_inertias: &'a [Row],
    pub(in crate::granular) spins: &'a mut [Row],
}

/// Rows in an [`Array`].
const PAIR: usize = LANES / 4;

impl Spheres<'_> {
    /// Moves them. Returns the largest square of each velocity component.
    pub(in crate::granular) fn advance(self) -> [f64; 4] {
        Arch::new().dispatch(self)
    }
}

impl Turning<'_> {
    /// Turns them.
    pub(in crate::granular) fn advance(self) {
        Arch::new().dispatch(self);
    }
}

impl WithSimd for Spheres<'_> {
    type Output = [f64; 4];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [f64; 4] {
        let law = Law::new(simd, self.drive, self.drive.gravity);
        let step = Lanes::splat(simd, self.drive.time_step);
        let mut largest: Array = [0.0; LANES];
        for first in (0..self.centres.len()).step_by(PAIR) {
            let force = read(self.forces, first);
            let inverse = read(self.inverse_masses, first);
            let mut velocity = read(self.velocities, first);
            let mut centre = read(self.centres, first);
            for part in 0..LANES / S::F64_LANES {
                let after = law.advance(simd, [&force, &inverse, &velocity], part);
                after.store(&mut velocity, part);
                let place = Lanes::load(simd, &centre, part) + step * after;
                place.store(&mut centre, part);
                let square = after * after;
                let most = Lanes::load(simd, &largest, part);
                // a square that is not a number is left out here, and told of where states are checked
                let most = square.only_if(most.below(square), most);
                most.store(&mut largest, part);
            }
            write(self.velocities, first, &velocity);
            write(self.centres, first, &centre);
        }
        let mut components = [0.0_f64; 4];
        for (place, square) in largest.into_iter().enumerate() {
            components[place % 4] = components[place % 4].max(square);
        }
        components
    }
}

impl WithSimd for Turning<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let law = Law::new(simd, self.drive, Vector::zeros());
        for first in (0..self.spins.len()).step_by(PAIR) {
            let torque = read(self.torques, first);
            let inverse = read(self.inverse_inertias, first);
            let mut spin = read(self.spins, first);
            for part in 0..LANES / S::F64_LANES {
                let after = law.advance(simd, [&torque, &inverse, &spin], part);
                after.store(&mut spin, part);
            }
            write(self.spins, first, &spin);
        }
    }
}

/// Equations (G.8) and (G.9) for velocities.
#[derive(Clone, Copy)]
struct Law<S: Simd> {
    gravity: Array,
    step: Lanes<S>,
    half_step: Lanes<S>,
    /// 1 − λ and 1 + λ.
    along: Lanes<S>,
    against: Lanes<S>,
}

impl<S: Simd> Law<S> {
    #[inline(always)]
    fn new(simd: S, drive: &Drive, gravity: Vector) -> Self {
        let [x, y, z] = [gravity.x, gravity.y, gravity.z];
        Self {
            gravity: [x, y, z, 0.0, x, y, z, 0.0],
            step: Lanes::splat(simd, drive.time_step),
            half_step: Lanes::splat(simd, 0.5 * drive.time_step),
            along: Lanes::splat(simd, 1.0 - drive.damping),
            against: Lanes::splat(simd, 1.0 + drive.damping),
        }
    }

    /// Velocity after a step, from load, inverse mass and velocity.
    #[inline(always)]
    fn advance(&self, simd: S, [load, inverse, velocity]: [&Array; 3], part: usize) -> Lanes<S> {
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let velocity = Lanes::load(simd, velocity, part);
        let inverse = Lanes::load(simd, inverse, part);
        let gravity = Lanes::load(simd, &self.gravity, part);
        let acceleration = Lanes::load(simd, load, part) * inverse + gravity;
        let power = acceleration * (velocity + self.half_step * acceleration);
        let kept = self.along.only_if(zero.below(power), one);
        let kept = self.against.only_if(power.below(zero), kept);
        let change = self.step * (acceleration * kept);
        change.only_if(zero.below(inverse), zero) + velocity
    }
}

/// Two rows side by side; beyond the last one zeros, which nothing moves.
#[inline(always)]
fn read(rows: &[Row], first: usize) -> Array {
    let mut array = [0.0; LANES];
    if let [a, b, ..] = &rows[first..] {
        array[..4].copy_from_slice(&a.0);
        array[4..].copy_from_slice(&b.0);
    } else {
        array[..4].copy_from_slice(&rows[first].0);
    }
    array
}

#[inline(always)]
fn write(rows: &mut [Row], first: usize, array: &Array) {
    let rows = &mut rows[first..];
    rows[0].0.copy_from_slice(&array[..4]);
    if let Some(second) = rows.get_mut(1) {
        second.0.copy_from_slice(&array[4..]);
    }
}
