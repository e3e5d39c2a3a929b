//! What grains and walls are made of.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::super::granular_scene::Material;

/// The materials of a test. Walls that are left out follow from the aggregate's modulus E_k as in
/// [Dubina2014], tables 4.1, 5.1 and 6.1: steel 10 E_k, rubber 0.1 E_k, concrete 1.43 E_k.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Materials {
    pub aggregate: Material,
    /// Cylinder, box, plate, the sleeper of the box test.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub steel: Option<Material>,
    /// The soft layer below, by its modulus.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rubber: Option<Material>,
    /// The same by its stiffness, instead of `rubber`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mat: Option<Mat>,
    /// The sleeper of the rail bed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub concrete: Option<Material>,
}

/// A soft layer below the bed, of which the stiffness under a grain is known: [Lim2004] has
/// 2.54e6 N/m, a 2000th of that of steel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Mat {
    /// K: a rigid grain is pressed into the layer by u with the force K u, whatever its size. With that
    /// of a grain it acts in series.
    #[schemars(range(min = 1e-3, max = 1e15), extend("x-unit" = "N/m"))]
    pub contact_stiffness_n_per_m: f64,
    /// ν, shear over normal stiffness.
    #[serde(default = "mat_stiffness_ratio")]
    #[schemars(range(min = 1e-6, max = 10.0), extend("x-unit" = "1"))]
    pub stiffness_ratio: f64,
    /// φ.
    #[serde(default = "mat_friction")]
    #[schemars(range(min = 0.0, max = 1.570_795_5), extend("x-unit" = "rad"))]
    pub friction_angle_rad: f64,
}

/// Rubber of [Dubina2014] table 5.1: ρ [kg/m³], E/E_k, ν, φ [rad].
const RUBBER_NUMBERS: [f64; 4] = [1000.0, 0.1, 0.5, 0.7];

fn mat_stiffness_ratio() -> f64 {
    RUBBER_NUMBERS[2]
}

fn mat_friction() -> f64 {
    RUBBER_NUMBERS[3]
}

/// A wall's material: density [kg/m³], E/E_k, ν, φ [rad].
fn wall(aggregate: &Material, [density, factor, ratio, friction]: [f64; 4]) -> Material {
    Material {
        density_kg_per_m3: density,
        youngs_modulus_pa: factor * aggregate.youngs_modulus_pa,
        stiffness_ratio: ratio,
        friction_angle_rad: Some(friction),
        rolling_resistance: None,
        parallel_bond: None,
        normal_cohesion_pa: 0.0,
        shear_cohesion_pa: 0.0,
        ..aggregate.clone()
    }
}

impl Materials {
    /// The same with all walls, steel of this friction angle [rad] if it is not given.
    pub(super) fn with_walls(&self, steel_friction: f64) -> Self {
        let or = |given: &Option<Material>, numbers| {
            Some((given.clone()).unwrap_or_else(|| wall(&self.aggregate, numbers)))
        };
        Self {
            aggregate: self.aggregate.clone(),
            steel: or(&self.steel, [7850.0, 10.0, 0.25, steel_friction]),
            // one of the two
            rubber: match self.mat {
                Some(_) => self.rubber.clone(),
                None => or(&self.rubber, RUBBER_NUMBERS),
            },
            mat: self.mat,
            concrete: or(&self.concrete, [2600.0, 1.43, 0.3, 0.5]),
        }
    }

    /// Those there are, with their names in a scene.
    pub(super) fn named(&self) -> impl Iterator<Item = (&'static str, Material)> {
        let mat = self.mat.map(|mat| {
            // its plane has a stiffness of its own
            let numbers = [mat.stiffness_ratio, mat.friction_angle_rad];
            let [density, factor, ..] = RUBBER_NUMBERS;
            wall(&self.aggregate, [density, factor, numbers[0], numbers[1]])
        });
        let walls = [
            (STEEL, self.steel.clone()),
            (RUBBER, self.rubber.clone().or(mat)),
            (CONCRETE, self.concrete.clone()),
        ];
        let walls = walls.into_iter();
        std::iter::once((AGGREGATE, self.aggregate.clone()))
            .chain(walls.filter_map(|(name, material)| Some((name, material?))))
    }
}

/// Names in a scene.
pub(super) const AGGREGATE: &str = "aggregate";
pub(super) const STEEL: &str = "steel";
pub(super) const RUBBER: &str = "rubber";
pub(super) const CONCRETE: &str = "concrete";
