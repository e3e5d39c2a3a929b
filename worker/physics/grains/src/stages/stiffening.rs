//! Moduli that change while the bodies move, and cohesions that were higher at first.
use loadframe_api::spec::granular_scene::Stage;

use super::runner::Runner;
use crate::step::engine::Engine;

/// Steps between changes: contacts are listed anew at each.
const STEPS_PER_CHANGE: u64 = 32;

impl Engine {
    /// Sets what the modulus of every material is multiplied with, from the next step on.
    pub(crate) fn stiffen(&mut self, factor: f64) {
        let old = std::mem::replace(&mut self.state.stiffness_factor, factor);
        if old.to_bits() == factor.to_bits() {
            return;
        }
        self.model.stiffen(factor);
        // contacts get their springs when they are listed
        if self.state.bonds_made > 0 {
            let mut memories = self.memories();
            memories.keep_bond_forces(&self.state.particles, old / factor);
            self.list_with(&memories);
        } else {
            self.drop_lists();
        }
    }
}

impl Engine {
    /// Sets what cohesions are multiplied with, of bonds that there are and of those that are made.
    fn raise_cohesion(&mut self, factor: f64) {
        let old = std::mem::replace(&mut self.state.cohesion_factor, factor);
        if old.to_bits() == factor.to_bits() {
            return;
        }
        self.model.cohesion_factor = factor;
        let mut memories = self.memories();
        memories.renew_strengths(&self.model, &self.state.particles);
        self.list_with(&memories);
    }
}

impl Runner<'_> {
    /// Cohesions of the present stage; to be called as it begins.
    pub(crate) fn raise_cohesion(&mut self) {
        let factor = self.spec.cohesion_factor(self.journal.stage);
        self.engine.raise_cohesion(factor);
    }

    /// Moduli before the next step of a stage, and the step that goes with them.
    pub(crate) fn stiffen(&mut self, stage: &Stage) {
        let done = self.journal.stage_steps;
        if let Stage::Stiffen(stiffen) = stage
            && done.is_multiple_of(STEPS_PER_CHANGE)
        {
            self.set_stiffness(stiffen.factor_after(done));
        }
    }

    /// Moduli when a stage is done.
    pub(crate) fn end_stiffening(&mut self, stage: &Stage) {
        if let Stage::Stiffen(stiffen) = stage {
            self.set_stiffness(stiffen.factor);
        }
    }

    /// `factor` is that of the present stage; those before it had theirs.
    fn set_stiffness(&mut self, factor: f64) {
        let before = self.spec.stages[..self.journal.stage].iter();
        let before: f64 = before
            .filter_map(|stage| match stage {
                Stage::Stiffen(stiffen) => Some(stiffen.factor),
                _ => None,
            })
            .product();
        let old = self.engine.state.stiffness_factor;
        self.engine.stiffen(before * factor);
        if self.has_automatic_step() {
            // Δt ∝ 1/√k; the next look finds out the rest
            self.journal.time_step *= (old / (before * factor)).sqrt().min(1.0);
        }
    }
}
