//! What is written.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What is written beside curve and tables.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Rows of the curve in each cycle, about.
    #[schemars(range(min = 10, max = 100_000))]
    pub rows_per_cycle: u32,
    /// Snapshots for ParaView in each cycle, about; before the first there are some of the
    /// preparation, as far apart. 0 writes none.
    #[schemars(range(max = 100_000))]
    pub snapshots: u32,
    /// Slices across z in which porosity is measured.
    #[schemars(range(min = 1, max = 100))]
    pub slices: u32,
    /// Given, porosity is mapped below the sleeper in cells about as wide, before the cycles and after
    /// them: `void_map.csv`. Cells smaller than grains tell where these are.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-4, max = 100.0), extend("x-unit" = "m"))]
    pub void_cell_m: Option<f64>,
}

impl Default for Output {
    fn default() -> Self {
        Self {
            rows_per_cycle: 200,
            snapshots: 0,
            slices: 5,
            void_cell_m: None,
        }
    }
}
