//! What collides: spheres, rigid clumps of spheres, bonded spheres that break, planes.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Filled;

/// A body: a sphere, a clump or a breakable one, exactly one of the three.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Body {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sphere: Option<Sphere>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clump: Option<Clump>,
    /// Spheres of a cohesive material, bonded to those of this body that they touch at the start,
    /// and to no others. Each is a body of its own, with its own number; what the bonds still hold
    /// together is a fragment.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub breakable: Option<Clump>,
    /// Name of a material.
    pub material: String,
    /// Centre of the sphere, or the point that the offsets of a clump's members start from.
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "m"))]
    pub position_m: [f64; 3],
    /// Velocity of the centre of mass, half a time step before the start (leapfrog).
    #[serde(default)]
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "m/s"))]
    pub velocity_m_per_s: [f64; 3],
    #[serde(default)]
    #[schemars(inner(range(min = -1e12, max = 1e12)), extend("x-unit" = "rad/s"))]
    pub angular_velocity_rad_per_s: [f64; 3],
    /// Degrees of freedom that no force changes. They keep the velocity given here.
    #[serde(default)]
    pub fixed: Vec<DegreeOfFreedom>,
}

/// A sphere.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sphere {
    #[schemars(range(min = 1e-9, max = 1e6), extend("x-unit" = "m"))]
    pub radius_m: f64,
}

/// Spheres that move as one body and do not touch each other. They may overlap: mass, centre and
/// inertia are those of their union, which counts overlaps once. Given one by one, or as spheres
/// that fill a shape.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Clump {
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 100_000))]
    pub members: Vec<Member>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub filled: Option<Filled>,
}

/// A sphere of a clump.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Member {
    /// From the body's `position_m` to the member's centre.
    #[schemars(inner(range(min = -1e6, max = 1e6)), extend("x-unit" = "m"))]
    pub offset_m: [f64; 3],
    #[schemars(range(min = 1e-9, max = 1e6), extend("x-unit" = "m"))]
    pub radius_m: f64,
}

/// A degree of freedom in the global frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DegreeOfFreedom {
    X,
    Y,
    Z,
    /// Rotation about x.
    Rx,
    /// Rotation about y.
    Ry,
    /// Rotation about z.
    Rz,
}

/// An infinite plane across an axis. It moves only when a stage moves it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Plane {
    /// Name for stages, tables and `record`.
    #[schemars(length(min = 1, max = 60), regex(pattern = "^[A-Za-z][A-Za-z0-9_]*$"))]
    pub name: String,
    /// Direction of the plane's normal.
    pub axis: Axis,
    /// Where it crosses its axis.
    #[schemars(range(min = -1e9, max = 1e9), extend("x-unit" = "m"))]
    pub position_m: f64,
    /// Side on which bodies are: 1 for above along the axis, -1 for below.
    #[schemars(extend("enum" = [1, -1]))]
    pub facing: i8,
    /// Name of a material.
    pub material: String,
    /// K that the plane brings to each of its contacts, in place of the E l of its material, and Kν in
    /// place of E l ν: what presses a rigid body into it by u has the force K u, whatever its radius,
    /// as with walls of PFC and the rubber of [Lim2004]. Not under `hertz_mindlin`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-6, max = 1e15), extend("x-unit" = "N/m"))]
    pub contact_stiffness_n_per_m: Option<f64>,
}

/// A coordinate axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    X,
    Y,
    Z,
}

impl Axis {
    /// Place of the axis among x, y, z.
    pub fn index(self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
            Self::Z => 2,
        }
    }
}

impl DegreeOfFreedom {
    /// Place among x, y, z, rx, ry, rz.
    pub fn index(self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
            Self::Z => 2,
            Self::Rx => 3,
            Self::Ry => 4,
            Self::Rz => 5,
        }
    }
}

impl Body {
    /// Nothing yet, at a place [m].
    pub fn at(position_m: [f64; 3], material: &str) -> Self {
        Self {
            material: material.to_owned(),
            position_m,
            ..Self::default()
        }
    }

    /// Its members, when it is not a sphere.
    pub fn members(&self) -> Option<&Clump> {
        self.clump.as_ref().or(self.breakable.as_ref())
    }

    /// Spheres of this body, about when they fill a shape.
    pub fn particles(&self) -> u64 {
        self.members().map_or(1, Clump::expected_members)
    }

    /// Numbers that it takes: one, or one for each sphere of a breakable body.
    pub fn numbers(&self) -> usize {
        self.breakable
            .as_ref()
            .map_or(1, |grain| grain.members.len())
    }

    /// Whether its members are still to be found.
    pub fn is_filled(&self) -> bool {
        self.members()
            .is_some_and(|members| members.filled.is_some())
    }
}
