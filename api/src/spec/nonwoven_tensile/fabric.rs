//! The fabric: a lattice to generate, or a measured network given bond by bond.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The specimen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Fabric {
    /// Generated layers of a hexagonal lattice.
    Lattice(Lattice),
    /// An explicit network.
    Network(Network),
}

/// Hexagonal layers ([Zilka2022] table 2): even rows (the first is row 0) have `points_per_row`
/// points, odd rows one more, half a spacing outward; layers lie straight above each other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Lattice {
    /// n_x, points of the even rows.
    #[schemars(range(min = 1, max = 100_000))]
    pub points_per_row: u32,
    /// n_y, an odd number.
    #[schemars(range(min = 1, max = 100_001))]
    pub rows: u32,
    /// n_z.
    #[serde(default = "one_layer")]
    #[schemars(range(min = 1, max = 10_000))]
    pub layers: u32,
    /// Spacing along x, y, z. It sets the specimen's size: `points_per_row` times the first is its width,
    /// which strength per width and energy per area are related to, `rows` times the second about its
    /// gauge length. Choose it so that they are those of the sample that was measured; forces do not
    /// depend on it.
    #[schemars(inner(range(min = 1e-6, max = 1e6)), extend("x-unit" = "mm"))]
    pub spacing_mm: [f64; 3],
    /// I_r along x, y, z: free nodes move by (U(0, I_r) − I_r/2) times the spacing. The rest
    /// length is taken afterwards, so the fabric starts free of stress.
    #[serde(default)]
    #[schemars(inner(range(min = 0.0, max = 1.0)), extend("x-unit" = "1"))]
    pub irregularity: [f64; 3],
    #[serde(default)]
    pub jaws: Jaws,
    /// Thickness of the fabric, if known: moduli and strength are then also given in Pa.
    #[serde(default)]
    #[schemars(range(min = 1e-6, max = 1e6), extend("x-unit" = "mm"))]
    pub thickness_mm: Option<f64>,
    /// Mass per area of the fabric, if known: strength and stiffness are then also given per mass, as
    /// N m/g and N/tex.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-3, max = 1e6), extend("x-unit" = "g/m2"))]
    pub grammage_g_per_m2: Option<f64>,
}

/// How the fabric is held.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Jaws {
    /// The thesis' jaws: the diagonals beyond the end rows are cut in half, and all layers meet in
    /// 2 n_x points in the mid-plane, half a bond outside. These half bonds are part of the grip: they
    /// stretch like others but never break, so the fabric does not tear at its jaws.
    #[default]
    HalfBond,
    /// The end rows themselves are held.
    ClampedRows,
}

/// A network given node by node and bond by bond.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Network {
    /// Node positions x, y, z.
    #[schemars(
        length(min = 2, max = 10_000_000),
        inner(inner(range(min = -1e9, max = 1e9))),
        extend("x-unit" = "mm")
    )]
    pub nodes_mm: Vec<[f64; 3]>,
    /// What holds each node, in the order of `nodes_mm`.
    #[schemars(length(min = 2, max = 10_000_000))]
    pub jaws: Vec<Jaw>,
    #[schemars(length(min = 1, max = 40_000_000))]
    pub bonds: Vec<NetworkBond>,
    /// Width of the specimen for results per width; left out, the extent of the nodes along x.
    #[serde(default)]
    #[schemars(range(min = 1e-6, max = 1e9), extend("x-unit" = "mm"))]
    pub width_mm: Option<f64>,
    /// Thickness of the fabric, if known: moduli and strength are then also given in Pa.
    #[serde(default)]
    #[schemars(range(min = 1e-6, max = 1e6), extend("x-unit" = "mm"))]
    pub thickness_mm: Option<f64>,
    /// Mass per area of the fabric, if known: strength and stiffness are then also given per mass, as
    /// N m/g and N/tex.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-3, max = 1e6), extend("x-unit" = "g/m2"))]
    pub grammage_g_per_m2: Option<f64>,
}

/// What holds a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Jaw {
    /// Nothing: the node finds its equilibrium.
    Free,
    /// The jaw at rest.
    Bottom,
    /// The jaw that moves along +y.
    Top,
}

/// A bond of an explicit network.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NetworkBond {
    /// Indices into `nodes_mm`, counted from 0.
    pub nodes: [u32; 2],
    /// l₀; left out, the distance of the nodes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-9, max = 1e9), extend("x-unit" = "mm"))]
    pub rest_length_mm: Option<f64>,
    /// e; left out, the spec's `bond.modulus_n`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-12, max = 1e12), extend("x-unit" = "N"))]
    pub modulus_n: Option<f64>,
    /// f_r; left out, the spec's `bond.friction_modulus_n`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e12), extend("x-unit" = "N"))]
    pub friction_modulus_n: Option<f64>,
    /// r_c; left out, the spec's `bond.compression_stiffness_n`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e12), extend("x-unit" = "N"))]
    pub compression_stiffness_n: Option<f64>,
    /// Strength; left out, drawn from the spec's distribution.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e12), extend("x-unit" = "N"))]
    pub strength_n: Option<f64>,
}

fn one_layer() -> u32 {
    1
}
