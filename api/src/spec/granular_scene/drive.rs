//! Walls and bodies that are moved or pushed.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::bodies::Axis;

/// Lets the bodies move while walls (planes and facets alike) and bodies are driven, for `steps` or
/// for `time_s`, exactly one of the two. Walls that are not named stand still. Everything stays where
/// the stage leaves it; a body that was held to a velocity is let go with it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Drive {
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 1000))]
    pub walls: Vec<WallDrive>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 1000))]
    pub bodies: Vec<BodyDrive>,
    /// The bodies are meant to flow: how close the stage is to rest is not judged.
    #[serde(default)]
    pub flow: bool,
    /// What tan φ of all contacts is multiplied with meanwhile: little friction while a sample is pressed
    /// together makes it dense.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    #[schemars(range(min = 0.0, max = 1.0), extend("x-unit" = "1"))]
    pub friction_factor: f64,
    /// The stage ends before its time when the bodies press on a wall as this says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<Until>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 1_000_000_000_000_u64))]
    pub steps: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-15, max = 1e9), extend("x-unit" = "s"))]
    pub time_s: Option<f64>,
}

/// An end of a stage by a force: after the first step in which the force of all bodies on a wall along
/// an axis, signed as in its column of the curve, is `at_least_n` or `at_most_n`, exactly one of
/// the two. A peak of a single step counts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Until {
    /// Name of a plane or of facets.
    pub wall: String,
    pub axis: Axis,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -1e15, max = 1e15), extend("x-unit" = "N"))]
    pub at_least_n: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -1e15, max = 1e15), extend("x-unit" = "N"))]
    pub at_most_n: Option<f64>,
}

/// How a wall is driven: `velocity_m_per_s`, `sine`, `turn`, `force` or `servo`, exactly one of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WallDrive {
    /// Name of a plane or of facets.
    pub name: String,
    /// In any direction. A plane that moves along itself drags what it touches.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(inner(range(min = -1e6, max = 1e6))), extend("x-unit" = "m/s"))]
    pub velocity_m_per_s: Option<[f64; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sine: Option<Sine>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turn: Option<Turn>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force: Option<WallForce>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub servo: Option<Servo>,
}

/// A plane that moves along its axis until what presses on it has the force or the stress asked for, exactly
/// one of the two, and follows it from then on. It has no mass: before each step of length Δt its velocity
/// towards the bodies is set to gain (F₁ − F)/(K Δt), at most `largest_velocity_m_per_s` either way, with the
/// sum K of the stiffnesses of all contacts that it has or may soon have. What touches it feels a
/// dashpot: a contact alone comes nearer to F₁ by the part `gain` of what is missing in each step, and
/// never beyond. Until it touches anything it moves at its largest velocity, and in its first step of
/// contact the force grows by K Δt times that. While the bodies make it move at a speed v its force
/// is off by K Δt v/gain.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Servo {
    /// F₁, positive when it presses on the bodies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e15), extend("x-unit" = "N"))]
    pub force_n: Option<f64>,
    /// The same over the rectangle that the planes across the other two axes enclose at the moment.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e15), extend("x-unit" = "Pa"))]
    pub stress_pa: Option<f64>,
    /// So slow that the bodies can follow.
    #[schemars(range(min = 1e-12, max = 1e6), extend("x-unit" = "m/s"))]
    pub largest_velocity_m_per_s: f64,
    /// Part of the missing force that a step makes good; beyond 1 it would swing.
    #[serde(default = "gain")]
    #[schemars(range(min = 1e-6, max = 1.0), extend("x-unit" = "1"))]
    pub gain: f64,
}

/// A swing about where the wall was, x = A (sin(2πft + φ) − sin φ), t from the start of the stage.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sine {
    /// A.
    #[schemars(inner(range(min = -1e6, max = 1e6)), extend("x-unit" = "m"))]
    pub amplitude_m: [f64; 3],
    /// f.
    #[schemars(range(min = 0.0, max = 1e9), extend("x-unit" = "Hz"))]
    pub frequency_hz: f64,
    /// φ.
    #[serde(default)]
    #[schemars(range(min = -1e3, max = 1e3), extend("x-unit" = "rad"))]
    pub phase_rad: f64,
}

/// A turn of facets about an axis through `about_m`: a drum.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Turn {
    #[schemars(inner(range(min = -1e6, max = 1e6)), extend("x-unit" = "rad/s"))]
    pub angular_velocity_rad_per_s: [f64; 3],
    /// A point of the axis.
    #[serde(default)]
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "m"))]
    pub about_m: [f64; 3],
}

