//! Where a mesh is and how it moves.
use loadframe_api::surface::{Point, along, bounds, cross, length, minus};
use nalgebra::UnitQuaternion;
use serde::{Deserialize, Serialize};

use super::Mesh;
use crate::{numbers::Vector, walls::motion::WallMotion};

/// Place and motion of a mesh.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Pose {
    pub(crate) motion: WallMotion,
    /// Where the origin of its frame is [m].
    origin: Point,
    /// Orientation of its frame, once it has turned.
    turned: Option<UnitQuaternion<f64>>,
    /// ω [rad/s]; zero for a wall that does not turn now.
    spin: Point,
    /// A point of the axis of that turn [m].
    pivot: Point,
}

impl Pose {
    /// Begins to turn at `spin` [rad/s] about an axis through `pivot` [m]; at zero, ends it.
    pub(crate) fn turn(&mut self, spin: Point, pivot: Point) {
        (self.spin, self.pivot) = (spin, pivot);
    }

    /// ω [rad/s].
    pub(crate) fn spin(&self) -> Point {
        self.spin
    }

    /// Whether it turns now.
    pub(crate) fn is_turning(&self) -> bool {
        self.spin.iter().any(|part| part.abs() > 0.0)
    }

    /// A place in the frame of the mesh.
    #[inline]
    pub(crate) fn to_local(&self, place: &Point) -> Point {
        let from_origin = minus(place, &self.origin);
        match &self.turned {
            None => from_origin,
            Some(turned) => turned
                .inverse_transform_vector(&Vector::from(from_origin))
                .into(),
        }
    }

    /// A direction of the frame of the mesh in space.
    #[inline]
    pub(crate) fn direction(&self, local: &Point) -> Point {
        match &self.turned {
            None => *local,
            Some(turned) => turned.transform_vector(&Vector::from(*local)).into(),
        }
    }

    /// A place of the frame of the mesh in space.
    #[inline]
    pub(crate) fn to_global(&self, local: &Point) -> Point {
        along(&self.direction(local), &self.origin, 1.0)
    }

    /// Velocity of the wall at a place that comes from turning alone [m/s].
    #[inline]
    pub(crate) fn turning_velocity(&self, place: &Point) -> Point {
        cross(&self.spin, &minus(place, &self.pivot))
    }

    /// Bound of the speeds of all points of the mesh [m/s].
    pub(crate) fn speed(&self, mesh: &Mesh) -> f64 {
        let straight = self.motion.speed();
        if !self.is_turning() {
            return straight;
        }
        let (middle, radius) = mesh.ball;
        let arm = length(&minus(&self.to_global(&middle), &self.pivot)) + radius;
        straight + length(&self.spin) * arm
    }

    /// Corners of the upright box around the mesh where it is [m].
    pub(crate) fn bounds(&self, mesh: &Mesh) -> [Point; 2] {
        let [lower, upper] = mesh.bounds;
        let corners = (0..8).map(|corner| {
            let local = std::array::from_fn(|axis| match corner >> axis & 1 {
                0 => lower[axis],
                _ => upper[axis],
            });
            self.to_global(&local)
        });
        let corners: Vec<Point> = corners.collect();
        bounds(&corners)
    }

    /// Moves along an axis [m] at once.
    pub(crate) fn shift(&mut self, axis: usize, way: f64) {
        self.origin[axis] += way;
        self.motion.displacement[axis] += way;
    }

    /// Moves on by a step [s].
    pub(crate) fn advance(&mut self, time_step: f64) {
        self.motion.advance(time_step);
        self.origin = along(&self.origin, &self.motion.velocity, time_step);
        if self.is_turning() {
            let turn = UnitQuaternion::from_scaled_axis(Vector::from(self.spin) * time_step);
            let arm = turn.transform_vector(&Vector::from(minus(&self.origin, &self.pivot)));
            self.origin = along(&self.pivot, &arm.into(), 1.0);
            let turned = turn * self.turned.unwrap_or_else(UnitQuaternion::identity);
            self.turned = Some(UnitQuaternion::new_normalize(turned.into_inner()));
        }
    }
}
