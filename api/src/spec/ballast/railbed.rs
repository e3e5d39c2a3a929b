//! The rail bed.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    super::granular_scene::{Axis, DegreeOfFreedom, Material, Volume},
    Apparatus, Layer, Loading, Materials, Script, Tilting, Walls,
    checks::{check_shell, check_tilting},
    materials::{AGGREGATE, CONCRETE, RUBBER},
};
use crate::{Violation, Violations, surface::rectangle};

/// Half of a cross-section of a track, one sleeper spacing long: x from the symmetry plane outward,
/// y along the track. Soft ground below, smooth planes where the track goes on, a form at the slope of
/// the shoulder.
///
/// The sleeper is a rigid box, free along z, that rests with its weight from when it is placed; the
/// rail passes the load on to it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Railbed {
    /// Distance of sleepers along the track.
    #[schemars(range(min = 1e-2, max = 100.0), extend("x-unit" = "m"))]
    pub sleeper_spacing_m: f64,
    /// Ballast below the sleeper.
    #[schemars(range(min = 1e-2, max = 100.0), extend("x-unit" = "m"))]
    pub height_below_m: f64,
    /// Half of the sleeper's length, along x.
    #[schemars(range(min = 1e-2, max = 100.0), extend("x-unit" = "m"))]
    pub half_sleeper_length_m: f64,
    /// Of the sleeper along the track.
    #[schemars(range(min = 1e-2, max = 100.0), extend("x-unit" = "m"))]
    pub sleeper_width_m: f64,
    #[schemars(range(min = 1e-2, max = 100.0), extend("x-unit" = "m"))]
    pub sleeper_height_m: f64,
    /// Given, the sleeper is a shell of spheres of this radius instead of a box with flat faces.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-4, max = 1.0), extend("x-unit" = "m"))]
    pub sleeper_member_radius_m: Option<f64>,
    /// Whether the sleeper is free to move along the track and to turn about x from when it is placed;
    /// the plane of symmetry holds the rest. Only one of spheres can.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub sleeper_tilts: bool,
    /// Where the rail stands on a sleeper that tilts and passes the load on, from the middle of its
    /// half's top along x and y; left out, in the middle.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(inner(inner(range(min = -100.0, max = 100.0))), extend("x-unit" = "m"))]
    pub rail_m: Option<[f64; 2]>,
    /// Ballast beyond the sleeper's end, at its top.
    #[schemars(range(min = 0.0, max = 100.0), extend("x-unit" = "m"))]
    pub shoulder_m: f64,
    /// Way across over height of the shoulder's slope.
    #[schemars(range(min = 0.0, max = 10.0), extend("x-unit" = "1"))]
    pub slope: f64,
}

impl Default for Railbed {
    /// [Dubina2014] chapter 6; it does not give the shoulder: 0.4 m and 1 to 1.5 are usual.
    fn default() -> Self {
        Self {
            sleeper_spacing_m: 0.6,
            height_below_m: 0.35,
            half_sleeper_length_m: 1.3,
            sleeper_width_m: 0.3,
            sleeper_height_m: 0.22,
            sleeper_member_radius_m: None,
            sleeper_tilts: false,
            rail_m: None,
            shoulder_m: 0.4,
            slope: 1.5,
        }
    }
}

/// Planes of symmetry are of this: the aggregate's modulus, without friction.
const MIRROR: &str = "mirror";

impl Railbed {
    fn top(&self) -> f64 {
        self.height_below_m + self.sleeper_height_m
    }

    /// x of the bed's edge at a height [m].
    fn edge(&self, height: f64) -> f64 {
        let rest = (self.top() - height).max(0.0);
        self.half_sleeper_length_m + self.shoulder_m + self.slope * rest
    }

    /// Volume of the bed between two heights, sleeper included [m³].
    fn volume(&self, [bottom, top]: [f64; 2]) -> f64 {
        0.5 * (self.edge(bottom) + self.edge(top)) * (top - bottom) * self.sleeper_spacing_m
    }

    fn poured_over(&self, bottom: f64, edge: f64) -> Volume {
        Volume::Box {
            lower_m: [0.0, 0.0, bottom],
            upper_m: [edge, self.sleeper_spacing_m, bottom + 1.0],
        }
    }

    /// The form: the slope, and above it a wall as high as grains are poured.
    fn form(&self, height: f64) -> Vec<crate::surface::Triangle> {
        let width = self.sleeper_spacing_m;
        let line = |x: f64, z: f64| [[x, 0.0, z], [x, width, z]];
        let [toe_front, toe_back] = line(self.edge(0.0), 0.0);
        let [crest_front, crest_back] = line(self.edge(self.top()), self.top());
        let [end_front, end_back] = line(self.edge(self.top()), height);
        let slope = rectangle([toe_front, toe_back, crest_back, crest_front]);
        let wall = rectangle([crest_front, crest_back, end_back, end_front]);
        [slope, wall].concat()
    }
}

