//! What a sort of fibres is.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::fibre::{Elasticity, FibreError, Section};

/// Density of the wall [kg/m³] where no coarseness is given.
const WALL_DENSITY_KG_PER_M3: f64 = 1500.0;

/// Fibres of one sort: hollow tubes, curled to an arc.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pulp {
    #[schemars(length(min = 1, max = 100))]
    pub name: String,
    /// Of the mass of all fibres; those of all pulps sum to 1.
    #[serde(default = "whole")]
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1"))]
    pub mass_fraction: f64,
    /// Mean length along the fibre, by number. Left out where fibres are `measured`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.01, max = 100.0), extend("x-unit" = "mm"))]
    pub length_mm: Option<f64>,
    /// Standard deviation of lengths over their mean. A single fibre has the mean length.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 2.0), extend("x-unit" = "1"))]
    pub length_variation: f64,
    /// Fibres of a fibre analyser, from which those of a sheet are drawn, instead of a mean length.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measured: Option<MeasuredFibres>,
    /// Outer diameter W.
    #[schemars(range(min = 0.1, max = 1000.0), extend("x-unit" = "µm"))]
    pub width_um: f64,
    /// Thickness of the wall, at most half the width.
    #[schemars(range(min = 0.001, max = 500.0), extend("x-unit" = "µm"))]
    pub wall_um: f64,
    /// Mass over length. Left out: that of the wall at 1500 kg/m³.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-6, max = 1000.0), extend("x-unit" = "mg/m"))]
    pub coarseness_mg_per_m: Option<f64>,
    /// E along the fibre.
    #[schemars(range(min = 1e-3, max = 1000.0), extend("x-unit" = "GPa"))]
    pub youngs_modulus_gpa: f64,
    /// ν, contraction of the fibre's width over its strain.
    #[schemars(range(min = 0.01, max = 0.5), extend("x-unit" = "1"))]
    pub poisson_ratio: f64,
    /// G of the wall in torsion of the fibre; from a hundredth to two thirds of E.
    #[schemars(range(min = 1e-5, max = 700.0), extend("x-unit" = "GPa"))]
    pub shear_modulus_gpa: f64,
    /// Axial stress at which a fibre breaks. Left out: never.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-3, max = 1e6), extend("x-unit" = "MPa"))]
    pub strength_mpa: Option<f64>,
    /// Where the fibres of a sheet yield. Left out: they are elastic until they break. A single fibre is
    /// elastic in any case.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub yielding: Option<Yielding>,
    /// Distance of the ends over the length of the fibre, which is an arc; 1 is straight.
    #[serde(default = "whole")]
    #[schemars(range(min = 0.01, max = 1.0), extend("x-unit" = "1"))]
    pub shape_factor: f64,
}

/// Fibres one by one, each as likely as any other: number `i` of every list is one fibre. What is not
/// listed is that of the pulp.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeasuredFibres {
    /// Lengths along the fibres.
    #[schemars(
        length(min = 1, max = 1_000_000),
        inner(range(min = 0.01, max = 100.0)),
        extend("x-unit" = "mm")
    )]
    pub lengths_mm: Vec<f64>,
    /// Outer diameters. Left out: that of the pulp.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(
        length(min = 1, max = 1_000_000),
        inner(range(min = 0.1, max = 1000.0)),
        extend("x-unit" = "µm")
    )]
    pub widths_um: Option<Vec<f64>>,
    /// Thicknesses of the walls, at most half the widths. Left out: that of the pulp.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(
        length(min = 1, max = 1_000_000),
        inner(range(min = 0.001, max = 500.0)),
        extend("x-unit" = "µm")
    )]
    pub walls_um: Option<Vec<f64>>,
    /// Distances of the ends over the lengths. Left out: that of the pulp.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(
        length(min = 1, max = 1_000_000),
        inner(range(min = 0.01, max = 1.0)),
        extend("x-unit" = "1")
    )]
    pub shape_factors: Option<Vec<f64>>,
}

/// Stress over strain along a fibre in two straight lines: up to a stress with Young's modulus, beyond it
/// with less. Unloading is elastic, what is pushed yields as what is pulled, and hardens for both.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Yielding {
    /// Force along the fibre over the area of its wall at which it yields, below `strength_mpa`.
    #[schemars(range(min = 1e-3, max = 1e6), extend("x-unit" = "MPa"))]
    pub stress_mpa: f64,
    /// Slope of stress over strain beyond; from a thousandth to 0.99 of Young's modulus.
    #[schemars(range(min = 1e-6, max = 1000.0), extend("x-unit" = "GPa"))]
    pub hardening_modulus_gpa: f64,
}

fn whole() -> f64 {
    1.0
}

impl Pulp {
    /// The wall of a fibre.
    ///
    /// # Errors
    /// [`FibreError::OutOfRange`] when the wall is thicker than half the width.
    pub fn section(&self) -> Result<Section, FibreError> {
        Section::new(self.width_um, self.wall_um)
    }

    /// E, ν and G.
    ///
    /// # Errors
    /// [`FibreError::OutOfRange`].
    pub fn elasticity(&self) -> Result<Elasticity, FibreError> {
        Elasticity::new(
            self.youngs_modulus_gpa,
            self.poisson_ratio,
            self.shear_modulus_gpa,
        )
    }

    /// The coarseness that is given, or that of the wall [mg/m].
    pub fn coarseness_mg_per_m(&self, section: &Section) -> f64 {
        self.coarseness_mg_per_m
            .unwrap_or_else(|| section.coarseness_mg_per_m(WALL_DENSITY_KG_PER_M3))
    }

    /// The same of this pulp's wall [µg/µm]; none when there is no such wall.
    pub fn coarseness_ug_per_um(&self) -> Option<f64> {
        let section = self.section().ok()?;
        // 1 mg/m is 10⁻³ µg/µm
        Some(1e-3 * self.coarseness_mg_per_m(&section))
    }
}
