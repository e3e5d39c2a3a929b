//! Counting work, and looking for interrupts while it is done.
use loadframe_harness::{Interrupt, InterruptSource};
use serde::{Deserialize, Serialize};

/// Work done so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Work {
    /// Bonds times passes over them (energy and forces, Hessian times vector, node steps).
    pub(crate) bond_evaluations: u64,
    /// Equilibria searched.
    pub(crate) equilibria: u64,
    pub(crate) newton_iterations: u64,
    pub(crate) conjugate_gradient_iterations: u64,
    /// Passes of a relaxation over the nodes.
    pub(crate) sweeps: u64,
}

/// Bond evaluations between two looks at the interrupt source: some milliseconds of work.
const EVALUATIONS_BETWEEN_LOOKS: u64 = 500_000;

/// Counts work and looks for interrupts often enough, however large the network is.
pub(crate) struct Meter<'a> {
    pub(crate) work: Work,
    source: &'a dyn InterruptSource,
    next_look: u64,
}

impl<'a> Meter<'a> {
    pub(crate) fn new(work: Work, source: &'a dyn InterruptSource) -> Self {
        Self {
            work,
            source,
            next_look: work.bond_evaluations + EVALUATIONS_BETWEEN_LOOKS,
        }
    }

    /// Counts work about to be done, or done.
    ///
    /// # Errors
    /// The interrupt to obey now.
    pub(crate) fn spend(&mut self, bond_evaluations: usize) -> Result<(), Interrupt> {
        self.work.bond_evaluations += bond_evaluations as u64;
        if self.work.bond_evaluations < self.next_look {
            return Ok(());
        }
        self.next_look = self.work.bond_evaluations + EVALUATIONS_BETWEEN_LOOKS;
        self.look()
    }

    /// Looks for an interrupt whatever was done.
    ///
    /// # Errors
    /// The interrupt found.
    pub(crate) fn look(&self) -> Result<(), Interrupt> {
        self.source.heed()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU64, Ordering};

    #[derive(Default)]
    struct Looks(AtomicU64);

    impl InterruptSource for Looks {
        fn interrupt(&self) -> Option<Interrupt> {
            self.0.fetch_add(1, Ordering::Relaxed);
            None
        }
    }

    #[test]
    fn looks_follow_the_work_whatever_the_size_of_a_pass() -> Result<(), Interrupt> {
        for pass in [8, 30_000, 7_000_000] {
            let looks = Looks::default();
            let mut meter = Meter::new(Work::default(), &looks);
            for _ in 0..10_000_000 / pass {
                meter.spend(pass)?;
            }
            let expected = meter.work.bond_evaluations / EVALUATIONS_BETWEEN_LOOKS.max(pass as u64);
            let found = looks.0.load(Ordering::Relaxed);
            assert!(
                found.abs_diff(expected) <= 1,
                "{found} looks, {expected} expected"
            );
        }
        Ok(())
    }
}
