//! A result as it is read off a test.

/// A result.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Measured {
    pub(super) name: &'static str,
    /// Not a number where the test did not get so far.
    pub(super) value: f64,
    pub(super) unit: &'static str,
    pub(super) description: &'static str,
}
