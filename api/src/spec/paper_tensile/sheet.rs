//! Sheets of fibres: given fibre by fibre, or made from pulps.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A sheet given fibre by fibre and bond by bond, as a scan finds it. It is pulled along x; points at
/// x ≤ 0 and x ≥ `length_mm` are held by the jaws.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ExplicitSheet {
    /// Distance of the jaws along x.
    #[schemars(range(min = 1e-6, max = 1e6), extend("x-unit" = "mm"))]
    pub length_mm: f64,
    /// Width of the strip, for results per width and per mass.
    #[schemars(range(min = 1e-6, max = 1e6), extend("x-unit" = "mm"))]
    pub width_mm: f64,
    #[schemars(length(min = 1, max = 1_000_000))]
    pub fibres: Vec<ExplicitFibre>,
    #[serde(default)]
    #[schemars(length(max = 10_000_000))]
    pub bonds: Vec<ExplicitBond>,
}

/// A fibre of a sheet that is given; unstrained as it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ExplicitFibre {
    /// Name of its pulp, which gives section and moduli; lengths of the pulp do not count.
    pub pulp: String,
    /// Points x, y, z along its middle.
    #[schemars(
        length(min = 2, max = 1_000_000),
        inner(inner(range(min = -1e9, max = 1e9))),
        extend("x-unit" = "µm")
    )]
    pub centre_line_um: Vec<[f64; 3]>,
}

/// A bond of a sheet that is given; unstrained as it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ExplicitBond {
    /// Places in `fibres`, counted from 0.
    pub fibres: [u32; 2],
    /// Arc length from each fibre's first point.
    #[schemars(inner(range(min = 0.0, max = 1e9)), extend("x-unit" = "µm"))]
    pub at_um: [f64; 2],
    /// Area in which the fibres hold one another.
    #[schemars(range(min = 1e-6, max = 1e9), extend("x-unit" = "µm2"))]
    pub area_um2: f64,
    /// Force across the area that breaks it. Left out: that of `bond` for its area.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "N"))]
    pub normal_strength_n: Option<f64>,
    /// Force along the area that breaks it. Left out: that of `bond` for its area.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "N"))]
    pub shear_strength_n: Option<f64>,
}

/// A sheet made of the pulps: fibres are laid one after the other until it has its mass, and cut at
/// its edges.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MadeSheet {
    /// Distance of the jaws, along the pull.
    #[schemars(range(min = 1e-3, max = 1e4), extend("x-unit" = "mm"))]
    pub length_mm: f64,
    /// Width of the strip, across the pull.
    #[schemars(range(min = 1e-3, max = 1e4), extend("x-unit" = "mm"))]
    pub width_mm: f64,
    /// Mass per area, which the sheet has exactly.
    #[schemars(range(min = 1e-3, max = 1e4), extend("x-unit" = "g/m2"))]
    pub grammage_g_per_m2: f64,
    /// Thickness by which Young's modulus is told, such as a measured one. Left out: the mean thickness
    /// of the sheet that was made.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-3, max = 1e6), extend("x-unit" = "µm"))]
    pub thickness_um: Option<f64>,
    #[serde(default)]
    pub placement: Placement,
    #[serde(default)]
    pub orientation: Orientation,
}

/// Where fibres lie across the sheet.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Placement {
    /// One after the other onto what lies below; thickness and density are results.
    Deposition(Deposition),
    /// Flat, at any height within a thickness, through one another.
    Random(RandomPlacement),
}

/// How fibres are laid onto others.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Deposition {
    /// Steepest slope a fibre takes to reach what lies below; more makes denser sheets with more
    /// contacts.
    #[schemars(range(min = 0.0, max = 10.0), extend("x-unit" = "1"))]
    pub flexibility: f64,
}

/// Where fibres lie at random.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RandomPlacement {
    /// Thickness within which every fibre lies.
    #[schemars(range(min = 1e-3, max = 1e6), extend("x-unit" = "µm"))]
    pub thickness_um: f64,
}

/// Which way fibres point in the plane.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Orientation {
    /// All ways alike.
    #[default]
    Uniform,
    /// Mostly along the machine direction.
    VonMises(VonMises),
    /// As measured.
    Histogram(AngleHistogram),
}

/// A measured distribution of the angle to the machine direction, by length of fibre.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AngleHistogram {
    /// Densities in equally wide bins from 0 to 180 degrees, counted from the machine direction towards
    /// y; only their ratios count, and within a bin all angles are alike.
    #[schemars(
        length(min = 1, max = 10_000),
        inner(range(min = 0.0, max = 1e9)),
        extend("x-unit" = "1")
    )]
    pub densities: Vec<f64>,
}

/// Density ∝ exp(κ cos 2θ) of the angle θ to the machine direction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VonMises {
    /// κ; 0 is uniform.
    #[schemars(range(min = 0.0, max = 1000.0), extend("x-unit" = "1"))]
    pub concentration: f64,
}

impl Default for Placement {
    fn default() -> Self {
        Self::Deposition(Deposition::default())
    }
}

impl Default for Deposition {
    fn default() -> Self {
        Self { flexibility: 0.2 }
    }
}
