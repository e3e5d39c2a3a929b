//! Motion of spheres.
//!
//! A sphere's inertia is the same about every axis, so translation and rotation are one formula.
//! Rows are worked through component by component without a branch; a component with inverse mass
//! zero is fixed, or belongs to a clump's member, which its clump moves.
use super::Drive;
use crate::{granular::rows::Row, wide::wide};

/// Advances velocities by the accelerations that `loads` cause.
pub(in crate::granular) fn accelerate(
    drive: &Drive,
    with_gravity: bool,
    loads: &[Row],
    inverse_masses: &[Row],
    velocities: &mut [Row],
) {
    let gravity = if with_gravity {
        drive.gravity
    } else {
        super::Vector::zeros()
    };
    let gravity = [gravity.x, gravity.y, gravity.z, 0.0];
    let step = drive.time_step;
    wide(
        #[inline(always)]
        || {
            let rows = loads.iter().zip(inverse_masses).zip(&mut *velocities);
            for ((load, inverse), velocity) in rows {
                for axis in 0..4 {
                    let inverse = inverse.0[axis];
                    let acceleration = load.0[axis] * inverse + gravity[axis];
                    let damped = drive.damped(acceleration, velocity.0[axis]);
                    let damped = if inverse == 0.0 { 0.0 } else { damped };
                    velocity.0[axis] += step * damped;
                }
            }
        },
    );
}

/// Moves centres by their velocities. Returns the largest square of each velocity component.
pub(in crate::granular) fn drift(
    time_step: f64,
    velocities: &[Row],
    centres: &mut [Row],
) -> [f64; 4] {
    wide(
        #[inline(always)]
        || {
            let mut largest = [0.0_f64; 4];
            for (velocity, centre) in velocities.iter().zip(&mut *centres) {
                for axis in 0..4 {
                    let velocity = velocity.0[axis];
                    centre.0[axis] += time_step * velocity;
                    let square = velocity * velocity;
                    // false for NaN, which is told of where states are checked
                    largest[axis] = if square > largest[axis] {
                        square
                    } else {
                        largest[axis]
                    };
                }
            }
            largest
        },
    )
}
