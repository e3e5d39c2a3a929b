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
    /// The soft layer below.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rubber: Option<Material>,
    /// The sleeper of the rail bed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub concrete: Option<Material>,
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
            rubber: or(&self.rubber, [1000.0, 0.1, 0.5, 0.7]),
            concrete: or(&self.concrete, [2600.0, 1.43, 0.3, 0.5]),
        }
    }

    /// Those there are, with their names in a scene.
    pub(super) fn named(&self) -> impl Iterator<Item = (&'static str, &Material)> {
        let walls = [
            (STEEL, &self.steel),
            (RUBBER, &self.rubber),
            (CONCRETE, &self.concrete),
        ];
        let walls = walls.into_iter();
        std::iter::once((AGGREGATE, &self.aggregate)).chain(
            walls.filter_map(|(name, material)| material.as_ref().map(|material| (name, material))),
        )
    }
}

/// Names in a scene.
pub(super) const AGGREGATE: &str = "aggregate";
pub(super) const STEEL: &str = "steel";
pub(super) const RUBBER: &str = "rubber";
pub(super) const CONCRETE: &str = "concrete";
