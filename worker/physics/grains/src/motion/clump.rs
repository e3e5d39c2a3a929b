//! Motion of rigid clumps.
//!
//! A clump turns about its centre of mass. Its angular momentum L is kept in the global frame at
//! half steps, L ← L + Δt T, its orientation q (principal axes to global) at whole ones.
//!
//! Two ways to turn the orientation by a step with L held:
//! - *Fincham* (convention `yade`): the leapfrog of [Fincham1992], with the orientation at the half
//!   step predicted first. Keeps L; the energy of a free body drifts slowly.
//! - *Splitting* (convention `loadframe`): [`splitting`](super::splitting) keeps L to round-off, and
//!   energy does not drift.
//!
//! Torques are damped by T_w ← T_w (1 − λ sgn(T_w ω_w)).
use nalgebra::{Matrix3, Quaternion, UnitQuaternion};
use serde::{Deserialize, Serialize};

use super::{Drive, Wrenches};
use crate::numbers::{Vector, rows::Row};

/// A rigid clump.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Clump {
    /// Its number in the spec.
    pub(crate) body: u32,
    /// Its members are the particles from `first` on, in the order of `offsets`.
    pub(crate) first: u32,
    /// Centres of the members from the centre of mass, in the frame of principal axes [m].
    pub(crate) offsets: Vec<Vector>,
    /// [kg].
    pub(crate) mass: f64,
    /// About the principal axes [kg m²].
    pub(crate) inertia: Vector,
    pub(crate) centre: Vector,
    pub(crate) velocity: Vector,
    /// Principal axes to global.
    pub(crate) orientation: UnitQuaternion<f64>,
    /// L [kg m²/s], global.
    pub(crate) angular_momentum: Vector,
    /// ω [rad/s], global.
    pub(crate) spin: Vector,
    /// Whether x, y, z, rx, ry, rz are fixed.
    pub(crate) fixed: [bool; 6],
}

/// How free rotation is integrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rotation {
    Fincham,
    Splitting,
}

/// Rows of a clump's members.
pub(crate) struct Members<'a> {
    pub(crate) centres: &'a mut [Row],
    pub(crate) velocities: &'a mut [Row],
    pub(crate) spins: &'a mut [Row],
}

impl Clump {
    pub(crate) fn members(&self) -> std::ops::Range<usize> {
        let first = self.first as usize;
        first..first + self.offsets.len()
    }

    /// Arm² over inertia of a contact of a member, at most [1/kg].
    pub(crate) fn turning(&self, member: &Row) -> f64 {
        self.turning_by(&(member.vector() - self.centre), member.0[3])
    }

    /// The same of a member at this offset with this radius [m].
    pub(crate) fn turning_by(&self, offset: &Vector, radius: f64) -> f64 {
        (offset.norm() + radius).powi(2) / self.inertia.min()
    }

    /// Inertia in the global frame [kg m²].
    pub(crate) fn global_inertia(&self) -> Matrix3<f64> {
        let axes = self.orientation.to_rotation_matrix();
        axes.matrix() * Matrix3::from_diagonal(&self.inertia) * axes.matrix().transpose()
    }

    /// Angular momentum of a spin at the present orientation.
    pub(crate) fn momentum_of(&self, spin: Vector) -> Vector {
        let local = self.orientation.inverse_transform_vector(&spin);
        self.orientation
            .transform_vector(&local.component_mul(&self.inertia))
    }

    /// Force and torque about the centre of mass, from those on the members' rows.
    pub(crate) fn wrench(&self, wrenches: &Wrenches, centres: &[Row], first: usize) -> [Vector; 2] {
        let (mut force, mut torque) = (Vector::zeros(), Vector::zeros());
        for member in self.members() {
            let load = wrenches.forces[member - first].vector();
            let arm = centres[member - first].vector() - self.centre;
            force += load;
            torque += arm.cross(&load);
            if let Some(own) = wrenches.torques.get(member - first) {
                torque += own.vector();
            }
        }
        [force, torque]
    }

