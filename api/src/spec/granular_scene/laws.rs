//! How bodies act on each other: materials, the contact law, the time step.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{ParallelBond, RollingResistance};

/// A material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Material {
    #[schemars(range(min = 1e-6, max = 1e12), extend("x-unit" = "kg/m3"))]
    pub density_kg_per_m3: f64,
    /// E. Under the laws `linear` and `logarithmic` the modulus of the contact as a spring:
    /// K_N = E₁l₁E₂l₂/(E₁l₁ + E₂l₂) with l = 2r. Under `hertz_mindlin` that of the solid.
    #[schemars(range(min = 1e-3, max = 1e15), extend("x-unit" = "Pa"))]
    pub youngs_modulus_pa: f64,
    /// ν, shear over normal stiffness: K_T is K_N with Eν in place of E. Not used by
    /// `hertz_mindlin`.
    #[serde(default = "stiffness_ratio")]
    #[schemars(range(min = 1e-6, max = 10.0), extend("x-unit" = "1"))]
    pub stiffness_ratio: f64,
    /// Poisson's ratio of the solid, used by `hertz_mindlin` alone; 0.3 when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -0.99, max = 0.5), extend("x-unit" = "1"))]
    pub poisson_ratio: Option<f64>,
    /// e, speed after over speed before a head-on impact: contacts have a dashpot along the normal.
    /// Between two materials the smaller one counts; left out, there is none, as with 1. What steps
    /// leave of it is in the guide, by presets of accuracy.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-6, max = 1.0), extend("x-unit" = "1"))]
    pub restitution: Option<f64>,
    /// e_T, what a sphere that sticks keeps of its speed in half a period of its swing on the shear
    /// spring: contacts have a dashpot across the normal. Friction limits spring and dashpot together;
    /// without it there is neither. Approximate for clumps, and under `hertz_mindlin`, whose spring
    /// changes during a swing. Between two materials the smaller one counts; left out, there is none,
    /// as with 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-6, max = 1.0), extend("x-unit" = "1"))]
    pub shear_restitution: Option<f64>,
    /// φ; a contact slides at tan φ of the smoother material. 0 is frictionless; left out, it is 0 too,
    /// and the results warn of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1.570_795_5), extend("x-unit" = "rad"))]
    pub friction_angle_rad: Option<f64>,
    /// What contacts set against rolling and twisting; left out, nothing. Not in a scene with cohesion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rolling_resistance: Option<RollingResistance>,
    /// Bonds that bend and twist, instead of those by cohesion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub parallel_bond: Option<ParallelBond>,
    /// c_N: spheres that touch at the start are bonded when both materials have cohesion; the bond
    /// breaks at a tension of c_N min(r)², the weaker material's.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e15), extend("x-unit" = "Pa"))]
    pub normal_cohesion_pa: f64,
    /// c_T: the bond breaks at a shear force of c_T min(r)² + F_N tan φ, compression positive.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e15), extend("x-unit" = "Pa"))]
    pub shear_cohesion_pa: f64,
}

/// The laws of contact and damping.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Laws {
    pub contact: ContactLaw,
    /// λ_D of Cundall's local damping: each component of a body's acceleration is changed by
    /// −λ_D |a| sgn(power). Independent of velocity, so free fall is slower too, by (1 − λ_D). Left
    /// out, 0.3; or 0 when a material gives a restitution, which damps in another way.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 0.99), extend("x-unit" = "1"))]
    pub local_damping: Option<f64>,
    pub convention: Convention,
    pub bond_rest_length: BondRestLength,
    /// Cohesion that is higher at first, or for stages in between; left out, it is that of the materials all the time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub raised_cohesion: Option<RaisedCohesion>,
    /// Whether a change of friction by a stage reaches contacts that exist.
    #[serde(skip_serializing_if = "ContactFriction::is_renewed")]
    pub contact_friction: ContactFriction,
}

/// Cohesion that is multiplied for some stages, from the first on unless another is named: bonds that rest where their spheres just touch
/// (`bond_rest_length`: `touching`) are not torn by the overlaps they are made with, at the start or when a later
/// stage puts breakable grains in. Before and after these stages every bond has the strength of its material.
/// Source: [Dubina2014] 4.5.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RaisedCohesion {
    /// What c_N and c_T of all materials are multiplied with.
    #[schemars(range(min = 1.0, max = 1e9), extend("x-unit" = "1"))]
    pub factor: f64,
    /// The stage, from 0, with which cohesions are raised.
    #[serde(default, skip_serializing_if = "is_first")]
    #[schemars(range(max = 999))]
    pub from_stage: usize,
    /// The stage, from 0, with which cohesions are set back.
    #[schemars(range(min = 1, max = 1000))]
    pub until_stage: usize,
}

/// The friction of contacts when a stage changes it (`friction_factor`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ContactFriction {
    /// All contacts have that of the present stage.
    #[default]
    Renewed,
    /// A contact keeps the friction that it began with until it opens, as in Yade, where materials that
    /// change do not reach it. One that opens and closes again between two searches for neighbours counts
    /// as one that stayed; one that goes on at another triangle is the same where both are of one material.
    Kept,
}

