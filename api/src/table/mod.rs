//! Tables that testing machines export, read by name and unit.
//!
//! In the order in which [`read`] calls them: [`encoding`] makes text of a file's bytes; [`cells`]
//! parts it into cells and finds the mark of decimals with the help of [`number`]; [`header`] finds
//! the line of names, with its [`unit`]s; [`choice`] decides which columns are meant, by their
//! [`meaning`], and by what factor of [`conversion`] they become the job's; [`origin`] takes slack or preload off. What can be understood in two
//! ways is refused with both, never decided; every line after the names is a point or refused.
//!
//! Nothing here knows of jobs: what is [`wanted`] is two columns by name.
mod cells;
mod choice;
mod conversion;
mod encoding;
mod header;
mod meaning;
mod number;
mod origin;
#[cfg(test)]
mod tests;
mod unit;
mod wanted;

use cells::Sheet;
use choice::Choice;
use header::Header;

pub use number::DecimalMark;
pub use wanted::Wanted;

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

/// A table that was understood.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Abscissa and ordinate of each point, in the units of the wanted columns.
    pub points: Vec<[f64; 2]>,
    /// What was understood, a sentence each.
    pub words: Vec<String>,
}

/// Why a table is not understood.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// The field to which it is said.
    pub place: Place,
    /// Word for programs, as in [`crate::Violation`].
    pub code: &'static str,
    pub detail: String,
    /// What was found there.
    pub value: Option<String>,
    pub allowed: String,
}

/// What a refusal is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    Text,
    /// The hint of abscissa (0) or ordinate (1).
    Column(usize),
    Unit(usize),
    Decimal,
    GaugeLength,
    Preload,
    Slack,
}

impl Refusal {
    fn new(place: Place, code: &'static str, detail: impl Into<String>, allowed: &str) -> Self {
        Self {
            place,
            code,
            detail: detail.into(),
            value: None,
            allowed: allowed.to_owned(),
        }
    }

    fn value(mut self, value: impl Into<String>) -> Self {
        self.value = Some(value.into());
        self
    }
}

/// Reads the two wanted columns, abscissa and ordinate, of a table.
///
/// # Errors
/// The first thing that cannot be understood, or can be in two ways.
pub fn read(text: &str, wanted: &[Wanted; 2], hints: &Hints<'_>) -> Result<Reading, Refusal> {
    let (text, coded) = encoding::text(text)?;
    let sheet = Sheet::new(&text, hints.decimal)?;
    let header = Header::find(&sheet)?;
    let choice = Choice::new(&sheet, &header, wanted, hints)?;
    let mut points = Vec::with_capacity(sheet.lines.len() - header.first);
    for line in &sheet.lines[header.first..] {
        let mut point = [0.0; 2];
        for (number, column) in point.iter_mut().zip(&choice.columns) {
            *number = column.factor * sheet.number(line, column.index)?;
        }
        points.push(point);
    }
    let mut words: Vec<String> = coded.into_iter().collect();
    words.push(format!(
        "{} points from line {} on, {}",
        points.len(),
        sheet.lines[header.first].number,
        sheet.words()
    ));
    words.extend(choice.words);
    choice::check_reach(&points, wanted, &choice.columns, hints)?;
    words.extend(origin::move_to(&mut points, choice.strain, hints)?);
    Ok(Reading { points, words })
}
