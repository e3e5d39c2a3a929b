//! Bodies that sit in each other, behind a plane or in facets, at the start.
use super::{Body, BondRestLength, GranularScene, Material};
use crate::{
    Violation,
    surface::{bounds, closest_point, length, minus},
};

/// At most this many are listed; the worst comes first.
const LISTED: usize = 20;

/// A sphere of a body.
struct Particle {
    /// Place among the bodies, and its number.
    body: usize,
    number: usize,
    centre: [f64; 3],
    radius: f64,
}

/// Two spheres, or a sphere and a plane, that overlap too much.
struct Overlap {
    body: usize,
    number: usize,
    /// What the other is, in words.
    other: String,
    /// Over the smaller radius.
    ratio: f64,
    is_same_place: bool,
}

impl Body {
    /// Centre and radius [m] of each sphere at the start.
    pub fn spheres(&self) -> impl Iterator<Item = ([f64; 3], f64)> {
        let sphere = self.sphere.iter().map(|sphere| ([0.0; 3], sphere.radius_m));
        let members = self.members().into_iter().flat_map(|clump| &clump.members);
        let members = members.map(|member| (member.offset_m, member.radius_m));
        sphere.chain(members).map(|(offset, radius)| {
            let centre = std::array::from_fn(|axis| self.position_m[axis] + offset[axis]);
            (centre, radius)
        })
    }

    /// Radius of the smallest sphere [m].
    pub fn smallest_radius(&self) -> f64 {
        let radii = self.spheres().map(|(_, radius)| radius);
        radii.fold(f64::INFINITY, f64::min)
    }
}

/// Checks `bodies`, of which the first are those of the spec.
pub(super) fn check(
    spec: &GranularScene,
    bodies: &[Body],
    largest_ratio: f64,
    violations: &mut Vec<Violation>,
) {
    let mut particles: Vec<Particle> = Vec::new();
    let mut first = 0;
    for (body, shape) in bodies.iter().enumerate() {
        particles.extend(
            shape
                .spheres()
                .enumerate()
                .map(|(place, (centre, radius))| {
                    // the members of a rigid clump share its number
                    let place = place.min(shape.numbers() - 1);
                    Particle {
                        body,
                        number: first + place,
                        centre,
                        radius,
                    }
                }),
        );
        first += shape.numbers();
    }
    let mut overlaps = between_bodies(spec, bodies, &mut particles, largest_ratio);
    overlaps.extend(behind_planes(spec, bodies, &particles, largest_ratio));
    overlaps.extend(in_facets(spec, bodies, &particles, largest_ratio));
    overlaps.sort_by(|a, b| b.ratio.total_cmp(&a.ratio).then(a.body.cmp(&b.body)));
    let count = overlaps.len();
    for overlap in overlaps.into_iter().take(LISTED) {
        let pointer = if overlap.body < spec.bodies.len() {
            format!("/bodies/{}/position_m", overlap.body)
        } else {
            "/import".to_owned()
        };
        let more = if count > LISTED {
            format!(" ({count} such overlaps in all)")
        } else {
            String::new()
        };
        let violation = if overlap.is_same_place {
            let detail = format!(
                "body {} has its centre where {} has its own{more}",
                overlap.number, overlap.other
            );
            Violation::new(pointer, "equal_centres", detail).allowed("places of their own")
        } else {
            let detail = format!("body {} sits in {}{more}", overlap.number, overlap.other);
            Violation::new(pointer, "overlap", detail)
                .value(overlap.ratio)
                .allowed(format!(
                    "overlap ≤ {largest_ratio} of the smaller radius, or a first stage that relaxes"
                ))
                .unit("1")
        };
        violations.push(violation);
    }
}

