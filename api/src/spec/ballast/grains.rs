//! The grains of a bed.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::super::granular_scene::{Arrangement, Clump, Equal, Grain, Sizes, Whole};
use super::PouredAsSpheres;

/// Shape and sizes of grains.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Grains {
    /// A sphere, a rigid clump, or a breakable one of an aggregate with cohesion. A clump is given
    /// member by member or fills an ellipsoid, a cylinder, a box or an STL surface.
    pub shape: Grain,
    /// Sizes; a clump is scaled to the volume of a sphere of the size drawn. Left out, spheres have
    /// radii of 0.6 to 1.4 times 16.25 mm and clumps the size they are given with.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sizes: Option<Sizes>,
    /// Where the grains of the first layer begin to fall: at random places or on a lattice; later layers
    /// come in at random.
    #[serde(skip_serializing_if = "is_random")]
    pub arrangement: Arrangement,
    /// Whether grains that are not spheres are turned at random.
    #[serde(skip_serializing_if = "is_true")]
    pub turned: bool,
}

impl Default for Grains {
    fn default() -> Self {
        Self {
            shape: Grain::default(),
            sizes: None,
            arrangement: Arrangement::Random,
            turned: true,
        }
    }
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
fn is_random(arrangement: &Arrangement) -> bool {
    *arrangement == Arrangement::Random
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
fn is_true(turned: &bool) -> bool {
    *turned
}

/// Part of the places of a lattice that lie in a round or narrow region, at least.
const PLACES_INSIDE: f64 = 0.6;

/// r of the source's spheres, and its scatter.
const RADIUS: f64 = 0.01625;
const SCATTER: [f64; 2] = [0.6, 1.4];

/// Spheres that are poured, and the clumps that take their places.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SpheresFirst {
    pub(super) spheres: Grains,
    pub(super) clump: Clump,
    pub(super) equal: Equal,
    /// Volume of a clump over that of its sphere.
    pub(super) volume_ratio: f64,
    /// Radius of the ball around a clump over that of its sphere.
    reach_ratio: f64,
}

impl SpheresFirst {
    /// Diameter of the largest ball around a sphere or a clump [m].
    pub(super) fn largest_diameter(&self) -> f64 {
        self.spheres.largest_diameter() * self.reach_ratio.max(1.0)
    }

    /// Diameter of the ball of a mean clump's volume [m].
    pub(super) fn mean_diameter(&self) -> f64 {
        self.spheres.mean_diameter() * self.volume_ratio.cbrt()
    }
}

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

    /// Spheres that clumps take the places of; none where grains are no clumps, or cannot be filled.
    pub(super) fn spheres_first(&self, poured: PouredAsSpheres) -> Option<SpheresFirst> {
        let Grain::Clump(clump) = &self.shape else {
            return None;
        };
        let whole = Whole::of(&clump.resolved().ok()?.members);
        let radius = poured.equal.radius(&whole);
        Some(SpheresFirst {
            spheres: Self {
                shape: Grain::Sphere,
                sizes: Some(self.sizes.clone().unwrap_or(Sizes::RadiusM(radius))),
                ..self.clone()
            },
            clump: clump.clone(),
            equal: poured.equal,
            volume_ratio: (whole.equal_radius() / radius).powi(3),
            reach_ratio: whole.reach / radius,
        })
    }

    /// Solid fraction that the first layer reaches before it falls.
    pub(super) fn placed_fraction(&self) -> f64 {
        let places = match self.arrangement {
            Arrangement::Random => return self.shape.placed_fraction(),
            Arrangement::Grid => 1.0,
            Arrangement::Hexagonal => std::f64::consts::SQRT_2,
        };
        let volume = std::f64::consts::PI / 6.0 * self.mean_diameter().powi(3);
        PLACES_INSIDE * places * volume / self.largest_diameter().powi(3)
    }

    /// Diameter of the largest ball around a grain [m].
    pub(super) fn largest_diameter(&self) -> f64 {
        self.shape.largest_diameter(self.sizes().as_ref())
    }

    /// Diameter of the ball of a mean grain's volume [m].
    pub(super) fn mean_diameter(&self) -> f64 {
        self.shape.mean_diameter(self.sizes().as_ref())
    }
}
