//! How fibres hold one another where they touch.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A bond by the area in which two fibres touch.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bond {
    /// Force across the area at which a bond breaks, over the area. Left out: none breaks it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "MPa"))]
    pub normal_strength_mpa: Option<f64>,
    /// Force along the area at which a bond breaks, over the area. Left out: none breaks it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "MPa"))]
    pub shear_strength_mpa: Option<f64>,
    /// Stiffness over the area, the same in all directions. Left out: that of the two half fibres
    /// between the centre lines, of a tenth of Young's modulus and as thick as flattened walls; a warning
    /// tells it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-9, max = 1e9), extend("x-unit" = "N/m/µm2"))]
    pub stiffness_n_per_m_per_um2: Option<f64>,
    /// Standard deviation of the strengths of bonds over their mean; a bond draws one factor for both
    /// strengths, log-normally. Strengths that a bond is given of its own are not drawn.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 2.0), extend("x-unit" = "1"))]
    pub strength_variation: f64,
}
