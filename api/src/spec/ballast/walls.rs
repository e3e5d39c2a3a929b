//! What surrounds a bed.

/// Walls whose forces are told, by their names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Walls {
    /// Below the bed.
    pub base: &'static str,
    /// Around it.
    pub sides: &'static [&'static str],
}
