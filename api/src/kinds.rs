//! The one list of job kinds. A new kind is a line here, a file in `spec/`, an example in
//! `api/examples/` and an engine in `loadframe-physics`; the compiler and the tests ask for the rest.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use serde_json::Value;

use crate::calibration::{Calibration, Estimate};
use crate::digest::sha256_hex;
use crate::problem::Violation;
use crate::spec;
use crate::spec_trait::Spec;
use crate::study::{Knob, TurnError};

macro_rules! job_kinds {
    ($($kind:ident($name:literal): $spec:ty, $title:literal, $description:literal, [$($example:literal),+ $(,)?];)+) => {
        /// Kind of a job.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
        pub enum JobKind {
            $(#[doc = $title] #[serde(rename = $name)] $kind,)+
        }

        /// A checked spec of any kind.
        #[derive(Clone, Debug, PartialEq)]
        pub enum JobSpec {
            $(#[doc = $title] $kind(Box<$spec>),)+
        }

        impl JobKind {
            /// Every kind, in the order of the list.
            pub const ALL: &[Self] = &[$(Self::$kind),+];

            /// Name on the wire.
            pub fn name(self) -> &'static str {
                match self { $(Self::$kind => $name,)+ }
            }

            /// Title for people.
            pub fn title(self) -> &'static str {
                match self { $(Self::$kind => $title,)+ }
            }

            /// A sentence on what the test does.
            pub fn description(self) -> &'static str {
                match self { $(Self::$kind => $description,)+ }
            }

            /// Example jobs; the first is the one to start from, and has the kind's name.
            pub fn examples(self) -> &'static [Example] {
                match self {
                    $(Self::$kind => &[$(Example {
                        name: $example,
                        body: include_str!(concat!("../examples/", $example, ".json")),
                    }),+],)+
                }
            }

            /// Lets `visitor` work with the kind's spec type.
            pub(crate) fn visit<V: SpecVisitor>(self, visitor: V) -> V::Output {
                match self {
                    $(Self::$kind => visitor.visit::<$spec>(|spec| JobSpec::$kind(Box::new(spec))),)+
                }
            }
        }

        impl JobSpec {
            /// The kind of this spec.
            pub fn kind(&self) -> JobKind {
                match self { $(Self::$kind(_) => JobKind::$kind,)+ }
            }

            /// The spec as JSON, all defaults written out: the text behind `spec_sha256`.
            pub fn to_json(&self) -> String {
                match self { $(Self::$kind(spec) => json(&**spec),)+ }
            }

            /// What the job will take.
            pub fn estimate(&self, calibration: &Calibration) -> Estimate {
                match self { $(Self::$kind(spec) => spec.estimate(calibration),)+ }
            }

            /// Seed of the random streams.
            pub fn seed(&self) -> u64 {
                match self { $(Self::$kind(spec) => spec.seed(),)+ }
            }

            /// What an accuracy study may vary.
            pub fn knobs(&self) -> Vec<Knob> {
                match self { $(Self::$kind(spec) => spec.knobs(),)+ }
            }

            /// The spec of one test of this seed, which writes as little as it can.
            pub fn single(&self, seed: u64) -> Self {
                let mut own = self.clone();
                match &mut own { $(Self::$kind(spec) => spec.single(seed),)+ }
                own
            }

            /// The spec of the tests of one specimen of this seed, which writes as little as it can.
            pub fn realisation(&self, seed: u64) -> Self {
                let mut own = self.clone();
                match &mut own { $(Self::$kind(spec) => spec.realise(seed),)+ }
                own
            }

            /// Whether a result may be compared between the settings of a study.
            pub fn compares(&self, result: &str) -> bool {
                match self { $(Self::$kind(_) => <$spec as Spec>::compares(result),)+ }
            }

            /// The spec as a JSON value, all defaults written out.
            pub(crate) fn to_value(&self) -> Value {
                match self { $(Self::$kind(spec) => value(&**spec),)+ }
            }

            /// Reports what the kind's JSON Schema cannot say.
            pub(crate) fn cross_check(&self, violations: &mut Vec<Violation>) {
                match self { $(Self::$kind(spec) => spec.check(violations),)+ }
            }

            fn set(&mut self, knob: &str, value: &str) -> Option<()> {
                match self { $(Self::$kind(spec) => spec.turn(knob, value),)+ }
            }
        }
    };
}

