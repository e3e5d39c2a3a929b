//! How grains fill a room: what tests that make beds of them reckon with.
use std::f64::consts::PI;

use super::{Clump, Grain, Shape, Sizes};

/// Solid fraction of balls that random placing reaches safely.
const PLACED_FRACTION: f64 = 0.30;

impl Grain {
    /// Solid fraction that random placing of these grains reaches: each has the ball around it for
    /// itself.
    pub(crate) fn placed_fraction(&self) -> f64 {
        let Some(template) = self.template() else {
            return PLACED_FRACTION;
        };
        let ball = 4.0 / 3.0 * PI * reach(template).powi(3);
        PLACED_FRACTION * (template.expected_volume() / ball).min(1.0)
    }

    /// Diameter of the largest ball around a grain of these sizes [m]; without any, of its own.
    pub(crate) fn largest_diameter(&self, sizes: Option<&Sizes>) -> f64 {
        let largest = sizes.map(|sizes| sizes.range()[1]);
        let Some(template) = self.template() else {
            return 2.0 * largest.unwrap_or(0.0);
        };
        let own = (template.expected_volume() * 0.75 / PI).cbrt();
        2.0 * largest.map_or(1.0, |largest| largest / own) * reach(template)
    }

    /// Diameter of the ball of a mean grain's volume [m].
    pub(crate) fn mean_diameter(&self, sizes: Option<&Sizes>) -> f64 {
        let volume = match (sizes, self.template()) {
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
