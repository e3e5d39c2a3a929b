//! Which columns are meant, and by what factor they become the job's.
use super::{
    ColumnHint, Hints, Place, Refusal,
    cells::Sheet,
    header::{Column, Header, words},
    unit::{Dimension, Unit, of_column, of_symbol},
};

/// A column of the job's curve that is looked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// With its unit at the end: `force_n`.
    pub name: String,
}

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

/// A gauge length [mm] and where it is from.
type Gauge = (f64, String);

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

fn is_strain(name: &str) -> bool {
    of_column(name).is_some_and(|unit| unit.dimension == Dimension::Ratio)
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
            Some(symbol) => factor(side, wanted, symbol, of_symbol(symbol), hints, &|| None)?.0,
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
    let (symbol, unit) = unit_of(column, index, side, wanted, hint)?;
    let gauge = || gauge_length(sheet, header, hints);
    let (factor, over) = factor(side, wanted, &symbol, unit, hints, &gauge)?;
    let pure = if symbol.is_empty() {
        ", a pure number"
    } else {
        ""
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

/// The unit of a column, by its title or the hint; an empty symbol is a pure number.
fn unit_of(
    column: &Column,
    index: usize,
    side: usize,
    wanted: &Wanted,
    hint: ColumnHint<'_>,
) -> Result<(String, Option<Unit>), Refusal> {
    if let Some(symbol) = hint.unit {
        let unit = of_symbol(symbol);
        if column.unit.is_some() && unit.is_some() && column.unit != unit {
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
        (Some(symbol), Some(unit)) => Ok((symbol.clone(), Some(unit))),
        // exactly the job's column, or one that has no unit on either side
        _ if column.title.eq_ignore_ascii_case(&wanted.name) => Ok((wanted.name.clone(), own)),
        (Some(symbol), None) => {
            let detail = format!(
                "the unit {symbol:?} of column {} '{}' is not known",
                index + 1,
                column.title
            );
            Err(open_unit(side, own, detail))
        }
        (None, _) if own.is_some_and(|unit| unit.dimension == Dimension::Ratio) => {
            Ok((String::new(), own))
        }
        (None, _) => {
            let detail = format!("column {} '{}' has no unit", index + 1, column.title);
            Err(open_unit(side, own, detail))
        }
    }
}

fn open_unit(side: usize, own: Option<Unit>, detail: String) -> Refusal {
    let units = own.map_or("the unit of the job's column", |unit| {
        unit.dimension.words().1
    });
    let allowed = format!("{units}, in the title or in reading.{}.unit", name_of(side));
    Refusal::new(Place::Unit(side), "ambiguous", detail, &allowed)
}

fn name_of(side: usize) -> &'static str {
    ["abscissa", "ordinate"][side]
}

/// The factor to the job's unit, and what it leads over.
fn factor(
    side: usize,
    wanted: &Wanted,
    symbol: &str,
    unit: Option<Unit>,
    hints: &Hints<'_>,
    gauge: &dyn Fn() -> Option<Gauge>,
) -> Result<(f64, String), Refusal> {
    let Some(own) = of_column(&wanted.name) else {
        // what the job does not give in a unit of measurements is taken as it is
        return Ok((1.0, String::new()));
    };
    let Some(unit) = unit else {
        let detail = format!("the unit {symbol:?} is not known");
        return Err(open_unit(side, Some(own), detail).value(symbol));
    };
    let ratio = round(unit.factor / own.factor);
    let length = || {
        let given = hints
            .gauge_length_mm
            .map(|length| (length, "given".to_owned()));
        given.or_else(gauge).ok_or_else(|| {
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
fn times(factor: f64) -> String {
    if factor == 1.0 {
        String::new()
    } else {
        format!(", times {factor}")
    }
}

fn by_number(name: &str, width: usize) -> Option<usize> {
    let number: usize = name.trim().parse().ok()?;
    (1..=width).contains(&number).then(|| number - 1)
}

fn no_such_column(side: usize, name: &str, width: usize, detail: &str) -> Refusal {
    let allowed = format!("a number of a column, 1 … {width}");
    Refusal::new(Place::Column(side), "not_allowed", detail, &allowed).value(name)
}

fn by_name(header: &Header, side: usize, name: &str) -> Result<usize, Refusal> {
    let wanted = words(name);
    let found = header.columns.iter().enumerate().filter(|(_, column)| {
        column.title.trim().eq_ignore_ascii_case(name.trim())
            || words(&column.title) == wanted
            || column.words == wanted
    });
    let found: Vec<usize> = found.map(|(index, _)| index).collect();
    match found[..] {
        [index] => Ok(index),
        [] => {
            let Some(index) = by_number(name, header.columns.len()) else {
                let detail = format!("line {} names no such column", header.line);
                let allowed = format!(
                    "one of: {}; or its number",
                    titles(header, 0..header.columns.len())
                );
                let refusal = Refusal::new(Place::Column(side), "not_allowed", detail, &allowed);
                return Err(refusal.value(name));
            };
            // a broken line below the names would pass for names
            let are_names = header
                .columns
                .iter()
                .any(|column| column.unit.is_some() || meaning(column).is_some());
            if are_names {
                return Ok(index);
            }
            let detail = format!(
                "line {} holds neither numbers nor names with units",
                header.line
            );
            let allowed = "names with units above the numbers, or no line of text right above them";
            Err(Refusal::new(Place::Text, "ambiguous", detail, allowed))
        }
        _ => Err(several(header, side, name, &found)),
    }
}

fn several(header: &Header, side: usize, name: &str, found: &[usize]) -> Refusal {
    let detail = format!(
        "{name} may be any of: {}",
        titles(header, found.iter().copied())
    );
    let allowed = format!(
        "reading.{}.column with the name or number of one",
        name_of(side)
    );
    Refusal::new(Place::Column(side), "ambiguous", detail, &allowed)
}

fn titles(header: &Header, columns: impl Iterator<Item = usize>) -> String {
    let shown =
        columns.map(|index| format!("column {} '{}'", index + 1, header.columns[index].title));
    shown.collect::<Vec<_>>().join(", ")
}

/// The column that means what is wanted.
fn by_meaning(header: &Header, side: usize, wanted: &Wanted) -> Result<usize, Refusal> {
    let columns = || header.columns.iter().enumerate();
    let named = |(index, column): (usize, &Column)| {
        column
            .title
            .eq_ignore_ascii_case(&wanted.name)
            .then_some(index)
    };
    let exact: Vec<usize> = columns().filter_map(named).collect();
    let own = of_column(&wanted.name).map(|unit| unit.dimension);
    let of = |dimension: Dimension| -> Vec<usize> {
        // by unit and word; by unit alone; by word where no unit is said
        let with = |column: &Column| column.unit.is_some_and(|unit| unit.dimension == dimension);
        let both = columns().filter(|(_, column)| with(column) && means(column, dimension));
        let both: Vec<usize> = both.map(|(index, _)| index).collect();
        let worded =
            columns().filter(|(_, column)| column.unit.is_none() && means(column, dimension));
        let worded: Vec<usize> = worded.map(|(index, _)| index).collect();
        match (both.is_empty(), worded.is_empty()) {
            (false, true) => both,
            (false, false) => [both, worded].concat(),
            (true, false) => worded,
            // pure numbers and lengths stand for much else
            (true, true) if matches!(dimension, Dimension::Ratio) => Vec::new(),
            (true, true) => columns()
                .filter(|(_, column)| with(column))
                .map(|(index, _)| index)
                .collect(),
        }
    };
    let found = match (exact.is_empty(), own) {
        (false, _) => exact,
        (true, None) => Vec::new(),
        (true, Some(own)) => {
            let other = match own {
                Dimension::Ratio => Some(Dimension::Length),
                Dimension::Length => Some(Dimension::Ratio),
                _ => None,
            };
            let same = of(own);
            if same.is_empty() {
                other.map_or(same, of)
            } else {
                same
            }
        }
    };
    match found[..] {
        [index] => Ok(index),
        [] => {
            let detail = format!(
                "line {} names no column for {}: {}",
                header.line,
                wanted.name,
                titles(header, 0..header.columns.len())
            );
            let allowed = format!(
                "reading.{}.column with the name or number of one",
                name_of(side)
            );
            Err(Refusal::new(
                Place::Column(side),
                "missing_field",
                detail,
                &allowed,
            ))
        }
        _ => Err(several(header, side, &wanted.name, &found)),
    }
}

/// Words for what is measured, in the languages of testing machines: parts of words, and whole words.
const MEANINGS: [(Dimension, &[&str], &[&str]); 5] = [
    (
        Dimension::Ratio,
        &["strain", "dehnung"],
        &[
            "elongation",
            "stretch",
            "deformation",
            "deformace",
            "protazeni",
            "prodlouzeni",
            "taznost",
            "allongement",
            "deformacion",
            "elongacion",
            "alargamiento",
            "allungamento",
            "deformazione",
            "epsilon",
            "eps",
            "ε",
        ],
    ),
    (
        Dimension::Length,
        &[
            "extens",
            "displacement",
            "dehnung",
            "crosshead",
            "standardweg",
            "traversenweg",
            "verlangerung",
        ],
        &[
            "weg",
            "elongation",
            "stroke",
            "position",
            "travel",
            "deflection",
            "deformation",
            "traverse",
            "separation",
            "durchbiegung",
            "prodlouzeni",
            "protazeni",
            "deformace",
            "posuv",
            "posunuti",
            "draha",
            "deplacement",
            "allongement",
            "course",
            "desplazamiento",
            "alargamiento",
            "spostamento",
            "allungamento",
            "corsa",
            "jaw",
        ],
    ),
    (
        Dimension::Force,
        &["force", "load", "kraft"],
        &[
            "last", "sila", "zatizeni", "fuerza", "carga", "forza", "carico", "effort", "charge",
            "f",
        ],
    ),
    (
        Dimension::Time,
        &["time", "zeit"],
        &["cas", "temps", "tiempo", "tempo", "t"],
    ),
    (
        Dimension::Stress,
        &["stress", "spannung"],
        &["napeti", "contrainte", "tension", "sforzo"],
    ),
];

fn means(column: &Column, dimension: Dimension) -> bool {
    MEANINGS.iter().any(|(of, parts, whole)| {
        *of == dimension
            && column.words.iter().any(|word| {
                parts.iter().any(|part| word.contains(part)) || whole.contains(&word.as_str())
            })
    })
}

fn meaning(column: &Column) -> Option<Dimension> {
    let dimensions = MEANINGS.iter().map(|(of, ..)| *of);
    dimensions.into_iter().find(|of| means(column, *of))
}

/// A gauge length in the lines above the names: a label, a number, and a unit in either.
fn gauge_length(sheet: &Sheet, header: &Header, _hints: &Hints<'_>) -> Option<Gauge> {
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
    sheet.lines[..header.above].iter().find_map(|line| {
        let (label, rest) = line.cells.split_first()?;
        let said = words(label);
        let is_label = LABELS
            .iter()
            .any(|label| said.windows(label.len()).any(|part| part == *label));
        let number = sheet.parse(rest.first()?).filter(|number| *number > 0.0)?;
        let beside = rest
            .get(1)
            .map(|cell| cell.trim_matches(['(', ')', '[', ']']));
        let within = label
            .rsplit_once(['(', '['])
            .map(|(_, end)| end.trim_end_matches([')', ']', ':', ' ']));
        let unit = beside
            .and_then(of_symbol)
            .or_else(|| within.and_then(of_symbol))?;
        (is_label && unit.dimension == Dimension::Length).then(|| {
            (
                round(1e3 * unit.factor * number),
                format!("line {}", line.number),
            )
        })
    })
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
