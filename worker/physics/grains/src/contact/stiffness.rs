//! What two bodies bring to a contact: materials, radii, masses.
use loadframe_api::spec::granular_scene::{
    Material, ParallelBond, RollingResistance,
    hertz::{self, Solid},
    step_with_dashpot,
};

use super::{freedom::Freedom, past::Past};

/// A material as contacts see it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    /// ρ [kg/m³].
    pub(crate) density: f64,
    /// E [Pa].
    youngs_modulus: f64,
    /// K of a plane that has one of its own [N/m].
    own_stiffness: Option<f64>,
    /// ν, k_T/k_N of linear springs.
    pub(super) stiffness_ratio: f64,
    poisson_ratio: f64,
    /// tan φ.
    friction: f64,
    /// c_N and c_T [Pa].
    cohesion: [f64; 2],
    /// β of the dashpots along and across the normal.
    damping_ratios: [f64; 2],
    rolling: RollingResistance,
    /// Its modulus is softened with the other.
    bond: Option<ParallelBond>,
}

/// A body at a contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Side {
    pub(crate) surface: Surface,
    /// Of the sphere [m]; a wall has that of the sphere it touches.
    pub(crate) radius: f64,
    pub(crate) is_flat: bool,
    /// Of its body [1/kg]; 0 for one that does not move.
    pub(crate) inverse_mass: f64,
    /// What is left of it at this contact.
    pub(crate) freedom: Freedom,
}

/// What a contact is made of: constants of the law's springs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Springs {
    /// k_N [N/m] of a linear spring.
    pub(crate) normal: f64,
    /// k_T/k_N of the constants.
    pub(crate) ratio: f64,
    /// tan φ.
    pub(crate) friction: f64,
    /// c_N and c_T [N s/m] beside linear springs.
    pub(crate) dashpots: [f64; 2],
    pub(crate) resistance: Resistance,
    /// What a bond between the two is made of, where it bends and twists.
    pub(crate) cement: Cement,
}

/// A bond like a beam; nothing where there is none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Cement {
    /// R̄ [m].
    pub(crate) radius: f64,
    /// EA [N].
    pub(crate) section: f64,
    /// κ.
    pub(crate) ratio: f64,
    /// Of a fibre in tension and in shear [Pa].
    pub(crate) strengths: [f64; 2],
}

/// What a contact sets against rolling and twisting, in this order; where nothing is asked for, 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Resistance {
    /// k_r and k_t [N m] beside linear springs.
    pub(crate) stiffness: [f64; 2],
    /// μ_r R and μ_t R [m].
    pub(crate) reach: [f64; 2],
    /// c_r and c_t [N m s] beside linear springs.
    pub(crate) dashpots: [f64; 2],
}

/// Inertia over m r² of a sphere that rolls about the place of contact, and of one that twists.
const TURNING: [f64; 2] = [1.4, 0.4];

/// What two spheres that stick set against motion across the normal, over m*: with I = 2/5 m r² a
/// force there moves the point of contact by 1/m* (1 + 5/2).
const STICKING: f64 = 2.0 / 7.0;

/// Freedom of both sides below which a dashpot fades: hardly anything moves along it, as between two that are
/// held, and the mass that it would be made for grows without limit. A normal is then 6° off an
/// axis that both are held along.
const LEAST_FREEDOM: f64 = 0.01;

impl Surface {
    pub(crate) fn new(material: &Material) -> Self {
        Self {
            density: material.density_kg_per_m3,
            youngs_modulus: material.youngs_modulus_pa,
            own_stiffness: None,
            stiffness_ratio: material.stiffness_ratio,
            poisson_ratio: material.poisson_ratio(),
            friction: material.friction_angle().tan(),
            cohesion: [material.normal_cohesion_pa, material.shear_cohesion_pa],
            damping_ratios: material.damping_ratios(),
            rolling: material.rolling(),
            bond: material.parallel_bond,
        }
    }

    /// That of a plane which brings this stiffness to its contacts [N/m].
    pub(crate) fn of_stiffness(self, stiffness: f64) -> Self {
        Self {
            own_stiffness: Some(stiffness),
            ..self
        }
    }

