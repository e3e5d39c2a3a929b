//! The box test.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    super::granular_scene::{Axis, DegreeOfFreedom, Volume},
    Apparatus, Layer, Loading, Materials, Script, Tilting, Walls,
    checks::{check_shell, check_tilting},
    materials::{RUBBER, STEEL},
};
use crate::{Violation, Violations};

/// A steel box on rubber, half filled, with a sleeper across its width, and filled up beside it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct BoxTest {
    /// Along x.
    #[schemars(range(min = 1e-2, max = 100.0), extend("x-unit" = "m"))]
    pub length_m: f64,
    /// Along y, along the sleeper.
    #[schemars(range(min = 1e-2, max = 100.0), extend("x-unit" = "m"))]
    pub width_m: f64,
    /// Of the ballast beside the sleeper.
    #[schemars(range(min = 1e-2, max = 100.0), extend("x-unit" = "m"))]
    pub height_m: f64,
    /// Of the ballast below the sleeper.
    #[schemars(range(min = 1e-2, max = 100.0), extend("x-unit" = "m"))]
    pub height_below_m: f64,
    pub sleeper: Sleeper,
}

/// A sleeper: a rigid box that is free along z, and to tilt if asked for, and rests with its weight from when it is placed, also
/// while the bed is compacted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Sleeper {
    /// Along x.
    #[schemars(range(min = 1e-3, max = 100.0), extend("x-unit" = "m"))]
    pub length_m: f64,
    /// Along y.
    #[schemars(range(min = 1e-3, max = 100.0), extend("x-unit" = "m"))]
    pub width_m: f64,
    #[schemars(range(min = 1e-3, max = 100.0), extend("x-unit" = "m"))]
    pub height_m: f64,
    #[schemars(range(min = 1e-3, max = 1e6), extend("x-unit" = "kg"))]
    pub mass_kg: f64,
    /// Given, the sleeper is a shell of spheres of this radius instead of a box with flat faces.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-4, max = 1.0), extend("x-unit" = "m"))]
    pub member_radius_m: Option<f64>,
    /// Whether it is free to turn about x and y from when it is placed. Only one of spheres can.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub tilts: bool,
    /// Where the rail stands on a sleeper that tilts and passes the load on, from the middle of its top
    /// along x and y; left out, in the middle.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(inner(inner(range(min = -100.0, max = 100.0))), extend("x-unit" = "m"))]
    pub rail_m: Option<[f64; 2]>,
}

impl Default for Sleeper {
    /// [Lim2004].
    fn default() -> Self {
        Self {
            length_m: 0.25,
            width_m: 0.3,
            height_m: 0.15,
            mass_kg: 34.0,
            member_radius_m: None,
            tilts: false,
            rail_m: None,
        }
    }
}

impl Default for BoxTest {
    /// [Lim2004].
    fn default() -> Self {
        Self {
            length_m: 0.7,
            width_m: 0.3,
            height_m: 0.45,
            height_below_m: 0.3,
            sleeper: Sleeper::default(),
        }
    }
}

impl Apparatus for BoxTest {
    const STEEL_FRICTION: f64 = 0.5;
    const IS_OEDOMETER: bool = false;

    fn loading() -> Loading {
        Loading {
            smallest_force_n: 3e3,
            peak_force_n: 40e3,
            cycles: 1,
            period_s: None,
            frequency_hz: None,
            velocity_m_per_s: None,
            largest_displacement_m: None,
            then: Vec::new(),
        }
    }

    fn set_up(&self, script: &mut Script) {
        script.plane("base", Axis::Z, [0.0, 1.0], RUBBER);
        script.plane("left", Axis::X, [0.0, 1.0], STEEL);
        script.plane("right", Axis::X, [self.length_m, -1.0], STEEL);
        script.plane("front", Axis::Y, [0.0, 1.0], STEEL);
        script.plane("back", Axis::Y, [self.width_m, -1.0], STEEL);
        let area = self.length_m * self.width_m;
        let footprint = |bottom: f64| Volume::Box {
            lower_m: [0.0, 0.0, bottom],
            upper_m: [self.length_m, self.width_m, bottom + 1.0],
        };
        let below = Layer {
            footprint: footprint(0.0),
            volume: area * self.height_below_m,
        };
        let start = script.column(&below);
        let [low, high] = self.footprint();
        let sleeper = &self.sleeper;
        let corners = [
            [low[0], low[1], start],
            [high[0], high[1], start + sleeper.height_m],
        ];
        script.sleeper(corners, STEEL, sleeper.mass_kg, sleeper.member_radius_m);
        script.tilt(self.tilting());
        script.pour(&below);
        script.cut(self.height_below_m);
        script.place(self.sleeper.mass_kg);
        // poured over the sleeper too: what lies on it goes with the cut
        let top = self.height_below_m + self.sleeper.height_m + script.largest_diameter();
        script.pour(&Layer {
            footprint: footprint(top),
            volume: area * (self.height_m - self.height_below_m),
        });
        script.cut(self.height_m);
        script.compact();
    }

    fn walls(&self) -> Walls {
        Walls {
            base: "base",
            sides: &["left", "right", "front", "back"],
        }
    }

    fn footprint(&self) -> [[f64; 2]; 2] {
        let across = [self.length_m, self.width_m];
        let sleeper = [self.sleeper.length_m, self.sleeper.width_m];
        let edge = |side: f64| [0, 1].map(|axis| 0.5 * (across[axis] + side * sleeper[axis]));
        [edge(-1.0), edge(1.0)]
    }

    fn loaded_area(&self) -> f64 {
        self.sleeper.length_m * self.sleeper.width_m
    }

    fn bed_height(&self) -> f64 {
        self.height_below_m
    }

    fn loading_mass(&self, _materials: &Materials) -> f64 {
        self.sleeper.mass_kg
    }

    fn tilting(&self) -> Option<Tilting> {
        use DegreeOfFreedom as D;
        let sleeper = &self.sleeper;
        let [x, y] = sleeper.rail_m.unwrap_or_default();
        sleeper.tilts.then(|| Tilting {
            held: vec![D::X, D::Y, D::Rz],
            rail: [x, y, 0.5 * sleeper.height_m],
        })
    }

    fn check(&self, violations: &mut Violations) {
        let too_large = |field: &str, value: f64, allowed: f64, what: &str| {
            (value > allowed).then(|| {
                Violation::new(format!("/apparatus/{field}"), "too_large", what)
                    .value(value)
                    .allowed(format!("≤ {allowed}"))
                    .unit("m")
            })
        };
        let sleeper = &self.sleeper;
        let wide = "the sleeper is larger than its box";
        violations.extend(too_large(
            "sleeper/length_m",
            sleeper.length_m,
            self.length_m,
            wide,
        ));
        violations.extend(too_large(
            "sleeper/width_m",
            sleeper.width_m,
            self.width_m,
            wide,
        ));
        let low = "the bed below the sleeper is higher than that beside it";
        violations.extend(too_large(
            "height_below_m",
            self.height_below_m,
            self.height_m,
            low,
        ));
        violations.extend(check_shell(
            "/apparatus/sleeper/member_radius_m",
            [sleeper.length_m, sleeper.width_m, sleeper.height_m],
            sleeper.member_radius_m,
        ));
        violations.extend(check_tilting(
            [
                "/apparatus/sleeper/tilts",
                "/apparatus/sleeper/rail_m",
                "/apparatus/sleeper/member_radius_m",
            ],
            (sleeper.tilts, sleeper.member_radius_m.is_some()),
            sleeper.rail_m,
            [sleeper.length_m, sleeper.width_m],
        ));
    }
}
