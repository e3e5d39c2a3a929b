//! Bodies that a scene makes: how many, how large, where.
//!
//! A grain that is not a sphere is made from a template. Its size is the radius of the sphere of
//! the same solid volume, so that sieve curves, masses and porosities hold for every shape; without
//! `sizes` it is as large as its template.
use std::f64::consts::PI;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Body, Clump, Sphere};

/// Bodies made at random, without overlaps, by the streams of the scene's seed. One of `count`,
/// `mass_kg` and `porosity` says how many.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Generate {
    /// Name for messages.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1, max = 60))]
    pub name: Option<String>,
    /// Name of a material.
    pub material: String,
    /// Where they are placed, wholly inside.
    pub region: Volume,
    #[serde(default)]
    pub grain: Grain,
    /// How large they are; spheres need it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sizes: Option<Sizes>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 10_000_000))]
    pub count: Option<u32>,
    /// Mass of them together, to within half a grain, of each sieve fraction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-30, max = 1e15), extend("x-unit" = "kg"))]
    pub mass_kg: Option<f64>,
    /// Share of the region that is left empty.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.2, max = 0.999_999), extend("x-unit" = "1"))]
    pub porosity: Option<f64>,
    #[serde(default)]
    pub arrangement: Arrangement,
    /// Whether grains that are not spheres are turned at random.
    #[serde(default = "yes")]
    pub turned: bool,
    #[serde(default)]
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "m/s"))]
    pub velocity_m_per_s: [f64; 3],
}

/// A volume.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Volume {
    Box {
        #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "m"))]
        lower_m: [f64; 3],
        #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "m"))]
        upper_m: [f64; 3],
    },
    /// Upright, axis along z.
    Cylinder {
        /// Centre of the lower face.
        #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "m"))]
        base_m: [f64; 3],
        #[schemars(range(min = 1e-9, max = 1e6), extend("x-unit" = "m"))]
        radius_m: f64,
        #[schemars(range(min = 1e-9, max = 1e6), extend("x-unit" = "m"))]
        height_m: f64,
    },
    Sphere {
        #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "m"))]
        centre_m: [f64; 3],
        #[schemars(range(min = 1e-9, max = 1e6), extend("x-unit" = "m"))]
        radius_m: f64,
    },
}

/// What is made.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Grain {
    #[default]
    Sphere,
    /// A rigid clump like this one.
    Clump(Clump),
    /// Bonded spheres like these, of a cohesive material.
    Breakable(Clump),
}

/// How large grains are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Sizes {
    /// All the same.
    RadiusM(#[schemars(range(min = 1e-9, max = 1e6), extend("x-unit" = "m"))] f64),
    /// Radii between two, equally likely.
    Uniform {
        #[schemars(range(min = 1e-9, max = 1e6), extend("x-unit" = "m"))]
        smallest_radius_m: f64,
        #[schemars(range(min = 1e-9, max = 1e6), extend("x-unit" = "m"))]
        largest_radius_m: f64,
    },
    /// Radius median · exp(σ N(0, 1)), cut at 3 σ.
    LogNormal {
        #[schemars(range(min = 1e-9, max = 1e6), extend("x-unit" = "m"))]
        median_radius_m: f64,
        #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1"))]
        sigma: f64,
    },
    /// What lies between sieves. Within a fraction the curve of mass passing is straight.
    SieveCurve(#[schemars(length(min = 1, max = 100))] Vec<SieveFraction>),
}

/// Grains between two sieves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SieveFraction {
    #[schemars(range(min = 1e-9, max = 1e6), extend("x-unit" = "m"))]
    pub smallest_diameter_m: f64,
    #[schemars(range(min = 1e-9, max = 1e6), extend("x-unit" = "m"))]
    pub largest_diameter_m: f64,
    /// Share of the mass, relative to the sum of all shares.
    #[schemars(range(min = 1e-9, max = 1e9), extend("x-unit" = "1"))]
    pub mass_share: f64,
}

/// Where grains are placed in their region.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Arrangement {
    /// At random, the largest first; equal spheres reach a solid fraction of about 0.38.
    #[default]
    Random,
    /// On a simple cubic lattice from below, as wide as the largest grain.
    Grid,
    /// On a hexagonal close packing from below, as wide as the largest grain.
    Hexagonal,
}

fn yes() -> bool {
    true
}

