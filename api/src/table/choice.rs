//! Which columns are meant, and by what factor they become the job's.
use super::{
    Hints, Place, Refusal,
    cells::Sheet,
    conversion::{factor, gauge_length, times, unit_of},
    header::Header,
    meaning::{by_meaning, by_name, by_number, no_such_column},
    unit::of_symbol,
    wanted::{Wanted, is_strain},
};

/// A column of the table, in the unit of the job after the factor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chosen {
    pub(super) index: usize,
    pub(super) factor: f64,
    /// Whether the table says no unit for it.
    pub(super) is_bare: bool,
}

/// The two columns.
#[derive(Clone, Debug)]
pub(super) struct Choice {
    pub(super) columns: [Chosen; 2],
    /// Whether the abscissa is a strain.
    pub(super) strain: bool,
    pub(super) words: Vec<String>,
}

impl Choice {
    /// # Errors
    /// When a column is not found, may be several, or has no known unit.
    pub(super) fn new(
        sheet: &Sheet,
        header: &Header,
        wanted: &[Wanted; 2],
        hints: &Hints<'_>,
    ) -> Result<Self, Refusal> {
        if header.columns.is_empty() {
            return by_place(sheet, wanted, hints);
        }
        let mut said = Vec::new();
        let mut columns = Vec::with_capacity(2);
        for (side, wanted) in wanted.iter().enumerate() {
            let (chosen, sentence) = one(sheet, header, side, wanted, hints)?;
            columns.push(chosen);
            said.push(sentence);
        }
        let columns = [columns[0], columns[1]];
        if columns[0].index == columns[1].index {
            let detail = "abscissa and ordinate are the same column";
            return Err(Refusal::new(
                Place::Column(1),
                "not_unique",
                detail,
                "two columns",
            ));
        }
        Ok(Self {
            columns,
            strain: is_strain(&wanted[0].name),
            words: said,
        })
    }
}

/// Columns of a table without names: two of them, in the order and units of the job, or by number.
fn by_place(sheet: &Sheet, wanted: &[Wanted; 2], hints: &Hints<'_>) -> Result<Choice, Refusal> {
    let width = sheet.lines[0].cells.len();
    let mut columns = Vec::with_capacity(2);
    let mut said = Vec::new();
    for (side, wanted) in wanted.iter().enumerate() {
        let hint = hints.columns[side];
        let index = match hint.column {
            Some(name) => by_number(name, width)
                .ok_or_else(|| no_such_column(side, name, width, "the text has no names"))?,
            None if width == 2 => side,
            None => {
                let detail = format!(
                    "{width} columns without names: which one is {}?",
                    wanted.name
                );
                let allowed = "a line of names with units above the numbers, or reading.abscissa and \
                               reading.ordinate with the numbers of the columns";
                return Err(Refusal::new(Place::Text, "ambiguous", detail, allowed));
            }
        };
        let factor = match hint.unit {
            Some(symbol) => factor(side, wanted, symbol, of_symbol(symbol), hints, &|| Ok(None))?.0,
            None => 1.0,
        };
        said.push(format!(
            "column {} (the text has no names) as {}{}",
            index + 1,
            wanted.name,
            if hint.unit.is_some() {
                times(factor)
            } else {
                ", in its unit".to_owned()
            }
        ));
        columns.push(Chosen {
            index,
            factor,
            is_bare: hint.unit.is_none(),
        });
    }
    let columns = [columns[0], columns[1]];
    let strain = is_strain(&wanted[0].name);
    Ok(Choice {
        columns,
        strain,
        words: said,
    })
}

fn one(
    sheet: &Sheet,
    header: &Header,
    side: usize,
    wanted: &Wanted,
    hints: &Hints<'_>,
) -> Result<(Chosen, String), Refusal> {
    let hint = hints.columns[side];
    let index = match hint.column {
        Some(name) => by_name(header, side, name)?,
        None => by_meaning(header, side, wanted)?,
    };
    let column = &header.columns[index];
    let (symbol, unit) = unit_of(sheet, header, index, side, wanted, hint)?;
    let gauge = || gauge_length(sheet, header);
    let (factor, over) = factor(side, wanted, &symbol, unit, hints, &gauge)?;
    let pure = match symbol.as_str() {
        "" => ", a pure number",
        own if own == wanted.name && column.unit.is_none() => ", in its unit",
        _ => "",
    };
    let sentence = format!(
        "column {} '{}'{over} as {}{pure}{}",
        index + 1,
        column.title,
        wanted.name,
        times(factor)
    );
    let is_bare = symbol.is_empty();
    Ok((
        Chosen {
            index,
            factor,
            is_bare,
        },
        sentence,
    ))
}

/// A strain without unit must not lie where it can only be per cent.
///
/// # Errors
/// When it goes beyond what the job gets to.
pub(super) fn check_reach(
    points: &[[f64; 2]],
    wanted: &[Wanted; 2],
    columns: &[Chosen; 2],
    hints: &Hints<'_>,
) -> Result<(), Refusal> {
    let Some(reach) = hints
        .reach
        .filter(|_| columns[0].is_bare && is_strain(&wanted[0].name))
    else {
        return Ok(());
    };
    let largest = points
        .iter()
        .fold(0.0_f64, |largest, [x, _]| largest.max(x.abs()));
    if largest <= reach {
        return Ok(());
    }
    let detail = format!(
        "the strain has no unit and goes to {largest}, beyond the {reach} that the job gets to: per \
         cent?"
    );
    let allowed = "the unit in the title, or reading.abscissa.unit: \"1\" or \"%\"";
    Err(Refusal::new(Place::Unit(0), "ambiguous", detail, allowed))
}
