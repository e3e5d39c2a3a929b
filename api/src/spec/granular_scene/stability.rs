//! Stiffness of contacts, and the step that integrates them stably.
//!
//! A contact is two springs in series, each body with K = E l, l = 2r:
//! K_N = K₁K₂/(K₁ + K₂), and K_T the same with Eν in place of E. A plane takes the radius of the
//! sphere that touches it, and so do facets but for Yade's convention, in which they take twice it.
//! The critical step of the leapfrog is 2/ω with the highest frequency ω of the scene; here ω² is that of one contact, the larger of K_N/m* along the normal and
//! K_T (1/m* + Σ r²/I) across it, with 1/m* the sum of the movable bodies' inverse masses and
//! I = 2/5 m r²; what resists rolling or twisting with k_r adds k_r Σ 1/I to the latter. A dashpot
//! shortens it, see [`step_with_dashpot`]. Hertz's contacts stiffen with their
//! overlap: they are taken at that of an impact at the speed given, or at a least one.
//!
//! A body that is held in part, such as one whose centre is held and that turns, counts as if nothing of it
//! were held: to hold something raises no frequency (Rayleigh), and the rows of (G.10) and (G.11), by
//! which a run bounds the contacts that it has, count it so too.
//!
//! Source: [CundallStrack1979]; series rule as in Yade.
use std::collections::{BTreeMap, BTreeSet};

use super::{
    Body, ContactLaw, DegreeOfFreedom, GranularScene, Material,
    hertz::{self, Solid},
};

/// Stiffness of two springs in series [N/m].
pub fn series_stiffness(first: f64, second: f64) -> f64 {
    first * second / (first + second)
}

/// Critical step with a dashpot of damping ratio β, over that without:
/// √(1 + 4β²) − 2β, since the velocity that damps is carried on to the middle of the step, with weights
/// 3/2 and −1/2, from those of half a step and one and a half ago.
pub fn step_with_dashpot(damping_ratio: f64) -> f64 {
    let twice = 2.0 * damping_ratio;
    (1.0 + twice * twice).sqrt() - twice
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

impl Partner<'_> {
    /// What it brings to the springs along and across the normal [N/m].
    fn stiffnesses(&self) -> [f64; 2] {
        match self.own_stiffness {
            Some(stiffness) => [stiffness, stiffness * self.material.stiffness_ratio],
            None => [
                self.material.normal_stiffness(self.radius),
                self.material.shear_stiffness(self.radius),
            ],
        }
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
    /// K of a plane that gives it [N/m], in place of its material's.
    own_stiffness: Option<f64>,
    /// 1/r [1/m]; 0 for a plane.
    curvature: f64,
    /// 1/m [1/kg]; 0 for one whose centre does not move.
    inverse_mass: f64,
    /// 1/m of one that moves or turns [1/kg]; 0 for one that is held.
    mobility: f64,
}

/// A wall, likewise.
struct Wall<'a> {
    material: &'a Material,
    /// Radius that it takes, over that of the sphere that touches it.
    radius_ratio: f64,
    /// K that it brings by itself [N/m].
    stiffness: Option<f64>,
    /// 1/m [1/kg]; 0 for one that stands.
    inverse_mass: f64,
}

/// The step that is critical for a pair of bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct CriticalStep {
    /// 2/ω [s].
    pub step: f64,
    pub body: usize,
    /// The body it touches; `None` for a wall.
    pub partner: Option<usize>,
}

