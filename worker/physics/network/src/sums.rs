//! Where kernels add up what bonds do to their ends.
use super::field::Real;

/// Sums at places, in one array per component.
#[derive(Debug)]
pub(crate) struct Sums<'a, T, const N: usize> {
    /// The place of the first of them.
    pub(crate) first: usize,
    pub(crate) own: [&'a mut [T]; N],
    /// At the places after those, which are somebody else's.
    spill: [&'a mut [T]; N],
}

impl<'a, T: Real, const N: usize> Sums<'a, T, N> {
    pub(crate) fn new(first: usize, own: [&'a mut [T]; N], spill: [&'a mut [T]; N]) -> Self {
        Self { first, own, spill }
    }

    pub(crate) fn clear(&mut self) {
        self.clear_spill();
        for component in &mut self.own {
            component.fill(T::zero());
        }
    }

    pub(crate) fn clear_spill(&mut self) {
        for component in &mut self.spill {
            component.fill(T::zero());
        }
    }

    /// Those of a component at so many places from `place` on.
    #[inline(always)]
    pub(crate) fn at(&mut self, component: usize, place: usize, count: usize) -> [&mut [T]; 2] {
        let (own, spill) = (&mut self.own[component], &mut self.spill[component]);
        let start = place - self.first;
        let inside = own.len().saturating_sub(start).min(count);
        let beyond = start.saturating_sub(own.len());
        let own = if inside > 0 {
            &mut own[start..][..inside]
        } else {
            &mut []
        };
        let spill = if inside < count {
            &mut spill[beyond..][..count - inside]
        } else {
            &mut []
        };
        [own, spill]
    }
}
