//! Making the lists of candidates: order, patches, pairs, walls, facets; the past of contacts is kept.
pub(crate) mod memories;
pub(crate) mod sides;

use std::ops::Range;

use loadframe_numerics::Team;

use memories::Memories;

use super::{
    alone::{self, Mobility, Other},
    patch::{Incoming, Patch},
};
use crate::{
    contact::{WATCHES, chosen::Chosen, lists::Lists, past::Past, stiffness::Springs},
    geometry::neighbours::{
        grid::{Candidates, candidates},
        order::along_curve,
    },
    motion::{clump::Clump, spheres::PartlyFixed},
    numbers::Vector,
    scene::{model::Model, particles::Particles},
    walls::{
        Face,
        facets::{Pose, search::Search},
    },
};

/// Particles of a mean patch, at most: enough work to share out (about 0.1 ms), few enough to stay in a
/// core's own cache together with their contacts.
const PATCH: usize = 2048;
/// Work that a candidate makes in a step, in that of a particle: contacts are with the first of their
/// two particles, so that early patches have more of them.
const WORK_OF_CANDIDATE: usize = 2;

/// Sorts particles and clumps along a curve through space, members with their clump.
pub(crate) fn sort(particles: &mut Particles, clumps: &mut Vec<Clump>) {
    /// A body's particles and, for a clump, its place among the clumps.
    struct Unit {
        particles: Range<usize>,
        clump: Option<usize>,
    }
    let mut units = Vec::with_capacity(particles.len());
    let mut centres: Vec<Vector> = Vec::with_capacity(particles.len());
    let mut next = 0;
    for (place, clump) in clumps.iter().enumerate() {
        let members = clump.members();
        units.extend((next..members.start).map(|single| Unit {
            particles: single..single + 1,
            clump: None,
        }));
        next = members.end;
        units.push(Unit {
            particles: members,
            clump: Some(place),
        });
    }
    units.extend((next..particles.len()).map(|single| Unit {
        particles: single..single + 1,
        clump: None,
    }));
    for unit in &units {
        centres.push(match unit.clump {
            Some(clump) => clumps[clump].centre,
            None => particles.centres[unit.particles.start].vector(),
        });
    }
    let mut order: Vec<u32> = Vec::with_capacity(particles.len());
    let mut sorted = Vec::with_capacity(clumps.len());
    for unit in along_curve(&centres) {
        let unit = &units[unit as usize];
        if let Some(clump) = unit.clump {
            let mut clump = clumps[clump].clone();
            clump.first = order.len() as u32;
            sorted.push(clump);
        }
        order.extend(unit.particles.clone().map(|particle| particle as u32));
    }
    particles.reorder(&order);
    *clumps = sorted;
}

/// What lists of candidates are made from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Listing<'a> {
    pub(crate) law: &'a Chosen,
    pub(crate) model: &'a Model,
    pub(crate) faces: &'a [Face],
    pub(crate) poses: &'a [Pose],
    /// Prepared for these particles and this skin, where there are facets.
    pub(crate) search: &'a Search,
    pub(crate) particles: &'a Particles,
    /// Bits of the degrees of freedom that are held now of each particle's body.
    pub(crate) held: &'a [u8],
    pub(crate) memories: &'a Memories,
    /// 1/m of each wall that follows forces now [1/kg], 0 of the others.
    pub(crate) plates: &'a [f64],
    /// Bits of the degrees of freedom that each wall does not follow forces along.
    pub(crate) walls_held: &'a [u8],
    /// Walls whose contacts are added up.
    pub(crate) followers: &'a [bool],
    /// What tan φ of new contacts is multiplied with, where others keep theirs.
    pub(crate) kept_friction: Option<f64>,
    /// Distance of surfaces below which bodies are listed [m].
    pub(crate) skin: f64,
}

/// A patch whose lists are being filled.
struct Filling<'a> {
    range: Range<usize>,
    lists: &'a mut dyn Lists,
    /// Of all particles.
    mobilities: &'a [Mobility],
    alone: alone::Candidates<'a>,
    at_plates: Vec<[f64; 2]>,
}

