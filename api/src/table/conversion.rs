//! Factors from the table's units to the job's.
use super::{
    ColumnHint, Hints, Place, Refusal,
    cells::{Line, Sheet},
    header::{Column, Header, column as column_of, words},
    meaning::{is_plain_strain, means},
    unit::{Dimension, Unit, of_column, of_symbol},
    wanted::{Wanted, name_of},
};

/// A gauge length [mm] and where it is from.
pub(super) type Gauge = (f64, String);

/// The unit of a column, by its title or the hint; an empty symbol is a pure number, the name of the
/// wanted column its own unit.
pub(super) fn unit_of(
    sheet: &Sheet,
    header: &Header,
    index: usize,
    side: usize,
    wanted: &Wanted,
    hint: ColumnHint<'_>,
) -> Result<(String, Option<Unit>), Refusal> {
    let column = &header.columns[index];
    if let Some(symbol) = hint.unit {
        let unit = of_symbol(symbol);
        if column.beyond.is_none() && column.unit.is_some() && unit.is_some() && column.unit != unit
        {
            let detail = format!("the title of column {} is '{}'", index + 1, column.title);
            let refusal = Refusal::new(
                Place::Unit(side),
                "contradiction",
                detail,
                "the unit of the title",
            );
            return Err(refusal.value(symbol));
        }
        return Ok((symbol.to_owned(), unit));
    }
    let own = of_column(&wanted.name);
    match (&column.symbol, column.unit) {
        // exactly the job's column, or one that has no unit on either side
        _ if column.title.eq_ignore_ascii_case(&wanted.name) => Ok((wanted.name.clone(), own)),
        _ if column.beyond.is_some() => Err(beyond(side, index, column)),
        (Some(symbol), Some(unit)) => Ok((symbol.clone(), Some(unit))),
        (Some(symbol), None) => {
            let detail = format!(
                "the unit {symbol:?} of column {} '{}' is not known",
                index + 1,
                column.title
            );
            Err(open_unit(side, own, detail))
        }
        (None, _) if own.is_none() => Ok((String::new(), None)),
        // `Extension` and `Elongation` may be lengths
        (None, _) if own.is_some_and(|unit| !is_said(column, unit)) => {
            let detail = format!("column {} '{}' has no unit", index + 1, column.title);
            Err(open_unit(side, own, detail))
        }
        (None, _) if let Some(line) = own.and_then(|own| unit_above(sheet, header, own)) => {
            let detail = format!(
                "column {} '{}' has no unit, but line {} above it names one",
                index + 1,
                column.title,
                line.number
            );
            Err(open_unit(side, own, detail))
        }
        (None, _) if own.is_some_and(|unit| unit.dimension == Dimension::Ratio) => {
            Ok((String::new(), own))
        }
        // a table that knows no units is one in the job's, as one without names
        (None, _) if header.columns.iter().all(|column| column.symbol.is_none()) => {
            Ok((wanted.name.clone(), own))
        }
        (None, _) => {
            let detail = format!("column {} '{}' has no unit", index + 1, column.title);
            Err(open_unit(side, own, detail))
        }
    }
}

/// A line above the names that speaks of units, or has one like `own` that is another.
fn unit_above<'a>(sheet: &'a Sheet, header: &Header, own: Unit) -> Option<&'a Line> {
    const UNITS: [&str; 11] = [
        "unit",
        "units",
        "einheit",
        "einheiten",
        "jednotka",
        "jednotky",
        "unite",
        "unites",
        "unidad",
        "unidades",
        "unita",
    ];
    // a strain stands beside shares of all kinds, such as the force at which a test ends
    let is_measure = own.dimension != Dimension::Ratio;
    let is_other = |cell: &String| {
        let unit = column_of(cell).unit;
        unit.is_some_and(|unit| unit.dimension == own.dimension && unit != own)
    };
    sheet.lines[..header.above].iter().find(|line| {
        let mut cells = line.cells.iter();
        cells.any(|cell| {
            words(cell)
                .iter()
                .any(|word| UNITS.contains(&word.as_str()))
                || is_measure && is_other(cell)
        })
    })
}

