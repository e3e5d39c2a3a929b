//! Elastic materials.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use uuid::Uuid;

use crate::section::material as elastic;
use crate::section::strength;

/// A linear elastic material: isotropic or orthotropic.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Material {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub isotropic: Option<Isotropic>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub orthotropic: Option<Orthotropic>,
    /// Needed where motion in time is asked for; what is at rest does not depend on it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-3, max = 1e6), extend("x-unit" = "kg/m3"))]
    pub density_kg_per_m3: Option<f64>,
    /// What it bears, where the test lets things break; left out, it does not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub strength: Option<Strength>,
    /// What the faces of fibres of this material bear; left out, they hold.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interface: Option<Interface>,
    /// A finished `composite_cell` job whose constants these are. Alone, without constants, a server
    /// fills them in when it takes the job.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_job: Option<Uuid>,
}

/// Where a crack begins, and what it takes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Limit {
    #[schemars(range(min = 1e-9, max = 1e12), extend("x-unit" = "MPa"))]
    pub strength_mpa: f64,
    /// Energy per area of crack (N/mm = kJ/m²). Left out: what breaks is gone at once, and the energy
    /// of a crack is what its cells held, which falls with their size; the result says so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-12, max = 1e12), extend("x-unit" = "N/mm"))]
    pub fracture_energy_n_per_mm: Option<f64>,
}

/// What a material bears. A direction that is left out does not break.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Strength {
    /// Of an isotropic material against its largest principal stress; of an orthotropic one along axis 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tension: Option<Limit>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub compression: Option<Limit>,
    /// Across axis 1 of an orthotropic material.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub across_tension: Option<Limit>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub across_compression: Option<Limit>,
    /// In shear along axis 1 of an orthotropic material.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shear: Option<Limit>,
}

/// What the face of a fibre, or that between two plies, bears: tension across it and shear along it count together, each over its
/// strength, as the root of the sum of their squares.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Interface {
    pub normal: Limit,
    pub shear: Limit,
}

/// The same in all directions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Isotropic {
    /// E.
    #[schemars(range(min = 1e-9, max = 1e12), extend("x-unit" = "MPa"))]
    pub youngs_modulus_mpa: f64,
    /// ν, above -1 and below 0.5.
    #[schemars(range(min = -0.999, max = 0.5), extend("x-unit" = "1"))]
    pub poisson_ratio: f64,
}

/// Three planes of symmetry: axis 1 lies along the fibres, 2 in the section's plane across them, 3
/// out of it. ν_ij is minus the strain along j over that along i when pulled along i.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Orthotropic {
    /// E₁.
    #[schemars(range(min = 1e-9, max = 1e12), extend("x-unit" = "MPa"))]
    pub modulus_1_mpa: f64,
    /// E₂.
    #[schemars(range(min = 1e-9, max = 1e12), extend("x-unit" = "MPa"))]
    pub modulus_2_mpa: f64,
    /// ν₁₂.
    #[schemars(range(min = -10.0, max = 10.0), extend("x-unit" = "1"))]
    pub poisson_ratio_12: f64,
    /// G₁₂; `null` takes Huber's estimate √(E₁E₂)/(2(1 + √(ν₁₂ν₂₁))), and the result says so.
    #[serde(default)]
    #[schemars(range(min = 1e-9, max = 1e12), extend("x-unit" = "MPa"))]
    pub shear_modulus_12_mpa: Option<f64>,
    /// E₃; left out, it is E₂. This and what follows count only in plane strain and where a ply is
    /// turned out of the plane; what is taken for them is told with the result.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-9, max = 1e12), extend("x-unit" = "MPa"))]
    pub modulus_3_mpa: Option<f64>,
    /// ν₁₃; left out, it is ν₁₂.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -10.0, max = 10.0), extend("x-unit" = "1"))]
    pub poisson_ratio_13: Option<f64>,
    /// ν₂₃; left out, it is ν₁₂.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -10.0, max = 10.0), extend("x-unit" = "1"))]
    pub poisson_ratio_23: Option<f64>,
    /// G₁₃; left out, it is G₁₂.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-9, max = 1e12), extend("x-unit" = "MPa"))]
    pub shear_modulus_13_mpa: Option<f64>,
    /// G₂₃; left out, it is E₂/(2(1 + ν₂₃)).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-9, max = 1e12), extend("x-unit" = "MPa"))]
    pub shear_modulus_23_mpa: Option<f64>,
}

impl Material {
    /// The elastic constants; `None` unless exactly one set of them is given.
    pub fn elastic(&self) -> Option<elastic::Material> {
        match (self.isotropic, self.orthotropic) {
            (Some(constants), None) => Some(elastic::Material::Isotropic {
                youngs_modulus_mpa: constants.youngs_modulus_mpa,
                poisson_ratio: constants.poisson_ratio,
            }),
            (None, Some(constants)) => Some(elastic::Material::Orthotropic(elastic::Orthotropic {
                modulus_1_mpa: constants.modulus_1_mpa,
                modulus_2_mpa: constants.modulus_2_mpa,
                poisson_ratio_12: constants.poisson_ratio_12,
                shear_modulus_12_mpa: constants.shear_modulus_12_mpa,
                modulus_3_mpa: constants.modulus_3_mpa,
                poisson_ratio_13: constants.poisson_ratio_13,
                poisson_ratio_23: constants.poisson_ratio_23,
                shear_modulus_13_mpa: constants.shear_modulus_13_mpa,
                shear_modulus_23_mpa: constants.shear_modulus_23_mpa,
            })),
            _ => None,
        }
    }
}

impl From<Limit> for strength::Limit {
    fn from(limit: Limit) -> Self {
        Self {
            limit: limit.strength_mpa,
            fracture_energy_n_per_mm: limit.fracture_energy_n_per_mm,
        }
    }
}

impl From<Strength> for strength::Strength {
    fn from(strength: Strength) -> Self {
        Self {
            tension: strength.tension.map(Into::into),
            compression: strength.compression.map(Into::into),
            across_tension: strength.across_tension.map(Into::into),
            across_compression: strength.across_compression.map(Into::into),
            shear: strength.shear.map(Into::into),
        }
    }
}

impl From<Interface> for strength::InterfaceStrength {
    fn from(interface: Interface) -> Self {
        Self {
            normal: interface.normal.into(),
            shear: interface.shear.into(),
        }
    }
}
