//! What is given up for speed.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A preset's name or its knobs. `loadframe study accuracy` measures what each knob costs and how far
/// off it is on your own spec.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Accuracy {
    Preset(Preset),
    Knobs(Knobs),
}

/// Named choices of the knobs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Preset {
    Draft,
    Standard,
    Reference,
}

/// The knobs of accuracy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Knobs {
    /// Time step over the critical one.
    #[schemars(range(min = 1e-6, max = 0.9), extend("x-unit" = "1"))]
    pub critical_step_fraction: f64,
    /// Moduli of all materials during the test, over those that are given.
    #[schemars(range(min = 1e-9, max = 1.0), extend("x-unit" = "1"))]
    pub stiffness: f64,
    /// The aggregate's modulus while the bed is prepared, if that of the test is higher; walls are
    /// softened with it. All grow to those of the test before it is loaded.
    #[schemars(range(min = 1e3, max = 1e15), extend("x-unit" = "Pa"))]
    pub preparation_modulus_pa: f64,
    /// I that sets the period of a cycle where none is given.
    #[schemars(range(min = 1e-6, max = 1.0), extend("x-unit" = "1"))]
    pub inertial_number: f64,
}

impl Default for Accuracy {
    fn default() -> Self {
        Self::Preset(Preset::Standard)
    }
}

impl Default for Knobs {
    fn default() -> Self {
        Accuracy::default().knobs()
    }
}

impl Accuracy {
    /// The knobs a preset stands for.
    pub fn knobs(&self) -> Knobs {
        match self {
            Self::Knobs(knobs) => knobs.clone(),
            Self::Preset(Preset::Draft) => Knobs {
                critical_step_fraction: 0.4,
                stiffness: 1.0,
                preparation_modulus_pa: 1e8,
                inertial_number: 2e-3,
            },
            Self::Preset(Preset::Standard) => Knobs {
                critical_step_fraction: 0.4,
                stiffness: 1.0,
                preparation_modulus_pa: 1e9,
                inertial_number: 5e-4,
            },
            Self::Preset(Preset::Reference) => Knobs {
                critical_step_fraction: 0.2,
                stiffness: 1.0,
                preparation_modulus_pa: 1e15,
                inertial_number: 1e-4,
            },
        }
    }
}
