//! Cells of a text: what parts them, and the mark of their decimals.
use std::ops::Range;

use super::{
    Place, Refusal,
    number::{DecimalMark, Evidence, evidence, is_number, parse},
};

/// What may part the cells of a line, in the order in which they are preferred where several do:
/// marks that no number holds come first.
const SEPARATORS: [Separator; 5] = [
    Separator::Mark(b'\t'),
    Separator::Mark(b';'),
    Separator::Mark(b'|'),
    Separator::Mark(b','),
    Separator::Space,
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Separator {
    Mark(u8),
    /// Any number of spaces.
    Space,
}

/// How well a separator parts a text: lines of numbers only, lines with two numbers, lines of several
/// cells.
type Score = (usize, usize, usize);

/// A line that is not empty.
#[derive(Clone, Debug)]
pub(super) struct Line {
    /// Counted from 1.
    pub(super) number: u64,
    /// Without quotes, spaces around them, and empty cells at the end.
    pub(super) cells: Vec<String>,
    /// Whether empty lines stand above it.
    pub(super) is_parted: bool,
}

/// A text parted by one separator.
#[derive(Debug)]
struct Parted {
    lines: Vec<Line>,
    /// The first and last of the first lines that a quote makes one of, where that hides numbers.
    merged: Option<[u64; 2]>,
}

/// A text in cells.
#[derive(Clone, Debug)]
pub(super) struct Sheet {
    pub(super) lines: Vec<Line>,
    separator: Separator,
    decimal: DecimalMark,
    /// Whether the user or a cell of the table tells the mark; without, all its numbers are whole.
    is_mark_told: bool,
    /// Whether thousands are parted by the other mark somewhere.
    has_groups: bool,
}

impl Line {
    pub(super) fn numbers(&self) -> usize {
        self.cells.iter().filter(|cell| is_number(cell)).count()
    }

    /// Whether it is a line of numbers as far as can be told.
    fn is_all_numbers(&self) -> bool {
        self.cells.len() > 1
            && self
                .cells
                .iter()
                .all(|cell| cell.is_empty() || is_number(cell))
    }
}

impl Sheet {
    /// # Errors
    /// When it has no table, or its decimals can be read in two ways.
    pub(super) fn new(text: &str, decimal: Option<DecimalMark>) -> Result<Self, Refusal> {
        // lines are counted at their ends, and some machines end them with a return alone
        let text = &text.replace("\r\n", "\n").replace('\r', "\n");
        let (first, named) = named_separator(text);
        let tried: Vec<Separator> = match named {
            Some(separator) => vec![separator],
            None => SEPARATORS.to_vec(),
        };
        let mut best: Option<(Score, Separator, Parted)> = None;
        for separator in tried {
            let parted_text = part(text, separator, first)?;
            let lines = &parted_text.lines;
            let whole = lines.iter().filter(|line| line.is_all_numbers()).count();
            let some = lines.iter().filter(|line| line.numbers() > 1).count();
            let parted = match separator {
                Separator::Mark(_) => lines.iter().filter(|line| line.cells.len() > 1).count(),
                // words are parted by spaces everywhere
                Separator::Space => 0,
            };
            let score = (whole, some, parted);
            if best.as_ref().is_none_or(|(other, ..)| score > *other) {
                best = Some((score, separator, parted_text));
            }
        }
        let Some(((_, 1.., _), separator, Parted { lines, merged })) = best else {
            let detail = "no line of the text has two numbers";
            return Err(no_points(detail));
        };
        if let Some([first, last]) = merged {
            let detail = format!(
                "a quote in line {first} makes one cell of the lines up to {last}, with numbers among \
                 them"
            );
            let allowed = "quotes that end in their line; take out the one that does not";
            return Err(Refusal::new(Place::Text, "syntax", detail, allowed));
        }
        let (told, has_groups) = mark(&lines, separator, decimal)?;
        Ok(Self {
            lines,
            separator,
            decimal: told.unwrap_or(DecimalMark::Point),
            is_mark_told: told.is_some(),
            has_groups,
        })
    }

    /// The number of a cell.
    ///
    /// # Errors
    /// When there is none.
    pub(super) fn number(&self, line: &Line, column: usize) -> Result<f64, Refusal> {
        let cell = line.cells.get(column).map_or("", String::as_str);
        self.parse(cell).ok_or_else(|| {
            let detail = format!(
                "line {} has no number in column {}",
                line.number,
                column + 1
            );
            let allowed = "a number in both columns of every line after the names; correct the line \
                           or take it out";
            Refusal::new(Place::Text, "syntax", detail, allowed).value(cell)
        })
    }

    pub(super) fn parse(&self, cell: &str) -> Option<f64> {
        parse(cell, self.decimal)
    }

    /// The number of a cell above the table, by its own mark where the table tells none.
    ///
    /// # Errors
    /// When it can be read in two ways.
    pub(super) fn number_above(&self, line: &Line, cell: &str) -> Result<Option<f64>, Refusal> {
        let decimal = match evidence(cell) {
            Evidence::For(mark) if !self.is_mark_told => mark,
            Evidence::Either if !self.is_mark_told => return Err(either(line.number, cell)),
            _ => self.decimal,
        };
        Ok(parse(cell, decimal))
    }

    pub(super) fn is_parted_by_spaces(&self) -> bool {
        self.separator == Separator::Space
    }

    /// How it is parted, in words.
    pub(super) fn words(&self) -> String {
        let parted = match self.separator {
            Separator::Mark(b'\t') => "tabs",
            Separator::Mark(b';') => "semicolons",
            Separator::Mark(b'|') => "bars",
            Separator::Mark(_) => "commas",
            Separator::Space => "spaces",
        };
        let (decimals, thousands) = match self.decimal {
            DecimalMark::Point => ("points", "commas"),
            DecimalMark::Comma => ("commas", "points"),
        };
        let groups = if self.has_groups {
            format!(", {thousands} between thousands")
        } else {
            String::new()
        };
        format!("cells parted by {parted}, {decimals} before decimals{groups}")
    }
}

/// A first line `sep=;`, as Excel writes it: how many lines it takes, and the separator.
fn named_separator(text: &str) -> (u64, Option<Separator>) {
    let first = text.lines().next().unwrap_or_default();
    let first = first.trim_matches(['"', ' ']);
    let mark = first
        .get(..4)
        .filter(|word| word.eq_ignore_ascii_case("sep="))
        .and_then(|_| first[4..].bytes().next().or(Some(b'\t')))
        .filter(u8::is_ascii);
    match mark {
        Some(mark) => (1, Some(Separator::Mark(mark))),
        None => (0, None),
    }
}

fn part(text: &str, separator: Separator, skipped: u64) -> Result<Parted, Refusal> {
    let tidy = |cells: &mut Vec<String>| {
        while cells.last().is_some_and(String::is_empty) {
            cells.pop();
        }
    };
    let mut lines = Vec::new();
    let mut is_parted = false;
    let mut push = |number: u64, mut cells: Vec<String>| {
        tidy(&mut cells);
        if cells.is_empty() {
            is_parted = true;
        } else if number > skipped {
            lines.push(Line {
                number,
                cells,
                is_parted: std::mem::take(&mut is_parted),
            });
        }
    };
    let mut merged = None;
    match separator {
        Separator::Space => {
            for (number, line) in (1..).zip(text.lines()) {
                push(number, line.split_whitespace().map(str::to_owned).collect());
            }
        }
        Separator::Mark(mark) => {
            let mut reader = csv::ReaderBuilder::new()
                .delimiter(mark)
                .flexible(true)
                .has_headers(false)
                .trim(csv::Trim::All)
                .from_reader(text.as_bytes());
            let mut record = csv::StringRecord::new();
            while reader
                .read_record(&mut record)
                .map_err(|error| no_points(&error.to_string()))?
            {
                let from = record.position();
                // empty lines before a record count as its own
                let byte = from.and_then(|from| usize::try_from(from.byte()).ok());
                let own = byte.and_then(|byte| text.get(byte..)).unwrap_or_default();
                let empty = own.bytes().take_while(|byte| *byte == b'\n').count() as u64;
                let number = from.map_or(0, csv::Position::line) + empty;
                if empty > 0 {
                    push(number, Vec::new());
                }
                // titles and remarks may span lines, numbers within them were points
                if merged.is_none() && record.iter().any(|cell| cell.contains('\n')) {
                    let to = reader.position().byte();
                    merged = hidden(text, from.map_or(0, csv::Position::byte)..to, mark);
                }
                push(number, record.iter().map(str::to_owned).collect());
            }
        }
    }
    Ok(Parted { lines, merged })
}

/// The first and last line of a record, given by its bytes, where a line after its first has two
/// numbers.
fn hidden(text: &str, record: Range<u64>, mark: u8) -> Option<[u64; 2]> {
    let [start, end] = [record.start, record.end].map(|at| usize::try_from(at).ok());
    let (start, end) = (start?, end?);
    let whole = text.get(start..end)?;
    // empty lines before a record count as its own
    let own = whole.trim_start_matches('\n');
    let before = &text[..start + whole.len() - own.len()];
    let first = 1 + before.bytes().filter(|byte| *byte == b'\n').count() as u64;
    let numbers = |line: &str| {
        let cells = line.split(char::from(mark));
        let bare = cells.map(|cell| cell.trim_matches(['"', ' ']));
        bare.filter(|cell| is_number(cell)).count()
    };
    let is_point = own.lines().skip(1).any(|line| numbers(line) > 1);
    is_point.then(|| [first, first + own.trim_end().lines().count() as u64 - 1])
}

/// The mark of decimals, where something tells it, and whether the other one parts thousands.
fn mark(
    lines: &[Line],
    separator: Separator,
    given: Option<DecimalMark>,
) -> Result<(Option<DecimalMark>, bool), Refusal> {
    let cells = || {
        let lines = lines.iter().filter(|line| line.numbers() > 1);
        lines.flat_map(|line| line.cells.iter().map(move |cell| (line.number, cell)))
    };
    let first = |wanted: Evidence| cells().find(|(_, cell)| evidence(cell) == wanted);
    let told = match given {
        Some(decimal) => Some(decimal),
        None => {
            let point = first(Evidence::For(DecimalMark::Point));
            let comma = first(Evidence::For(DecimalMark::Comma));
            let open = first(Evidence::Either);
            match (point, comma, open) {
                (Some((one, point)), Some((other, comma)), _) => {
                    let detail = format!(
                        "line {one} has {point:?} with a decimal point, line {other} {comma:?} with a \
                         decimal comma"
                    );
                    return Err(open_mark(detail, comma));
                }
                (Some(_), None, _) => Some(DecimalMark::Point),
                (None, Some(_), _) => Some(DecimalMark::Comma),
                (None, None, Some((line, cell))) if !is_plain(cells(), separator) => {
                    return Err(either(line, cell));
                }
                (None, None, Some(_)) => Some(DecimalMark::Point),
                (None, None, None) => None,
            }
        }
    };
    let decimal = told.unwrap_or(DecimalMark::Point);
    let other = match decimal {
        DecimalMark::Point => DecimalMark::Comma,
        DecimalMark::Comma => DecimalMark::Point,
    };
    let has_groups =
        cells().any(|(_, cell)| cell.contains(other.character()) && parse(cell, decimal).is_some());
    Ok((told, has_groups))
}

/// Whether only points can be decimals: commas part the cells, and none stands within one.
fn is_plain<'a>(mut cells: impl Iterator<Item = (u64, &'a String)>, separator: Separator) -> bool {
    separator == Separator::Mark(b',') && !cells.any(|(_, cell)| cell.contains(','))
}

/// A cell that is one number with the one mark and another with the other.
fn either(line: u64, cell: &str) -> Refusal {
    let bare: String = cell.chars().filter(|c| !matches!(c, '.' | ',')).collect();
    let detail = format!(
        "{cell:?} in line {line} is {} or {bare}, and no other cell tells which",
        cell.replace(',', ".")
    );
    open_mark(detail, cell)
}

fn open_mark(detail: String, cell: &str) -> Refusal {
    let allowed = "reading.decimal: \"point\" or \"comma\"";
    Refusal::new(Place::Decimal, "ambiguous", detail, allowed).value(cell)
}

pub(super) fn no_points(detail: &str) -> Refusal {
    let allowed = "a line of names with units, then lines of numbers, such as \
                   \"Strain (%);Load (N)\" and \"0.1;8.5\"";
    Refusal::new(Place::Text, "syntax", detail, allowed)
}
