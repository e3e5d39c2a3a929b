//! Lines below the names: points, or a footer that is refused before it is taken for some.
use super::{Place, Refusal, cells::Line, header::words, number::is_number};

/// Words for what is reckoned of points and is none.
const STATISTICS: [&str; 38] = [
    "mean",
    "average",
    "avg",
    "median",
    "std",
    "stdev",
    "stddev",
    "sd",
    "standard",
    "deviation",
    "variance",
    "variation",
    "cv",
    "cov",
    "min",
    "minimum",
    "max",
    "maximum",
    "sum",
    "total",
    "count",
    "mittelwert",
    "mittel",
    "durchschnitt",
    "standardabweichung",
    "varianz",
    "variationskoeffizient",
    "spannweite",
    "summe",
    "anzahl",
    "prumer",
    "odchylka",
    "moyenne",
    "ecart",
    "media",
    "promedio",
    "desviacion",
    "deviazione",
];

/// Refuses a line that says it is no point, and lines that an empty one parts from the points.
///
/// # Errors
/// Naming that line.
pub(super) fn check(rows: &[Line]) -> Result<(), Refusal> {
    let Some((first, rest)) = rows.split_first() else {
        return Ok(());
    };
    // a word where the first point has a number, or the name of a statistic where it has none
    let odd = |line: &Line| {
        line.cells.iter().enumerate().find_map(|(column, cell)| {
            let above = first.cells.get(column).map_or("", String::as_str);
            let is_label =
                is_word(cell) && is_number(above) || is_statistic(cell) && !is_statistic(above);
            is_label.then(|| cell.clone())
        })
    };
    if let Some((line, cell)) = rest.iter().find_map(|line| Some((line, odd(line)?))) {
        let detail = format!(
            "line {} has {cell:?} beside its numbers, unlike the first of the points in line {}: is it one of them?",
            line.number, first.number
        );
        return Err(open(detail).value(cell));
    }
    // empty lines between all points are as good as none
    let parted = rest.iter().filter(|line| line.is_parted).count();
    match rest.iter().find(|line| line.is_parted) {
        Some(line) if parted < rest.len() => {
            let detail = format!(
                "an empty line parts line {} from the points above it: are these numbers points of the same curve?",
                line.number
            );
            Err(open(detail))
        }
        _ => Ok(()),
    }
}

fn open(detail: String) -> Refusal {
    let allowed = "points alone below the names, without empty lines among them; take out what is none, such as \
                   means or another table";
    Refusal::new(Place::Text, "ambiguous", detail, allowed)
}

/// Whether a cell holds a word, not what stands for a value that is missing (`---`, `NaN`, `n/a`).
fn is_word(cell: &str) -> bool {
    const MISSING: [&str; 8] = [
        "nan", "na", "inf", "infinity", "null", "none", "overflow", "e",
    ];
    let word: String = cell
        .chars()
        .filter(|c| c.is_alphabetic())
        .flat_map(char::to_lowercase)
        .collect();
    !word.is_empty() && !is_number(cell) && !MISSING.contains(&word.as_str())
}

fn is_statistic(cell: &str) -> bool {
    matches!(cell, "x̄" | "Ø" | "ø" | "σ")
        || words(cell)
            .first()
            .is_some_and(|word| STATISTICS.contains(&word.as_str()))
}
