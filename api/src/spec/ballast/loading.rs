//! What is done to a bed: blocks of cycles, by a force that swings or by a machine that moves.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A force on the loading wall, downward, that swings between two values:
/// F = F₀ + (F₁ − F₀)(1 − cos 2πt/T)/2. With `velocity_m_per_s` a machine moves the wall instead: down
/// until the force is F₁, up until it is F₀, cycle by cycle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Loading {
    /// F₀, beside the weight of a sleeper.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e12), extend("x-unit" = "N"))]
    pub smallest_force_n: f64,
    /// F₁.
    #[schemars(range(min = 1e-6, max = 1e12), extend("x-unit" = "N"))]
    pub peak_force_n: f64,
    #[serde(default = "one")]
    #[schemars(range(min = 1, max = 100_000))]
    pub cycles: u32,
    /// T; left out with `frequency_hz`, it follows from the inertial number that `accuracy` asks for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-6, max = 1e6), extend("x-unit" = "s"))]
    pub period_s: Option<f64>,
    /// 1/T, instead of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-6, max = 1e6), extend("x-unit" = "Hz"))]
    pub frequency_hz: Option<f64>,
    /// Speed at which a machine moves plate or sleeper, down and up: 1.67e-5 is 1 mm/min. Not with a
    /// period or a frequency.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-9, max = 1e3), extend("x-unit" = "m/s"))]
    pub velocity_m_per_s: Option<f64>,
    /// A machine turns when it has gone down this far in a cycle, though the force is not F₁ yet; left
    /// out, half of the bed's height.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-9, max = 100.0), extend("x-unit" = "m"))]
    pub largest_displacement_m: Option<f64>,
    /// Blocks of cycles after these: first 3 kN, then 40 kN.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 100))]
    pub then: Vec<Block>,
}

/// A block of cycles after another. What it leaves out is as in the block before; a period, a
/// frequency and a velocity stand for each other.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Block {
    /// F₀. Where it is another than before, the force goes there first, smoothly, in half a period of
    /// the block before.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e12), extend("x-unit" = "N"))]
    pub smallest_force_n: Option<f64>,
    /// F₁.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-6, max = 1e12), extend("x-unit" = "N"))]
    pub peak_force_n: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 100_000))]
    pub cycles: Option<u32>,
    /// T.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-6, max = 1e6), extend("x-unit" = "s"))]
    pub period_s: Option<f64>,
    /// 1/T.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-6, max = 1e6), extend("x-unit" = "Hz"))]
    pub frequency_hz: Option<f64>,
    /// Of a machine.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-9, max = 1e3), extend("x-unit" = "m/s"))]
    pub velocity_m_per_s: Option<f64>,
    /// Of a machine.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-9, max = 100.0), extend("x-unit" = "m"))]
    pub largest_displacement_m: Option<f64>,
}

/// Strain of grains that find their place, as it is taken for the choice of a period.
const STRAIN: f64 = 0.05;
/// Modulus of a bed over that of its contacts, for the same purpose: oedometers of spheres have 0.2 to
/// 0.3.
const BED_MODULUS: f64 = 0.2;
/// Strain that is not taken to be exceeded.
const LARGEST_STRAIN: f64 = 0.5;

/// What a period follows from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    /// I.
    pub(super) inertial_number: f64,
    /// Of the loading wall [m²].
    pub(super) area: f64,
    /// Of a mean grain [m].
    pub(super) diameter: f64,
    /// Of grains [kg/m³].
    pub(super) density: f64,
    /// Of contacts between grains during the test [Pa].
    pub(super) modulus: f64,
}

/// A block with all that it took from those before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cycles {
    /// F₀ and F₁ [N].
    pub(super) forces: [f64; 2],
    pub(super) cycles: u32,
    pub(super) motion: Motion,
}

/// What moves the wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Motion {
    /// A force with this period [s].
    Force { period: f64 },
    /// A machine at a speed [m/s], which turns at a way [m]; a cycle takes about this time [s].
    Machine {
        velocity: f64,
        largest: f64,
        time: f64,
    },
}