/// A force on a wall that has a mass and follows the force and what touches it along some axes: a
/// plate. It has no weight, and starts at rest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WallForce {
    #[schemars(range(min = 1e-12, max = 1e12), extend("x-unit" = "kg"))]
    pub mass_kg: f64,
    /// At the start of the stage.
    #[schemars(inner(range(min = -1e15, max = 1e15)), extend("x-unit" = "N"))]
    pub force_n: [f64; 3],
    /// Left out, the force is constant. Otherwise it swings between `force_n` and this,
    /// F = F₀ + (F₁ − F₀)(1 − cos 2πt/T)/2.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(inner(range(min = -1e15, max = 1e15))), extend("x-unit" = "N"))]
    pub peak_force_n: Option<[f64; 3]>,
    /// T of the swing; needed with `peak_force_n`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-15, max = 1e9), extend("x-unit" = "s"))]
    pub period_s: Option<f64>,
    /// Axes along which the wall moves; along the others it stands still.
    #[schemars(length(min = 1, max = 3))]
    pub free: Vec<Axis>,
}

/// How a body is driven: `velocity` or `force`, exactly one of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BodyDrive {
    /// Number of the body.
    pub body: u32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity: Option<BodyVelocity>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force: Option<BodyForce>,
}

/// A velocity of a body's centre of mass that no force changes, along some axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BodyVelocity {
    /// Components along other axes than those of `along` are not looked at.
    #[schemars(inner(range(min = -1e6, max = 1e6)), extend("x-unit" = "m/s"))]
    pub velocity_m_per_s: [f64; 3],
    /// Axes along which the body is held to its velocity; left out, all of them.
    #[serde(default = "all_axes")]
    #[schemars(length(min = 1, max = 3))]
    pub along: Vec<Axis>,
}

/// A force on a body beside its weight: on a sleeper.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BodyForce {
    /// At the start of the stage.
    #[schemars(inner(range(min = -1e15, max = 1e15)), extend("x-unit" = "N"))]
    pub force_n: [f64; 3],
    /// Where it acts on a clump, from its centre of mass as it lies at the start; the place turns with
    /// the clump, the force does not. Left out, at the centre of mass.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(inner(range(min = -1e6, max = 1e6))), extend("x-unit" = "m"))]
    pub at_m: Option<[f64; 3]>,
    /// As of a wall's force.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(inner(range(min = -1e15, max = 1e15))), extend("x-unit" = "N"))]
    pub peak_force_n: Option<[f64; 3]>,
    /// T of the swing; needed with `peak_force_n`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-15, max = 1e9), extend("x-unit" = "s"))]
    pub period_s: Option<f64>,
}

fn one() -> f64 {
    1.0
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
fn is_one(value: &f64) -> bool {
    value.to_bits() == 1.0_f64.to_bits()
}

/// A fifth: Hertz's contacts may be some times as stiff as they are foreseen.
fn gain() -> f64 {
    0.2
}

fn all_axes() -> Vec<Axis> {
    vec![Axis::X, Axis::Y, Axis::Z]
}

/// F₀ + (F₁ − F₀)(1 − cos 2πt/T)/2, or F₀ without a peak.
pub(super) fn swing(first: f64, peak: Option<f64>, period: Option<f64>, time: f64) -> f64 {
    match (peak, period) {
        (Some(peak), Some(period)) => {
            let phase = std::f64::consts::TAU * time / period;
            first + (peak - first) * 0.5 * (1.0 - phase.cos())
        }
        _ => first,
    }
}

fn swings(first: [f64; 3], peak: Option<[f64; 3]>, period: Option<f64>, time: f64) -> [f64; 3] {
    std::array::from_fn(|axis| swing(first[axis], peak.map(|peak| peak[axis]), period, time))
}

impl WallDrive {
    /// Not driven yet, in no way.
    pub fn of(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            velocity_m_per_s: None,
            sine: None,
            turn: None,
            force: None,
            servo: None,
        }
    }
}

impl Until {
    /// Whether this force along the axis [N] ends the stage.
    pub fn is_met(&self, force: f64) -> bool {
        self.at_least_n.is_some_and(|least| force >= least)
            || self.at_most_n.is_some_and(|most| force <= most)
    }
}

impl WallForce {
    /// Force at `time` [s] of the stage [N].
    pub fn force_at(&self, time: f64) -> [f64; 3] {
        swings(self.force_n, self.peak_force_n, self.period_s, time)
    }
}

impl BodyForce {
    /// Force at `time` [s] of the stage [N].
    pub fn force_at(&self, time: f64) -> [f64; 3] {
        swings(self.force_n, self.peak_force_n, self.period_s, time)
    }
}

impl Sine {
    /// Way from where the wall was at the start of the stage, at `time` [s] of it [m].
    pub fn way_at(&self, time: f64) -> [f64; 3] {
        let phase = std::f64::consts::TAU * self.frequency_hz * time + self.phase_rad;
        let swing = phase.sin() - self.phase_rad.sin();
        self.amplitude_m.map(|amplitude| amplitude * swing)
    }
}
