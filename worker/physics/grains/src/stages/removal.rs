//! Bodies that are taken out.
//!
//! What is left keeps its numbers and the memory of its contacts. The energy of what goes, that of
//! its contacts included, goes out of the balance with it.
use std::collections::BTreeSet;

use loadframe_api::spec::granular_scene::Cut;
use loadframe_harness::{Recorder, SimulationError};

use super::runner::Runner;
use crate::{
    numbers::Vector,
    observe::{contact::Contact, fragments::Fragments},
    step::engine::Engine,
};

/// What was taken out.
#[derive(Clone, Copy, Debug, Default)]
struct Removal {
    bodies: u64,
    /// [kg].
    mass: f64,
    /// Change of the scene's energy [J].
    energy: f64,
}

impl Engine {
    /// Bodies that do not move along an axis now.
    fn held_along(&self, axis: usize) -> BTreeSet<u32> {
        let particles = &self.state.particles;
        let spheres = particles.owners.iter().zip(&particles.fixed);
        let spheres = spheres.filter(|(owner, fixed)| {
            let is_sphere = self.model.sphere_inertias[**owner as usize] > 0.0;
            is_sphere && **fixed >> axis & 1 == 1
        });
        let clumps = self.state.clumps.iter().filter(|clump| clump.fixed[axis]);
        let clumps = clumps.map(|clump| clump.body);
        spheres.map(|(owner, _)| *owner).chain(clumps).collect()
    }

    /// For each number, whether the cut takes the body: by the centre of mass of what bonds hold
    /// together.
    fn taken(&self, cut: &Cut) -> Vec<bool> {
        let count = self.model.masses.len();
        let fragments = Fragments::of(self);
        let mut masses = vec![0.0; count];
        let mut moments = vec![Vector::zeros(); count];
        for (body, mass, centre) in self.present_bodies() {
            let fragment = fragments.of_body(body) as usize;
            masses[fragment] += mass;
            moments[fragment] += mass * centre;
        }
        let mut taken = vec![false; count];
        // a sleeper that stands out of its bed is no grain
        let driven = self.model.driven.iter().map(|driven| driven.body);
        let mut held = self.held_along(cut.axis.index());
        held.extend(driven);
        for (body, ..) in self.present_bodies() {
            let fragment = fragments.of_body(body) as usize;
            taken[body as usize] =
                !held.contains(&body) && cut.takes(&(moments[fragment] / masses[fragment]).into());
        }
        taken
    }

    fn take_out(&mut self, cut: &Cut, contacts: &[Contact]) -> Removal {
        let taken = self.taken(cut);
        let is_taken = |body: u32| taken.get(body as usize) == Some(&true);
        let gone = self.present_bodies().filter(|(body, ..)| is_taken(*body));
        let mut removal = gone.fold(Removal::default(), |sum, (_, mass, _)| Removal {
            bodies: sum.bodies + 1,
            mass: sum.mass + mass,
            ..sum
        });
        if removal.bodies == 0 {
            return removal;
        }
        let before = self.body_sums().energy();
        let bonds = self.intact_bonds();
        let memories = self.memories();
        let state = &mut self.state;
        let owners = &state.particles.owners;
        let kept: Vec<u32> = (0..owners.len() as u32)
            .filter(|particle| !is_taken(owners[*particle as usize]))
            .collect();
        state.clumps.retain(|clump| !is_taken(clump.body));
        for clump in &mut state.clumps {
            clump.first = kept.partition_point(|particle| *particle < clump.first) as u32;
        }
        state.particles.reorder(&kept);
        self.relist(memories);
        self.state.bonds_removed += bonds - self.intact_bonds();
        let torn = contacts
            .iter()
            .filter(|contact| contact.bodies.into_iter().any(is_taken));
        let torn: f64 = torn.map(|contact| contact.energy).sum();
        removal.energy = self.body_sums().energy() - before - torn;
        removal
    }
}

impl Runner<'_> {
    /// Takes bodies out and records what is left.
    pub(crate) fn cut(
        &mut self,
        cut: &Cut,
        recorder: &mut dyn Recorder,
    ) -> Result<(), SimulationError> {
        let survey = self.engine.survey(true);
        let removal = self.engine.take_out(cut, &survey.contacts);
        self.journal.balance.shift(removal.energy);
        self.journal.removed_bodies += removal.bodies;
        self.journal.removed_mass += removal.mass;
        recorder.log(&format!(
            "stage {}: {} bodies of {:.6e} kg were taken out",
            self.journal.stage + 1,
            removal.bodies,
            removal.mass
        ));
        self.observe_still(recorder)
    }
}
