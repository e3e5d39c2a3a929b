//! What is done to the specimen.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Where the force of a sheet has fallen this far, the rest of the curve tells of its tatters.
const STOP_FORCE_FRACTION: f64 = 0.3;

/// The course of a test. What a single fibre does not use may be given, and a warning says so.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Test {
    /// What sort of test, a tensile one if left out. A single fibre has its `load` instead.
    #[serde(rename = "type", skip_serializing_if = "Option::is_none")]
    pub sort: Option<TestType>,
    /// Strain at which the test ends.
    #[schemars(range(min = 1e-6, max = 1.0), extend("x-unit" = "1"))]
    pub max_strain: f64,
    /// Direction of the pull, that of the machine if left out. A single fibre is pulled along itself, a
    /// sheet that is given along x.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub direction: Option<Direction>,
    /// Part of the maximum force at which a test ends, 0.3 if left out. A single fibre does not break.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1"))]
    pub stop_force_fraction: Option<f64>,
    /// Specimens, 1 if left out: sheets made with the seeds `seed`, `seed` + 1, ...; results become means
    /// with standard deviation and 95 % interval, curve and pictures are those of the first. There is one
    /// single fibre.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 1000), extend("x-unit" = "1"))]
    pub repeats: Option<u32>,
    /// Of a sheet: masses in motion under a jaw of constant speed. Left out, every break is followed by rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dynamics: Option<Dynamics>,
}

/// A pull at a constant speed, step by step of time: nodes have masses, and what breaks shakes the rest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Dynamics {
    /// Speed of the jaw over the distance of the jaws. Real tests, some 0.003 a second, would take 10⁹ steps; where
    /// kinetic energy is below a hundredth of the elastic one (`kinetic_share`) a faster one finds the same.
    #[schemars(range(min = 1e-3, max = 1e6), extend("x-unit" = "1/s"))]
    pub strain_rate_per_s: f64,
    /// Drag on what moves otherwise than a sheet that is stretched evenly, over the critical one of the slowest
    /// vibration along the pull. It acts from outside: while masses move to where a break lets them, the jaws differ by it.
    #[serde(default = "damping")]
    #[schemars(range(min = 0.0, max = 10.0), extend("x-unit" = "1"))]
    pub damping: f64,
    /// Mass that may be added where nodes are lightest for their springs, over all mass, so that steps are longer.
    #[serde(default = "added_mass")]
    #[schemars(range(min = 0.0, max = 100.0), extend("x-unit" = "1"))]
    pub added_mass: f64,
    /// Points of the curve up to `max_strain`; its forces are means in between.
    #[serde(default = "points")]
    #[schemars(range(min = 10, max = 100_000), extend("x-unit" = "1"))]
    pub points: u32,
}

fn damping() -> f64 {
    0.1
}

fn added_mass() -> f64 {
    0.1
}

fn points() -> u32 {
    500
}

/// What the jaws of a test hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TestType {
    /// The ends of the sheet (ISO 1924-2).
    Tensile,
    /// The fibres themselves, in the middle of a sheet that is made: jaws that close to the width of the
    /// widest fibre, so that fibres break and bonds do not count (ISO 15361).
    ZeroSpan,
}

/// Direction of the pull in a sheet that a machine made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// Along the machine direction.
    Md,
    /// Across it.
    Cd,
    /// Sheets of each seed along and across, and the ratios of their results; those across end in
    /// `_along_cd`.
    Both,
}

impl Direction {
    /// Name on the wire.
    pub fn name(self) -> &'static str {
        match self {
            Self::Md => "md",
            Self::Cd => "cd",
            Self::Both => "both",
        }
    }

    /// Those in which a specimen is pulled, one after the other.
    pub fn each(self) -> &'static [Self] {
        match self {
            Self::Md => &[Self::Md],
            Self::Cd => &[Self::Cd],
            Self::Both => &[Self::Md, Self::Cd],
        }
    }
}

impl Default for Test {
    fn default() -> Self {
        Self {
            sort: None,
            max_strain: 0.05,
            direction: None,
            stop_force_fraction: None,
            repeats: None,
            dynamics: None,
        }
    }
}

impl Test {
    /// Whether the jaws hold the fibres themselves.
    pub fn is_zero_span(&self) -> bool {
        self.sort == Some(TestType::ZeroSpan)
    }

    /// Direction in which a sheet is pulled.
    pub fn pulled(&self) -> Direction {
        self.direction.unwrap_or(Direction::Md)
    }

    /// Part of the maximum force at which the test of a sheet ends.
    pub fn stop_fraction(&self) -> f64 {
        self.stop_force_fraction.unwrap_or(STOP_FORCE_FRACTION)
    }

    /// Names of the fields that were given and that a single fibre does not use.
    pub fn unused_by_a_fibre(&self) -> Vec<&'static str> {
        let given = [
            (self.sort.is_some(), "test.type"),
            (self.direction.is_some(), "test.direction"),
            (
                self.stop_force_fraction.is_some(),
                "test.stop_force_fraction",
            ),
            (self.repeats.is_some(), "test.repeats"),
            (self.dynamics.is_some(), "test.dynamics"),
        ];
        given
            .into_iter()
            .filter_map(|(is_given, name)| is_given.then_some(name))
            .collect()
    }
}
