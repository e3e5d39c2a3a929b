//! Bodies that are put in while the others move.
use std::ops::Range;

use loadframe_api::spec::granular_scene::{Insert, Stage};
use loadframe_harness::{
    Recorder,
    rng::{Purpose, Streams},
};
use rand_chacha::ChaCha8Rng;

use super::runner::Runner;
use crate::{
    generate::{Region, insert_some},
    geometry::sphere::Sphere,
    numbers::Vector,
    scene::particles::Particles,
    step::engine::Engine,
};

/// Places tried for a grain of a batch; the next batch tries again.
const TRIES: usize = 500;
/// Part of a time step that round-off may take from the time of a batch.
const HAIR: f64 = 1e-6;

impl Engine {
    /// Puts in as many of these waiting grains as find room in the region, in their order. Returns
    /// how many, and the kinetic and gravitational energy they bring [J].
    fn put_in(
        &mut self,
        grains: Range<usize>,
        region: &Region,
        random: &mut ChaCha8Rng,
    ) -> (usize, f64) {
        let [lower, upper] = region.bounds();
        let rows = self.state.particles.centres.iter();
        let obstacles: Vec<Sphere> = rows
            .map(|row| Sphere::new(row.vector(), row.0[3]))
            .filter(|sphere| {
                let outside = (lower - sphere.centre).sup(&(sphere.centre - upper));
                outside.max() < sphere.radius
            })
            .collect();
        let waiting = &self.reserve.grains[grains];
        let largest = waiting.iter().map(|grain| grain.reach).fold(0.0, f64::max);
        self.search.prepare(&self.model.facets, largest);
        let reaches: Vec<f64> = waiting.iter().map(|grain| grain.reach).collect();
        let (search, facets) = (&self.search, &self.model.facets);
        let (faces, poses) = (&self.state.faces, &self.state.poses);
        let is_clear_of_walls = |place: &Sphere| {
            let [x, y, z]: [f64; 3] = place.centre.into();
            search.is_clear(facets, poses, place)
                && faces
                    .iter()
                    .all(|face| face.height(&[x, y, z, 0.0]) >= place.radius)
        };
        let places = insert_some(
            region,
            &reaches,
            &obstacles,
            TRIES,
            is_clear_of_walls,
            random,
        );
        if places.is_empty() {
            return (0, 0.0);
        }
        let before = self.body_sums().energy();
        let memories = self.memories();
        let first = self.reserve.particles.numbers[waiting[0].particles.start];
        let memories = memories.with_newcomers(first);
        let state = &mut self.state;
        for (grain, place) in waiting.iter().zip(&places) {
            if let Some(clump) = grain.clump {
                let mut clump = self.reserve.clumps[clump].clone();
                clump.first = state.particles.len() as u32;
                clump.centre += place;
                state.clumps.push(clump);
            }
            state
                .particles
                .append(&self.reserve.particles, grain.particles.clone(), place);
        }
        self.relist(memories);
        let energy = self.body_sums().energy() - before;
        (places.len(), energy)
    }
}

impl Runner<'_> {
    /// The batch of this moment, when one is due.
    pub(crate) fn supply(&mut self, stage: &Stage, recorder: &mut dyn Recorder) {
        let Stage::Insert(insert) = stage else {
            return;
        };
        let time = self.engine.state.time;
        let next = self.journal.stage_start + self.journal.batches as f64 * insert.every_s;
        if time < next - HAIR * self.journal.time_step || self.waiting() == 0 {
            return;
        }
        let all = self
            .reserved
            .get(&self.journal.stage)
            .cloned()
            .unwrap_or(0..0);
        let first = all.start - self.engine.reserve.first + self.journal.supplied;
        let most = insert.batch.map_or(usize::MAX, |batch| batch as usize);
        let grains = first..first + self.waiting().min(most);
        let streams = Streams::new(self.spec.seed, Purpose::BatchPlaces);
        // stages and batches count from 0 and stay far below 2³²
        let mut random = streams.of((self.journal.stage << 32) + self.journal.batches as usize);
        let region = Region::from(insert.bodies.region);
        let (count, energy) = self.engine.put_in(grains, &region, &mut random);
        self.journal.batches += 1;
        self.journal.supplied += count;
        self.journal.balance.shift(energy);
        if count > 0 {
            self.limit_step();
            recorder.log(&format!(
                "batch {} at {time:.6} s: {count} grains, {} still wait",
                self.journal.batches,
                self.waiting()
            ));
        }
    }

    /// Grains that the present stage has not put in.
    fn waiting(&self) -> usize {
        let all = self.reserved.get(&self.journal.stage).map_or(0, Range::len);
        all - self.journal.supplied
    }

    /// Time until the end of a stage that puts bodies in, once all are in [s].
    pub(crate) fn time_after_last_batch(&self, insert: &Insert) -> Option<f64> {
        let end = self.journal.stage_start + self.journal.batches as f64 * insert.every_s;
        (self.waiting() == 0).then_some(end - self.engine.state.time)
    }

    /// Tells what a stage that ends could not put in.
    pub(crate) fn end_supply(&mut self, stage: &Stage) {
        if let Stage::Insert(_) = stage {
            let left = self.waiting();
            if left > 0 {
                self.journal.not_inserted.push((self.journal.stage, left));
            }
        }
        self.journal.batches = 0;
        self.journal.supplied = 0;
    }
}

impl Particles {
    /// Adds copies of `range` of others, moved by `shift` [m].
    pub(super) fn append(&mut self, others: &Self, range: Range<usize>, shift: &Vector) {
        fn copy<T: Copy>(to: &mut Vec<T>, from: &[T], range: &Range<usize>) {
            if !from.is_empty() {
                to.extend_from_slice(&from[range.clone()]);
            }
        }
        let first = self.len();
        copy(&mut self.centres, &others.centres, &range);
        for centre in &mut self.centres[first..] {
            centre.set(centre.vector() + shift);
        }
        copy(&mut self.velocities, &others.velocities, &range);
        copy(&mut self.spins, &others.spins, &range);
        copy(&mut self.numbers, &others.numbers, &range);
        copy(&mut self.owners, &others.owners, &range);
        copy(&mut self.fixed, &others.fixed, &range);
        copy(&mut self.surfaces, &others.surfaces, &range);
    }
}