    /// The spring along the normal that it brings to a contact at this radius [N/m]: E 2r, or its own.
    pub(super) fn stiffness(&self, radius: f64) -> f64 {
        self.own_stiffness
            .unwrap_or(self.youngs_modulus * 2.0 * radius)
    }

    /// The same with `factor` times the modulus.
    pub(crate) fn stiffened(&self, factor: f64) -> Self {
        Self {
            youngs_modulus: factor * self.youngs_modulus,
            own_stiffness: self.own_stiffness.map(|stiffness| factor * stiffness),
            bond: self.bond.map(|bond| ParallelBond {
                youngs_modulus_pa: factor * bond.youngs_modulus_pa,
                ..bond
            }),
            ..*self
        }
    }

    /// k_N of two spheres of this material with radius r [m].
    pub(crate) fn half_stiffness(&self, radius: f64) -> f64 {
        self.youngs_modulus * radius
    }

    /// What the stiffest of its contacts that may turn sets against turning, over the stiffness that one
    /// has along the normal, at most.
    pub(crate) fn turning_bound(&self) -> f64 {
        if self.rolling.is_felt() {
            1.0 + self.rolling.stiffness_ratio * self.stiffness_ratio.max(1.0)
        } else {
            1.0
        }
    }

    /// A critical step of one contact without dashpots [s], shortened by those of this surface:
    /// 2/ω becomes 2/ω (√(1 + β²) − β). A push across the normal moves the point of contact
    /// `mobility` times as much as it moves the mass.
    pub(crate) fn damped_step(&self, step: f64, mobility: f64) -> f64 {
        let [along, across] = self.damping_ratios;
        step * step_with_dashpot(along.max(across * (STICKING * mobility).sqrt()))
    }

    pub(super) fn solid(&self) -> Solid {
        Solid {
            youngs_modulus: self.youngs_modulus,
            poisson_ratio: self.poisson_ratio,
        }
    }
}

impl Springs {
    /// With what a bond that bends and twists adds to the springs, for how large a step it allows.
    pub(crate) fn held(&self, past: Option<&Past>) -> Self {
        let bond = past.map(|past| past.bond).filter(|bond| bond.is_intact);
        let Some(bond) = bond.filter(|_| self.cement.section > 0.0) else {
            return *self;
        };
        let axial = self.cement.section / bond.beam.length;
        let across = self.cement.ratio * axial;
        let square = self.cement.radius.powi(2);
        let normal = self.normal + axial;
        Self {
            normal,
            ratio: (self.ratio * self.normal + across) / normal,
            resistance: Resistance {
                stiffness: [0.25 * axial * square, 0.5 * across * square],
                ..self.resistance
            },
            ..*self
        }
    }
}

impl Side {
    /// A wall of this surface, where this sphere touches it; 1/m [1/kg] is 0 for one that no force
    /// moves.
    pub(crate) fn wall(&self, surface: Surface, inverse_mass: f64) -> Self {
        Self {
            surface,
            radius: self.radius,
            is_flat: true,
            inverse_mass,
            freedom: Freedom::WHOLE,
        }
    }

    /// The same with what is left of its freedom.
    pub(crate) fn with(self, freedom: Freedom) -> Self {
        Self { freedom, ..self }
    }

    /// 1/m* [1/kg] of the two, of each the part that is left; without limit where nothing is.
    fn moving_with(&self, other: &Self, left: impl Fn(&Freedom) -> f64) -> f64 {
        let sides = [self, other].map(|side| (side.inverse_mass, left(&side.freedom)));
        let inverse_mass = sides[0].0 * sides[0].1 + sides[1].0 * sides[1].1;
        let moving = sides.iter().filter(|(inverse_mass, _)| *inverse_mass > 0.0);
        let most = moving.map(|(_, left)| *left).fold(0.0, f64::max);
        // c ∝ 1/√(1/m*), times most/LEAST_FREEDOM
        inverse_mass * (LEAST_FREEDOM / most).max(1.0).powi(2)
    }

