//! Free rotation by splitting, many clumps side by side.
//!
//! The energy L²/2I is split into its three principal parts, each of which is a plain rotation about
//! its axis; they are done in the order x y z y x with half, half, whole, half, half steps, L held
//! in space ([Dullweber1997]). Symplectic and reversible: energy oscillates within a bound and does
//! not drift. Rotations by angle θ are done as 2 atan(θ/2), which needs no sine and keeps the order:
//!
//!   h = Δt L_k/(2 I_k), cos = (1 − h²)/(1 + h²), sin = 2h/(1 + h²), q ← q (1 + h e_k) (G.23)
//!
//! with L in the frame of principal axes, turned the other way; q gets its length back at the end.
//! One rotation waits for the one before it, so that clumps side by side cost little more than one.
use nalgebra::{Quaternion, UnitQuaternion};
use pulp::{Arch, Simd, WithSimd};

use super::clump::Clump;
use crate::numbers::{
    Vector,
    lanes::{Array, LANES, Lanes, Vectors},
};

/// Clumps that turn by a step, one in each lane.
#[derive(Clone, Debug, Default)]
pub(crate) struct Turns {
    /// L at the end of the step [kg m²/s].
    momentum: [Array; 3],
    /// Principal moments [kg m²].
    inertia: [Array; 3],
    /// i, j, k and w, principal axes to global.
    orientation: [Array; 4],
    /// ω at the end of the step, global [rad/s].
    spin: [Array; 3],
    /// Δt [s].
    step: f64,
}

impl Turns {
    pub(crate) fn new(step: f64) -> Self {
        Self {
            step,
            ..Self::default()
        }
    }

    /// Puts a clump with this momentum into a lane.
    pub(crate) fn set(&mut self, lane: usize, clump: &Clump) {
        for axis in 0..3 {
            self.momentum[axis][lane] = clump.angular_momentum[axis];
            self.inertia[axis][lane] = clump.inertia[axis];
        }
        for (column, value) in self
            .orientation
            .iter_mut()
            .zip(clump.orientation.coords.iter())
        {
            column[lane] = *value;
        }
    }

    /// Gives a clump what its lane has come to.
    pub(crate) fn give(&self, lane: usize, clump: &mut Clump) {
        let [i, j, k, w] = [0, 1, 2, 3].map(|part: usize| self.orientation[part][lane]);
        clump.orientation = UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k));
        clump.spin = Vector::from(self.spin.map(|column| column[lane]));
    }

    /// Turns all of them; lanes without a clump hold no numbers afterwards.
    pub(crate) fn run(&mut self) {
        Arch::new().dispatch(self);
    }
}

impl WithSimd for &mut Turns {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let number = |value: f64| Lanes::splat(simd, value);
        let (one, two, half_step) = (number(1.0), number(2.0), number(0.5 * self.step));
        for part in 0..LANES / S::F64_LANES {
            let inertia = self.inertia.each_ref();
            let inverse = inertia.map(|column| one.over(Lanes::load(simd, column, part)));
            let [i, j, k, w] = self.orientation.each_ref();
            let [i, j, k, w] = [i, j, k, w].map(|column| Lanes::load(simd, column, part));
            let momentum = Vectors::load(simd, &self.momentum, part);
            let local = turned(
                simd,
                Vectors {
                    x: -i,
                    y: -j,
                    z: -k,
                },
                w,
                momentum,
            );
            let mut local = [local.x, local.y, local.z];
            let (mut axes, mut w) = ([i, j, k], w);
            for (axis, share) in [(0, 0.5), (1, 0.5), (2, 1.0), (1, 0.5), (0, 0.5)] {
                let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
                let tangent = half_step * number(share) * local[axis] * inverse[axis];
                let square = tangent * tangent;
                let scale = one.over(one + square);
                let (cosine, sine) = ((one - square) * scale, two * tangent * scale);
                [local[next], local[last]] = [
                    cosine * local[next] + sine * local[last],
                    cosine * local[last] - sine * local[next],
                ];
                [axes[axis], axes[next], axes[last], w] = [
                    axes[axis] + tangent * w,
                    axes[next] + tangent * axes[last],
                    axes[last] - tangent * axes[next],
                    w - tangent * axes[axis],
                ];
            }
            let [i, j, k] = axes;
            let length = (i * i + j * j + k * k + w * w).sqrt();
            let [i, j, k, w] = [i, j, k, w].map(|value| value.over(length));
            for (column, value) in self.orientation.iter_mut().zip([i, j, k, w]) {
                value.store(column, part);
            }
            let spin = Vectors {
                x: local[0] * inverse[0],
                y: local[1] * inverse[1],
                z: local[2] * inverse[2],
            };
            turned(simd, Vectors { x: i, y: j, z: k }, w, spin).store(&mut self.spin, part);
        }
    }
}

/// v turned by the unit quaternion (u, w): v + w t + u × t with t = 2 u × v.
#[inline(always)]
fn turned<S: Simd>(simd: S, u: Vectors<S>, w: Lanes<S>, v: Vectors<S>) -> Vectors<S> {
    let t = u.cross(v).scaled(Lanes::splat(simd, 2.0));
    v + t.scaled(w) + u.cross(t)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A slab that turns about no axis in particular, as lane `lane` of a scene has it.
    fn slab(lane: usize) -> Clump {
        let number = lane as f64;
        Clump {
            body: 0,
            first: 0,
            offsets: Vec::new(),
            mass: 1.0,
            inertia: Vector::new(1.0, 2.0 + 0.1 * number, 2.5),
            centre: Vector::zeros(),
            velocity: Vector::zeros(),
            orientation: UnitQuaternion::from_euler_angles(0.3, -0.4 * number, 1.1),
            angular_momentum: Vector::new(0.4, 3.0, -0.2 - number),
            spin: Vector::zeros(),
            fixed: [false; 6],
        }
    }

    #[test]
    fn every_lane_keeps_its_energy_and_turns_alone() {
        let (step, steps) = (1e-2, 20_000);
        let mut clumps: Vec<Clump> = (0..LANES).map(slab).collect();
        let energy = |clump: &Clump| {
            let local = clump
                .orientation
                .inverse_transform_vector(&clump.angular_momentum);
            0.5 * local
                .component_mul(&local)
                .component_div(&clump.inertia)
                .sum()
        };
        let before: Vec<f64> = clumps.iter().map(energy).collect();
        let mut alone = slab(3);
        for _ in 0..steps {
            let mut turns = Turns::new(step);
            for (lane, clump) in clumps.iter().enumerate() {
                turns.set(lane, clump);
            }
            turns.run();
            for (lane, clump) in clumps.iter_mut().enumerate() {
                turns.give(lane, clump);
            }
            let mut turns = Turns::new(step);
            turns.set(0, &alone);
            turns.run();
            turns.give(0, &mut alone);
        }
        assert_eq!(alone, clumps[3]);
        for (clump, before) in clumps.iter().zip(before) {
            // of second order in the angle of a step, 0.03, and it does not grow
            let change = (energy(clump) / before - 1.0).abs();
            assert!(change < 1e-3, "{change}");
            // the spin is that of the momentum
            let momentum = clump.momentum_of(clump.spin);
            assert!((momentum - clump.angular_momentum).norm() < 1e-12 * momentum.norm());
        }
    }
}