impl Filling<'_> {
    /// A candidate of two particles, or of one and a wall; `radius` is the smaller one [m].
    fn see(
        &mut self,
        listing: &Listing<'_>,
        [a, b]: [u32; 2],
        wall: Option<usize>,
        radius: f64,
        springs: &Springs,
    ) {
        if let Some(wall) = wall.filter(|wall| listing.followers[*wall]) {
            self.at_plates.resize(listing.plates.len(), [0.0; 2]);
            let found = alone::at_wall(listing.law, listing.model.is_rough, radius, springs);
            for (sum, part) in self.at_plates[wall].iter_mut().zip(found) {
                *sum += part;
            }
        }
        if !WATCHES {
            return;
        }
        let owner = |particle: u32| listing.particles.owners[particle as usize];
        let own = &self.mobilities[a as usize];
        let (partner, other) = match wall {
            Some(wall) => {
                let number = listing.model.masses.len() + wall;
                (number as u32, Other::Wall(listing.plates[wall]))
            }
            None => (owner(b), Other::Body(self.mobilities[b as usize])),
        };
        (self.alone).add([owner(a), partner], own, &other, radius, springs);
    }
}

impl Listing<'_> {
    /// How easily each particle is pushed away.
    fn mobilities(&self, clumps: &[Clump]) -> Vec<Mobility> {
        let (model, particles) = (self.model, self.particles);
        let of_sphere = |(particle, owner): (usize, &u32)| {
            let body = *owner as usize;
            let inertia = model.sphere_inertias[body];
            if model.is_movable[body] && inertia > 0.0 {
                Mobility::new(model.masses[body], self.radius(particle).powi(2) / inertia)
            } else {
                Mobility::default()
            }
        };
        let owners = particles.owners.iter().enumerate();
        let mut mobilities: Vec<Mobility> = owners.map(of_sphere).collect();
        let movable = |clump: &&Clump| model.is_movable[clump.body as usize];
        for clump in clumps.iter().filter(movable) {
            for member in clump.members() {
                let turning = clump.turning(&particles.centres[member]);
                mobilities[member] = Mobility::new(clump.mass, turning);
            }
        }
        mobilities
    }

    /// [m].
    fn radius(&self, particle: usize) -> f64 {
        self.particles.centres[particle].0[3]
    }

    /// Cuts the particles into patches and fills the lists of each.
    pub(crate) fn list(&self, clumps: &[Clump], team: &Team) -> (Vec<Patch>, Vec<Box<dyn Lists>>) {
        let centres = &self.particles.centres;
        let stretched = self.memories.stretched_bonds(self.particles, self.skin);
        let candidates = candidates(team, centres, self.skin, stretched, |a, b| {
            self.may_touch(a, b)
        });
        let ranges = cut(&candidates, clumps);
        let mobilities = if WATCHES {
            self.mobilities(clumps)
        } else {
            Vec::new()
        };
        let filled = team.map(ranges, |(particles, clumps)| {
            let mut lists = (self.law.lists)();
            let others = others(particles.clone(), &candidates);
            let mut filling = Filling {
                range: particles.clone(),
                lists: lists.as_mut(),
                mobilities: &mobilities,
                alone: alone::Candidates::new(self.law, self.model),
                at_plates: Vec::new(),
            };
            self.fill_pairs(&others, &candidates, &mut filling);
            self.fill_walls(&mut filling);
            self.fill_facets(&mut filling);
            let (shortest, at_plates) = (filling.alone.shortest(), filling.at_plates);
            lists.finish(self.faces.len());
            let patch = Patch {
                shortest,
                at_plates,
                others,
                partly_fixed: partly_fixed(self.particles, particles.clone()),
                particles,
                clumps,
                ..Patch::default()
            };
            (patch, lists)
        });
        let (mut patches, contact_lists): (Vec<Patch>, Vec<_>) = filled.into_iter().unzip();
        address(&mut patches);
        (patches, contact_lists)
    }

    fn may_touch_wall(&self, body: usize, wall: usize) -> bool {
        let wall = self.model.masses.len() + wall;
        self.model.touching.may_touch(body, wall)
    }

    fn may_touch(&self, a: usize, b: usize) -> bool {
        let [a, b] = [a, b].map(|particle| self.particles.owners[particle] as usize);
        a != b && self.model.touching.may_touch(a, b)
    }

    /// Adds the pairs whose first particle is one of these.
    fn fill_pairs(&self, others: &[u32], candidates: &Candidates, filling: &mut Filling<'_>) {
        let range = filling.range.clone();
        let past =
            |a: usize, b: usize| (self.memories).pair_or_bond(self.model, self.particles, a, b);
        let has_bonds = self.memories.has_bonds();
        let is_bonded = |a, b| has_bonds && past(a, b).is_some_and(|past| past.bond.is_intact);
        let pairs = range.clone().flat_map(|a| {
            let partners = candidates.of(a).iter();
            partners.map(move |b| (a, *b as usize))
        });
        // what is held now comes first, so that blocks of what is not are passed over by one look
        let (held, apart): (Vec<_>, Vec<_>) =
            pairs.partition(|&(a, b)| self.is_touching(a, b) || is_bonded(a, b));
        for pairs in [held, apart] {
            for (a, b) in pairs {
                let past = past(a, b);
                let (own, other) = (self.side(a), self.side(b));
                let springs = (self.law.springs)(&own, &other);
                let springs = self.rubbed(springs, past.as_ref());
                let pair = [a as u32, b as u32];
                let radii = pair.map(|particle| self.radius(particle as usize));
                let held = springs.held(past.as_ref());
                filling.see(self, pair, None, radii[0].min(radii[1]), &held);
                let springs =
                    self.held_back(springs, [own, other], [self.held[a], self.held[b]], || {
                        self.between(a, b)
                    });
                let lists = &mut *filling.lists;
                if range.contains(&b) {
                    lists.add_inner(pair, &springs, past.as_ref());
                } else {
                    let place = others.partition_point(|other| (*other as usize) < b) as u32;
                    lists.add_outer(pair, place, &springs, past.as_ref());
                }
            }
            filling.lists.close_blocks();
        }
    }

    /// With the friction of this contact, where contacts keep theirs.
    fn rubbed(&self, springs: Springs, past: Option<&Past>) -> Springs {
        let Some(factor) = self.kept_friction else {
            return springs;
        };
        let kept = past.and_then(|past| past.friction);
        Springs {
            friction: kept.unwrap_or(factor * springs.friction),
            ..springs
        }
    }

    fn is_touching(&self, a: usize, b: usize) -> bool {
        let [a, b] = [a, b].map(|particle| &self.particles.centres[particle]);
        a.overlap(b) >= 0.0
    }

    fn fill_walls(&self, filling: &mut Filling<'_>) {
        for ((number, plane), face) in self.model.planes.iter().enumerate().zip(self.faces) {
            for particle in filling.range.clone() {
                let centre = &self.particles.centres[particle].0;
                let radius = centre[3];
                let owner = self.particles.owners[particle] as usize;
                if face.height(centre) > radius + self.skin || !self.may_touch_wall(owner, number) {
                    continue;
                }
                let own = self.side(particle);
                let wall = own.wall(self.model.surfaces[plane.surface], self.freedom_of(number));
                let springs = (self.law.springs)(&own, &wall);
                let past = (self.memories).wall(self.particles.numbers[particle], number as u32);
                let springs = self.rubbed(springs, past.as_ref());
                let held = [self.held[particle], self.walls_held[number]];
                let particle = particle as u32;
                filling.see(self, [particle; 2], Some(number), radius, &springs);
                let springs = self.held_back(springs, [own, wall], held, || face.normal().into());
                (filling.lists).add_plane(number, particle, &springs, past.as_ref());
            }
        }
    }

    fn fill_facets(&self, filling: &mut Filling<'_>) {
        let facets = &self.model.facets;
        if facets.facets.is_empty() {
            return;
        }
        let (mut found, mut near) = (Vec::new(), Vec::new());
        for particle in filling.range.clone() {
            let owner = self.particles.owners[particle] as usize;
            let wall_of = |mesh: usize| self.faces.len() + mesh;
            let may_touch = |mesh: usize| self.may_touch_wall(owner, wall_of(mesh));
            if !(0..facets.meshes.len()).any(may_touch) {
                continue;
            }
            let sphere = &self.particles.centres[particle];
            (self.search).near(facets, self.poses, sphere, self.skin, &mut found);
            found.retain(|facet| may_touch(facets.facets[*facet as usize].mesh as usize));
            let own = self.side(particle);
            let number = self.particles.numbers[particle];
            near.clear();
            near.extend(found.iter().map(|facet| {
                let wall = self.facet_side(&own, facets.facets[*facet as usize].mesh as usize);
                let springs = (self.law.springs)(&own, &wall);
                let past = self.memories.facet(number, *facet);
                (*facet, self.rubbed(springs, past.as_ref()), past)
            }));
            for (facet, springs, _) in &mut near {
                let mesh = facets.facets[*facet as usize].mesh as usize;
                let wall = wall_of(mesh);
                filling.see(self, [particle as u32; 2], Some(wall), sphere.0[3], springs);
                let held = [self.held[particle], self.walls_held[wall]];
                let sides = [own, self.facet_side(&own, mesh)];
                *springs = self.held_back(*springs, sides, held, || {
                    facets.towards(self.poses, sphere, *facet).into()
                });
            }
            filling.lists.add_facets(particle as u32, &near);
        }
    }
}