impl GranularScene {
    /// Smallest critical step of any contact between two spheres, or a sphere and a plane, that
    /// may come to pass between `bodies`: each sphere against the planes, the stiffest and the
    /// lightest other. Rigid clumps are left out: their mass is not known here. `None` when nothing
    /// can touch. Under Hertz's law the bodies meet at `speed` [m/s]; linear springs do not ask.
    /// `plates` are 1/m of the walls [1/kg], planes before meshes, where forces move them; walls that are
    /// left out stand.
    pub fn critical_step_of_one_contact(
        &self,
        bodies: &[Body],
        speed: f64,
        plates: &[f64],
    ) -> Option<CriticalStep> {
        let mut spheres: Vec<Partner<'_>> = Vec::new();
        let mut number = 0;
        for body in bodies {
            self.add_partners(number, body, &mut spheres);
            number += body.numbers();
        }
        let stiffness = |partner: &Partner<'_>| partner.material.normal_stiffness(partner.radius);
        let most = |value: &dyn Fn(&Partner<'_>) -> f64| {
            let mut order: Vec<usize> = (0..spheres.len()).collect();
            order.sort_by(|a, b| value(&spheres[*b]).total_cmp(&value(&spheres[*a])));
            order.truncate(2);
            order
        };
        let mut others = most(&stiffness);
        others.extend(most(&|partner| partner.mobility));
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
                    offer(
                        self.critical_step(sphere, other, speed),
                        sphere.body,
                        Some(other.body),
                    );
                }
            }
        }
        let walls = self.distinct_walls(plates);
        for sphere in extremes_of_each_material(&spheres) {
            for wall in &walls {
                let wall = Partner {
                    material: wall.material,
                    own_stiffness: wall.stiffness,
                    curvature: 0.0,
                    inverse_mass: wall.inverse_mass,
                    mobility: wall.inverse_mass,
                    radius: wall.radius_ratio * sphere.radius,
                    ..*sphere
                };
                offer(self.critical_step(sphere, &wall, speed), sphere.body, None);
            }
        }
        smallest
    }

    /// Walls that differ, each once; `plates` as above.
    fn distinct_walls(&self, plates: &[f64]) -> Vec<Wall<'_>> {
        let planes = self.planes.iter();
        let planes = planes.map(|plane| (&plane.material, 1.0, plane.contact_stiffness_n_per_m));
        let ratio = self.laws.facet_radius_ratio();
        let facets = self.facets.iter().map(|mesh| (&mesh.material, ratio, None));
        let inverse_masses = plates.iter().copied().chain(std::iter::repeat(0.0));
        let walls = planes.chain(facets).zip(inverse_masses);
        let mut seen = BTreeSet::new();
        let walls = walls.filter(|((name, ratio, stiffness), inverse_mass)| {
            let numbers = [*ratio, *inverse_mass].map(f64::to_bits);
            seen.insert((*name, numbers, stiffness.map(f64::to_bits)))
        });
        let walls = walls.filter_map(|((name, radius_ratio, stiffness), inverse_mass)| {
            Some(Wall {
                material: self.materials.get(name)?,
                radius_ratio,
                stiffness,
                inverse_mass,
            })
        });
        walls.collect()
    }

    /// Spheres that move on their own, of a body that begins at `number`.
    fn add_partners<'a>(&'a self, number: usize, body: &'a Body, to: &mut Vec<Partner<'a>>) {
        let Some(material) = self.materials.get(&body.material) else {
            return;
        };
        if body.clump.is_some() {
            return;
        }
        for (place, (_, radius)) in body.spheres().enumerate() {
            let mass =
                material.density_kg_per_m3 * 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
            to.push(Partner {
                body: number + place,
                material,
                radius,
                own_stiffness: None,
                curvature: 1.0 / radius,
                inverse_mass: if body.is_movable() { 1.0 / mass } else { 0.0 },
                mobility: if body.is_held() { 0.0 } else { 1.0 / mass },
            });
        }
    }

    /// Twice the largest speed of `bodies` at the start [m/s]: that of two bodies that meet.
    pub fn first_speed(bodies: &[Body]) -> f64 {
        let squares = bodies.iter().map(|body| {
            let components = body.velocity_m_per_s.iter();
            components
                .map(|component| component * component)
                .sum::<f64>()
        });
        2.0 * squares.fold(0.0, f64::max).sqrt()
    }

    /// 2/ω of two spheres in contact [s]; infinite when neither moves.
    fn critical_step(&self, a: &Partner<'_>, b: &Partner<'_>, speed: f64) -> f64 {
        let mobility = a.mobility + b.mobility;
        let is_bonded = a.material.parallel_bond.is_some() && b.material.parallel_bond.is_some();
        let is_rough =
            is_bonded || a.material.friction_angle().min(b.material.friction_angle()) > 0.0;
        let [normal, shear] = match self.laws.contact {
            ContactLaw::Linear | ContactLaw::Logarithmic => linear_stiffness(a, b),
            // an impact is stopped by what moves along the normal
            ContactLaw::HertzMindlin => {
                hertz_stiffness(a, b, a.inverse_mass + b.inverse_mass, speed)
            }
        };
        let shear_alone = shear;
        let bond = self.bond_stiffness(a, b);
        let normal = normal + bond[0];
        let shear = shear + bond[1];
        let shear = if is_rough {
            shear * (1.0 + SPHERE_ROTATION)
        } else {
            0.0
        };
        let [first, second] = [a, b].map(|partner| partner.material.damping_ratios());
        let [along, across] = [0, 1].map(|way: usize| first[way].max(second[way]));
        let rolling = a.material.rolling().with(&b.material.rolling());
        let is_resisting = rolling.is_felt();
        let turning = if is_resisting {
            let radius = hertz::effective_radius(a.curvature, b.curvature);
            let turning = [a, b].map(|side| side.mobility * side.curvature * side.curvature);
            let stiffness = rolling.stiffness_ratio * shear_alone * radius * radius;
            stiffness * SPHERE_ROTATION * (turning[0] + turning[1])
        } else {
            0.0
        };
        let turns =
            [a, b].map(|side| side.mobility * side.curvature * side.curvature * SPHERE_ROTATION);
        let turning = turning + bond[2].max(bond[3]) * (turns[0] + turns[1]);
        let step = |square: f64, ratio: f64| 2.0 / square.sqrt() * step_with_dashpot(ratio);
        // a dashpot along the normal counts across it too, which is on the safe side
        let turning_damping = if is_resisting {
            rolling.damping_ratio
        } else {
            0.0
        };
        let across = across.max(along).max(turning_damping);
        step(normal * mobility, along).min(step(shear * mobility + turning, across))
    }

    /// Stiffnesses of the bond that two spheres which touch would have, 0 where there is none.
    fn bond_stiffness(&self, a: &Partner<'_>, b: &Partner<'_>) -> [f64; 4] {
        let is_pair = a.curvature > 0.0 && b.curvature > 0.0;
        match (a.material.parallel_bond, b.material.parallel_bond) {
            (Some(own), Some(other)) if is_pair => {
                let length = a.radius + b.radius;
                own.with(&other).stiffnesses(a.radius.min(b.radius), length)
            }
            _ => [0.0; 4],
        }
    }
}

