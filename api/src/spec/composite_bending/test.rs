//! What is done to the section.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Supports with a load or with moved faces, perhaps in time; or one of the tests of a laboratory.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Test {
    /// What holds the faces. A face that is not named is free.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub supports: Option<Supports>,
    /// The load; needs `supports`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub load: Option<Load>,
    /// Motion in time under the load, by the solver `verlet`; without it, what is at rest is looked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub history: Option<History>,
    /// Three-point flexure on rollers, evaluated as ISO 14125 method A words it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub three_point: Option<Flexure>,
    /// Four-point flexure, the loading rollers at the thirds of the span: ISO 14125 method B.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub four_point: Option<Flexure>,
    /// Short-beam shear: three-point flexure with a short span, evaluated as ISO 14130 words it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub short_beam: Option<Flexure>,
    /// A double cantilever: the arms of a split laminate are pulled apart at their left ends, evaluated
    /// as ASTM D5528 and ISO 15024 word it. Needs `breaking` and one of `delaminations` that begins at the
    /// left end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub double_cantilever: Option<DoubleCantilever>,
    /// A pull along x, for the effective Young's modulus and Poisson ratio.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tension: Option<Tension>,
    /// Simple shear of the section's edges, for the effective shear modulus.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shear: Option<Shear>,
    /// Lets materials and interfaces break where their strengths are reached, as the load or the
    /// way of what is driven grows from nothing, beyond what is given until the test ends. Left out,
    /// everything holds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub breaking: Option<Breaking>,
}

/// How things break: crack by crack, each where and when its strength is reached.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Breaking {
    pub criterion: Criterion,
    /// What the machine keeps from falling back while something breaks.
    pub control: Control,
    /// Scatter of strengths from cell to cell. Left out, all have those of their materials.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scatter: Option<Scatter>,
    /// Steps in which a crack of a material with a fracture energy opens.
    #[schemars(range(min = 2, max = 100), extend("x-unit" = "1"))]
    pub teeth: u32,
    /// The test ends when the force has fallen below this part of its peak.
    #[schemars(range(min = 0.0, max = 0.99), extend("x-unit" = "1"))]
    pub stop_force_fraction: f64,
    /// The test ends when what is driven has gone this far.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-12, max = 1e6), extend("x-unit" = "mm"))]
    pub max_displacement_mm: Option<f64>,
    /// The test ends after so many events.
    #[schemars(range(min = 1, max = 10_000_000), extend("x-unit" = "1"))]
    pub max_events: u64,
}

/// What is compared with a strength.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Criterion {
    /// Stresses.
    #[default]
    Stress,
    /// Strains, with the strength over the modulus of its direction.
    Strain,
}

/// How the machine drives the test.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Control {
    /// The way grows: a break that would take it back lets the force fall at the same way.
    #[default]
    Displacement,
    /// The force grows: at its peak all breaks at once.
    Force,
    /// Neither: the curve follows every equilibrium, back where the section snaps back.
    Path,
}

/// Weibull's distribution of strengths.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scatter {
    /// Shape: some 5 scatters a fifth of the strength, some 25 a twentieth.
    #[schemars(range(min = 1.0, max = 1000.0), extend("x-unit" = "1"))]
    pub weibull_modulus: f64,
    /// Volume in which strengths have the mean given; smaller cells are stronger on average, by the
    /// weakest link. Left out: every cell has it, whatever its size, and finer grids are weaker.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-15, max = 1e15), extend("x-unit" = "mm3"))]
    pub reference_volume_mm3: Option<f64>,
}

/// What holds each face.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Supports {
    pub left: Support,
    pub right: Support,
    pub bottom: Support,
    pub top: Support,
}

/// What holds a face: a word, a word for each axis, or displacements.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Support {
    Word(SupportWord),
    PerAxis([Axis; 2]),
    Driven(Driven),
}

