//! Candidates among facets.
use super::{Past, Springs, memories::Memories, side};
use crate::granular::{
    contact::{
        facets::{FacetBlock, FacetList, Visitor},
        law::{Law, Normal as _},
    },
    facets::{Pose, search::Search},
    lanes::LANES,
    particles::Particles,
    patch::Patch,
    scene::Model,
};

/// Past of a particle's contact with a facet, by their numbers, sorted.
pub(super) fn pasts<F: Law>(
    patches: &[Patch<F>],
    particles: &Particles,
) -> Vec<((u32, u32), Past)> {
    let touching = patches.iter().flat_map(|patch| patch.facets.touching());
    let mut pasts: Vec<_> = touching
        .map(|(particle, block, lane)| {
            let key = (particles.numbers[particle], block.facets[lane]);
            (key, block.law.past(lane))
        })
        .collect();
    pasts.sort_by_key(|(key, _)| *key);
    pasts
}

/// Fills patches with the facets closer to their spheres than `skin` [m].
pub(in crate::granular) fn fill<F: Law>(
    model: &Model,
    search: &mut Search,
    poses: &[Pose],
    particles: &Particles,
    patches: &mut [Patch<F>],
    skin: f64,
    memories: &Memories,
) {
    let facets = &model.facets;
    if facets.facets.is_empty() {
        return;
    }
    let radii = particles.centres.iter().map(|centre| centre.0[3]);
    search.prepare(facets, radii.fold(0.0, f64::max) + skin);
    let mut found = Vec::new();
    for patch in patches {
        let mut list = FacetList::default();
        for particle in patch.particles.clone() {
            if !model.is_movable[particles.owners[particle] as usize] {
                continue;
            }
            let sphere = &particles.centres[particle];
            search.near(facets, poses, sphere, skin, &mut found);
            let own = side(model, particles, particle);
            let number = particles.numbers[particle];
            let candidates = found.iter().map(|facet| {
                let mesh = &facets.meshes[facets.facets[*facet as usize].mesh as usize];
                let mut wall = own.wall(model.surfaces[mesh.surface]);
                wall.radius *= facets.radius_ratio;
                let springs = F::Normal::springs(&own, &wall);
                (*facet, springs, memories.facet(number, *facet))
            });
            list.add(particle as u32, candidates);
        }
        patch.facets = list;
    }
}

impl Memories {
    fn facet(&self, particle: u32, facet: u32) -> Option<Past> {
        let place = self
            .facets
            .binary_search_by_key(&(particle, facet), |(key, _)| *key);
        place.ok().map(|place| self.facets[place].1)
    }
}

impl<F: Law> FacetList<F> {
    /// Adds a sphere with its candidates, if it has any.
    fn add(
        &mut self,
        particle: u32,
        candidates: impl Iterator<Item = (u32, Springs, Option<Past>)>,
    ) {
        let first = self.blocks.len();
        for (slot, (facet, springs, past)) in candidates.enumerate() {
            let lane = slot % LANES;
            if lane == 0 {
                self.blocks.push(FacetBlock::default());
                self.touching.push(0);
            }
            self.count += 1;
            if let (Some(block), Some(touching)) =
                (self.blocks.last_mut(), self.touching.last_mut())
            {
                block.facets[lane] = facet;
                block.stiffness[lane] = springs.normal;
                block.law.start(lane, &springs, &past.unwrap_or_default());
                *touching |= u8::from(past.is_some()) << lane;
            }
        }
        let blocks = (self.blocks.len() - first) as u32;
        if blocks > 0 {
            self.visitors.push(Visitor { particle, blocks });
        }
    }
}