impl Apparatus for Railbed {
    const STEEL_FRICTION: f64 = 0.5;
    const IS_OEDOMETER: bool = false;

    fn loading() -> Loading {
        Loading {
            smallest_force_n: 0.0,
            peak_force_n: 200e3,
            cycles: 1,
            period_s: None,
            frequency_hz: None,
            velocity_m_per_s: None,
            largest_displacement_m: None,
            then: Vec::new(),
        }
    }

    fn set_up(&self, script: &mut Script) {
        let mirror = Material {
            friction_angle_rad: Some(0.0),
            rolling_resistance: None,
            parallel_bond: None,
            normal_cohesion_pa: 0.0,
            shear_cohesion_pa: 0.0,
            ..script.scene.materials[AGGREGATE].clone()
        };
        script.scene.materials.insert(MIRROR.to_owned(), mirror);
        script.plane("ground", Axis::Z, [0.0, 1.0], RUBBER);
        script.plane("symmetry", Axis::X, [0.0, 1.0], MIRROR);
        script.plane("front", Axis::Y, [0.0, 1.0], MIRROR);
        script.plane("back", Axis::Y, [self.sleeper_spacing_m, -1.0], MIRROR);
        // poured where the form is upright, it finds the slope by itself
        let narrow = self.edge(self.top());
        let below = Layer {
            footprint: self.poured_over(0.0, narrow),
            volume: self.volume([0.0, self.height_below_m]),
        };
        let above = self.top() + script.largest_diameter();
        let beside = Layer {
            footprint: self.poured_over(above, narrow),
            volume: self.volume([self.height_below_m, self.top()]),
        };
        let start = script.column(&below);
        let form = self.form(start.max(above + script.column(&beside)));
        script.facets("form", AGGREGATE, form);
        let [low, high] = self.footprint();
        let corners = [
            [low[0], low[1], start],
            [high[0], high[1], start + self.sleeper_height_m],
        ];
        let density = script.scene.materials[CONCRETE].density_kg_per_m3;
        let mass = density * self.sleeper_volume();
        script.sleeper(corners, CONCRETE, mass, self.sleeper_member_radius_m);
        script.tilt(self.tilting());
        // compacted to fill the form, and again around the sleeper
        script.pour(&below);
        script.compact();
        script.cut(self.height_below_m);
        script.place(mass);
        script.pour(&beside);
        script.compact();
        script.cut(self.top());
        script.rest();
    }

    fn walls(&self) -> Walls {
        Walls {
            base: "ground",
            sides: &["symmetry", "front", "back", "form"],
        }
    }

    fn footprint(&self) -> [[f64; 2]; 2] {
        let middle = 0.5 * self.sleeper_spacing_m;
        let half = 0.5 * self.sleeper_width_m;
        [
            [0.0, middle - half],
            [self.half_sleeper_length_m, middle + half],
        ]
    }

    fn loaded_area(&self) -> f64 {
        self.half_sleeper_length_m * self.sleeper_width_m
    }

    fn bed_height(&self) -> f64 {
        self.height_below_m
    }

    fn loading_mass(&self, materials: &Materials) -> f64 {
        let concrete = materials.concrete.as_ref();
        concrete.map_or(0.0, |concrete| concrete.density_kg_per_m3) * self.sleeper_volume()
    }

    fn tilting(&self) -> Option<Tilting> {
        use DegreeOfFreedom as D;
        let [x, y] = self.rail_m.unwrap_or_default();
        self.sleeper_tilts.then(|| Tilting {
            // the other half would turn about z the other way
            held: vec![D::X, D::Ry, D::Rz],
            rail: [x, y, 0.5 * self.sleeper_height_m],
        })
    }

    fn check(&self, violations: &mut Violations) {
        if self.sleeper_width_m > self.sleeper_spacing_m {
            let detail = "the sleeper is wider than the distance of sleepers";
            violations.push(
                Violation::new("/apparatus/sleeper_width_m", "too_large", detail)
                    .value(self.sleeper_width_m)
                    .allowed(format!("≤ {}", self.sleeper_spacing_m))
                    .unit("m"),
            );
        }
        violations.extend(check_shell(
            "/apparatus/sleeper_member_radius_m",
            [
                self.half_sleeper_length_m,
                self.sleeper_width_m,
                self.sleeper_height_m,
            ],
            self.sleeper_member_radius_m,
        ));
        violations.extend(check_tilting(
            [
                "/apparatus/sleeper_tilts",
                "/apparatus/rail_m",
                "/apparatus/sleeper_member_radius_m",
            ],
            (self.sleeper_tilts, self.sleeper_member_radius_m.is_some()),
            self.rail_m,
            [self.half_sleeper_length_m, self.sleeper_width_m],
        ));
    }
}

impl Railbed {
    fn sleeper_volume(&self) -> f64 {
        self.loaded_area() * self.sleeper_height_m
    }
}
