//! Beds of other programs: text as Yade exports it, data files of LAMMPS.
//!
//! Text in, plain structs out, in the units of the file (SI in Yade and in LAMMPS `units si`). What
//! a file says wrongly is an error with its line; what makes a good specimen is not judged here.
mod lammps;
mod yade;

use std::str::FromStr;

use nalgebra::Vector3;

pub(crate) use lammps::{LammpsData, LammpsParticle, read_lammps};
pub(crate) use yade::{YadeSphere, read_yade};

/// Longest piece of a line that a message repeats [characters].
const LONGEST_QUOTE: usize = 60;

/// Why a file was not read. Lines count from 1.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum ImportError {
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
}

/// A line without its comment.
#[derive(Clone, Copy, Debug)]
struct Line<'a> {
    number: usize,
    text: &'a str,
}

impl<'a> Line<'a> {
    /// The lines of a file that say something, as text and comment.
    fn all(text: &'a str) -> impl Iterator<Item = (Self, Option<&'a str>)> {
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

    fn words(&self) -> Vec<&'a str> {
        self.text.split_whitespace().collect()
    }

    fn wrong(&self, found: &str, expected: impl Into<String>) -> ImportError {
        ImportError::Line {
            line: self.number,
            found: found.chars().take(LONGEST_QUOTE).collect(),
            expected: expected.into(),
        }
    }

    fn parse<T: FromStr>(&self, word: &str, expected: &str) -> Result<T, ImportError> {
        word.parse().map_err(|_| self.wrong(word, expected))
    }

    /// A finite number.
    fn number(&self, word: &str, name: &str) -> Result<f64, ImportError> {
        let number: Option<f64> = word.parse().ok();
        number
            .filter(|number| number.is_finite())
            .ok_or_else(|| self.wrong(word, format!("{name}, a finite number")))
    }

    fn positive(&self, word: &str, name: &str) -> Result<f64, ImportError> {
        match self.number(word, name)? {
            number if number > 0.0 => Ok(number),
            _ => Err(self.wrong(word, format!("{name}, a number above 0"))),
        }
    }

    /// Three numbers; their names share one letter.
    fn vector(&self, words: &[&str], names: [&str; 3]) -> Result<Vector3<f64>, ImportError> {
        let mut vector = Vector3::zeros();
        for axis in 0..3 {
            vector[axis] = self.number(words[axis], names[axis])?;
        }
        Ok(vector)
    }
}
