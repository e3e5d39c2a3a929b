//! How finely the test is divided.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How exactly: a preset's name or its knobs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Accuracy {
    Preset(Preset),
    Knobs(Knobs),
}

/// Named choices of the number of steps: 20, 50 and 200.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Preset {
    Draft,
    Standard,
    Reference,
}

/// The knobs of accuracy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Knobs {
    /// Equal steps to the largest strain, each a point of the curve. Every step is brought to rest, so
    /// that they do not add up to an error of their own.
    #[schemars(range(min = 1, max = 10_000), extend("x-unit" = "1"))]
    pub load_steps: u32,
}

impl Default for Accuracy {
    fn default() -> Self {
        Self::Preset(Preset::Standard)
    }
}

impl Default for Knobs {
    fn default() -> Self {
        Self { load_steps: 50 }
    }
}

impl Accuracy {
    /// The knobs.
    pub fn knobs(&self) -> Knobs {
        let load_steps = match self {
            Self::Knobs(knobs) => return *knobs,
            Self::Preset(Preset::Draft) => 20,
            Self::Preset(Preset::Standard) => 50,
            Self::Preset(Preset::Reference) => 200,
        };
        Knobs { load_steps }
    }
}