/// Sweeps along x: of all spheres whose lower ends are sorted, only those that begin before one
/// ends can touch it.
fn between_bodies(
    spec: &GranularScene,
    bodies: &[Body],
    particles: &mut [Particle],
    largest_ratio: f64,
) -> Vec<Overlap> {
    particles.sort_by(|a, b| (a.centre[0] - a.radius).total_cmp(&(b.centre[0] - b.radius)));
    let mut overlaps = Vec::new();
    for (index, first) in particles.iter().enumerate() {
        let end = first.centre[0] + first.radius;
        for second in &particles[index + 1..] {
            if second.centre[0] - second.radius > end {
                break;
            }
            let away = |axis: usize| second.centre[axis] - first.centre[axis];
            let reach = first.radius + second.radius;
            if away(1).abs() > reach || first.number == second.number {
                continue;
            }
            let distance = (0..3).map(|axis| away(axis).powi(2)).sum::<f64>().sqrt();
            let ratio = (reach - distance) / first.radius.min(second.radius);
            if ratio <= largest_ratio && distance > 0.0 {
                continue;
            }
            let (low, high) = if first.number < second.number {
                (first, second)
            } else {
                (second, first)
            };
            let pair = [low, high].map(|particle| &bodies[particle.body]);
            if pair.iter().all(|body| body.is_held()) {
                continue;
            }
            let is_same_place = distance == 0.0;
            let may_bond = low.body == high.body || pair.iter().all(|body| body.sphere.is_some());
            if may_bond && rests_in_a_bond(spec, pair) && !is_same_place {
                continue;
            }
            overlaps.push(Overlap {
                body: high.body,
                number: high.number,
                other: format!("body {}", low.number),
                ratio,
                is_same_place,
            });
        }
    }
    overlaps
}

/// Whether the bodies will be bonded at the distance they have.
fn rests_in_a_bond(spec: &GranularScene, bodies: [&Body; 2]) -> bool {
    let is_cohesive = |body: &Body| {
        let material = spec.materials.get(&body.material);
        material.is_some_and(Material::is_cohesive)
    };
    spec.laws.bond_rest_length == BondRestLength::Initial && bodies.into_iter().all(is_cohesive)
}

fn behind_planes(
    spec: &GranularScene,
    bodies: &[Body],
    particles: &[Particle],
    largest_ratio: f64,
) -> Vec<Overlap> {
    let mut overlaps = Vec::new();
    let is_held = |particle: &Particle| bodies[particle.body].is_held();
    for plane in &spec.planes {
        // a plate is thrown off bodies that are held, too
        let mass = spec.mass_of_wall(&plane.name);
        for particle in particles {
            let height = particle.centre[plane.axis.index()] - plane.position_m;
            let overlap = particle.radius - height * f64::from(plane.facing);
            let ratio = overlap / particle.radius;
            if ratio > largest_ratio && !(is_held(particle) && mass.is_none()) {
                overlaps.push(Overlap {
                    body: particle.body,
                    number: particle.number,
                    other: format!("or behind plane {:?}", plane.name),
                    ratio,
                    is_same_place: false,
                });
            }
        }
    }
    overlaps
}

/// Spheres come sorted by their lower ends along x: of those, a triangle can meet only the ones that
/// begin before it ends, and not farther before it begins than the largest of them is wide.
fn in_facets(
    spec: &GranularScene,
    bodies: &[Body],
    particles: &[Particle],
    largest_ratio: f64,
) -> Vec<Overlap> {
    let low = |particle: &Particle| particle.centre[0] - particle.radius;
    let radii = particles.iter().map(|particle| particle.radius);
    let widest = 2.0 * radii.fold(0.0, f64::max);
    let mut overlaps = Vec::new();
    for mesh in &spec.facets {
        let mass = spec.mass_of_wall(&mesh.name);
        for (number, triangle) in mesh.triangles().unwrap_or_default().iter().enumerate() {
            let [lower, upper] = bounds(triangle);
            let first = particles.partition_point(|particle| low(particle) < lower[0] - widest);
            let near = particles[first..].iter();
            for particle in near.take_while(|particle| low(particle) <= upper[0]) {
                let is_apart = (1..3).any(|axis| {
                    let [centre, radius] = [particle.centre[axis], particle.radius];
                    centre - radius > upper[axis] || centre + radius < lower[axis]
                });
                if is_apart || bodies[particle.body].is_held() && mass.is_none() {
                    continue;
                }
                let closest = closest_point(triangle, &particle.centre).position;
                let distance = length(&minus(&closest, &particle.centre));
                let ratio = (particle.radius - distance) / particle.radius;
                if ratio > largest_ratio {
                    overlaps.push(Overlap {
                        body: particle.body,
                        number: particle.number,
                        other: format!("triangle {number} of facets {:?}", mesh.name),
                        ratio,
                        is_same_place: false,
                    });
                }
            }
        }
    }
    overlaps
}
