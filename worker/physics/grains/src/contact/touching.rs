//! Contacts that touch, as lists show them to observers.
use super::law::Lanewise;

/// Who touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Who {
    /// Two particles.
    Pair([u32; 2]),
    /// A particle and a plane.
    Plane([u32; 2]),
    /// A particle and a facet.
    Facet([u32; 2]),
}

/// A contact that touched in the last step.
#[derive(Clone, Copy)]
pub(crate) struct Touching<'a> {
    pub(crate) who: Who,
    /// Constant of the normal spring: k_N [N/m] of a linear one.
    pub(crate) constant: f64,
    /// k_T/k_N of the constants.
    pub(crate) shear_ratio: f64,
    /// tan φ.
    pub(crate) friction: f64,
    /// Its law, and its lane there.
    pub(crate) law: &'a dyn Lanewise,
    pub(crate) lane: usize,
}

/// Who looks at contacts.
pub(crate) type Observer<'a> = dyn FnMut(Touching<'_>) + 'a;
