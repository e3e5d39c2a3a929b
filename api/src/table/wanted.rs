//! What is looked for in a table.
use super::unit::{Dimension, of_column};

/// A column of the job's curve that is looked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// With its unit at the end: `force_n`.
    pub name: String,
}

/// The field that says it.
pub(super) fn name_of(side: usize) -> &'static str {
    ["abscissa", "ordinate"][side]
}

/// Whether a column of the job is a strain.
pub(super) fn is_strain(name: &str) -> bool {
    of_column(name).is_some_and(|unit| unit.dimension == Dimension::Ratio)
}