impl Volume {
    /// The same from its lowest place on, this high [m]; a sphere stays as it is.
    #[must_use]
    pub fn with_height(mut self, height: f64) -> Self {
        match &mut self {
            Self::Box { lower_m, upper_m } => upper_m[2] = lower_m[2] + height,
            Self::Cylinder { height_m, .. } => *height_m = height,
            Self::Sphere { .. } => {}
        }
        self
    }

    /// Volume [m³].
    pub fn volume(&self) -> f64 {
        match self {
            Self::Box { lower_m, upper_m } => {
                (0..3).map(|axis| upper_m[axis] - lower_m[axis]).product()
            }
            Self::Cylinder {
                radius_m, height_m, ..
            } => PI * radius_m.powi(2) * height_m,
            Self::Sphere { radius_m, .. } => 4.0 / 3.0 * PI * radius_m.powi(3),
        }
    }

    /// Lower and upper corner of the bounding box [m].
    pub fn bounds(&self) -> [[f64; 3]; 2] {
        match *self {
            Self::Box { lower_m, upper_m } => [lower_m, upper_m],
            Self::Cylinder {
                base_m: [x, y, z],
                radius_m: r,
                height_m,
            } => [[x - r, y - r, z], [x + r, y + r, z + height_m]],
            Self::Sphere { centre_m, radius_m } => [
                centre_m.map(|x| x - radius_m),
                centre_m.map(|x| x + radius_m),
            ],
        }
    }
}

/// Volume of a ball [m³].
fn ball(radius: f64) -> f64 {
    4.0 / 3.0 * PI * radius.powi(3)
}

impl Sizes {
    /// Smallest and largest radius [m].
    pub fn range(&self) -> [f64; 2] {
        match self {
            Self::RadiusM(radius) => [*radius; 2],
            Self::Uniform {
                smallest_radius_m,
                largest_radius_m,
            } => [*smallest_radius_m, *largest_radius_m],
            Self::LogNormal {
                median_radius_m,
                sigma,
            } => [-3.0, 3.0].map(|factor| median_radius_m * (factor * sigma).exp()),
            Self::SieveCurve(fractions) => {
                let smallest = fractions
                    .iter()
                    .map(|fraction| fraction.smallest_diameter_m);
                let largest = fractions.iter().map(|fraction| fraction.largest_diameter_m);
                [
                    0.5 * smallest.fold(f64::INFINITY, f64::min),
                    0.5 * largest.fold(0.0, f64::max),
                ]
            }
        }
    }

    /// Mean volume of a grain [m³].
    pub fn mean_volume(&self) -> f64 {
        let [smallest, largest] = self.range();
        match self {
            Self::Uniform { .. } if largest > smallest => {
                PI / 3.0 * (largest.powi(4) - smallest.powi(4)) / (largest - smallest)
            }
            Self::RadiusM(_) | Self::Uniform { .. } => ball(smallest),
            Self::LogNormal {
                median_radius_m,
                sigma,
            } => ball(*median_radius_m) * (4.5 * sigma * sigma).exp(),
            Self::SieveCurve(fractions) => {
                let shares: f64 = fractions.iter().map(|fraction| fraction.mass_share).sum();
                let grains = fractions.iter().map(|fraction| {
                    let [lower, upper] =
                        [fraction.smallest_diameter_m, fraction.largest_diameter_m];
                    // number of grains ∝ d⁻³ within a fraction
                    let mean = PI / 3.0 * (lower * upper).powi(2) / (lower + upper);
                    fraction.mass_share / mean
                });
                shares / grains.sum::<f64>()
            }
        }
    }
}

impl Grain {
    /// The template of a grain that is not a sphere.
    pub fn template(&self) -> Option<&Clump> {
        match self {
            Self::Sphere => None,
            Self::Clump(template) | Self::Breakable(template) => Some(template),
        }
    }
}

impl Generate {
    /// Spheres of a material, not yet any, nor anywhere.
    pub fn of(material: &str) -> Self {
        Self {
            name: None,
            grain: Grain::Sphere,
            sizes: None,
            material: material.to_owned(),
            region: Volume::Sphere {
                centre_m: [0.0; 3],
                radius_m: 1.0,
            },
            count: None,
            mass_kg: None,
            porosity: None,
            arrangement: Arrangement::Random,
            turned: true,
            velocity_m_per_s: [0.0; 3],
        }
    }

    /// Mean solid volume of a grain [m³]; overlaps of a template count twice here.
    fn mean_volume(&self) -> f64 {
        match (&self.sizes, self.grain.template()) {
            (Some(sizes), _) => sizes.mean_volume(),
            (None, Some(template)) => template.expected_volume(),
            (None, None) => f64::INFINITY,
        }
    }

