//! The grains of a bed.
use std::f64::consts::PI;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::super::granular_scene::{Clump, Grain, Shape, Sizes};

/// Shape and sizes of grains.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Grains {
    /// A sphere, a rigid clump, or a breakable one of an aggregate with cohesion. A clump is given
    /// member by member or fills an ellipsoid, a cylinder, a box or an STL surface.
    pub shape: Grain,
    /// Sizes; a clump is scaled to the volume of a sphere of the size drawn. Left out, spheres have
    /// radii of 0.6 to 1.4 times 16.25 mm and clumps the size they are given with.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sizes: Option<Sizes>,
}

/// Solid fraction of balls that random placing reaches safely.
const PLACED_FRACTION: f64 = 0.30;
/// r of the source's spheres, and its scatter.
const RADIUS: f64 = 0.01625;
const SCATTER: [f64; 2] = [0.6, 1.4];

impl Grains {
    /// Sizes that are meant; none for clumps of their own size.
    pub(super) fn sizes(&self) -> Option<Sizes> {
        match (&self.sizes, &self.shape) {
            (None, Grain::Sphere) => Some(Sizes::Uniform {
                smallest_radius_m: SCATTER[0] * RADIUS,
                largest_radius_m: SCATTER[1] * RADIUS,
            }),
            (sizes, _) => sizes.clone(),
        }
    }

    /// Solid fraction that random placing of these grains reaches: each has the ball around it for
    /// itself.
    pub(super) fn placed_fraction(&self) -> f64 {
        let Some(template) = self.shape.template() else {
            return PLACED_FRACTION;
        };
        let ball = 4.0 / 3.0 * PI * reach(template).powi(3);
        PLACED_FRACTION * (template.expected_volume() / ball).min(1.0)
    }

    /// Diameter of the largest ball around a grain [m].
    pub(super) fn largest_diameter(&self) -> f64 {
        let Some(template) = self.shape.template() else {
            return 2.0 * self.sizes().map_or(0.0, |sizes| sizes.range()[1]);
        };
        let own = (template.expected_volume() * 0.75 / PI).cbrt();
        let scale = (self.sizes.as_ref()).map_or(1.0, |sizes| sizes.range()[1] / own);
        2.0 * scale * reach(template)
    }

    /// Diameter of the ball of a mean grain's volume [m].
    pub(super) fn mean_diameter(&self) -> f64 {
        let volume = match (self.sizes(), self.shape.template()) {
            (Some(sizes), _) => sizes.mean_volume(),
            (None, Some(template)) => template.expected_volume(),
            (None, None) => 0.0,
        };
        2.0 * (volume * 0.75 / PI).cbrt()
    }
}

/// Radius of the ball around a template [m], at most.
fn reach(template: &Clump) -> f64 {
    let members = template.members.iter().map(|member| {
        let offset = member.offset_m.iter().map(|part| part * part).sum::<f64>();
        offset.sqrt() + member.radius_m
    });
    let filled = template.filled.iter().map(|filled| match &filled.shape {
        Shape::Ellipsoid { semi_axes_m } => semi_axes_m.iter().copied().fold(0.0, f64::max),
        Shape::Cylinder { radius_m, height_m } => radius_m.hypot(0.5 * height_m),
        Shape::Box { sides_m } => 0.5 * sides_m.iter().map(|side| side * side).sum::<f64>().sqrt(),
        Shape::Surface { stl, scale } => {
            let triangles = crate::surface::read_stl(stl.as_bytes()).unwrap_or_default();
            let [lower, upper] = crate::surface::bounds(triangles.iter().flatten());
            0.5 * scale * crate::surface::length(&crate::surface::minus(&upper, &lower))
        }
    });
    members.chain(filled).fold(0.0, f64::max)
}
