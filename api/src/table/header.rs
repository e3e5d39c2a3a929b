//! The line of names above the numbers, and what stands above it.
use super::{
    Place, Refusal,
    cells::{Line, Sheet, no_points},
    number::is_number,
    scale::beyond,
    unit::{Unit, of_column, of_symbol},
};

/// A column by its title.
#[derive(Clone, Debug, Default)]
pub(super) struct Column {
    /// As it stands in the text, with its unit.
    pub(super) title: String,
    /// Its words without unit, in small letters without accents.
    pub(super) words: Vec<String>,
    /// Its unit as it stands there.
    pub(super) symbol: Option<String>,
    /// That unit, where it is known.
    pub(super) unit: Option<Unit>,
    /// What else the title says that makes its numbers others.
    pub(super) beyond: Option<String>,
}

/// What the lines of a sheet are.
#[derive(Clone, Debug)]
pub(super) struct Header {
    /// Line of the names, and the columns; empty where the text has no names.
    pub(super) line: u64,
    pub(super) columns: Vec<Column>,
    /// Index of the first line of numbers.
    pub(super) first: usize,
    /// Lines above the names.
    pub(super) above: usize,
}

impl Header {
    /// # Errors
    /// When numbers stand above the names, or there are more of them than names, or, between spaces,
    /// fewer.
    pub(super) fn find(sheet: &Sheet) -> Result<Self, Refusal> {
        let lines = &sheet.lines;
        let last = lines.iter().rposition(|line| line.numbers() > 1);
        let Some(last) = last else {
            return Err(no_points("no line of the text has two numbers"));
        };
        let is_text = |line: &Line| {
            let filled = line.cells.iter().filter(|cell| !cell.is_empty());
            line.numbers() == 0 && filled.count() > 1
        };
        let header = match lines[..last].iter().rposition(is_text) {
            None => Self {
                line: 0,
                columns: Vec::new(),
                first: 0,
                above: 0,
            },
            Some(at) if are_units(&lines[at]) && at > 0 && is_text(&lines[at - 1]) => {
                Self::over(lines, at - 1, Some(at))
            }
            Some(at) if lines.get(at + 1).is_some_and(are_units) => {
                Self::over(lines, at, Some(at + 1))
            }
            Some(at) if at > 0 && is_text(&lines[at - 1]) && are_units(&lines[at - 1]) => {
                Self::over(lines, at, Some(at - 1))
            }
            Some(at) => Self::over(lines, at, None),
        };
        header.check(sheet)?;
        Ok(header)
    }

    fn over(lines: &[Line], names: usize, units: Option<usize>) -> Self {
        let titles = &lines[names].cells;
        let below = units.map_or(&[][..], |units| &lines[units].cells);
        let columns = titles.iter().enumerate().map(|(index, title)| {
            let symbol = below
                .get(index)
                .map(|cell| bare(cell))
                .filter(|s| !s.is_empty());
            match symbol {
                Some(symbol) => {
                    let unit = of_symbol(symbol);
                    let own = column(title);
                    // a unit in the title, too, is the same one
                    let other = own.symbol.filter(|own| {
                        of_symbol(own).is_some_and(|own| Some(own) != unit) && !is_counter(own)
                    });
                    Column {
                        title: format!("{title} [{symbol}]"),
                        words: words(title),
                        unit,
                        symbol: Some(symbol.to_owned()),
                        beyond: own.beyond.or(other),
                    }
                }
                None => column(title),
            }
        });
        Self {
            line: lines[names].number,
            columns: columns.collect(),
            first: units.map_or(names, |units| units.max(names)) + 1,
            above: units.map_or(names, |units| units.min(names)),
        }
    }

