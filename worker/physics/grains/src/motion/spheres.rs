//! Motion of spheres.
//!
//! A sphere's inertia is the same about every axis, so translation and rotation are one formula.
//! Rows are worked through two at a time, component by component, without a branch; a sphere with
//! inverse mass zero is fixed, or a clump's member, which its clump moves. Spheres that are fixed
//! in part ([`PartlyFixed`]) are moved like the others and put back where they are held.
use pulp::{Arch, Simd, WithSimd};
use serde::{Deserialize, Serialize};

use super::{Drive, Vector};
use crate::numbers::{
    lanes::{Array, LANES, Lanes},
    rows::Row,
};

/// Spheres under forces, for one step.
pub(crate) struct Spheres<'a> {
    pub(crate) drive: &'a Drive,
    pub(crate) forces: &'a [Row],
    /// With the inverse masses.
    pub(crate) velocities: &'a mut [Row],
    pub(crate) centres: &'a mut [Row],
}

/// The same spheres under torques.
pub(crate) struct Turning<'a> {
    pub(crate) drive: &'a Drive,
    pub(crate) torques: &'a [Row],
    /// With the inverse inertias.
    pub(crate) spins: &'a mut [Row],
}

/// A sphere that is fixed in part, and what it keeps over a step.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct PartlyFixed {
    /// Counted from the first sphere of the patch.
    pub(crate) particle: u32,
    /// Bits of the degrees of freedom.
    pub(crate) fixed: u8,
    centre: Row,
    velocity: Row,
    spin: Row,
}

impl PartlyFixed {
    pub(crate) fn new(particle: u32, fixed: u8) -> Self {
        Self {
            particle,
            fixed,
            ..Self::default()
        }
    }

    /// Before the spheres move.
    pub(crate) fn note(&mut self, centres: &[Row], velocities: &[Row], spins: &[Row]) {
        let particle = self.particle as usize;
        self.centre = centres[particle];
        self.velocity = velocities[particle];
        self.spin = spins.get(particle).copied().unwrap_or_default();
    }

    /// After they moved by a step Δt [s]: what is fixed has kept its velocity.
    pub(crate) fn hold(
        &self,
        time_step: f64,
        centres: &mut [Row],
        velocities: &mut [Row],
        spins: &mut [Row],
    ) {
        let particle = self.particle as usize;
        for axis in 0..3 {
            if self.fixed >> axis & 1 == 1 {
                velocities[particle].0[axis] = self.velocity.0[axis];
                centres[particle].0[axis] = self.centre.0[axis] + time_step * self.velocity.0[axis];
            }
            if let Some(spin) = spins.get_mut(particle)
                && self.fixed >> (3 + axis) & 1 == 1
            {
                spin.0[axis] = self.spin.0[axis];
            }
        }
    }
}

/// Rows in an [`Array`].
const PAIR: usize = LANES / 4;

impl Spheres<'_> {
    /// Moves them. Returns the largest square of each velocity component.
    pub(crate) fn advance(self) -> [f64; 3] {
        Arch::new().dispatch(self)
    }
}

impl Turning<'_> {
    /// Turns them.
    pub(crate) fn advance(self) {
        Arch::new().dispatch(self);
    }
}

impl WithSimd for Spheres<'_> {
    type Output = [f64; 3];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [f64; 3] {
        let law = Law::new(simd, self.drive, self.drive.gravity);
        let way = per_component(self.drive.time_step);
        let mut largest: Array = [0.0; LANES];
        for first in (0..self.centres.len()).step_by(PAIR) {
            let force = read(self.forces, first);
            let mut velocity = read(self.velocities, first);
            let inverse = fourths(&velocity);
            let mut centre = read(self.centres, first);
            for part in 0..LANES / S::F64_LANES {
                let after = law.advance(simd, [&force, &inverse, &velocity], part);
                after.store(&mut velocity, part);
                let place =
                    Lanes::load(simd, &centre, part) + Lanes::load(simd, &way, part) * after;
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
        std::array::from_fn(|axis| largest[axis].max(largest[axis + 4]))
    }
}

impl WithSimd for Turning<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let law = Law::new(simd, self.drive, Vector::zeros());
        for first in (0..self.spins.len()).step_by(PAIR) {
            let torque = read(self.torques, first);
            let mut spin = read(self.spins, first);
            let inverse = fourths(&spin);
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

/// A value for each component, and 0 for the number beside them.
#[inline(always)]
fn per_component(value: f64) -> Array {
    [value, value, value, 0.0, value, value, value, 0.0]
}

/// The fourth number of each row for its components.
#[inline(always)]
fn fourths(rows: &Array) -> Array {
    let (a, b) = (rows[3], rows[7]);
    [a, a, a, 0.0, b, b, b, 0.0]
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