/// A title that says more than a name and a unit.
fn beyond(side: usize, index: usize, column: &Column) -> Refusal {
    let said = column.beyond.as_deref().unwrap_or_default();
    let detail = format!(
        "column {} '{}' says more than a name and a unit ({said:?}), which tables are not converted by",
        index + 1,
        column.title
    );
    let allowed = format!(
        "a title of name and unit alone, its numbers converted to that; or reading.{0}.column with its name \
         or number and reading.{0}.unit with what a 1 in it stands for",
        name_of(side)
    );
    Refusal::new(Place::Unit(side), "ambiguous", detail, &allowed).value(column.title.clone())
}

/// Whether the title leaves no doubt of what a column without unit measures.
fn is_said(column: &Column, unit: Unit) -> bool {
    let others = [Dimension::Ratio, Dimension::Length, Dimension::Force];
    let is_other = |other: &Dimension| *other != unit.dimension && means(column, *other);
    let is_strain = unit.dimension == Dimension::Ratio && is_plain_strain(column);
    is_strain || means(column, unit.dimension) && !others.iter().any(is_other)
}

fn open_unit(side: usize, own: Option<Unit>, detail: String) -> Refusal {
    let units = own.map_or("the unit of the job's column", |unit| {
        unit.dimension.words().1
    });
    let allowed = format!("{units}, in the title or in reading.{}.unit", name_of(side));
    Refusal::new(Place::Unit(side), "ambiguous", detail, &allowed)
}

/// The factor to the job's unit, and what it leads over.
pub(super) fn factor(
    side: usize,
    wanted: &Wanted,
    symbol: &str,
    unit: Option<Unit>,
    hints: &Hints<'_>,
    gauge: &dyn Fn() -> Result<Option<Gauge>, Refusal>,
) -> Result<(f64, String), Refusal> {
    let Some(own) = of_column(&wanted.name) else {
        let is_same = symbol.is_empty() || symbol == wanted.name || symbol == "1";
        if is_same {
            return Ok((1.0, String::new()));
        }
        let detail = format!("{} is in no unit that tables are converted to", wanted.name);
        let allowed = "a column of the job's own name, or without unit and in the job's";
        let refusal = Refusal::new(Place::Unit(side), "not_allowed", detail, allowed);
        return Err(refusal.value(symbol));
    };
    let Some(unit) = unit else {
        let detail = format!("the unit {symbol:?} is not known");
        return Err(open_unit(side, Some(own), detail).value(symbol));
    };
    let ratio = round(unit.factor / own.factor);
    let length = || {
        // the user's word goes before what the table says, in one way or several
        if let Some(length) = hints.gauge_length_mm {
            return Ok((length, "given".to_owned()));
        }
        gauge()?.ok_or_else(|| {
            let detail = format!(
                "{} is a strain, but the column is a length ({symbol})",
                wanted.name
            );
            let detail = if own.dimension == Dimension::Ratio {
                detail
            } else {
                format!("{} is a length, but the column is a strain", wanted.name)
            };
            let allowed = "reading.gauge_length_mm, that of the measured specimen";
            Refusal::new(Place::GaugeLength, "missing_field", detail, allowed)
        })
    };
    match (unit.dimension, own.dimension) {
        (one, other) if one == other => Ok((ratio, String::new())),
        (Dimension::Length, Dimension::Ratio) => {
            let (gauge, from) = length()?;
            let over = format!(" over the gauge length of {gauge} mm ({from})");
            Ok((round(1e3 * unit.factor / gauge), over))
        }
        (Dimension::Ratio, Dimension::Length) => {
            let (gauge, from) = length()?;
            let over = format!(" times the gauge length of {gauge} mm ({from})");
            Ok((round(1e-3 * gauge * unit.factor / own.factor), over))
        }
        (Dimension::ForcePerLength, Dimension::Force) => {
            let detail = format!(
                "{} is a force, but the column is one per width ({symbol})",
                wanted.name
            );
            let allowed = format!(
                "{}: the column times the width of the job's specimen",
                own.dimension.words().1
            );
            let refusal = Refusal::new(Place::Unit(side), "not_allowed", detail, &allowed);
            Err(refusal.value(symbol))
        }
        (one, other) => {
            let detail = format!(
                "{} is {}, but the column is {} ({symbol})",
                wanted.name,
                other.words().0,
                one.words().0
            );
            let refusal = Refusal::new(Place::Unit(side), "not_allowed", detail, other.words().1);
            Err(refusal.value(symbol))
        }
    }
}