impl Support {
    /// Whether the face is held along both axes.
    pub(super) fn holds_both_axes(&self) -> bool {
        match self {
            Self::Word(word) => *word == SupportWord::Clamped,
            Self::PerAxis(axes) => axes.iter().all(|axis| *axis == Axis::Clamped),
            Self::Driven(driven) => driven.displacement_mm.iter().all(Option::is_some),
        }
    }
}

/// What holds a face along both axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SupportWord {
    /// It cannot move.
    Clamped,
    Free,
    /// No displacement across the face; along it the face slides.
    Rolling,
}

/// What holds a face along one axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    Clamped,
    Free,
}

/// A face that is moved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Driven {
    /// Along x and along y at full load; `null` leaves the axis free.
    #[schemars(inner(range(min = -1e6, max = 1e6)), extend("x-unit" = "mm"))]
    pub displacement_mm: [Option<f64>; 2],
}

/// A total force and where it acts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Load {
    /// Along x and along y.
    #[schemars(inner(range(min = -1e12, max = 1e12)), extend("x-unit" = "N"))]
    pub force_n: [f64; 2],
    pub on: LoadPlace,
}

/// Where a load acts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LoadPlace {
    /// Evenly along a face.
    Face(Face),
    /// Evenly along a part of a face.
    Patch(Patch),
    /// At a point. The displacement there grows without bound as cells get smaller.
    PointMm(#[schemars(inner(range(min = 0.0, max = 1e6)), extend("x-unit" = "mm"))] [f64; 2]),
    /// Evenly over the whole section.
    Body,
}

/// A side of the section.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Face {
    Left,
    Right,
    Bottom,
    Top,
}

/// A part of a face, measured along x or y from the origin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Patch {
    pub face: Face,
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "mm"))]
    pub from_mm: f64,
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "mm"))]
    pub to_mm: f64,
}

/// Motion in time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct History {
    #[schemars(range(min = 1e-12, max = 1e6), extend("x-unit" = "s"))]
    pub duration_s: f64,
    #[serde(default)]
    pub load: HistoryLoad,
    /// Speed of all particles that are not held, at the start: an impact on the supports.
    #[serde(default)]
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "mm/s"))]
    pub velocity_mm_per_s: [f64; 2],
    /// Points of the curve.
    #[serde(default = "curve_points")]
    #[schemars(range(min = 2, max = 100_000))]
    pub points: u32,
}

/// How the load acts in time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum HistoryLoad {
    /// All at once at the start, on the section at rest, and from then on.
    #[default]
    Sudden,
    /// The section rests under it at the start, when it is taken away.
    Released,
}

/// A bent specimen on rollers. Its span lies in the middle of the section; its width is the section's
/// thickness.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Flexure {
    /// Between the middles of the supports.
    #[schemars(range(min = 1e-6, max = 1e6), extend("x-unit" = "mm"))]
    pub span_mm: f64,
    /// Radius of the loading rollers.
    #[serde(default = "roller")]
    #[schemars(range(min = 1e-6, max = 1e6), extend("x-unit" = "mm"))]
    pub loading_radius_mm: f64,
    /// Radius of the supporting rollers.
    #[serde(default = "roller")]
    #[schemars(range(min = 1e-6, max = 1e6), extend("x-unit" = "mm"))]
    pub support_radius_mm: f64,
    /// Way of the loading rollers, downwards. This or `force_n`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-12, max = 1e6), extend("x-unit" = "mm"))]
    pub displacement_mm: Option<f64>,
    /// Force on all loading rollers together, downwards. This or `displacement_mm`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-12, max = 1e12), extend("x-unit" = "N"))]
    pub force_n: Option<f64>,
}

/// A split laminate whose arms are pulled apart, each at a hinge in the middle of its left end. The right
/// end is kept from turning in the middle of its height, which bears nothing where the arms are alike.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DoubleCantilever {
    /// By how much the hinges part.
    #[schemars(range(min = 1e-12, max = 1e6), extend("x-unit" = "mm"))]
    pub opening_mm: f64,
}