    /// A step under force [N] and torque [N m]. Returns whether the clump has still to be turned, by
    /// [`splitting`](super::splitting), side by side with others.
    pub(crate) fn advance(
        &mut self,
        drive: &Drive,
        rotation: Rotation,
        force: Vector,
        torque: Vector,
    ) -> bool {
        let step = drive.time_step;
        for axis in 0..3 {
            if !self.fixed[axis] {
                let acceleration = force[axis] / self.mass + drive.gravity[axis];
                self.velocity[axis] += step * drive.damped(acceleration, self.velocity[axis]);
            }
        }
        self.centre += step * self.velocity;

        let damped =
            Vector::from_fn(|axis, _| drive.against(torque[axis], torque[axis] * self.spin[axis]));
        match (&self.fixed[3..], rotation) {
            ([false, false, false], Rotation::Splitting) => {
                self.angular_momentum += step * damped;
                return true;
            }
            ([false, false, false], Rotation::Fincham) => self.turn_by_fincham(step, damped),
            _ => self.turn_about_free_axes(step, torque, drive),
        }
        false
    }

    fn turn_by_fincham(&mut self, step: f64, torque: Vector) {
        let spin_of = |clump: &Self, momentum: Vector| {
            let local = clump.orientation.inverse_transform_vector(&momentum);
            local.component_div(&clump.inertia)
        };
        let now = spin_of(self, self.angular_momentum + 0.5 * step * torque);
        let half = self.orientation.into_inner() + rate(&self.orientation, now) * (0.5 * step);
        self.angular_momentum += step * torque;
        let later = spin_of(self, self.angular_momentum);
        let turned = self.orientation.into_inner() + rate(&half, later) * step;
        self.orientation = UnitQuaternion::new_normalize(turned);
        self.spin = self.orientation.transform_vector(&later);
    }

    /// With some or all rotations fixed: Euler's equation for the free components of ω alone, the
    /// orientation turned by ω.
    fn turn_about_free_axes(&mut self, step: f64, torque: Vector, drive: &Drive) {
        let inertia = self.global_inertia();
        let is_free = |axis: usize| !self.fixed[3 + axis];
        let resultant = torque - self.spin.cross(&(inertia * self.spin));
        // fixed axes become the identity, so that the free ones are solved alone
        let free = Matrix3::from_fn(|row, column| match (is_free(row), is_free(column)) {
            (true, true) => inertia[(row, column)],
            _ => f64::from(u8::from(row == column)),
        });
        let load = Vector::from_fn(|axis, _| if is_free(axis) { resultant[axis] } else { 0.0 });
        let acceleration = free
            .try_inverse()
            .map_or(Vector::zeros(), |inverse| inverse * load);
        for axis in 0..3 {
            if is_free(axis) {
                self.spin[axis] += step * drive.damped(acceleration[axis], self.spin[axis]);
            }
        }
        let half = 0.5 * step * self.spin;
        let turn = UnitQuaternion::new_normalize(Quaternion::new(1.0, half.x, half.y, half.z));
        self.orientation = UnitQuaternion::new_normalize((turn * self.orientation).into_inner());
        self.angular_momentum = self.momentum_of(self.spin);
    }

    /// Stands still in every direction that is free.
    pub(crate) fn halt(&mut self) {
        for axis in 0..3 {
            if !self.fixed[axis] {
                self.velocity[axis] = 0.0;
            }
            if !self.fixed[3 + axis] {
                self.spin[axis] = 0.0;
            }
        }
        self.angular_momentum = self.momentum_of(self.spin);
    }

    /// Puts the members where the clump has them. Returns the square of their largest speed.
    pub(crate) fn place(&self, members: &mut Members<'_>, first: usize) -> f64 {
        let mut largest = 0.0_f64;
        let axes = self.orientation.to_rotation_matrix();
        for (member, offset) in self.members().zip(&self.offsets) {
            let arm = axes * offset;
            let velocity = self.velocity + self.spin.cross(&arm);
            let member = member - first;
            members.centres[member].set(self.centre + arm);
            members.velocities[member].set(velocity);
            // scenes without friction have no use for the members' spins
            if let Some(spin) = members.spins.get_mut(member) {
                spin.set(self.spin);
            }
            largest = largest.max(velocity.norm_squared());
        }
        largest
    }
}

/// dq/dt of an orientation that turns with `spin` in its own frame: ½ q ω.
fn rate(orientation: &Quaternion<f64>, spin: Vector) -> Quaternion<f64> {
    *orientation * Quaternion::from_imag(spin) * 0.5
}
