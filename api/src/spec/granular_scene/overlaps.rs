//! Bodies that sit in each other, behind a plane or in facets, at the start.
use std::collections::BTreeMap;
use std::ops::ControlFlow;

use super::sphere_tree::{Bounds, Particle, SphereTree};
use super::{Body, BondRestLength, GranularScene, Material, Plane};
use crate::violations::LISTED_OF_A_SORT;
use crate::{
    Violation, Violations,
    surface::{Triangle, bounds, closest_point, cross, dot, length, minus},
};

/// The search ends at this many: who has put all bodies into one place has half their square.
const MOST_FOUND: usize = 10_000;
/// Pairs that are looked at for each sphere and triangle, at most, beside some for small scenes. A
/// sphere among others of its size has 12 neighbours, and twice as many boxes meet its own; spheres that
/// are crowded beyond this, bonded or to be relaxed, could not be run either.
const LOOKS: usize = 200;
const FIRST_LOOKS: usize = 1_000_000;

/// Two spheres, or a sphere and a wall, that overlap too much.
struct Overlap {
    body: usize,
    number: usize,
    /// What the other is, in words.
    other: String,
    /// Over the smaller radius.
    ratio: f64,
    is_same_place: bool,
}

/// The worst overlaps, and how many there are.
#[derive(Default)]
struct Worst {
    listed: Vec<Overlap>,
    count: usize,
    /// Whether the search was ended before all were found.
    is_cut: bool,
}

impl Worst {
    fn offer(
        &mut self,
        particle: &Particle,
        ratio: f64,
        is_same_place: bool,
        other: impl FnOnce() -> String,
    ) {
        self.count += 1;
        let place = self.listed.partition_point(|known| {
            let order = known.ratio.total_cmp(&ratio).reverse();
            order.then(known.body.cmp(&particle.body)).is_le()
        });
        if place < LISTED_OF_A_SORT {
            self.listed.truncate(LISTED_OF_A_SORT - 1);
            let overlap = Overlap {
                body: particle.body,
                number: particle.number,
                other: other(),
                ratio,
                is_same_place,
            };
            self.listed.insert(place, overlap);
        }
    }
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
    violations: &mut Violations,
) {
    let mut worst = Worst::default();
    let tree = SphereTree::new(particles(bodies));
    let searched = between_bodies(spec, bodies, &tree, largest_ratio, &mut worst);
    behind_planes(spec, &tree, largest_ratio, &mut worst);
    let searched = match searched {
        ControlFlow::Continue(()) => in_facets(spec, &tree, largest_ratio, &mut worst),
        crowded @ ControlFlow::Break(_) => crowded,
    };
    if let ControlFlow::Break(Crowded { place, what }) = searched
        && worst.count == 0
    {
        let detail = format!("too many {what} are in one place");
        violations.push(
            Violation::new(place, "crowded", detail)
                .allowed(format!("about {LOOKS} neighbours of each, on average")),
        );
    }
    let more = match worst.count {
        count if worst.is_cut => format!(" (more than {} such overlaps)", count - 1),
        count if count > LISTED_OF_A_SORT => format!(" ({count} such overlaps in all)"),
        _ => String::new(),
    };
    for overlap in worst.listed {
        violations.push(overlap.violation(spec, largest_ratio, &more));
    }
}

impl Overlap {
    fn violation(self, spec: &GranularScene, largest_ratio: f64, more: &str) -> Violation {
        let pointer = if self.body < spec.bodies.len() {
            format!("/bodies/{}/position_m", self.body)
        } else {
            "/import".to_owned()
        };
        if self.is_same_place {
            let detail = format!(
                "body {} has its centre where {} has its own{more}",
                self.number, self.other
            );
            return Violation::new(pointer, "equal_centres", detail).allowed("places of their own");
        }
        let detail = format!("body {} sits in {}{more}", self.number, self.other);
        Violation::new(pointer, "overlap", detail)
            .value(self.ratio)
            .allowed(format!(
                "overlap ≤ {largest_ratio} of the smaller radius, a first stage that relaxes, or a larger /largest_overlap_at_start if it is meant"
            ))
            .unit("1")
    }
}

