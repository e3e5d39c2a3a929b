//! Cement between spheres: bonds that bend and twist.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::GranularScene;

/// A bond like a round beam of cement beside the contact: it carries tension, shear, bending and torsion,
/// and breaks at once when the stress of its outermost fibre is its strength
/// ([PotyondyCundall2004]). With the radius R̄, the length L between the centres when it was made,
/// A = πR̄², I = πR̄⁴/4 and J = πR̄⁴/2 its stiffnesses are EA/L, κEA/L, EI/L and κEJ/L, and its stresses
/// σ = −F_N/A + M R̄/I and τ = F_T/A + M_t R̄/J. Spheres that touch at the start are bonded where both
/// materials have such bonds, with the smaller of each value; a breakable body's within it alone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ParallelBond {
    /// R̄ over the smaller of both radii.
    #[serde(default = "whole")]
    #[schemars(range(min = 1e-3, max = 10.0), extend("x-unit" = "1"))]
    pub radius_ratio: f64,
    /// E of the cement.
    #[schemars(range(min = 1e-3, max = 1e15), extend("x-unit" = "Pa"))]
    pub youngs_modulus_pa: f64,
    /// κ, shear over normal stiffness: 0.4 is the 1/2.5 of the source.
    #[serde(default = "stiffness_ratio")]
    #[schemars(range(min = 1e-6, max = 10.0), extend("x-unit" = "1"))]
    pub stiffness_ratio: f64,
    /// σ at which it breaks.
    #[schemars(range(min = 1e-9, max = 1e15), extend("x-unit" = "Pa"))]
    pub tensile_strength_pa: f64,
    /// τ at which it breaks.
    #[schemars(range(min = 1e-9, max = 1e15), extend("x-unit" = "Pa"))]
    pub shear_strength_pa: f64,
}

impl ParallelBond {
    /// That between two materials.
    #[must_use]
    pub fn with(&self, other: &Self) -> Self {
        Self {
            radius_ratio: self.radius_ratio.min(other.radius_ratio),
            youngs_modulus_pa: self.youngs_modulus_pa.min(other.youngs_modulus_pa),
            stiffness_ratio: self.stiffness_ratio.min(other.stiffness_ratio),
            tensile_strength_pa: self.tensile_strength_pa.min(other.tensile_strength_pa),
            shear_strength_pa: self.shear_strength_pa.min(other.shear_strength_pa),
        }
    }

    /// EA/L, κEA/L [N/m], EI/L and κEJ/L [N m] between spheres the smaller of which has this radius,
    /// with this length [m].
    pub fn stiffnesses(&self, radius: f64, length: f64) -> [f64; 4] {
        let square = (self.radius_ratio * radius).powi(2);
        let axial = self.youngs_modulus_pa * std::f64::consts::PI * square / length;
        let shear = self.stiffness_ratio * axial;
        [axial, shear, 0.25 * axial * square, 0.5 * shear * square]
    }
}

impl GranularScene {
    /// Whether bonds bend and twist.
    pub fn has_parallel_bonds(&self) -> bool {
        let mut materials = self.materials.values();
        materials.any(|material| material.parallel_bond.is_some())
    }

    /// Whether contacts have moments beside those of their forces.
    pub fn has_moments(&self) -> bool {
        self.resists_rolling() || self.has_parallel_bonds()
    }
}

fn whole() -> f64 {
    1.0
}

fn stiffness_ratio() -> f64 {
    0.4
}
