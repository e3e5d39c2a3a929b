//! Stiffness and friction of a contact from its two materials.
use loadframe_api::spec::granular_scene::{Material, series_stiffness};

/// A material as contacts see it.
#[derive(Clone, Copy, Debug)]
pub(in crate::granular) struct Surface {
    /// E [Pa].
    youngs_modulus: f64,
    /// E ν [Pa].
    shear_modulus: f64,
    /// φ [rad].
    friction_angle: f64,
    /// c_N and c_T [Pa].
    cohesion: [f64; 2],
}

/// What a contact is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::granular) struct Springs {
    /// k_N [N/m].
    pub(in crate::granular) normal: f64,
    /// k_T [N/m].
    pub(in crate::granular) shear: f64,
    /// tan φ.
    pub(in crate::granular) friction: f64,
}

impl Surface {
    pub(in crate::granular) fn new(material: &Material) -> Self {
        Self {
            youngs_modulus: material.youngs_modulus_pa,
            shear_modulus: material.youngs_modulus_pa * material.stiffness_ratio,
            friction_angle: material.friction_angle_rad,
            cohesion: [material.normal_cohesion_pa, material.shear_cohesion_pa],
        }
    }

    /// k_N of two spheres of this material with radius r [m].
    pub(in crate::granular) fn half_stiffness(&self, radius: f64) -> f64 {
        self.youngs_modulus * radius
    }
}

/// Strengths a = c r² [N] of a bond between two surfaces, of the smaller radius [m] and the weaker
/// material, for the normal and the shear direction (T 3.34); `None` when it would not hold.
pub(in crate::granular) fn bond_strength(a: (Surface, f64), b: (Surface, f64)) -> Option<[f64; 2]> {
    let radius = a.1.min(b.1);
    let strength = [0, 1].map(|way| a.0.cohesion[way].min(b.0.cohesion[way]) * radius * radius);
    strength
        .iter()
        .any(|strength| *strength > 0.0)
        .then_some(strength)
}

impl Springs {
    /// Two surfaces of bodies with radii r [m]: springs E 2r in series, the smaller friction angle.
    pub(in crate::granular) fn between(a: (Surface, f64), b: (Surface, f64)) -> Self {
        let series = |modulus: fn(&Surface) -> f64| {
            series_stiffness(modulus(&a.0) * 2.0 * a.1, modulus(&b.0) * 2.0 * b.1)
        };
        Self {
            normal: series(|surface| surface.youngs_modulus),
            shear: series(|surface| surface.shear_modulus),
            friction: a.0.friction_angle.min(b.0.friction_angle).tan(),
        }
    }
}
