//! What contacts remember while their lists are made anew, and the bonds that are made.
use super::super::{
    contact::{
        law::{Bond, Past},
        lists::{Lists, Who},
        stiffness::bond_strength,
    },
    neighbours::grid::is_near,
    particles::Particles,
    scene::Model,
};
use crate::parallel::Team;

/// What contacts remember, by particle number of the spec, whatever the order in memory.
#[derive(Debug)]
pub(in crate::granular) struct Memories {
    /// For each particle, the partners with higher numbers that it touched.
    starts: Vec<u32>,
    pairs: Vec<(u32, Past)>,
    /// Particle, plane and past, sorted.
    walls: Vec<((u32, u32), Past)>,
    /// Particle, facet and past, sorted.
    facets: Vec<((u32, u32), Past)>,
    intact_bonds: u64,
    /// Particles with this number and higher ones are new: bonds are made between them.
    newcomers: u32,
}

impl Default for Memories {
    fn default() -> Self {
        Self {
            starts: Vec::new(),
            pairs: Vec::new(),
            walls: Vec::new(),
            facets: Vec::new(),
            intact_bonds: 0,
            newcomers: u32::MAX,
        }
    }
}

/// What the contacts of one patch remember.
#[derive(Default)]
struct Part {
    /// The lower number, the higher one, and the past as seen from the lower.
    pairs: Vec<(u32, u32, Past)>,
    walls: Vec<((u32, u32), Past)>,
    facets: Vec<((u32, u32), Past)>,
    intact_bonds: u64,
}

/// Spheres this part of the smaller radius apart touch when bonds are made: places in a spec are
/// rounded.
const BOND_REACH: f64 = 1e-6;

impl Part {
    fn of(lists: &dyn Lists, particles: &Particles) -> Self {
        let mut part = Self::default();
        let number = |particle: u32| particles.numbers[particle as usize];
        lists.see(&mut |touching| {
            let past = touching.law.past(touching.lane);
            match touching.who {
                Who::Pair(pair) => {
                    let [a, b] = pair.map(number);
                    part.intact_bonds += u64::from(past.bond.is_intact);
                    part.pairs.push(if a < b {
                        (a, b, past)
                    } else {
                        (b, a, past.seen_from_b())
                    });
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
    pub(in crate::granular) fn of(
        team: &Team,
        contacts: &[Box<dyn Lists>],
        particles: &Particles,
    ) -> Self {
        let parts = team.map(contacts.iter().collect(), |lists| {
            Part::of(lists.as_ref(), particles)
        });
        // numbers of particles that were taken out are missing
        let last = particles.numbers.iter().max();
        let numbers = last.map_or(0, |last| *last as usize + 1);
        let mut starts = vec![0_u32; numbers + 1];
        for (low, ..) in parts.iter().flat_map(|part| &part.pairs) {
            starts[*low as usize + 1] += 1;
        }
        for number in 0..numbers {
            starts[number + 1] += starts[number];
        }
        let mut next = starts.clone();
        let mut pairs = vec![(0, Past::default()); starts[numbers] as usize];
        for (low, high, past) in parts.iter().flat_map(|part| &part.pairs) {
            let place = &mut next[*low as usize];
            pairs[*place as usize] = (*high, *past);
            *place += 1;
        }
        let mut memories = Self {
            starts,
            pairs,
            intact_bonds: parts.iter().map(|part| part.intact_bonds).sum(),
            ..Self::default()
        };
        for part in parts {
            memories.walls.extend(part.walls);
            memories.facets.extend(part.facets);
        }
        memories.walls.sort_by_key(|(key, _)| *key);
        memories.facets.sort_by_key(|(key, _)| *key);
        memories
    }

    /// The same when particles of these numbers come in.
    pub(in crate::granular) fn with_newcomers(self, first: u32) -> Self {
        Self {
            newcomers: first,
            ..self
        }
    }

    pub(in crate::granular) fn makes_bonds(&self) -> bool {
        self.newcomers < u32::MAX
    }

    pub(in crate::granular) fn intact_bonds(&self) -> u64 {
        self.intact_bonds
    }

    /// Whether there are bonds, or some are about to be made.
    pub(super) fn has_bonds(&self) -> bool {
        self.intact_bonds > 0 || self.makes_bonds()
    }

    /// All springs have changed, from stiffness to stiffness by 1/`ratio` [-]: bonds get the rest
    /// overlap at which they pull as before. The bonds of a grain hold each other under tension, which
    /// no motion could relieve while it grew with the springs, and they would break.
    pub(in crate::granular) fn keep_bond_forces(&mut self, particles: &Particles, ratio: f64) {
        let places = self.places(particles);
        for (low, ends) in self.starts.windows(2).enumerate() {
            let Some(a) = places[low] else { continue };
            for (high, past) in &mut self.pairs[ends[0] as usize..ends[1] as usize] {
                let Some(b) = places[*high as usize].filter(|_| past.bond.is_intact) else {
                    continue;
                };
                let [a, b] = [a, b].map(|place| &particles.centres[place as usize]);
                let overlap = a.overlap(b);
                let rest = &mut past.bond.rest;
                *rest = overlap - ratio * (overlap - *rest);
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
    pub(super) fn stretched_bonds(&self, particles: &Particles, skin: f64) -> Vec<[u32; 2]> {
        if self.intact_bonds() == 0 {
            return Vec::new();
        }
        let places = self.places(particles);
        let lows = self.starts.windows(2).enumerate();
        let pairs = lows.flat_map(|(low, ends)| {
            let partners = &self.pairs[ends[0] as usize..ends[1] as usize];
            let bonded = partners.iter().filter(|(_, past)| past.bond.is_intact);
            bonded.map(move |(high, _)| [low, *high as usize])
        });
        pairs
            .filter_map(|pair| {
                let [Some(a), Some(b)] = pair.map(|number| places[number]) else {
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
        let (_, past) = self.pairs[range]
            .iter()
            .find(|(partner, _)| *partner == high)?;
        Some(if a == low { *past } else { past.seen_from_b() })
    }

    /// At the start of a scene.
    pub(in crate::granular) fn none() -> Self {
        Self {
            newcomers: 0,
            ..Self::default()
        }
    }

    /// The past of two particles, or the bond that is made between them.
    pub(super) fn pair_or_bond(
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
        let surfaces =
            [a, b].map(|particle| model.surfaces[usize::from(particles.surfaces[particle])]);
        let strength = bond_strength((surfaces[0], radii[0]), (surfaces[1], radii[1]))?;
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
            },
            ..Past::default()
        })
    }

    pub(super) fn facet(&self, particle: u32, facet: u32) -> Option<Past> {
        let place = self
            .facets
            .binary_search_by_key(&(particle, facet), |(key, _)| *key);
        place.ok().map(|place| self.facets[place].1)
    }

    pub(super) fn wall(&self, particle: u32, plane: u32) -> Option<Past> {
        let place = self
            .walls
            .binary_search_by_key(&(particle, plane), |(key, _)| *key);
        place.ok().map(|place| self.walls[place].1)
    }
}
