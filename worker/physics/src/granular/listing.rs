//! Making the lists of candidates: order, patches, pairs, walls, facets; the past of contacts is kept.
pub(super) mod facets;
pub(super) mod memories;

use std::ops::Range;

use memories::Memories;

use super::{
    Vector,
    contact::{
        law::{Law, Normal, Past},
        pairs::{PairBlock, PairList},
        stiffness::{Side, Springs},
        touching_lanes,
        walls::{Face, WallBlock, WallList},
    },
    lanes::LANES,
    motion::{clump::Clump, spheres::PartlyFixed},
    neighbours::{
        grid::{Candidates, candidates},
        order::along_curve,
    },
    particles::Particles,
    patch::{Incoming, Patch},
    scene::Model,
};

/// Particles of a patch: enough work to share out (about 0.1 ms), few enough to stay in a core's
/// own cache together with their contacts.
const PATCH: usize = 2048;

/// Sorts particles and clumps along a curve through space, members with their clump.
pub(super) fn sort(particles: &mut Particles, clumps: &mut Vec<Clump>) {
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

/// Cuts the particles into patches and fills them with candidates closer than `skin` [m].
pub(super) fn list<F: Law>(
    model: &Model,
    faces: &[Face],
    particles: &Particles,
    clumps: &[Clump],
    skin: f64,
    memories: &Memories,
) -> Vec<Patch<F>> {
    let may_touch = |a: usize, b: usize| {
        let (a, b) = (particles.owners[a] as usize, particles.owners[b] as usize);
        a != b && (model.is_movable[a] || model.is_movable[b])
    };
    let candidates = candidates(&particles.centres, skin, may_touch);
    let mut patches: Vec<Patch<F>> = cut(particles.len(), clumps)
        .into_iter()
        .map(|(particles, clumps)| Patch {
            particles,
            clumps,
            ..Patch::default()
        })
        .collect();
    let mut patch_of = vec![0_u32; particles.len()];
    for (number, patch) in (0..).zip(&patches) {
        patch_of[patch.particles.clone()].fill(number);
    }
    let ends: Vec<usize> = patches.iter().map(|patch| patch.particles.end).collect();
    let mut incoming: Vec<Vec<Incoming>> = vec![Vec::new(); patches.len()];
    for (number, patch) in patches.iter_mut().enumerate() {
        fill_pairs::<F>(model, particles, &candidates, memories, patch);
        fill_walls(model, faces, particles, skin, memories, patch);
        patch.partly_fixed = partly_fixed(particles, patch.particles.clone());
        for (block, pairs) in patch.outer.blocks.iter().enumerate() {
            for lane in 0..LANES {
                if pairs.is_padding(lane) {
                    continue;
                }
                let b = pairs.b[lane] as usize;
                let target = patch_of[b] as usize;
                let first = if target == 0 { 0 } else { ends[target - 1] };
                let entry = [(block * LANES + lane) as u32, (b - first) as u32];
                match incoming[target].last_mut() {
                    Some(last) if last.patch == number => last.entries.push(entry),
                    _ => incoming[target].push(Incoming {
                        patch: number,
                        entries: vec![entry],
                    }),
                }
            }
        }
    }
    for (patch, incoming) in patches.iter_mut().zip(incoming) {
        patch.incoming = incoming;
    }
    patches
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

/// Ranges of particles and clumps of each patch; no clump is cut.
fn cut(particles: usize, clumps: &[Clump]) -> Vec<(Range<usize>, Range<usize>)> {
    let mut patches = Vec::new();
    let (mut first, mut first_clump, mut clump) = (0, 0, 0);
    while first < particles {
        let mut end = (first + PATCH).min(particles);
        while clump < clumps.len() && (clumps[clump].first as usize) < end {
            end = end.max(clumps[clump].members().end);
            clump += 1;
        }
        patches.push((first..end, first_clump..clump));
        (first, first_clump) = (end, clump);
    }
    patches
}

fn fill_pairs<F: Law>(
    model: &Model,
    particles: &Particles,
    candidates: &Candidates,
    memories: &Memories,
    patch: &mut Patch<F>,
) {
    // what touches now comes first, so that blocks of what does not are passed over by one look
    for wants_touching in [true, false] {
        for a in patch.particles.clone() {
            for &b in candidates.of(a) {
                let past = memories.pair_or_bond(model, particles, a, b as usize);
                let is_bonded = past.is_some_and(|past| past.bond.is_intact);
                if (is_bonded || is_touching(particles, a, b as usize)) != wants_touching {
                    continue;
                }
                let sides = [a, b as usize].map(|particle| side(model, particles, particle));
                let springs = F::Normal::springs(&sides[0], &sides[1]);
                let list = if patch.particles.contains(&(b as usize)) {
                    &mut patch.inner
                } else {
                    &mut patch.outer
                };
                list.add([a as u32, b], springs, past);
            }
        }
        patch.inner.close_block();
        patch.outer.close_block();
    }
    patch.inner.finish();
    patch.outer.finish();
}

/// What a particle brings to a contact.
fn side(model: &Model, particles: &Particles, particle: usize) -> Side {
    Side {
        surface: model.surfaces[usize::from(particles.surfaces[particle])],
        radius: particles.centres[particle].0[3],
        is_flat: false,
        inverse_mass: model.inverse_mass(particles.owners[particle] as usize),
    }
}

fn is_touching(particles: &Particles, a: usize, b: usize) -> bool {
    let [a, b] = [a, b].map(|particle| particles.centres[particle]);
    (b.vector() - a.vector()).norm() <= a.0[3] + b.0[3]
}

fn fill_walls<F: Law>(
    model: &Model,
    faces: &[Face],
    particles: &Particles,
    skin: f64,
    memories: &Memories,
    patch: &mut Patch<F>,
) {
    patch.walls = Vec::with_capacity(faces.len());
    for ((number, plane), face) in (0..).zip(&model.planes).zip(faces) {
        let mut list = WallList::default();
        for particle in patch.particles.clone() {
            let centre = &particles.centres[particle].0;
            let radius = centre[3];
            let owner = particles.owners[particle] as usize;
            if face.height(centre) > radius + skin || !model.is_movable[owner] {
                continue;
            }
            let own = side(model, particles, particle);
            let springs = F::Normal::springs(&own, &own.wall(model.surfaces[plane.surface]));
            let past = memories.wall(particles.numbers[particle], number);
            list.add(particle as u32, springs, past);
        }
        patch.walls.push(list);
    }
}

impl<F: Law> PairBlock<F> {
    /// Whether a lane only fills the block.
    pub(super) fn is_padding(&self, lane: usize) -> bool {
        self.a[lane] == self.b[lane]
    }
}

impl<F: Law> PairList<F> {
    /// Blocks and lanes that touched in the last step.
    pub(super) fn touching(&self) -> impl Iterator<Item = (&PairBlock<F>, usize)> {
        let blocks = self.blocks.iter().zip(&self.touching);
        blocks
            .flat_map(|(block, touching)| touching_lanes(*touching).map(move |lane| (block, lane)))
    }

    /// Adds a candidate. Its bit is set when it has a past, so that the past is forgotten in time.
    fn add(&mut self, pair: [u32; 2], springs: Springs, past: Option<Past>) {
        let lane = self.filled;
        if lane == 0 {
            let block = PairBlock {
                a: [pair[0]; LANES],
                b: [pair[0]; LANES],
                ..PairBlock::default()
            };
            self.blocks.push(block);
            self.touching.push(0);
        }
        self.count += 1;
        self.filled = (lane + 1) % LANES;
        if let (Some(block), Some(touching)) = (self.blocks.last_mut(), self.touching.last_mut()) {
            [block.a[lane], block.b[lane]] = pair;
            block.stiffness[lane] = springs.normal;
            block.law.start(lane, &springs, &past.unwrap_or_default());
            *touching |= u8::from(past.is_some()) << lane;
        }
    }

    /// The next candidate begins a block.
    fn close_block(&mut self) {
        self.filled = 0;
    }

    fn finish(&mut self) {
        self.blocks.shrink_to_fit();
        self.touching.shrink_to_fit();
    }
}

impl<F: Law> WallList<F> {
    fn add(&mut self, particle: u32, springs: Springs, past: Option<Past>) {
        let lane = self.count % LANES;
        if lane == 0 {
            let block = WallBlock {
                particles: [particle; LANES],
                ..WallBlock::default()
            };
            self.blocks.push(block);
            self.touching.push(0);
        }
        self.count += 1;
        if let (Some(block), Some(touching)) = (self.blocks.last_mut(), self.touching.last_mut()) {
            block.particles[lane] = particle;
            block.stiffness[lane] = springs.normal;
            block.law.start(lane, &springs, &past.unwrap_or_default());
            *touching |= u8::from(past.is_some()) << lane;
        }
    }
}