/// A pull along x.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Tension {
    /// Way of the right face over the length; negative compresses.
    #[schemars(range(min = -1.0, max = 1.0), extend("x-unit" = "1"))]
    pub strain: f64,
    #[serde(default)]
    pub grips: Grips,
}

/// What the grips of a pull do across it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Grips {
    /// They let the section contract.
    #[default]
    FreeToContract,
    /// They hold it.
    Clamped,
}

/// Simple shear: every point of the four faces moves along x by `strain` times its height.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Shear {
    #[schemars(range(min = -1.0, max = 1.0), extend("x-unit" = "1"))]
    pub strain: f64,
}

/// The one thing a test does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Way<'a> {
    Held(&'a Supports),
    ThreePoint(&'a Flexure),
    FourPoint(&'a Flexure),
    ShortBeam(&'a Flexure),
    DoubleCantilever(&'a DoubleCantilever),
    Tension(&'a Tension),
    Shear(&'a Shear),
}

fn curve_points() -> u32 {
    200
}

/// ISO 14125 asks for loading rollers of 5 mm.
fn roller() -> f64 {
    5.0
}

impl Default for Breaking {
    fn default() -> Self {
        Self {
            criterion: Criterion::default(),
            control: Control::default(),
            scatter: None,
            teeth: 10,
            stop_force_fraction: 0.3,
            max_displacement_mm: None,
            max_events: 100_000,
        }
    }
}

impl Default for Support {
    fn default() -> Self {
        Self::Word(SupportWord::Free)
    }
}

impl Support {
    /// Whether it moves.
    pub(super) fn drives(&self) -> bool {
        match self {
            Self::Driven(driven) => driven
                .displacement_mm
                .iter()
                .any(|value| value.is_some_and(|value| value != 0.0)),
            Self::Word(_) | Self::PerAxis(_) => false,
        }
    }
}

impl Supports {
    /// The four with their faces.
    pub fn faces(&self) -> [(Face, &Support); 4] {
        [
            (Face::Left, &self.left),
            (Face::Right, &self.right),
            (Face::Bottom, &self.bottom),
            (Face::Top, &self.top),
        ]
    }
}

impl Face {
    /// Its name on the wire.
    pub fn name(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::Right => "right",
            Self::Bottom => "bottom",
            Self::Top => "top",
        }
    }
}

impl Test {
    /// Everything it says to do, each with its field's name; a checked spec has exactly one.
    pub(super) fn ways(&self) -> Vec<(&'static str, Way<'_>)> {
        let given = [
            self.supports
                .as_ref()
                .map(|held| ("supports", Way::Held(held))),
            self.three_point
                .as_ref()
                .map(|test| ("three_point", Way::ThreePoint(test))),
            self.four_point
                .as_ref()
                .map(|test| ("four_point", Way::FourPoint(test))),
            self.short_beam
                .as_ref()
                .map(|test| ("short_beam", Way::ShortBeam(test))),
            self.double_cantilever
                .as_ref()
                .map(|test| ("double_cantilever", Way::DoubleCantilever(test))),
            self.tension
                .as_ref()
                .map(|test| ("tension", Way::Tension(test))),
            self.shear.as_ref().map(|test| ("shear", Way::Shear(test))),
        ];
        given.into_iter().flatten().collect()
    }

    /// What is done; `None` when the spec says nothing or several things.
    pub fn way(&self) -> Option<Way<'_>> {
        match self.ways().as_slice() {
            [(_, way)] => Some(*way),
            _ => None,
        }
    }
}

impl<'a> Way<'a> {
    /// The bent specimen and the name of its test.
    pub fn flexure(self) -> Option<(&'static str, &'a Flexure)> {
        match self {
            Self::ThreePoint(flexure) => Some(("three_point", flexure)),
            Self::FourPoint(flexure) => Some(("four_point", flexure)),
            Self::ShortBeam(flexure) => Some(("short_beam", flexure)),
            Self::Held(_) | Self::DoubleCantilever(_) | Self::Tension(_) | Self::Shear(_) => None,
        }
    }
}
