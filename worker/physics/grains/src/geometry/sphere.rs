//! The one shape that collides.
use nalgebra::Vector3;

/// A sphere in space: a free particle, or a member of a clump.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sphere {
    /// Centre [m].
    pub(crate) centre: Vector3<f64>,
    /// Radius [m], positive.
    pub(crate) radius: f64,
}

impl Sphere {
    pub(crate) const fn new(centre: Vector3<f64>, radius: f64) -> Self {
        Self { centre, radius }
    }

    /// Volume 4/3 π r³ [m³].
    pub(crate) fn volume(&self) -> f64 {
        volume(self.radius)
    }
}

/// Volume [m³] of a sphere of this radius [m].
pub(crate) fn volume(radius: f64) -> f64 {
    4.0 / 3.0 * std::f64::consts::PI * radius.powi(3)
}