    /// About how many grains are made, of a material of this density [kg/m³].
    pub(super) fn expected_grains(&self, density: f64) -> f64 {
        let by_mass = self.mass_kg.map(|mass| mass / density);
        let by_porosity = self
            .porosity
            .map(|porosity| (1.0 - porosity) * self.region.volume());
        let by_volume = by_mass
            .or(by_porosity)
            .map(|volume| volume / self.mean_volume());
        self.count.map(f64::from).or(by_volume).unwrap_or(0.0)
    }

    /// Solid fraction of the region when all are in it, about.
    pub(super) fn expected_solid_fraction(&self, density: f64) -> f64 {
        self.expected_grains(density) * self.mean_volume() / self.region.volume()
    }

    /// Places of the lattice that grains are put on, in the region's box, which are all listed; none for
    /// random ones.
    pub(super) fn places(&self) -> f64 {
        let share = match self.arrangement {
            Arrangement::Random => return 0.0,
            Arrangement::Grid => 1.0,
            Arrangement::Hexagonal => std::f64::consts::SQRT_2,
        };
        let [lower, upper] = self.region.bounds();
        let spacing = 2.0 * self.largest_radius();
        let rows = (0..3).map(|axis| ((upper[axis] - lower[axis]) / spacing).max(1.0));
        share * rows.product::<f64>()
    }

    /// Radius of the largest grain [m]; that of a ball of its volume where it is a clump.
    fn largest_radius(&self) -> f64 {
        let of_template = |template: &Clump| (template.expected_volume() / ball(1.0)).cbrt();
        match (&self.sizes, self.grain.template()) {
            (Some(sizes), _) => sizes.range()[1],
            (None, template) => template.map_or(f64::INFINITY, of_template),
        }
    }

    /// About how many spheres that makes.
    pub(super) fn expected_particles(&self, density: f64) -> u64 {
        let members = self.grain.template().map_or(1, Clump::expected_members);
        (self.expected_grains(density) as u64).saturating_mul(members)
    }

    /// Smallest and largest grain over its template.
    fn scales(&self, template: &Clump) -> [f64; 2] {
        let own = (template.expected_volume() / ball(1.0)).cbrt();
        let sizes = self.sizes.as_ref();
        sizes.map_or([1.0; 2], |sizes| sizes.range().map(|radius| radius / own))
    }

    /// Smallest grain over its template; 1 for spheres.
    pub(super) fn smallest_scale(&self) -> f64 {
        let template = self.grain.template();
        template.map_or(1.0, |template| self.scales(template)[0])
    }

    /// The smallest and the largest sphere that can be a body of its own, for questions of
    /// stability; none for rigid clumps.
    pub(super) fn extremes(&self) -> Vec<Body> {
        let radii = match &self.grain {
            Grain::Sphere => self.sizes.as_ref().map(Sizes::range),
            Grain::Clump(_) => None,
            Grain::Breakable(template) => {
                let [smallest, largest] = template.radii();
                let scales = self.scales(template);
                Some([smallest * scales[0], largest * scales[1]])
            }
        };
        let sphere = |radius_m| Body {
            sphere: Some(Sphere { radius_m }),
            velocity_m_per_s: self.velocity_m_per_s,
            ..Body::at([0.0; 3], &self.material)
        };
        radii.into_iter().flatten().map(sphere).collect()
    }
}

impl Clump {
    /// How many members it has, about when they fill a shape.
    pub(super) fn expected_members(&self) -> u64 {
        let filled = self
            .filled
            .as_ref()
            .map_or(0, super::Filled::expected_members);
        filled.saturating_add(self.members.len() as u64)
    }

    /// Volume of the members [m³], overlaps counted twice.
    pub fn expected_volume(&self) -> f64 {
        let filled = self.filled.as_ref().map_or(0.0, |filled| {
            filled.expected_members() as f64 * ball(filled.member_radius_m)
        });
        filled
            + self
                .members
                .iter()
                .map(|member| ball(member.radius_m))
                .sum::<f64>()
    }

    /// Smallest and largest radius of a member [m].
    pub(super) fn radii(&self) -> [f64; 2] {
        let filled = self.filled.iter().map(|filled| filled.member_radius_m);
        let radii = filled.chain(self.members.iter().map(|member| member.radius_m));
        radii.fold([f64::INFINITY, 0.0], |[low, high], radius| {
            [low.min(radius), high.max(radius)]
        })
    }
}