/// Of the spheres of a material that move, the first of the smallest, which a wall shakes fastest:
/// k ∝ r under every law and m ∝ r³, so that ω ∝ 1/r. A plate that moves is shaken most by the largest,
/// for k ∝ r: that of the spheres that move and of those that are held, which are as stiff.
fn extremes_of_each_material<'p, 'a>(spheres: &'p [Partner<'a>]) -> Vec<&'p Partner<'a>> {
    let mut smallest: BTreeMap<*const Material, &Partner<'a>> = BTreeMap::new();
    let mut largest: BTreeMap<(*const Material, bool), &Partner<'a>> = BTreeMap::new();
    for sphere in spheres {
        let moves = sphere.mobility > 0.0;
        let known = largest.entry((sphere.material, moves)).or_insert(sphere);
        if sphere.radius > known.radius {
            *known = sphere;
        }
        if !moves {
            continue;
        }
        let known = smallest.entry(sphere.material).or_insert(sphere);
        if sphere.radius < known.radius {
            *known = sphere;
        }
    }
    let mut extremes: Vec<_> = smallest
        .into_values()
        .chain(largest.into_values())
        .collect();
    // addresses say nothing, numbers do
    extremes.sort_by_key(|sphere| sphere.body);
    extremes
}

/// K_N and K_T [N/m].
fn linear_stiffness(a: &Partner<'_>, b: &Partner<'_>) -> [f64; 2] {
    let [first, second] = [a.stiffnesses(), b.stiffnesses()];
    [0, 1].map(|way: usize| series_stiffness(first[way], second[way]))
}