    /// 1/r of the surface [1/m].
    pub(super) fn curvature(&self) -> f64 {
        if self.is_flat { 0.0 } else { 1.0 / self.radius }
    }

    /// tan φ of the smoother surface.
    pub(super) fn friction_with(&self, other: &Self) -> f64 {
        self.surface.friction.min(other.surface.friction)
    }

    /// What a bond of the two is made of.
    pub(super) fn cement_with(&self, other: &Self) -> Cement {
        let (Some(own), Some(others), false) = (
            self.surface.bond,
            other.surface.bond,
            self.is_flat || other.is_flat,
        ) else {
            return Cement::default();
        };
        let bond = own.with(&others);
        let smaller = self.radius.min(other.radius);
        // EA, as of a beam that is 1 m long
        let [section, ..] = bond.stiffnesses(smaller, 1.0);
        Cement {
            radius: bond.radius_ratio * smaller,
            section,
            ratio: bond.stiffness_ratio,
            strengths: [bond.tensile_strength_pa, bond.shear_strength_pa],
        }
    }

    /// What the two set against rolling and twisting beside a shear spring [N/m].
    pub(super) fn resistance_with(&self, other: &Self, shear: f64) -> Resistance {
        let rolling = self.surface.rolling.with(&other.surface.rolling);
        if !rolling.is_felt() {
            return Resistance::default();
        }
        let radius = hertz::effective_radius(self.curvature(), other.curvature());
        let stiffness = rolling.stiffness_ratio * shear * radius * radius;
        let turning = [0, 1].map(|way: usize| {
            let turning = [self, other].map(|side| {
                side.freedom.turning[way] * (side.inverse_mass * side.curvature().powi(2))
            });
            turning[0] + turning[1]
        });
        let frictions = [rolling.rolling_friction, rolling.twisting_friction];
        // what has no limit above 0 has no spring either
        let springs = frictions.map(|friction| if friction > 0.0 { stiffness } else { 0.0 });
        Resistance {
            stiffness: springs,
            reach: frictions.map(|friction| friction * radius),
            dashpots: [0, 1].map(|way: usize| {
                if rolling.damping_ratio > 0.0 && turning[way] > 0.0 {
                    let inertia = TURNING[way] / turning[way];
                    2.0 * rolling.damping_ratio * (inertia * springs[way]).sqrt()
                } else {
                    0.0
                }
            }),
        }
    }

    /// 2 β √(m* k_N) and 2 β_T √(2/7 m* k_T) [N s/m] of the surface that damps more, beside springs of
    /// these stiffnesses [N/m].
    pub(super) fn dashpots_with(&self, other: &Self, stiffness: [f64; 2]) -> [f64; 2] {
        let inverse_masses = [
            self.moving_with(other, |freedom| freedom.along),
            self.moving_with(other, |freedom| freedom.across),
        ];
        let dashpot = |way: usize, stiffness: f64| {
            let [own, others] = [self, other].map(|side| side.surface.damping_ratios[way]);
            let ratio = own.max(others);
            let inverse_mass = inverse_masses[way];
            if ratio > 0.0 && inverse_mass > 0.0 && inverse_mass.is_finite() {
                2.0 * ratio * (stiffness / inverse_mass).sqrt()
            } else {
                0.0
            }
        };
        [
            dashpot(0, stiffness[0]),
            dashpot(1, STICKING * stiffness[1]),
        ]
    }
}

/// Strengths a = c r² [N] of a bond between two surfaces, of the smaller radius [m] and the weaker
/// material, for the normal and the shear direction (T 3.34), or 0 of one that bends and twists, whose
/// strengths are stresses; `None` when it would not hold.
pub(crate) fn bond_strength(a: (Surface, f64), b: (Surface, f64)) -> Option<[f64; 2]> {
    if a.0.bond.is_some() && b.0.bond.is_some() {
        return Some([0.0; 2]);
    }
    let radius = a.1.min(b.1);
    let strength = [0, 1].map(|way| a.0.cohesion[way].min(b.0.cohesion[way]) * radius * radius);
    strength
        .iter()
        .any(|strength| *strength > 0.0)
        .then_some(strength)
}
