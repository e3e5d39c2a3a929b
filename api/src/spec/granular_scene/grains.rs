//! Shapes that are filled with spheres.
use std::f64::consts::PI;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::surface::{bounds, enclosed_volume, minus, read_stl};

/// Equal spheres on a lattice inside a shape, whose middle is the body's `position_m`.
///
/// A hexagonal lattice has a sphere in the middle of the shape, a simple cubic one the middle of a
/// cell: touching members of 3.6 mm fill a ball of 48 mm 135 times. In a surface of triangles either has
/// a sphere in the middle of the bounding box.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Filled {
    pub shape: Shape,
    #[schemars(range(min = 1e-9, max = 1e6), extend("x-unit" = "m"))]
    pub member_radius_m: f64,
    #[serde(default)]
    pub lattice: Lattice,
    /// Distance of neighbouring members; left out, they just touch.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-9, max = 1e6), extend("x-unit" = "m"))]
    pub spacing_m: Option<f64>,
}

/// Outer shape of a grain.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Shape {
    Ellipsoid {
        #[schemars(inner(range(min = 1e-9, max = 1e6)), extend("x-unit" = "m"))]
        semi_axes_m: [f64; 3],
    },
    /// Axis along z.
    Cylinder {
        #[schemars(range(min = 1e-9, max = 1e6), extend("x-unit" = "m"))]
        radius_m: f64,
        #[schemars(range(min = 1e-9, max = 1e6), extend("x-unit" = "m"))]
        height_m: f64,
    },
    /// Members touch all faces; rows come closer where they do not fit evenly.
    Box {
        #[schemars(inner(range(min = 1e-9, max = 1e6)), extend("x-unit" = "m"))]
        sides_m: [f64; 3],
    },
    /// A closed surface of triangles.
    Surface {
        /// An STL file in its text form, the middle of its bounding box as origin.
        #[schemars(length(min = 1, max = 100_000_000))]
        stl: String,
        /// Metres in the file's unit of length.
        #[serde(default = "one")]
        #[schemars(range(min = 1e-12, max = 1e12), extend("x-unit" = "1"))]
        scale: f64,
    },
}

/// How members sit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Lattice {
    /// Close packing, 12 neighbours.
    #[default]
    Hexagonal,
    /// In line, 6 neighbours.
    SimpleCubic,
}

/// Spheres of a body, at most: more are refused before they are placed.
pub(crate) const MOST_MEMBERS: u64 = 100_000;

impl Filled {
    /// Distance of neighbouring members [m].
    pub fn spacing(&self) -> f64 {
        self.spacing_m.unwrap_or(2.0 * self.member_radius_m)
    }

    /// How many members it has; about, in a surface and when they are too many.
    pub(super) fn expected_members(&self) -> u64 {
        let about = self.members_by_size();
        if matches!(self.shape, Shape::Surface { .. }) || about > MOST_MEMBERS {
            return about;
        }
        self.members().map_or(1, |members| members.len() as u64)
    }

    /// About how many members it has: its share of a box of rows. One row is there however thin the
    /// shape is.
    pub(super) fn members_by_size(&self) -> u64 {
        let rows = |length: f64| {
            let open = (length - 2.0 * self.member_radius_m).max(0.0);
            open / self.spacing() + 1.0
        };
        let rounded = PI / 6.0;
        let (sides, share) = match &self.shape {
            Shape::Ellipsoid { semi_axes_m } => (semi_axes_m.map(|axis| 2.0 * axis), rounded),
            Shape::Cylinder { radius_m, height_m } => {
                ([2.0 * radius_m, 2.0 * radius_m, *height_m], PI / 4.0)
            }
            Shape::Box { sides_m } => (*sides_m, 1.0),
            Shape::Surface { stl, scale } => {
                let triangles = read_stl(stl.as_bytes()).unwrap_or_default();
                // the ball of its volume; what stands out of it by less than a row counts for nothing
                let volume = enclosed_volume(&triangles) * scale.powi(3);
                let diameter = 2.0 * (volume * 0.75 / PI).cbrt();
                ([diameter - self.spacing(); 3], rounded)
            }
        };
        let density = match self.lattice {
            Lattice::Hexagonal => std::f64::consts::SQRT_2,
            Lattice::SimpleCubic => 1.0,
        };
        ((share * density * sides.map(rows).iter().product::<f64>()) as u64).max(1)
    }

    /// Places that are looked at to fill a surface, times its triangles.
    pub(super) fn looks(&self) -> f64 {
        let Shape::Surface { stl, scale } = &self.shape else {
            return 0.0;
        };
        let triangles = read_stl(stl.as_bytes()).unwrap_or_default();
        let [lower, upper] = bounds(triangles.iter().flatten());
        let sides = minus(&upper, &lower);
        let rows = sides.map(|side| scale * side / self.spacing() + 1.0);
        triangles.len() as f64 * rows.iter().product::<f64>()
    }
}

fn one() -> f64 {
    1.0
}
