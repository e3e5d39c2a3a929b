//! What readers of all formats share: lines, numbers, errors with their place.
use std::str::FromStr;

/// A sphere of a file, in its units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Imported {
    pub(super) centre: [f64; 3],
    pub(super) radius: f64,
    /// Number of the clump it is a member of, as in the file.
    pub(super) clump: Option<u32>,
    /// [kg/m³].
    pub(super) density: Option<f64>,
    pub(super) velocity: [f64; 3],
    pub(super) angular_velocity: [f64; 3],
}

impl Imported {
    /// At rest, alone.
    pub(super) fn at(centre: [f64; 3], radius: f64) -> Self {
        Self {
            centre,
            radius,
            clump: None,
            density: None,
            velocity: [0.0; 3],
            angular_velocity: [0.0; 3],
        }
    }
}

/// Longest piece of a line that a message repeats [characters].
const LONGEST_QUOTE: usize = 60;

/// Why a file was not read. Lines count from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ImportError {
    #[error("line {line}: found \"{found}\", expected {expected}")]
    Line {
        line: usize,
        found: String,
        expected: String,
    },
    #[error("line {line}: atom {id} was already on line {first_line}")]
    Repeated {
        line: usize,
        id: u64,
        first_line: usize,
    },
    #[error("the header announces {announced} atoms, section {section} has {found}")]
    Count {
        section: &'static str,
        announced: usize,
        found: usize,
    },
    #[error("the file has no {0}")]
    Missing(&'static str),
    #[error("the file has a density of {found} kg/m³, the material {density} kg/m³")]
    Density { found: f64, density: f64 },
}

/// A line without its comment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line<'a> {
    pub(super) number: usize,
    pub(super) text: &'a str,
}

impl<'a> Line<'a> {
    /// The lines of a file that say something, as text and comment.
    pub(super) fn all(text: &'a str) -> impl Iterator<Item = (Self, Option<&'a str>)> {
        let lines = text.trim_start_matches('\u{feff}').lines().enumerate();
        lines.map(|(index, line)| {
            let (text, comment) = match line.split_once('#') {
                Some((text, comment)) => (text, Some(comment.trim())),
                None => (line, None),
            };
            let number = index + 1;
            (
                Self {
                    number,
                    text: text.trim(),
                },
                comment,
            )
        })
    }

    pub(super) fn words(&self) -> Vec<&'a str> {
        self.text.split_whitespace().collect()
    }

    pub(super) fn wrong(&self, found: &str, expected: impl Into<String>) -> ImportError {
        ImportError::Line {
            line: self.number,
            found: found.chars().take(LONGEST_QUOTE).collect(),
            expected: expected.into(),
        }
    }

    pub(super) fn parse<T: FromStr>(&self, word: &str, expected: &str) -> Result<T, ImportError> {
        word.parse().map_err(|_| self.wrong(word, expected))
    }

    /// A finite number.
    pub(super) fn number(&self, word: &str, name: &str) -> Result<f64, ImportError> {
        let number: Option<f64> = word.parse().ok();
        number
            .filter(|number| number.is_finite())
            .ok_or_else(|| self.wrong(word, format!("{name}, a finite number")))
    }

    pub(super) fn positive(&self, word: &str, name: &str) -> Result<f64, ImportError> {
        match self.number(word, name)? {
            number if number > 0.0 => Ok(number),
            _ => Err(self.wrong(word, format!("{name}, a number above 0"))),
        }
    }

    /// Three numbers; their names share one letter.
    pub(super) fn vector(&self, words: &[&str], names: [&str; 3]) -> Result<[f64; 3], ImportError> {
        let mut vector = [0.0; 3];
        for axis in 0..3 {
            vector[axis] = self.number(words[axis], names[axis])?;
        }
        Ok(vector)
    }
}