/// A factor without the last digits that a ratio of decimals leaves: 0.001, not
/// 0.0010000000000000002.
fn round(factor: f64) -> f64 {
    format!("{factor:.14e}").parse().unwrap_or(factor)
}

#[allow(clippy::float_cmp, reason = "1 means that nothing is to be said")]
pub(super) fn times(factor: f64) -> String {
    if factor == 1.0 {
        String::new()
    } else {
        format!(", times {factor}")
    }
}

/// The gauge length in the lines above the names: a label, a number, and a unit in either.
///
/// # Errors
/// When lines say different ones, as a gauge length and a grip separation may, or when one can be read
/// in two ways.
pub(super) fn gauge_length(sheet: &Sheet, header: &Header) -> Result<Option<Gauge>, Refusal> {
    let mut found: Option<(&Line, f64)> = None;
    for line in &sheet.lines[..header.above] {
        let Some(length) = length_of(sheet, line)? else {
            continue;
        };
        match found {
            None => found = Some((line, length)),
            Some((first, other)) if other.total_cmp(&length).is_ne() => {
                let [one, two] = [(first, other), (line, length)].map(|(line, length)| {
                    let label = line.cells.first().map_or("", String::as_str);
                    format!("line {} says {length} mm ('{label}')", line.number)
                });
                let detail = format!("{one}, {two}: which is the gauge length?");
                let allowed = "reading.gauge_length_mm, that of the measured specimen";
                let refusal = Refusal::new(Place::GaugeLength, "ambiguous", detail, allowed);
                return Err(refusal);
            }
            Some(_) => {}
        }
    }
    Ok(found.map(|(line, length)| (length, format!("line {}", line.number))))
}

/// The gauge length [mm] that a line says.
fn length_of(sheet: &Sheet, line: &Line) -> Result<Option<f64>, Refusal> {
    const LABELS: [&[&str]; 9] = [
        &["gauge", "length"],
        &["gage", "length"],
        &["grip", "separation"],
        &["messlange"],
        &["meßlange"],
        &["einspannlange"],
        &["anfangsmesslange"],
        &["upinaci", "delka"],
        &["initial", "length"],
    ];
    let [label, number, rest @ ..] = &line.cells[..] else {
        return Ok(None);
    };
    let said = words(label);
    let is_label = LABELS
        .iter()
        .any(|label| said.windows(label.len()).any(|part| part == *label));
    let beside = rest
        .first()
        .map(|cell| cell.trim_matches(['(', ')', '[', ']']));
    let within = label
        .rsplit_once(['(', '['])
        .map(|(_, end)| end.trim_end_matches([')', ']', ':', ' ']));
    let unit = beside
        .and_then(of_symbol)
        .or_else(|| within.and_then(of_symbol))
        .filter(|unit| is_label && unit.dimension == Dimension::Length);
    let Some(unit) = unit else {
        return Ok(None);
    };
    let number = sheet.number_above(line, number)?;
    Ok(number
        .filter(|number| *number > 0.0)
        .map(|number| round(1e3 * unit.factor * number)))
}
