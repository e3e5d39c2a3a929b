//! The oedometer.
use std::f64::consts::PI;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    super::granular_scene::{Axis, Volume},
    Apparatus, Layer, Loading, Materials, Script, Walls,
    materials::STEEL,
    shapes::{cylinder, face_radius},
};
use crate::Violations;

/// A steel cylinder, or a square box, on a steel base, open for a plate that presses the bed from above.
///
/// A cylinder is a prism of flat facets, as large in cross-section as the cylinder, with an
/// extension while it is filled.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Oedometer {
    #[serde(skip_serializing_if = "Section::is_circle")]
    pub section: Section,
    /// Of the cylinder, or the side of the square.
    #[schemars(range(min = 1e-3, max = 100.0), extend("x-unit" = "m"))]
    pub diameter_m: f64,
    #[schemars(range(min = 1e-3, max = 100.0), extend("x-unit" = "m"))]
    pub height_m: f64,
    /// Flat sides of the cylinder; a square has four.
    #[schemars(range(min = 3, max = 1000))]
    pub facets: u32,
    /// Mass of the plate. Its weight rests on the bed while that is compacted; after that, the load is all
    /// that presses.
    #[schemars(range(min = 1e-3, max = 1e6), extend("x-unit" = "kg"))]
    pub plate_mass_kg: f64,
}

/// A cross-section.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Section {
    #[default]
    Circle,
    Square,
}

impl Section {
    #[allow(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
    fn is_circle(&self) -> bool {
        *self == Self::Circle
    }
}

impl Default for Oedometer {
    /// [Lim2004]; the plate is 20 mm of steel.
    fn default() -> Self {
        Self {
            section: Section::Circle,
            diameter_m: 0.3,
            height_m: 0.15,
            facets: 24,
            plate_mass_kg: 11.0,
        }
    }
}

impl Oedometer {
    fn radius(&self) -> f64 {
        0.5 * self.diameter_m
    }
}

impl Apparatus for Oedometer {
    const STEEL_FRICTION: f64 = 0.0;
    const IS_OEDOMETER: bool = true;

    fn loading() -> Loading {
        Loading {
            smallest_force_n: 250.0,
            peak_force_n: 150e3,
            cycles: 1,
            period_s: None,
            frequency_hz: None,
            velocity_m_per_s: None,
            largest_displacement_m: None,
            then: Vec::new(),
        }
    }

    fn set_up(&self, script: &mut Script) {
        let (radius, height) = (self.radius(), self.height_m);
        let footprint = match self.section {
            Section::Circle => Volume::Cylinder {
                base_m: [0.0; 3],
                radius_m: face_radius(radius, self.facets),
                height_m: height,
            },
            Section::Square => Volume::Box {
                lower_m: [-radius, -radius, 0.0],
                upper_m: [radius, radius, height],
            },
        };
        let layer = Layer {
            footprint,
            volume: self.loaded_area() * height,
        };
        let column = script.column(&layer);
        script.plane("base", Axis::Z, [0.0, 1.0], STEEL);
        script.plane("plate", Axis::Z, [column, -1.0], STEEL);
        match self.section {
            Section::Circle => {
                let sides = cylinder(radius, column, self.facets);
                script.facets("cylinder", STEEL, sides);
            }
            Section::Square => {
                script.plane("left", Axis::X, [-radius, 1.0], STEEL);
                script.plane("right", Axis::X, [radius, -1.0], STEEL);
                script.plane("front", Axis::Y, [-radius, 1.0], STEEL);
                script.plane("back", Axis::Y, [radius, -1.0], STEEL);
            }
        }
        script.loads("plate", column);
        script.pour(&layer);
        script.cut(height);
        script.place(self.plate_mass_kg);
        script.compact();
    }

    fn walls(&self) -> Walls {
        Walls {
            base: "base",
            sides: match self.section {
                Section::Circle => &["cylinder"],
                Section::Square => &["left", "right", "front", "back"],
            },
        }
    }

    fn footprint(&self) -> [[f64; 2]; 2] {
        // corners of the prism stand out of the cylinder
        [[-self.diameter_m; 2], [self.diameter_m; 2]]
    }

    fn loaded_area(&self) -> f64 {
        match self.section {
            Section::Circle => PI * self.radius().powi(2),
            Section::Square => self.diameter_m.powi(2),
        }
    }

    fn bed_height(&self) -> f64 {
        self.height_m
    }

    fn loading_mass(&self, _materials: &Materials) -> f64 {
        self.plate_mass_kg
    }

    fn check(&self, _violations: &mut Violations) {}
}