    fn check(&self, sheet: &Sheet) -> Result<(), Refusal> {
        let lines = &sheet.lines;
        if let Some(early) = earlier_table(lines, self.above) {
            let detail = format!(
                "line {} holds numbers above the names in line {}: one table at a time",
                early.number, self.line
            );
            let allowed = "one line of names, lines of numbers below it, and no other table";
            return Err(Refusal::new(Place::Text, "ambiguous", detail, allowed));
        }
        let width = match self.columns.len() {
            0 => lines[0].cells.len(),
            width => width,
        };
        // no cell is empty between spaces: the names are fewer than the words
        let narrow = lines[self.first..]
            .iter()
            .find(|line| sheet.is_parted_by_spaces() && line.cells.len() < self.columns.len());
        if let Some(narrow) = narrow {
            let detail = format!(
                "line {} has {width} words between spaces, line {} only {} cells: which words are one \
                 name?",
                self.line,
                narrow.number,
                narrow.cells.len()
            );
            let allowed = "names of one word, or tabs or semicolons between the cells";
            return Err(Refusal::new(Place::Text, "ambiguous", detail, allowed));
        }
        let Some(wide) = lines[self.first..]
            .iter()
            .find(|line| line.cells.len() > width)
        else {
            return Ok(());
        };
        let detail = if self.columns.is_empty() {
            format!(
                "line {} has {} cells, the first line {width}",
                wide.number,
                wide.cells.len()
            )
        } else {
            format!(
                "line {} has {} cells, but line {} names {width} columns",
                wide.number,
                wide.cells.len(),
                self.line
            )
        };
        let allowed =
            "as many cells in each line as columns; a comma parts either cells or decimals";
        Err(Refusal::new(Place::Text, "ambiguous", detail, allowed))
    }
}

/// A line of another table above the names.
///
/// What a machine says of the specimen has numbers too: `Width;15;mm;Thickness;0.1;mm`, a label before
/// each. A line of a table begins with a number, or its numbers stand in the columns of those next
/// to it; or its names are these once more.
fn earlier_table(lines: &[Line], names: usize) -> Option<&Line> {
    let above = &lines[..names];
    let columns = |line: &Line| -> Vec<usize> {
        let cells = line.cells.iter().enumerate();
        let numbers = cells.filter(|(_, cell)| is_number(cell));
        numbers.map(|(column, _)| column).collect()
    };
    let begins_with_number = |line: &Line| {
        let mut filled = line.cells.iter().filter(|cell| !cell.is_empty());
        filled.next().is_some_and(|cell| is_number(cell))
    };
    let is_label = |cell: &str| !cell.is_empty() && !is_number(cell);
    let are_labelled = |line: &Line, columns: &[usize]| {
        let mut columns = columns.iter();
        columns.all(|column| *column > 0 && is_label(&line.cells[column - 1]))
    };
    let is_row = |index: usize| {
        let line = &above[index];
        let own = columns(line);
        let mut beside = [index.checked_sub(1), Some(index + 1)]
            .into_iter()
            .flatten()
            .filter_map(|other| above.get(other));
        own.len() > 1
            && (begins_with_number(line)
                || !are_labelled(line, &own) && beside.any(|other| columns(other) == own))
    };
    let same_names = above.iter().position(|line| {
        lines
            .get(names)
            .is_some_and(|names| line.cells == names.cells)
    });
    let below = same_names.map_or(&[][..], |same| &above[same..]);
    (0..above.len())
        .find(|index| is_row(*index))
        .map(|index| &above[index])
        .or_else(|| below.iter().find(|line| line.numbers() > 1))
}

/// Whether every cell of a line is a unit, not all of them numbers.
fn are_units(line: &Line) -> bool {
    let filled = || line.cells.iter().filter(|cell| !cell.is_empty());
    filled().count() > 0
        && filled().all(|cell| of_symbol(bare(cell)).is_some())
        && line.numbers() < filled().count()
}

/// A unit without brackets.
fn bare(cell: &str) -> &str {
    let open = ['(', '[', '{', '<'];
    cell.trim()
        .trim_start_matches(open)
        .trim_end_matches([')', ']', '}', '>'])
        .trim()
}