fn particles(bodies: &[Body]) -> Vec<Particle> {
    let mut particles = Vec::new();
    let mut first = 0;
    for (body, shape) in bodies.iter().enumerate() {
        let is_held = shape.is_held();
        let spheres = shape.spheres().enumerate();
        particles.extend(spheres.map(|(place, (centre, radius))| Particle {
            body,
            // the members of a rigid clump share its number
            number: first + place.min(shape.numbers() - 1),
            centre,
            radius,
            is_held,
        }));
        first += shape.numbers();
    }
    particles
}

/// More pairs to look at than a scene can have.
struct Crowded {
    place: &'static str,
    what: &'static str,
}

/// Looks that are left.
struct Looks(usize);

impl Looks {
    fn for_each_of(count: usize) -> Self {
        Self(count.saturating_mul(LOOKS).saturating_add(FIRST_LOOKS))
    }

    fn take(&mut self) -> ControlFlow<()> {
        match self.0.checked_sub(1) {
            Some(left) => {
                self.0 = left;
                ControlFlow::Continue(())
            }
            None => ControlFlow::Break(()),
        }
    }
}

/// Each sphere that moves against those that are held, and those that come after it in the tree.
fn between_bodies(
    spec: &GranularScene,
    bodies: &[Body],
    tree: &SphereTree,
    largest_ratio: f64,
    worst: &mut Worst,
) -> ControlFlow<Crowded> {
    let mut looks = Looks::for_each_of(tree.particles.len());
    for (place, first) in tree.particles.iter().enumerate() {
        if first.is_held {
            continue;
        }
        let own = Bounds::of(first);
        let searched = tree.visit(
            Some(first.number),
            |bounds| bounds.meets(&own),
            |other| {
                looks.take()?;
                let second = &tree.particles[other];
                if second.is_held || other > place {
                    offer_pair(spec, bodies, [first, second], largest_ratio, worst);
                }
                if worst.count > MOST_FOUND {
                    worst.is_cut = true;
                    return ControlFlow::Break(());
                }
                ControlFlow::Continue(())
            },
        );
        if searched.is_break() {
            return ControlFlow::Break(Crowded {
                place: "/bodies",
                what: "spheres",
            });
        }
    }
    ControlFlow::Continue(())
}

fn offer_pair(
    spec: &GranularScene,
    bodies: &[Body],
    [first, second]: [&Particle; 2],
    largest_ratio: f64,
    worst: &mut Worst,
) {
    let distance = length(&minus(&second.centre, &first.centre));
    let reach = first.radius + second.radius;
    let ratio = (reach - distance) / first.radius.min(second.radius);
    if ratio <= largest_ratio && distance > 0.0 {
        return;
    }
    let (low, high) = if first.number < second.number {
        (first, second)
    } else {
        (second, first)
    };
    let pair = [low, high].map(|particle| &bodies[particle.body]);
    let is_same_place = distance == 0.0;
    let may_bond = low.body == high.body || pair.iter().all(|body| body.sphere.is_some());
    if may_bond && !is_same_place && rests_in_a_bond(spec, pair) {
        return;
    }
    worst.offer(high, ratio, is_same_place, || {
        format!("body {}", low.number)
    });
}

/// Whether the bodies will be bonded at the distance they have.
fn rests_in_a_bond(spec: &GranularScene, bodies: [&Body; 2]) -> bool {
    let is_cohesive = |body: &Body| {
        let material = spec.materials.get(&body.material);
        material.is_some_and(Material::is_cohesive)
    };
    spec.laws.bond_rest_length == BondRestLength::Initial && bodies.into_iter().all(is_cohesive)
}

