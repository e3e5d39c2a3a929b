//! Which column is meant: by the user's word for it, or by what its title means.
use super::{
    Place, Refusal,
    header::{Column, Header, words},
    unit::{Dimension, of_column},
    wanted::{Wanted, name_of},
};

pub(super) fn by_number(name: &str, width: usize) -> Option<usize> {
    let number: usize = name.trim().parse().ok()?;
    (1..=width).contains(&number).then(|| number - 1)
}

pub(super) fn no_such_column(side: usize, name: &str, width: usize, detail: &str) -> Refusal {
    let allowed = format!("a number of a column, 1 … {width}");
    Refusal::new(Place::Column(side), "not_allowed", detail, &allowed).value(name)
}

pub(super) fn by_name(header: &Header, side: usize, name: &str) -> Result<usize, Refusal> {
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
pub(super) fn by_meaning(header: &Header, side: usize, wanted: &Wanted) -> Result<usize, Refusal> {
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

/// Whether a title can mean no length: `Strain`, `Dehnung`.
pub(super) fn is_plain_strain(column: &Column) -> bool {
    let said = |word: &String| word.contains("strain") || word.contains("dehnung");
    column.words.iter().any(said)
}

pub(super) fn means(column: &Column, dimension: Dimension) -> bool {
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
