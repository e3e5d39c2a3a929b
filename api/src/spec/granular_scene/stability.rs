//! Stiffness of contacts, and the step that integrates them stably.
//!
//! A contact is two springs in series, each body with K = E l, l = 2r:
//! K_N = K₁K₂/(K₁ + K₂), and K_T the same with Eν in place of E. A plane takes the radius of the
//! sphere that touches it. The critical step of the leapfrog is 2/ω with the highest frequency ω
//! of the scene; here ω² is that of one contact, the larger of K_N/m* along the normal and
//! K_T (1/m* + Σ r²/I) across it, with 1/m* the sum of the movable bodies' inverse masses and
//! I = 2/5 m r².
//!
//! Source: [CundallStrack1979]; series rule as in Yade.
use super::{Body, DegreeOfFreedom, GranularScene, Material};

/// Stiffness of two springs in series [N/m].
pub fn series_stiffness(first: f64, second: f64) -> f64 {
    first * second / (first + second)
}

/// r²/I over 1/m for a sphere: I = 2/5 m r².
const SPHERE_ROTATION: f64 = 2.5;

impl Material {
    /// Normal stiffness E 2r that a sphere of `radius` [m] brings to a contact [N/m].
    pub fn normal_stiffness(&self, radius: f64) -> f64 {
        self.youngs_modulus_pa * 2.0 * radius
    }

    /// Shear stiffness E ν 2r that a sphere of `radius` [m] brings to a contact [N/m].
    pub fn shear_stiffness(&self, radius: f64) -> f64 {
        self.youngs_modulus_pa * self.stiffness_ratio * 2.0 * radius
    }
}

impl Body {
    /// Whether no force moves the body at all.
    pub fn is_held(&self) -> bool {
        use DegreeOfFreedom as D;
        [D::X, D::Y, D::Z, D::Rx, D::Ry, D::Rz]
            .iter()
            .all(|degree| self.fixed.contains(degree))
    }

    /// Whether some force moves its centre.
    fn is_movable(&self) -> bool {
        use DegreeOfFreedom as D;
        !([D::X, D::Y, D::Z].iter()).all(|degree| self.fixed.contains(degree))
    }
}

/// A sphere that may touch others, as far as stability is concerned.
#[derive(Clone, Copy)]
struct Partner<'a> {
    body: usize,
    material: &'a Material,
    radius: f64,
    /// 1/m [1/kg]; 0 for one that does not move.
    inverse_mass: f64,
}

/// The step that is critical for a pair of bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct CriticalStep {
    /// 2/ω [s].
    pub step: f64,
    pub body: usize,
    /// The body it touches; `None` for a plane.
    pub partner: Option<usize>,
}

impl GranularScene {
    /// Smallest critical step of any contact between two spheres, or a sphere and a plane, that
    /// may come to pass: each sphere against the planes, the stiffest and the lightest other.
    /// Clumps are left out: their mass is not known here. `None` when nothing can touch.
    pub fn critical_step_of_one_contact(&self) -> Option<CriticalStep> {
        let spheres: Vec<Partner<'_>> = self
            .bodies
            .iter()
            .enumerate()
            .filter_map(|(body, spec)| self.partner(body, spec))
            .collect();
        let stiffness = |partner: &Partner<'_>| partner.material.normal_stiffness(partner.radius);
        let most = |value: &dyn Fn(&Partner<'_>) -> f64| {
            let mut order: Vec<usize> = (0..spheres.len()).collect();
            order.sort_by(|a, b| value(&spheres[*b]).total_cmp(&value(&spheres[*a])));
            order.truncate(2);
            order
        };
        let mut others = most(&stiffness);
        others.extend(most(&|partner| partner.inverse_mass));
        let mut smallest: Option<CriticalStep> = None;
        let mut offer = |step: f64, body: usize, partner: Option<usize>| {
            if step.is_finite() && smallest.as_ref().is_none_or(|found| step < found.step) {
                smallest = Some(CriticalStep {
                    step,
                    body,
                    partner,
                });
            }
        };
        for sphere in &spheres {
            for other in others.iter().map(|other| &spheres[*other]) {
                if other.body != sphere.body {
                    offer(critical_step(sphere, other), sphere.body, Some(other.body));
                }
            }
            for plane in &self.planes {
                if let Some(material) = self.materials.get(&plane.material) {
                    let wall = Partner {
                        material,
                        inverse_mass: 0.0,
                        ..*sphere
                    };
                    offer(critical_step(sphere, &wall), sphere.body, None);
                }
            }
        }
        smallest
    }

    fn partner<'a>(&'a self, body: usize, spec: &'a Body) -> Option<Partner<'a>> {
        let material = self.materials.get(&spec.material)?;
        let radius = spec.sphere?.radius_m;
        let mass = material.density_kg_per_m3 * 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
        let inverse_mass = if spec.is_movable() { 1.0 / mass } else { 0.0 };
        Some(Partner {
            body,
            material,
            radius,
            inverse_mass,
        })
    }
}

/// 2/ω of two spheres in contact [s]; infinite when neither moves.
fn critical_step(a: &Partner<'_>, b: &Partner<'_>) -> f64 {
    let normal = series_stiffness(
        a.material.normal_stiffness(a.radius),
        b.material.normal_stiffness(b.radius),
    );
    let is_rough = a
        .material
        .friction_angle_rad
        .min(b.material.friction_angle_rad)
        > 0.0;
    let shear = if is_rough {
        let shear = series_stiffness(
            a.material.shear_stiffness(a.radius),
            b.material.shear_stiffness(b.radius),
        );
        shear * (1.0 + SPHERE_ROTATION)
    } else {
        0.0
    };
    let inverse_mass = a.inverse_mass + b.inverse_mass;
    2.0 / (normal.max(shear) * inverse_mass).sqrt()
}