impl ContactFriction {
    #[allow(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
    pub(in crate::spec) fn is_renewed(&self) -> bool {
        *self == Self::Renewed
    }
}

/// The distance at which a bond carries no force.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BondRestLength {
    /// That at the start: bonded spheres may overlap as much as they like, and rest.
    #[default]
    Initial,
    /// That at which the spheres just touch, as in Yade: an overlap at the start is a compression.
    Touching,
}

impl BondRestLength {
    #[allow(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
    pub(in crate::spec) fn is_initial(&self) -> bool {
        *self == Self::Initial
    }
}

/// Law of a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ContactLaw {
    /// Springs along and across the normal, sliding by Coulomb ([CundallStrack1979]).
    #[default]
    Linear,
    /// The same, with the logarithm of the strain along the normal: spheres under high pressure do
    /// not pass through each other.
    Logarithmic,
    /// Hertz's springs of elastic spheres and Mindlin's shear without slip, sliding by Coulomb.
    HertzMindlin,
}

/// Whose rules where programs differ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Convention {
    /// One rule for every wall, and rotations that keep their energy.
    #[default]
    Loadframe,
    /// The algorithm of Yade 2023.02a, operation by operation.
    Yade,
}

/// The time step: given, or found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum TimeStep {
    Given(#[schemars(range(min = 1e-15, max = 1e3), extend("x-unit" = "s"))] f64),
    Automatic(AutomaticTimeStep),
}

/// The word for a time step that follows the stiffness of the contacts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AutomaticTimeStep {
    #[default]
    Auto,
}

/// λ_D when nothing is said: the usual choice for quasi-static loading, and the one of the ballast
/// studies.
const LOCAL_DAMPING: f64 = 0.3;
/// ν of most rocks and metals.
const POISSON_RATIO: f64 = 0.3;

impl Laws {
    /// Radius that facets bring to the stiffness of a contact, over that of the sphere.
    pub fn facet_radius_ratio(&self) -> f64 {
        match self.convention {
            Convention::Loadframe => 1.0,
            Convention::Yade => 2.0,
        }
    }
}

impl Default for TimeStep {
    fn default() -> Self {
        Self::Automatic(AutomaticTimeStep::Auto)
    }
}

impl Material {
    /// Resistance to rolling and twisting; all 0 where there is none.
    pub fn rolling(&self) -> RollingResistance {
        self.rolling_resistance.unwrap_or_default()
    }

    /// φ [rad], 0 where it is left out.
    pub fn friction_angle(&self) -> f64 {
        self.friction_angle_rad.unwrap_or(0.0)
    }

    /// Whether its spheres can be bonded.
    pub fn is_cohesive(&self) -> bool {
        self.has_cohesion() || self.parallel_bond.is_some()
    }

    /// Whether they are bonded by cohesion, without moments.
    pub fn has_cohesion(&self) -> bool {
        self.normal_cohesion_pa > 0.0 || self.shear_cohesion_pa > 0.0
    }

    /// The same with `factor` times its moduli, cement's too: what a stage `stiffen` multiplies.
    #[must_use]
    pub fn softened(mut self, factor: f64) -> Self {
        self.youngs_modulus_pa *= factor;
        if let Some(bond) = &mut self.parallel_bond {
            bond.youngs_modulus_pa *= factor;
        }
        self
    }

    /// ν of the solid.
    pub fn poisson_ratio(&self) -> f64 {
        self.poisson_ratio.unwrap_or(POISSON_RATIO)
    }

    /// β along and across the normal, of the oscillator whose half period leaves e of the speed:
    /// −ln e/√(π² + ln² e).
    pub fn damping_ratios(&self) -> [f64; 2] {
        [self.restitution, self.shear_restitution].map(|restitution| {
            let logarithm = restitution.unwrap_or(1.0).ln();
            if logarithm < 0.0 {
                -logarithm / std::f64::consts::PI.hypot(logarithm)
            } else {
                0.0
            }
        })
    }
}

impl super::GranularScene {
    /// Whether contacts have dashpots along and across the normal.
    pub fn is_viscous(&self) -> [bool; 2] {
        [0, 1].map(|way| {
            let mut materials = self.materials.values();
            materials.any(|material| material.damping_ratios()[way] > 0.0)
        })
    }

    /// What cohesions are multiplied with during a stage, from 0.
    pub fn cohesion_factor(&self, stage: usize) -> f64 {
        let raised = self.laws.raised_cohesion;
        let raised =
            raised.filter(|raised| (raised.from_stage..raised.until_stage).contains(&stage));
        raised.map_or(1.0, |raised| raised.factor)
    }

    /// λ_D, given or not.
    pub fn local_damping(&self) -> f64 {
        let mut materials = self.materials.values();
        let has_restitution = materials
            .any(|material| material.restitution.is_some() || material.shear_restitution.is_some());
        let default = if has_restitution { 0.0 } else { LOCAL_DAMPING };
        self.laws.local_damping.unwrap_or(default)
    }
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
fn is_first(stage: &usize) -> bool {
    *stage == 0
}

fn stiffness_ratio() -> f64 {
    0.3
}
