//! Taking bodies apart that sit in each other.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Lets bodies that overlap push each other apart without gaining speed: after every step all of
/// them stand still again, so that no contact moves a body by more than a part of its overlap. Ends
/// when no overlap is larger than asked for, or after `steps`. As the first stage it allows overlaps at
/// the start that are otherwise refused.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Relax {
    /// Over the smaller radius.
    #[serde(default = "small")]
    #[schemars(range(min = 1e-9, max = 1.0), extend("x-unit" = "1"))]
    pub largest_overlap_ratio: f64,
    #[schemars(range(min = 1, max = 1_000_000_000_000_u64))]
    pub steps: u64,
}

/// Stiff grains under their own weight overlap less.
fn small() -> f64 {
    0.01
}