job_kinds! {
    NonwovenTensile("nonwoven_tensile"): spec::nonwoven_tensile::NonwovenTensile,
        "Nonwoven tensile test",
        "A fabric of bonds is pulled until it parts; every strain step is brought to equilibrium.",
        ["nonwoven_tensile", "nonwoven_tensile_quick", "nonwoven_tensile_network",
            "nonwoven_tensile_repeats", "nonwoven_tensile_directions"];
    GranularScene("granular_scene"): spec::granular_scene::GranularScene,
        "Granular scene",
        "Spheres and clumps between planes and surfaces of triangles, in contact with friction, moved step by step through the stages you give.",
        ["granular_scene", "granular_scene_clump_drop", "granular_scene_breaking_clump",
            "granular_scene_hopper", "granular_scene_angle_of_repose"];
    BallastOedometer("ballast_oedometer"): spec::ballast::BallastOedometer,
        "Ballast oedometer",
        "Ballast is poured into a cylinder, compacted, and pressed by a plate: stiffness, void ratio, modulus.",
        ["ballast_oedometer"];
    BallastBox("ballast_box"): spec::ballast::BallastBox,
        "Ballast box test",
        "A sleeper on ballast in a box is loaded again and again: settlement by cycle.",
        ["ballast_box"];
    BallastRailbed("ballast_railbed"): spec::ballast::BallastRailbed,
        "Rail bed",
        "Half a cross-section of a track with its sleeper, shoulder and soft ground under the load of a wheel.",
        ["ballast_railbed", "ballast_railbed_cycles", "ballast_railbed_breakable"];
    CompositeBending("composite_bending"): spec::composite_bending::CompositeBending,
        "Composite bending",
        "A section of fibres or plies in a matrix is held and loaded, bent on rollers, pulled or sheared: deflections, moduli, stresses.",
        ["composite_bending", "composite_bending_three_point", "composite_bending_paper",
            "composite_bending_break"];
    CompositeCell("composite_cell"): spec::composite_cell::CompositeCell,
        "Composite cell",
        "Fibres in a matrix, seen along them: the elastic constants of the composite, beside the bounds that theory sets.",
        ["composite_cell", "composite_cell_hexagonal"];
    PaperTensile("paper_tensile"): spec::paper_tensile::PaperTensile,
        "Paper tensile test",
        "A sheet of pulp fibres that are bonded where they touch is pulled until it breaks; or one fibre, a hollow tube of springs, is pulled, twisted, bent or pushed until it buckles.",
        ["paper_tensile", "paper_tensile_buckling", "paper_tensile_sheet",
            "paper_tensile_directions", "paper_tensile_lap", "paper_tensile_zero_span",
            "paper_tensile_measured"];
    Calibrate("calibrate"): spec::calibrate::Calibrate,
        "Calibration",
        "Parameters of any other job are fitted to what was measured, with intervals, over the same specimens at every trial.",
        ["calibrate", "calibrate_pet", "calibrate_ballast", "calibrate_paper"];
}

/// An example job of a kind.
#[derive(Clone, Copy, Debug)]
pub struct Example {
    /// File name without `.json`.
    pub name: &'static str,
    /// The POST body.
    pub body: &'static str,
}

/// Work that is the same for every kind, given the spec's type.
pub(crate) trait SpecVisitor {
    type Output;
    fn visit<T: Spec>(self, wrap: fn(T) -> JobSpec) -> Self::Output;
}

fn value<T: Spec>(spec: &T) -> Value {
    // as below
    serde_json::to_value(spec).unwrap_or_default()
}

fn json<T: Spec>(spec: &T) -> String {
    // a spec is plain structs and numbers: writing it to memory has no way to fail
    serde_json::to_string(spec).unwrap_or_default()
}

impl JobSpec {
    /// SHA-256 of the normalised spec.
    pub fn sha256(&self) -> String {
        sha256_hex(self.to_json().as_bytes())
    }

    /// Sets a knob of a study. Whether the value is in range, [`Self::check`] tells.
    ///
    /// # Errors
    /// [`TurnError`] when there is no such knob, or it takes no such value.
    pub fn turn(&mut self, knob: &str, value: &str) -> Result<(), TurnError> {
        let knobs = self.knobs();
        let known = knobs.iter().find(|known| known.name == knob);
        let known = known.ok_or_else(|| TurnError::NoSuchKnob {
            knob: knob.to_owned(),
            known: knobs
                .iter()
                .map(|knob| knob.name)
                .collect::<Vec<_>>()
                .join(", "),
        })?;
        self.set(knob, value).ok_or_else(|| TurnError::NoSuchValue {
            knob: known.name,
            value: value.to_owned(),
            description: known.description,
        })
    }
}

impl std::fmt::Display for JobKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

impl std::str::FromStr for JobKind {
    type Err = UnknownKind;

    fn from_str(name: &str) -> Result<Self, UnknownKind> {
        let found = Self::ALL.iter().find(|kind| kind.name() == name);
        found.copied().ok_or_else(|| UnknownKind {
            name: name.chars().take(100).collect(),
        })
    }
}

/// There is no kind of this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no job kind named {name:?}; there are: {}", all_names())]
pub struct UnknownKind {
    pub name: String,
}

fn all_names() -> String {
    JobKind::ALL
        .iter()
        .map(|kind| kind.name())
        .collect::<Vec<_>>()
        .join(", ")
}
