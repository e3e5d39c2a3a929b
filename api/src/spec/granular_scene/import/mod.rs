//! Beds of other programs: text as Yade exports it, data files of LAMMPS.
//!
//! A file is in SI units (as in Yade, and in LAMMPS with `units si`) unless `scale` says otherwise.
//! What it says wrongly is an error with its line.
mod lammps;
mod yade;

use std::{collections::BTreeMap, str::FromStr};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Body, Clump, Member, Sphere};

/// Bodies of a file of another program. Spheres of one clump become one body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Import {
    pub format: ImportFormat,
    /// The whole file.
    #[schemars(length(min = 1, max = 2_000_000_000))]
    pub text: String,
    /// Name of a material, for all of it. A density that the file gives must be the material's.
    pub material: String,
    /// Metres in the file's unit of length; velocities are scaled too.
    #[serde(default = "one")]
    #[schemars(range(min = 1e-12, max = 1e12), extend("x-unit" = "1"))]
    pub scale: f64,
    /// Added to every position, after scaling.
    #[serde(default)]
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "m"))]
    pub shift_m: [f64; 3],
    /// Whether clumps of the file break: their spheres are bonded instead of rigid.
    #[serde(default)]
    pub breakable_clumps: bool,
}

/// Format of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ImportFormat {
    /// Lines `x y z r` or `x y z r clump`, as `yade.export.text` and `textClumps` write them.
    Yade,
    /// A data file with `Atoms # sphere` and perhaps `Velocities`.
    Lammps,
}

fn one() -> f64 {
    1.0
}

/// Densities of file and material differ by rounding at most.
const SAME_DENSITY: f64 = 1e-6;

/// A sphere of a file, in its units.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Imported {
    centre: [f64; 3],
    radius: f64,
    /// Number of the clump it is a member of, as in the file.
    clump: Option<u32>,
    /// [kg/m³].
    density: Option<f64>,
    velocity: [f64; 3],
    angular_velocity: [f64; 3],
}

impl Imported {
    /// At rest, alone.
    fn at(centre: [f64; 3], radius: f64) -> Self {
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

impl Import {
    /// The bodies of the file, in the order in which it first names them, made of a material of
    /// `density` [kg/m³].
    ///
    /// # Errors
    /// [`ImportError`] when the text is not what its format says.
    pub fn bodies(&self, density: f64) -> Result<Vec<Body>, ImportError> {
        let spheres = match self.format {
            ImportFormat::Yade => yade::read(&self.text),
            ImportFormat::Lammps => lammps::read(&self.text),
        }?;
        let mut bodies: Vec<Body> = Vec::with_capacity(spheres.len());
        let mut clumps: BTreeMap<u32, usize> = BTreeMap::new();
        for sphere in spheres {
            if let Some(found) = sphere.density
                && (found / density - 1.0).abs() > SAME_DENSITY
            {
                return Err(ImportError::Density { found, density });
            }
            let place = |axis: usize| self.shift_m[axis] + self.scale * sphere.centre[axis];
            let centre: [f64; 3] = std::array::from_fn(place);
            let radius_m = self.scale * sphere.radius;
            let Some(clump) = sphere.clump else {
                bodies.push(Body {
                    sphere: Some(Sphere { radius_m }),
                    velocity_m_per_s: sphere.velocity.map(|v| self.scale * v),
                    angular_velocity_rad_per_s: sphere.angular_velocity,
                    ..Body::at(centre, &self.material)
                });
                continue;
            };
            let body = *clumps.entry(clump).or_insert_with(|| {
                bodies.push(Body::at(centre, &self.material));
                bodies.len() - 1
            });
            let body = &mut bodies[body];
            let origin = body.position_m;
            let shape = if self.breakable_clumps {
                &mut body.breakable
            } else {
                &mut body.clump
            };
            let members = &mut shape.get_or_insert_with(Clump::default).members;
            members.push(Member {
                offset_m: std::array::from_fn(|axis| centre[axis] - origin[axis]),
                radius_m,
            });
        }
        Ok(bodies)
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
    fn vector(&self, words: &[&str], names: [&str; 3]) -> Result<[f64; 3], ImportError> {
        let mut vector = [0.0; 3];
        for axis in 0..3 {
            vector[axis] = self.number(words[axis], names[axis])?;
        }
        Ok(vector)
    }
}
