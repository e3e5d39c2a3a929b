//! Clumps that take the places of spheres.
use loadframe_api::spec::granular_scene::Replace;
use loadframe_harness::{Recorder, SimulationError};

use super::runner::Runner;
use crate::{
    motion::clump::Members, numbers::Vector, output::journal::Replacement, step::engine::Engine,
};

/// A sphere that goes, as the clump that comes in its place is to be.
struct Place {
    /// Of the clump among those that wait.
    grain: usize,
    centre: Vector,
    velocity: Vector,
    spin: Vector,
}

impl Engine {
    /// Puts the waiting grain `first` + k in the place of the sphere `spheres[k]`, which are in order, where
    /// that is there. Returns how many, and their masses before and after [kg].
    fn replace(&mut self, spheres: &[u32], first: usize) -> (u64, [f64; 2]) {
        let particles = &self.state.particles;
        let mut kept = Vec::with_capacity(particles.len());
        let mut places = Vec::with_capacity(spheres.len());
        for (particle, owner) in (0_u32..).zip(&particles.owners) {
            let at = particle as usize;
            match spheres.binary_search(owner) {
                Ok(number) => places.push(Place {
                    grain: first + number,
                    centre: particles.centres[at].vector(),
                    velocity: particles.velocities[at].vector(),
                    spin: (particles.spins.get(at)).map_or_else(Vector::zeros, |row| row.vector()),
                }),
                Err(_) => kept.push(particle),
            }
        }
        // in memory they lie as they came to lie
        places.sort_unstable_by_key(|place| place.grain);
        let memories = self.memories();
        let state = &mut self.state;
        for clump in &mut state.clumps {
            clump.first = kept.partition_point(|particle| *particle < clump.first) as u32;
        }
        state.particles.reorder(&kept);
        let mut masses = [0.0; 2];
        for place in &places {
            let grain = &self.reserve.grains[place.grain];
            let Some(waiting) = grain.clump else { continue };
            let mut clump = self.reserve.clumps[waiting].clone();
            clump.first = state.particles.len() as u32;
            clump.centre += place.centre;
            clump.velocity = place.velocity;
            clump.spin = place.spin;
            clump.angular_momentum = clump.momentum_of(place.spin);
            masses[1] += clump.mass;
            let range = grain.particles.clone();
            (state.particles).append(&self.reserve.particles, range, &place.centre);
            let particles = &mut state.particles;
            let members = &mut Members {
                centres: &mut particles.centres,
                velocities: &mut particles.velocities,
                spins: &mut particles.spins,
            };
            let speed = clump.place(members, 0).sqrt();
            state.speed_bound = state.speed_bound.max(speed);
            state.clumps.push(clump);
        }
        for place in &places {
            masses[0] += self.model.masses[spheres[place.grain - first] as usize];
        }
        self.relist(memories);
        (places.len() as u64, masses)
    }
}

impl Runner<'_> {
    /// Replaces spheres and records what is there then.
    pub(crate) fn replace(
        &mut self,
        replace: &Replace,
        recorder: &mut dyn Recorder,
    ) -> Result<(), SimulationError> {
        let stage = self.journal.stage;
        let waiting = self.reserved.get(&stage).map_or(0, |range| range.start);
        let spheres = self.replaced.get(&stage).map_or(&[][..], Vec::as_slice);
        let first = waiting - self.engine.reserve.first;
        let (count, masses) = self.engine.replace(spheres, first);
        // what the clumps overlap by is no work of the scene's
        self.journal.balance.pause();
        self.engine.push_still();
        let overlap_ratio = self.engine.survey(false).sums.overlap_ratio;
        self.observe_still(recorder)?;
        let replacement = Replacement {
            stage,
            spheres: count,
            masses,
            overlap_ratio,
        };
        self.journal.replacements.push(replacement);
        recorder.log(&format!(
            "stage {}: {count} spheres of {:?}, {:.6e} kg, were replaced by clumps of {:.6e} kg; the largest \
             overlap is then {:.3e} of the smaller radius",
            stage + 1,
            replace.material,
            masses[0],
            masses[1],
            overlap_ratio
        ));
        Ok(())
    }
}
