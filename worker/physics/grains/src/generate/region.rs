//! Where grains may be placed.
use std::f64::consts::{PI, TAU};

use loadframe_api::spec::granular_scene::Volume;
use nalgebra::Vector3;
use rand::{Rng, RngExt as _};

/// A volume to fill [m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Region {
    Cuboid {
        lower: Vector3<f64>,
        upper: Vector3<f64>,
    },
    /// Upright, axis along z.
    Cylinder {
        /// Centre of the lower face.
        base: Vector3<f64>,
        radius: f64,
        height: f64,
    },
    Ball {
        centre: Vector3<f64>,
        radius: f64,
    },
}

impl From<Volume> for Region {
    fn from(region: Volume) -> Self {
        match region {
            Volume::Box { lower_m, upper_m } => Self::Cuboid {
                lower: lower_m.into(),
                upper: upper_m.into(),
            },
            Volume::Cylinder {
                base_m,
                radius_m,
                height_m,
            } => Self::Cylinder {
                base: base_m.into(),
                radius: radius_m,
                height: height_m,
            },
            Volume::Sphere { centre_m, radius_m } => Self::Ball {
                centre: centre_m.into(),
                radius: radius_m,
            },
        }
    }
}

impl Region {
    /// Volume [m³].
    pub(crate) fn volume(&self) -> f64 {
        match self {
            Self::Cuboid { lower, upper } => (upper - lower).product(),
            Self::Cylinder { radius, height, .. } => PI * radius * radius * height,
            Self::Ball { radius, .. } => 4.0 / 3.0 * PI * radius.powi(3),
        }
    }

    /// Lower and upper corner of the bounding box.
    pub(crate) fn bounds(&self) -> [Vector3<f64>; 2] {
        match *self {
            Self::Cuboid { lower, upper } => [lower, upper],
            Self::Cylinder {
                base,
                radius,
                height,
            } => [
                base - Vector3::new(radius, radius, 0.0),
                base + Vector3::new(radius, radius, height),
            ],
            Self::Ball { centre, radius } => {
                [centre.add_scalar(-radius), centre.add_scalar(radius)]
            }
        }
    }

    /// What is left for the centres of spheres of a radius, if anything.
    pub(crate) fn inset(&self, by: f64) -> Option<Self> {
        match *self {
            Self::Cuboid { lower, upper } => {
                let (lower, upper) = (lower.add_scalar(by), upper.add_scalar(-by));
                ((upper - lower).min() >= 0.0).then_some(Self::Cuboid { lower, upper })
            }
            Self::Cylinder {
                base,
                radius,
                height,
            } => {
                let (radius, height) = (radius - by, height - 2.0 * by);
                let base = base + Vector3::z() * by;
                (radius >= 0.0 && height >= 0.0).then_some(Self::Cylinder {
                    base,
                    radius,
                    height,
                })
            }
            Self::Ball { centre, radius } => {
                let radius = radius - by;
                (radius >= 0.0).then_some(Self::Ball { centre, radius })
            }
        }
    }

    /// Whether a point lies in it, or outside by no more than `slack`.
    pub(crate) fn contains(&self, point: &Vector3<f64>, slack: f64) -> bool {
        let [lower, upper] = self.bounds();
        let is_in_box = (point - lower).min() >= -slack && (upper - point).min() >= -slack;
        is_in_box
            && match self {
                Self::Cuboid { .. } => true,
                Self::Cylinder { base, radius, .. } => (point - base).xy().norm() <= radius + slack,
                Self::Ball { centre, radius } => (point - centre).norm() <= radius + slack,
            }
    }

    /// A point of it, all equally likely. Takes three numbers from the generator.
    pub(crate) fn draw(&self, random: &mut impl Rng) -> Vector3<f64> {
        let [u, v, w]: [f64; 3] = std::array::from_fn(|_| random.random());
        match *self {
            Self::Cuboid { lower, upper } => {
                lower + (upper - lower).component_mul(&Vector3::new(u, v, w))
            }
            Self::Cylinder {
                base,
                radius,
                height,
            } => {
                let (sine, cosine) = (TAU * v).sin_cos();
                let away = radius * u.sqrt();
                base + Vector3::new(away * cosine, away * sine, w * height)
            }
            Self::Ball { centre, radius } => {
                let (sine, cosine) = (TAU * v).sin_cos();
                let along = 2.0 * w - 1.0;
                let across = (1.0 - along * along).sqrt();
                let away = radius * u.cbrt();
                centre + Vector3::new(across * cosine, across * sine, along) * away
            }
        }
    }
}