/// Of planes that face the same way, plates apart from walls, the one that stands farthest that way: who is
/// behind another is behind this one. And whether it is a plate, which is thrown off bodies that are held
/// too.
fn tightest_planes(spec: &GranularScene) -> impl Iterator<Item = (&Plane, bool)> {
    let mut tightest: BTreeMap<(usize, i8, bool), &Plane> = BTreeMap::new();
    let reach = |plane: &Plane| plane.position_m * f64::from(plane.facing);
    for plane in &spec.planes {
        let is_plate = spec.mass_of_wall(&plane.name).is_some();
        let way = (plane.axis.index(), plane.facing, is_plate);
        let known = tightest.entry(way).or_insert(plane);
        if reach(plane) > reach(known) {
            *known = plane;
        }
    }
    let tightest = tightest.into_iter();
    tightest.map(|((.., is_plate), plane)| (plane, is_plate))
}

fn behind_planes(spec: &GranularScene, tree: &SphereTree, largest_ratio: f64, worst: &mut Worst) {
    for (plane, is_plate) in tightest_planes(spec) {
        let feels = |particle: &&Particle| is_plate || !particle.is_held;
        for particle in tree.particles.iter().filter(feels) {
            let height = particle.centre[plane.axis.index()] - plane.position_m;
            let overlap = particle.radius - height * f64::from(plane.facing);
            let ratio = overlap / particle.radius;
            if ratio > largest_ratio {
                worst.offer(particle, ratio, false, || {
                    format!("or behind plane {:?}", plane.name)
                });
            }
        }
    }
}

/// A box that a triangle may reach into: it meets the triangle's own box and its plane.
fn reaches(triangle: &Triangle) -> impl Fn(&Bounds) -> bool {
    let [lower, upper] = bounds(triangle);
    let own = Bounds { lower, upper };
    let [a, b, c] = *triangle;
    let normal = cross(&minus(&b, &a), &minus(&c, &a));
    let height = dot(&normal, &a);
    move |bounds| {
        let half = |axis: usize| 0.5 * (bounds.upper[axis] - bounds.lower[axis]);
        let middle = std::array::from_fn(|axis| bounds.lower[axis] + half(axis));
        let extent: f64 = (0..3).map(|axis| normal[axis].abs() * half(axis)).sum();
        // round-off of far away places must not turn away what touches
        let slack = 1e-9 * (extent + height.abs());
        own.meets(bounds) && (dot(&normal, &middle) - height).abs() <= extent + slack
    }
}

fn in_facets(
    spec: &GranularScene,
    tree: &SphereTree,
    largest_ratio: f64,
    worst: &mut Worst,
) -> ControlFlow<Crowded> {
    if largest_ratio.is_infinite() {
        return ControlFlow::Continue(());
    }
    for mesh in &spec.facets {
        let is_plate = spec.mass_of_wall(&mesh.name).is_some();
        let triangles = mesh.triangles().unwrap_or_default();
        let mut looks = Looks::for_each_of(triangles.len() + tree.particles.len());
        for (number, triangle) in triangles.iter().enumerate() {
            let searched = tree.visit(None, reaches(triangle), |place| {
                looks.take()?;
                let particle = &tree.particles[place];
                if particle.is_held && !is_plate {
                    return ControlFlow::Continue(());
                }
                let closest = closest_point(triangle, &particle.centre).position;
                let distance = length(&minus(&closest, &particle.centre));
                let ratio = (particle.radius - distance) / particle.radius;
                if ratio > largest_ratio {
                    worst.offer(particle, ratio, false, || {
                        format!("triangle {number} of facets {:?}", mesh.name)
                    });
                }
                ControlFlow::Continue(())
            });
            if searched.is_break() {
                return ControlFlow::Break(Crowded {
                    place: "/facets",
                    what: "triangles and spheres",
                });
            }
        }
    }
    ControlFlow::Continue(())
}
