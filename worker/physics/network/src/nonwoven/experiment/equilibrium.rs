//! Each equilibrium: from where it is searched, how, and what it says of its own quality.
use loadframe_api::spec::nonwoven_tensile::{DescentGradient, Fabric, Solver};
use loadframe_harness::{Interrupt, SimulationError};

use super::Experiment;
use crate::{
    Vector,
    configuration::Verdict,
    equilibrium::{Descent, Gradient, Method, Search, Settled, calm, work::Meter},
    field::Field,
    nonwoven::predictor::JawMove,
};

/// Newton iterations and sweeps allowed when the spec does not say.
const NEWTON_ITERATIONS: u32 = 1_000;
const SWEEPS: u32 = 100_000;
/// Sweeps of a descent, of at most 50 moves of each node: what is not in balance by then hardly ever
/// comes to be.
const DESCENT_SWEEPS: u32 = 1_000;
/// Each step that did not reach equilibrium leaves the following ones fewer Newton iterations: half
/// after the first, a third after the second, and one part in so many at least.
const LEAST_PATIENCE: u32 = 8;

impl Experiment<'_> {
    /// Displacements to search equilibrium from.
    pub(super) fn start(&mut self, meter: &mut Meter<'_>) -> Result<Vec<Vector>, Interrupt> {
        let state = &self.state;
        if state.round > state.rounds_before || state.step == 0 {
            return Ok(state.displacements.clone());
        }
        let (network, parts) = (&self.specimen.network, &self.loaded.parts);
        let jaw_move = self.jaw_move();
        let stretched = jaw_move.stretch(network, parts, &state.displacements);
        let (Solver::NewtonCg, Some(last)) = (self.knobs.solver, &state.last_increment) else {
            return Ok(stretched);
        };
        // of two guesses the one with less energy is closer to the minimum; it is at hand then
        let repeated = jaw_move.repeat(last, network, parts, &state.displacements);
        let assembly = &self.loaded.assembly;
        meter.spend(2 * assembly.bonds())?;
        let is_first = self
            .workspace
            .choose(assembly, [&repeated, &stretched], &self.team);
        Ok(if is_first { repeated } else { stretched })
    }

    pub(super) fn jaw_move(&self) -> JawMove {
        let specimen = &self.specimen;
        JawMove {
            from: self.state.reached.strain * specimen.gauge_length,
            to: self.state.strain * specimen.gauge_length,
            bottom: specimen.bottom,
            gauge_length: specimen.gauge_length,
        }
    }

    pub(super) fn equilibrium(&self) -> Search {
        let knobs = &self.knobs;
        let (method, iterations) = match knobs.solver {
            Solver::NewtonCg => {
                // a test that fails step after step is to end all the same
                let failed = self.state.unconverged.len() as u32;
                let share = (1 + failed).min(LEAST_PATIENCE);
                (Method::NewtonCg, NEWTON_ITERATIONS / share)
            }
            Solver::Sequential => (Method::Sequential, SWEEPS),
            Solver::Parallel => {
                let relaxation_factor = knobs.relaxation_factor;
                (Method::Parallel { relaxation_factor }, SWEEPS)
            }
            Solver::GradientDescent | Solver::BarzilaiBorwein => {
                (Method::Descent(self.descent()), DESCENT_SWEEPS)
            }
        };
        // without strain the limit would be zero, so step 0 is held to the limit of step 1, and what is less
        // strained than that, too; but a force that is read there is to be as exact for its size as any other
        let strain = self.nominal_strain();
        let strain = if strain > 0.0 && self.path.is_read(self.state.place, strain) {
            strain
        } else {
            strain.max(self.spec.test.strain_step)
        };
        Search {
            method,
            iteration_limit: knobs.iteration_limit.unwrap_or(iterations),
            force_limit: self.specimen.softest_tension(strain) / knobs.force_accuracy,
            step_cap: self.step_cap,
            calm: calm(knobs.force_accuracy),
        }
    }

    fn descent(&self) -> Descent {
        let knobs = &self.knobs;
        let mean_length = self.specimen.network.bonds.mean_rest_length();
        Descent {
            gradient: match knobs.descent_gradient {
                DescentGradient::Exact => Gradient::Exact,
                DescentGradient::AsPrinted => Gradient::Printed,
                DescentGradient::Smoothed => Gradient::Smoothed {
                    spacing: knobs.smoothing_spacing * mean_length,
                },
            },
            step: knobs.descent_step_mm2_per_n,
            is_adaptive: knobs.solver == Solver::BarzilaiBorwein,
        }
    }

    /// Keeps what the equilibrium says about its own quality.
    pub(super) fn judge(&mut self, settled: &Settled, force_limit: f64) {
        let worst = &mut self.state.worst_of_step;
        let ratio = settled.residual.largest / force_limit;
        worst.residual_ratio = worst.residual_ratio.max(ratio);
        worst.is_unconverged |= settled.residual.verdict == Verdict::Unbalanced;
        worst.is_round_off |= settled.residual.verdict == Verdict::RoundOff;
        if self.state.mechanism.is_none() {
            let node = settled.mechanism(&self.loaded.assembly);
            self.state.mechanism = node.map(|node| (node, self.nominal_strain()));
        }
    }

    /// Keeps where a balance, in which nothing breaks any more, is one that does not last. Looked for in what
    /// is given node by node, where who gave it can move a node: a lattice is irregular, and between rounds of
    /// breaking it passes through such states.
    pub(super) fn judge_stability(&mut self, force_limit: f64) {
        let is_given = matches!(self.spec.fabric, Fabric::Network(_));
        if let Some(settled) = self.settled.as_ref().filter(|_| is_given)
            && self.state.unstable.is_none()
        {
            let node = settled.unstable(&self.loaded.assembly, force_limit);
            self.state.unstable = node.map(|node| (node, self.nominal_strain()));
        }
    }

    pub(super) fn check_finite(&self, settled: &Settled) -> Result<(), SimulationError> {
        let configuration = &settled.configuration;
        let error = |node, quantity| SimulationError::NonFinite {
            node: self.loaded.assembly.node(node),
            step: self.state.step,
            quantity,
        };
        let first = |field: &Field<f64>| {
            if field.is_finite() {
                return None;
            }
            let is_bad = |node: &usize| !field.at(*node).iter().all(|value| value.is_finite());
            (0..self.loaded.assembly.places()).find(is_bad)
        };
        if let Some(node) = first(&configuration.displacements) {
            return Err(error(node, "displacement"));
        }
        if let Some(node) = first(&configuration.resultants) {
            return Err(error(node, "resultant"));
        }
        Ok(())
    }
}