/// Tangents k_N and k_T [N/m] where an impact stops; k_T/k_N = 4 G*/E*.
fn hertz_stiffness(a: &Partner<'_>, b: &Partner<'_>, inverse_mass: f64, speed: f64) -> [f64; 2] {
    if inverse_mass == 0.0 {
        return [0.0; 2];
    }
    let [first, second] = [a, b].map(|partner| Solid {
        youngs_modulus: partner.material.youngs_modulus_pa,
        poisson_ratio: partner.material.poisson_ratio(),
    });
    let modulus = hertz::effective_modulus(first, second);
    let radius = hertz::effective_radius(a.curvature, b.curvature);
    let normal = hertz::impact_stiffness(modulus, radius, inverse_mass, speed);
    let ratio = 4.0 * hertz::effective_shear_modulus(first, second) / modulus;
    [normal, ratio * normal]
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    /// E 2r, and its ratio in shear.
    const STIFFNESS: f64 = 1e7 * 0.02;
    const RATIO: f64 = 0.3;
    const ROUND_OFF: f64 = 1e-12;

    /// Critical step of a sphere of 1 cm that is held along `fixed`, on a plane, and of a free one of twice the
    /// radius if asked for; with the mass of the first [kg].
    fn critical(fixed: &[&str], has_partner: bool, law: &str) -> (Option<f64>, f64) {
        let mut bodies = vec![json!({"sphere": {"radius_m": 0.01}, "material": "stone",
                                     "position_m": [0, 0, 0], "fixed": fixed})];
        if has_partner {
            bodies.push(json!({"sphere": {"radius_m": 0.02}, "material": "stone",
                               "position_m": [0, 0, 1]}));
        }
        let plane = json!({"name": "base", "axis": "z", "position_m": -0.01, "facing": 1, "material": "stone"});
        let scene: GranularScene = serde_json::from_value(json!({
            "version": 1, "bodies": bodies,
            "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e7,
                                    "stiffness_ratio": RATIO, "friction_angle_rad": 0.4}},
            "planes": if has_partner { json!([]) } else { json!([plane]) },
            "laws": {"contact": law},
            "stages": [{"run": {"steps": 1}}]
        }))
        .expect("a scene");
        let found = scene.critical_step_of_one_contact(&scene.bodies, 1.0, &[]);
        let mass = 2600.0 * 4.0 / 3.0 * std::f64::consts::PI * 1e-6;
        (found.map(|found| found.step), mass)
    }

    fn assert_step((found, _): (Option<f64>, f64), square: f64) {
        let (found, expected) = (found.expect("they may touch"), 2.0 / square.sqrt());
        assert!(
            (found / expected - 1.0).abs() < ROUND_OFF,
            "{found} {expected}"
        );
    }

    #[test]
    fn a_sphere_that_only_turns_is_shaken_by_what_it_touches() {
        let turning = ["x", "y", "z"];
        // of two equal springs in series; r²/I = 5/2 1/m
        let at_plane = critical(&turning, false, "linear");
        let across = 0.5 * STIFFNESS * RATIO * 3.5;
        assert_step(at_plane, across.max(0.5 * STIFFNESS) / at_plane.1);
        assert_eq!(at_plane, critical(&[], false, "linear"));
        // of one sphere and one of twice its radius, eight times its mass
        let at_sphere = critical(&turning, true, "linear");
        let across = STIFFNESS * 2.0 / 3.0 * RATIO * 3.5;
        assert_step(at_sphere, across * (1.0 + 0.125) / at_sphere.1);
        assert_eq!(at_sphere, critical(&[], true, "linear"));
        // an impact at it is no softer than at one that is wholly held
        let hertz = |fixed: &[&str]| critical(fixed, true, "hertz_mindlin").0.expect("a step");
        let whole = ["x", "y", "z", "rx", "ry", "rz"];
        let expected = hertz(&whole) * (0.125_f64 / 1.125).sqrt();
        assert!((hertz(&turning) / expected - 1.0).abs() < ROUND_OFF);
    }

    #[test]
    fn a_sphere_that_is_held_is_shaken_by_nothing() {
        let whole = ["x", "y", "z", "rx", "ry", "rz"];
        assert_eq!(critical(&whole, false, "linear").0, None);
        let at_sphere = critical(&whole, true, "linear");
        let across = STIFFNESS * 2.0 / 3.0 * RATIO * 3.5;
        assert_step(at_sphere, across * 0.125 / at_sphere.1);
    }
}
