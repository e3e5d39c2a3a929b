//! Tables that testing machines export, read by name and unit.
//!
//! In the order in which [`read`] calls them: [`encoding`] makes text of a file's bytes; [`cells`]
//! parts it into cells and finds the mark of decimals with the help of [`number`]; [`header`] finds
//! the line of names, with its [`unit`]s; [`choice`] decides which columns are meant, by their
//! [`meaning`], and by what factor of [`conversion`] they become the job's; [`origin`] takes slack or preload off. What can be understood in two
//! ways is refused with both, never decided; every line after the names is a point or refused. [`scale`]
//! finds what a title says beyond name and unit, [`rows`] lines that are no points.
//!
//! What the user says beyond the text are [`Hints`]; a table that is not understood is a [`Refusal`].
//! Nothing here knows of jobs: what is [`wanted`] is two columns by name.
mod cells;
mod choice;
mod conversion;
mod encoding;
#[cfg(test)]
mod exports;
mod header;
mod hints;
mod meaning;
mod number;
mod origin;
mod refusal;
mod rows;
mod scale;
#[cfg(test)]
mod tests;
mod unit;
mod wanted;

use cells::Sheet;
use choice::Choice;
use header::Header;

pub use hints::{ColumnHint, Hints};
pub use number::DecimalMark;
pub use refusal::{Place, Refusal};
pub use wanted::Wanted;

/// A table that was understood.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Abscissa and ordinate of each point, in the units of the wanted columns.
    pub points: Vec<[f64; 2]>,
    /// What was understood, a sentence each.
    pub words: Vec<String>,
}

/// Reads the two wanted columns, abscissa and ordinate, of a table.
///
/// # Errors
/// The first thing that cannot be understood, or can be in two ways.
pub fn read(text: &str, wanted: &[Wanted; 2], hints: &Hints<'_>) -> Result<Reading, Refusal> {
    let (text, coded) = encoding::text(text)?;
    let sheet = Sheet::new(&text, hints.decimal)?;
    let header = Header::find(&sheet)?;
    rows::check(&sheet.lines[header.first..])?;
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