impl Cycles {
    /// Of a cycle, about where a machine moves the wall [s].
    pub(super) fn cycle_time(&self) -> f64 {
        match self.motion {
            Motion::Force { period } => period,
            Motion::Machine { time, .. } => time,
        }
    }
}

impl Pace {
    /// Strain that grains need to find their place and to be pressed at a force [N], about.
    fn strain(&self, force: f64) -> f64 {
        let pressed = force / self.area / (BED_MODULUS * self.modulus);
        (STRAIN + pressed).min(LARGEST_STRAIN)
    }

    /// A period at which a bed follows the load without inertia [s]: with the mean pressure p of the
    /// cycle, the strain that grains need to find their place and to be pressed within half of it has
    /// the inertial number I = γ̇ d √(ρ/p).
    fn period(&self, [smallest, peak]: [f64; 2]) -> f64 {
        let mean = 0.5 * (smallest + peak) / self.area;
        let time = 2.0 * self.strain(peak) * self.diameter * (self.density / mean).sqrt();
        time / self.inertial_number
    }
}

impl Loading {
    /// All blocks, with what each took from those before.
    pub(super) fn history(&self) -> Vec<Block> {
        let mut blocks = vec![Block {
            smallest_force_n: Some(self.smallest_force_n),
            peak_force_n: Some(self.peak_force_n),
            cycles: Some(self.cycles),
            period_s: self.period_s,
            frequency_hz: self.frequency_hz,
            velocity_m_per_s: self.velocity_m_per_s,
            largest_displacement_m: self.largest_displacement_m,
        }];
        for (before, next) in self.then.iter().enumerate() {
            blocks.push(next.after(&blocks[before]));
        }
        blocks
    }

    /// The same as they are carried out, on a bed of this height [m].
    pub(super) fn blocks(&self, pace: &Pace, height: f64) -> Vec<Cycles> {
        let blocks = self.history();
        blocks
            .iter()
            .map(|block| block.resolved(pace, height))
            .collect()
    }

    /// Whether the pace of all is given.
    pub(super) fn has_period(&self) -> bool {
        // what a block leaves out it has from the first
        self.period_s.is_some() || self.frequency_hz.is_some() || self.velocity_m_per_s.is_some()
    }
}

impl Block {
    /// Filled up from the block before.
    fn after(&self, before: &Self) -> Self {
        let has_pace = self.period_s.is_some()
            || self.frequency_hz.is_some()
            || self.velocity_m_per_s.is_some();
        let pace = if has_pace { self } else { before };
        Self {
            smallest_force_n: self.smallest_force_n.or(before.smallest_force_n),
            peak_force_n: self.peak_force_n.or(before.peak_force_n),
            cycles: self.cycles.or(before.cycles),
            period_s: pace.period_s,
            frequency_hz: pace.frequency_hz,
            velocity_m_per_s: pace.velocity_m_per_s,
            largest_displacement_m: (self.largest_displacement_m).or(before.largest_displacement_m),
        }
    }

    /// F₀ and F₁ [N].
    pub(super) fn forces(&self) -> [f64; 2] {
        [self.smallest_force_n, self.peak_force_n].map(Option::unwrap_or_default)
    }

    fn resolved(&self, pace: &Pace, height: f64) -> Cycles {
        let forces = self.forces();
        let given = self.period_s.or(self.frequency_hz.map(f64::recip));
        let motion = match self.velocity_m_per_s {
            Some(velocity) => {
                let largest = self.largest_displacement_m.unwrap_or(0.5 * height);
                let way = (pace.strain(forces[1]) * height).min(largest);
                let time = 2.0 * way / velocity;
                Motion::Machine {
                    velocity,
                    largest,
                    time,
                }
            }
            None => Motion::Force {
                period: given.unwrap_or_else(|| pace.period(forces)),
            },
        };
        Cycles {
            forces,
            cycles: self.cycles.unwrap_or(1),
            motion,
        }
    }
}

fn one() -> u32 {
    1
}
