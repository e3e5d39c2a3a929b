//! What contacts remember while their lists are made anew, and the bonds that are made.
use loadframe_numerics::Team;

use crate::{
    contact::{
        lists::Lists,
        past::{Beam, Bond, Past},
        stiffness::bond_strength,
        touching::Who,
    },
    geometry::neighbours::grid::is_near,
    numbers::Vector,
    scene::{model::Model, particles::Particles},
};

/// What contacts remember, by particle number of the spec, whatever the order in memory.
#[derive(Debug)]
pub(crate) struct Memories {
    /// For each particle, where the entries of those with higher numbers that it touched begin.
    starts: Vec<u32>,
    entries: Vec<Entry>,
    /// Of each patch.
    pairs: Vec<Pairs>,
    /// Particle, plane and past, sorted.
    walls: Vec<((u32, u32), Past)>,
    /// Particle, facet and past, sorted.
    facets: Vec<((u32, u32), Past)>,
    intact_bonds: u64,
    /// Particles with this number and higher ones are new: bonds are made between them.
    newcomers: u32,
}

/// Pairs of a patch.
#[derive(Debug, Default)]
struct Pairs {
    /// The lower number first.
    numbers: Vec<[u32; 2]>,
    /// As seen from the lower one.
    pasts: Vec<Past>,
}

/// Where the past of a pair is.
#[derive(Clone, Copy, Debug, Default)]
struct Entry {
    /// The higher number of the pair.
    high: u32,
    patch: u32,
    place: u32,
}

impl Default for Memories {
    fn default() -> Self {
        Self {
            starts: Vec::new(),
            entries: Vec::new(),
            pairs: Vec::new(),
            walls: Vec::new(),
            facets: Vec::new(),
            intact_bonds: 0,
            newcomers: u32::MAX,
        }
    }
}

/// What the contacts of a patch remember.
#[derive(Default)]
struct Part {
    pairs: Pairs,
    walls: Vec<((u32, u32), Past)>,
    facets: Vec<((u32, u32), Past)>,
    intact_bonds: u64,
}

/// Spheres this part of the smaller radius apart touch when bonds are made: places in a spec are
/// rounded.
const BOND_REACH: f64 = 1e-6;

/// Strengths of a bond of two particles as cohesions are now [N]; `None` when it would not hold.
fn strength_between(model: &Model, particles: &Particles, pair: [usize; 2]) -> Option<[f64; 2]> {
    let [first, second] = pair.map(|particle| {
        let surface = model.surfaces[usize::from(particles.surfaces[particle])];
        (surface, particles.centres[particle].0[3])
    });
    let strength = bond_strength(first, second)?;
    Some(strength.map(|strength| model.cohesion_factor * strength))
}

impl Part {
    fn of(lists: &dyn Lists, particles: &Particles) -> Self {
        let mut part = Self::default();
        part.pairs.numbers.reserve(lists.candidates());
        part.pairs.pasts.reserve(lists.candidates());
        let number = |particle: u32| particles.numbers[particle as usize];
        lists.see(&mut |touching| {
            let past = Past {
                friction: Some(touching.friction),
                ..touching.law.past(touching.lane)
            };
            match touching.who {
                Who::Pair(pair) => {
                    let [a, b] = pair.map(number);
                    part.intact_bonds += u64::from(past.bond.is_intact);
                    let (numbers, past) = if a < b {
                        ([a, b], past)
                    } else {
                        ([b, a], past.seen_from_b())
                    };
                    part.pairs.numbers.push(numbers);
                    part.pairs.pasts.push(past);
                }
                Who::Plane([particle, plane]) => {
                    part.walls.push(((number(particle), plane), past));
                }
                Who::Facet([particle, facet]) => {
                    part.facets.push(((number(particle), facet), past));
                }
            }
        });
        part
    }
}

impl Memories {
    /// Of the contacts that touched in the last step.
    pub(crate) fn of(team: &Team, contacts: &[Box<dyn Lists>], particles: &Particles) -> Self {
        let parts = team.map(contacts.iter().collect(), |lists| {
            Part::of(lists.as_ref(), particles)
        });
        // numbers of particles that were taken out are missing
        let last = particles.numbers.iter().max();
        let numbers = last.map_or(0, |last| *last as usize + 1);
        let mut starts = vec![0_u32; numbers + 1];
        for [low, _] in parts.iter().flat_map(|part| &part.pairs.numbers) {
            starts[*low as usize + 1] += 1;
        }
        for number in 0..numbers {
            starts[number + 1] += starts[number];
        }
        let mut next = starts.clone();
        let mut entries = vec![Entry::default(); starts[numbers] as usize];
        for (patch, part) in (0..).zip(&parts) {
            for (place, [low, high]) in (0..).zip(&part.pairs.numbers) {
                let entry = &mut next[*low as usize];
                entries[*entry as usize] = Entry {
                    high: *high,
                    patch,
                    place,
                };
                *entry += 1;
            }
        }
        let mut memories = Self {
            starts,
            entries,
            intact_bonds: parts.iter().map(|part| part.intact_bonds).sum(),
            ..Self::default()
        };
        for part in parts {
            memories.pairs.push(part.pairs);
            memories.walls.extend(part.walls);
            memories.facets.extend(part.facets);
        }
        memories.walls.sort_by_key(|(key, _)| *key);
        memories.facets.sort_by_key(|(key, _)| *key);
        memories
    }

    /// The same when particles of these numbers come in.
    pub(crate) fn with_newcomers(self, first: u32) -> Self {
        Self {
            newcomers: first,
            ..self
        }
    }

    pub(crate) fn makes_bonds(&self) -> bool {
        self.newcomers < u32::MAX
    }

    pub(crate) fn intact_bonds(&self) -> u64 {
        self.intact_bonds
    }

