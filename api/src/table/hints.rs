//! What the user says of a table beyond its text.
use super::DecimalMark;

/// What the user says of a table beyond its text; everything left out is found in the text.
#[derive(Clone, Copy, Debug, Default)]
pub struct Hints<'a> {
    /// Of abscissa and ordinate: the column by its name or number (from 1), and its unit.
    pub columns: [ColumnHint<'a>; 2],
    pub decimal: Option<DecimalMark>,
    /// Gauge length of the measured specimen [mm].
    pub gauge_length_mm: Option<f64>,
    /// Ordinate at which the abscissa begins to count.
    pub preload: Option<f64>,
    /// Two ordinates: the straight line between them is drawn back to zero, where the abscissa begins
    /// to count.
    pub slack: Option<[f64; 2]>,
    /// Largest abscissa that the job gets to, in its own unit.
    pub reach: Option<f64>,
}

/// What the user says of one column.
#[derive(Clone, Copy, Debug, Default)]
pub struct ColumnHint<'a> {
    pub column: Option<&'a str>,
    pub unit: Option<&'a str>,
}
