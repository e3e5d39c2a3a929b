//! What a checkpoint keeps of a motion.
use serde::{Deserialize, Serialize};

use super::Motion;
use crate::error::CompositeError;

/// All that changes while a lattice moves: what a checkpoint keeps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MotionState {
    u: Vec<f64>,
    before: Vec<f64>,
    drive: Vec<f64>,
    kinetic: f64,
    is_starting: bool,
    steps: u64,
    /// XPBD's multipliers, of cells and of bonds.
    cells: Vec<[f64; 5]>,
    bonds: Vec<f64>,
}

impl Motion<'_> {
    /// What a checkpoint keeps.
    #[must_use]
    pub fn state(&self) -> MotionState {
        let memory = self.gains.memory.as_ref();
        MotionState {
            u: self.u.clone(),
            before: self.before.clone(),
            drive: self.drive.clone(),
            kinetic: self.kinetic,
            is_starting: self.is_starting,
            steps: self.steps,
            cells: memory.map_or_else(Vec::new, |memory| memory.cells.clone()),
            bonds: memory.map_or_else(Vec::new, |memory| memory.bonds.clone()),
        }
    }

    /// Goes on from a state of the same lattice, supports and options.
    ///
    /// # Errors
    /// [`CompositeError::OtherSize`] when it is of another lattice.
    pub fn resume(&mut self, state: MotionState) -> Result<(), CompositeError> {
        let memory = self.gains.memory.as_ref();
        let fits = state.u.len() == self.u.len()
            && state.before.len() == self.u.len()
            && state.drive.len() == self.u.len()
            && memory.is_none_or(|memory| {
                state.cells.len() == memory.cells.len() && state.bonds.len() == memory.bonds.len()
            });
        if !fits {
            return Err(CompositeError::OtherSize);
        }
        if let Some(memory) = &mut self.gains.memory {
            memory.cells = state.cells;
            memory.bonds = state.bonds;
        }
        self.u = state.u;
        self.before = state.before;
        self.drive = state.drive;
        self.kinetic = state.kinetic;
        self.is_starting = state.is_starting;
        self.steps = state.steps;
        Ok(())
    }
}