    /// Whether there are bonds, or some are about to be made.
    pub(crate) fn has_bonds(&self) -> bool {
        self.intact_bonds > 0 || self.makes_bonds()
    }

    /// All springs have changed, from stiffness to stiffness by 1/`ratio` [-]: bonds get the rest
    /// overlap at which they pull as before. The bonds of a grain hold each other under tension, which
    /// no motion could relieve while it grew with the springs, and they would break.
    pub(crate) fn keep_bond_forces(&mut self, particles: &Particles, ratio: f64) {
        let places = self.places(particles);
        let pairs = self.pairs.iter_mut();
        for (numbers, past) in pairs.flat_map(|pairs| pairs.numbers.iter().zip(&mut pairs.pasts)) {
            let [Some(a), Some(b)] = numbers.map(|number| places[number as usize]) else {
                continue;
            };
            if past.bond.is_intact {
                let [a, b] = [a, b].map(|place| &particles.centres[place as usize]);
                let overlap = a.overlap(b);
                let bond = &mut past.bond;
                for rest in [&mut bond.rest, &mut bond.beam.rest] {
                    *rest = overlap - ratio * (overlap - *rest);
                }
            }
        }
    }

    /// Cohesions have changed: bonds have the strengths of today.
    pub(crate) fn renew_strengths(&mut self, model: &Model, particles: &Particles) {
        let places = self.places(particles);
        let pairs = self.pairs.iter_mut();
        for (numbers, past) in pairs.flat_map(|pairs| pairs.numbers.iter().zip(&mut pairs.pasts)) {
            let [Some(a), Some(b)] = numbers.map(|number| places[number as usize]) else {
                continue;
            };
            if past.bond.is_intact {
                let strength = strength_between(model, particles, [a as usize, b as usize]);
                past.bond.strength = strength.unwrap_or_default();
            }
        }
    }

    /// The place of each particle by its number; one that was taken out has none.
    fn places(&self, particles: &Particles) -> Vec<Option<u32>> {
        let mut places = vec![None; self.starts.len()];
        for (place, number) in (0_u32..).zip(&particles.numbers) {
            if let Some(known) = places.get_mut(*number as usize) {
                *known = Some(place);
            }
        }
        places
    }

    /// Pairs of particles whose bond holds though they are farther apart than the skin [m], the lower
    /// one first. A bond softens with its modulus but not its strength, so it may stretch far.
    pub(crate) fn stretched_bonds(&self, particles: &Particles, skin: f64) -> Vec<[u32; 2]> {
        if self.intact_bonds() == 0 {
            return Vec::new();
        }
        let places = self.places(particles);
        let pairs = self.pairs.iter();
        let pairs = pairs.flat_map(|pairs| pairs.numbers.iter().zip(&pairs.pasts));
        pairs
            .filter(|(_, past)| past.bond.is_intact)
            .filter_map(|(numbers, _)| {
                let [Some(a), Some(b)] = numbers.map(|number| places[number as usize]) else {
                    return None;
                };
                let [one, other] = [a, b].map(|place| &particles.centres[place as usize]);
                (!is_near(one, other, skin)).then_some([a.min(b), a.max(b)])
            })
            .collect()
    }

    /// What the contact of particles `a` and `b` remembers, seen from a.
    fn pair(&self, a: u32, b: u32) -> Option<Past> {
        let (low, high) = (a.min(b), a.max(b));
        let range =
            *self.starts.get(low as usize)? as usize..*self.starts.get(low as usize + 1)? as usize;
        let mut entries = self.entries[range].iter();
        let entry = entries.find(|entry| entry.high == high)?;
        let past = &self.pairs[entry.patch as usize].pasts[entry.place as usize];
        Some(if a == low { *past } else { past.seen_from_b() })
    }

    /// At the start of a scene.
    pub(crate) fn none() -> Self {
        Self {
            newcomers: 0,
            ..Self::default()
        }
    }

    /// The past of two particles, or the bond that is made between them.
    pub(crate) fn pair_or_bond(
        &self,
        model: &Model,
        particles: &Particles,
        a: usize,
        b: usize,
    ) -> Option<Past> {
        let numbers = [a, b].map(|particle| particles.numbers[particle]);
        if numbers[0].min(numbers[1]) < self.newcomers {
            return self.pair(numbers[0], numbers[1]);
        }
        // spheres of breakable grains are bonded within their grain only
        let [own, other] = [a, b].map(|particle| particles.owners[particle] as usize);
        if model.grains.get(own) != model.grains.get(other) {
            return None;
        }
        let [one, other] = [a, b].map(|particle| &particles.centres[particle]);
        let radii = [one, other].map(|sphere| sphere.0[3]);
        let strength = strength_between(model, particles, [a, b])?;
        let overlap = one.overlap(other);
        if overlap < -BOND_REACH * radii[0].min(radii[1]) {
            return None;
        }
        let rest = if model.bonds_rest_as_made {
            overlap
        } else {
            0.0
        };
        Some(Past {
            bond: Bond {
                is_intact: true,
                strength,
                rest,
                beam: Beam {
                    rest: overlap,
                    length: radii[0] + radii[1] - overlap,
                    shear: Vector::zeros(),
                },
            },
            ..Past::default()
        })
    }

    pub(crate) fn facet(&self, particle: u32, facet: u32) -> Option<Past> {
        let place = self
            .facets
            .binary_search_by_key(&(particle, facet), |(key, _)| *key);
        place.ok().map(|place| self.facets[place].1)
    }

    pub(crate) fn wall(&self, particle: u32, plane: u32) -> Option<Past> {
        let place = self
            .walls
            .binary_search_by_key(&(particle, plane), |(key, _)| *key);
        place.ok().map(|place| self.walls[place].1)
    }
}
