//! The same of elements that are softer along themselves than the network's own: those that yield.
use std::borrow::Cow;

use super::super::clusters::Clusters;
use super::super::element::{Element, PARTS};
use super::super::error::FrameError;
use super::super::network::Network;
use super::{Equilibrium, Refactoring};

impl<'n> Equilibrium<'n> {
    /// The rest of a pull by 1 µm, of elements softer along themselves than the network's own, without
    /// those that are broken.
    pub(crate) fn softer(
        network: &'n Network,
        elements: Vec<Element>,
        broken: &[u32],
    ) -> Result<Self, FrameError> {
        let solved = (Clusters::Spanning, Refactoring::ByCost);
        Self::of_elements(network, Cow::Owned(elements), solved, (1.0, &[]), broken)
    }

    /// Makes elements as stiff along themselves as is asked.
    pub(crate) fn change(&mut self, axial: &[(usize, f64)]) -> Result<(), FrameError> {
        if axial.is_empty() {
            return Ok(());
        }
        let mut is_changed = self.is_correction_due(axial.len().div_ceil(PARTS) * PARTS);
        for &(element, stiffness) in axial {
            let less = self.elements[element].stiffness[0] - stiffness;
            let mut taken = [0.0; PARTS];
            taken[0] = less;
            is_changed = is_changed && (!self.is_active[element] || self.take(element, &taken));
            self.elements.to_mut()[element].stiffness[0] = stiffness;
        }
        if is_changed {
            self.settle()
        } else {
            self.rebuild()
        }
    }

    /// Stiffness of an element along itself [mN/µm].
    pub(crate) fn axial(&self, element: usize) -> f64 {
        self.elements[element].stiffness[0]
    }

    /// Whether an element is whole and stretched.
    pub(crate) fn is_stretched(&self, element: usize) -> bool {
        self.is_active[element]
    }

    pub(crate) fn active(&self) -> &[bool] {
        &self.is_active
    }

    /// Whether it is as it was factored.
    pub(crate) fn is_as_factored(&self) -> bool {
        self.softening.is_empty() && self.taken.is_empty()
    }
}