/// A title taken apart: `Load (mN)`, `Kraft [N]`, `F / N`, `Kraft in N`, `Load, N`, `Load N`,
/// `force_n`. The last of several brackets that holds a unit counts.
pub(super) fn column(title: &str) -> Column {
    let of = |name: &str, symbol: &str, rest: &str| Column {
        title: title.to_owned(),
        words: words(name),
        unit: of_symbol(symbol),
        symbol: Some(symbol.to_owned()),
        beyond: beyond(rest),
    };
    let groups = brackets(title);
    let outside = || {
        let cut = title.find(['(', '[', '{', '<']).unwrap_or(title.len());
        &title[..cut]
    };
    let known = |group: &&&str| of_symbol(group).is_some();
    if let Some(symbol) = groups.iter().rev().find(known) {
        // `(1)` is a channel, `(s)` the letter of a way
        let mut units = groups.iter().filter(known).filter(|unit| !is_counter(unit));
        let other = units.find(|unit| **unit != *symbol && !["s", "m", "h"].contains(unit));
        let rest = without_units(title);
        let column = of(outside(), symbol, &rest);
        let other = other.map(|unit| (*unit).to_owned());
        return Column {
            beyond: column.beyond.or(other),
            ..column
        };
    }
    // a slash comes last: it is part of `mm/mm` and `N/mm²`
    for parting in [" ", ",", "_", " in ", "/"] {
        let Some((name, symbol)) = title.rsplit_once(parting) else {
            continue;
        };
        // `in` and `h` are words of their own where nothing parts them but a space
        let is_sure = parting != " " || !["in", "h", "m", "s", "-", "1"].contains(&symbol);
        if is_sure && !name.trim().is_empty() && of_symbol(symbol).is_some() {
            return of(name, symbol.trim(), name);
        }
    }
    let mut plain = Column {
        title: title.to_owned(),
        words: words(title),
        symbol: groups.last().map(|group| (*group).to_owned()),
        unit: None,
        beyond: beyond(title),
    };
    if groups.is_empty() {
        if let Some(unit) = of_symbol(title) {
            plain.unit = Some(unit);
            plain.symbol = Some(title.to_owned());
            plain.words.clear();
            plain.beyond = None;
        } else if is_own_name(title) {
            plain.unit = of_column(title);
            plain.symbol = plain.unit.map(|_| "its name".to_owned());
        }
    }
    plain
}

/// Whether a unit of pure numbers may be a channel or a dash instead.
fn is_counter(symbol: &str) -> bool {
    matches!(symbol, "1" | "-")
}

/// Whether a title is written as this program writes columns: `force_n`.
fn is_own_name(title: &str) -> bool {
    title.contains('_')
        && title
            .bytes()
            .all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_')
}

/// What stands in brackets, innermost, in order.
fn brackets(title: &str) -> Vec<&str> {
    let mut found = Vec::new();
    let mut open = None;
    for (at, c) in title.char_indices() {
        match c {
            '(' | '[' | '{' | '<' => open = Some(at + 1),
            ')' | ']' | '}' | '>' => found.extend(open.take().map(|from| title[from..at].trim())),
            _ => {}
        }
    }
    found
}

/// A title without what stands in brackets and is a unit.
fn without_units(title: &str) -> String {
    let mut rest = String::with_capacity(title.len());
    let mut open = None;
    for c in title.chars() {
        rest.push(c);
        match c {
            '(' | '[' | '{' | '<' => open = Some(rest.len()),
            ')' | ']' | '}' | '>' => {
                if let Some(from) = open.take()
                    && of_symbol(rest[from..].trim_end_matches(c)).is_some()
                {
                    rest.truncate(from - 1);
                    rest.push(' ');
                }
            }
            _ => {}
        }
    }
    rest
}

/// Words in small letters without accents.
pub(super) fn words(text: &str) -> Vec<String> {
    let folded: String = text
        .chars()
        .flat_map(char::to_lowercase)
        .map(fold)
        .collect();
    folded
        .split(|c: char| !c.is_alphanumeric())
        .filter(|word| !word.is_empty())
        .map(str::to_owned)
        .collect()
}

/// A letter without its accent.
fn fold(letter: char) -> char {
    match letter {
        'á' | 'à' | 'â' | 'ä' | 'ã' | 'å' => 'a',
        'č' | 'ç' | 'ć' => 'c',
        'ď' => 'd',
        'é' | 'è' | 'ê' | 'ë' | 'ě' => 'e',
        'í' | 'ì' | 'î' | 'ï' => 'i',
        'ň' | 'ñ' => 'n',
        'ó' | 'ò' | 'ô' | 'ö' | 'õ' => 'o',
        'ř' => 'r',
        'š' => 's',
        'ť' => 't',
        'ú' | 'ù' | 'û' | 'ü' | 'ů' => 'u',
        'ý' => 'y',
        'ž' => 'z',
        other => other,
    }
}