/// Candidates of the particles in `range` that are in later patches, in order.
fn others(range: Range<usize>, candidates: &Candidates) -> Vec<u32> {
    let near = range.clone().flat_map(|particle| candidates.of(particle));
    let outside = near.filter(|other| !range.contains(&(**other as usize)));
    let mut others: Vec<u32> = outside.copied().collect();
    others.sort_unstable();
    others.dedup();
    others
}

/// Tells every patch what to fetch from the halos of earlier ones.
fn address(patches: &mut [Patch]) {
    for number in 0..patches.len() {
        let (earlier, later) = patches.split_at_mut(number + 1);
        let mut place = 0;
        let others = &earlier[number].others;
        for patch in later {
            let own = &patch.particles;
            let count = others[place..].partition_point(|other| (*other as usize) < own.end);
            if count > 0 {
                let particles = others[place..place + count].iter();
                patch.incoming.push(Incoming {
                    patch: number,
                    place,
                    particles: particles.map(|other| other - own.start as u32).collect(),
                });
            }
            place += count;
        }
    }
}

/// Spheres in `range` with some of their degrees of freedom fixed.
fn partly_fixed(particles: &Particles, range: Range<usize>) -> Vec<PartlyFixed> {
    let fixed = particles.fixed[range].iter().enumerate();
    let partly = fixed.filter(|(_, bits)| {
        let (ways, turns) = (**bits & 0b111, **bits >> 3);
        [ways, turns].iter().any(|bits| !matches!(bits, 0 | 0b111))
    });
    partly
        .map(|(particle, bits)| PartlyFixed::new(particle as u32, *bits))
        .collect()
}

/// Ranges of particles and clumps of each patch, with about equal work; no clump is cut.
fn cut(candidates: &Candidates, clumps: &[Clump]) -> Vec<(Range<usize>, Range<usize>)> {
    let particles = candidates.spheres();
    let mut patches = Vec::new();
    // an even number of equals, so that two threads have the same to do
    let count = match particles.div_ceil(PATCH) {
        1 => 1,
        count => count.next_multiple_of(2),
    };
    let work_before = |particle: usize| particle + WORK_OF_CANDIDATE * candidates.before(particle);
    let total = work_before(particles);
    let (mut first, mut first_clump, mut clump) = (0, 0, 0);
    while first < particles {
        let share = (patches.len() + 1) * total / count;
        let mut end = first + 1;
        while end < particles && work_before(end) < share {
            end += 1;
        }
        while clump < clumps.len() && (clumps[clump].first as usize) < end {
            end = end.max(clumps[clump].members().end);
            clump += 1;
        }
        patches.push((first..end, first_clump..clump));
        (first, first_clump) = (end, clump);
    }
    patches
}
