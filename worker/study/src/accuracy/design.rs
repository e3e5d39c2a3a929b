//! Which settings a study runs.
use loadframe_api::study::{Knob, TurnError};
use loadframe_api::{JobSpec, Violation};

use crate::settings::Settings;

/// A knob to vary, over these values or, where there are none, over its own grid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Request {
    pub knob: String,
    pub values: Vec<String>,
}

/// The settings of a study; equal ones are there once.
#[derive(Clone, Debug)]
pub struct Design {
    pub(super) settings: Settings,
    pub(super) lines: Vec<Line>,
    /// The setting that is the spec's own.
    pub(super) present: usize,
}

/// One knob over its values.
#[derive(Clone, Debug)]
pub(super) struct Line {
    pub(super) knob: Knob,
    /// In the order in which they are shown, the reference last.
    pub(super) points: Vec<Point>,
}

/// A value of a knob.
#[derive(Clone, Debug)]
pub(super) struct Point {
    /// The value, and beside it what else the reference sets.
    pub(super) label: String,
    pub(super) setting: usize,
}

/// Why a study cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DesignError {
    #[error(transparent)]
    Turn(#[from] TurnError),
    #[error("{setting}: {}", list(.violations))]
    Invalid {
        setting: String,
        violations: Vec<Violation>,
    },
}

fn list(violations: &[Violation]) -> String {
    let all: Vec<String> = violations.iter().map(ToString::to_string).collect();
    all.join("; ")
}

impl Design {
    /// The study of `spec` over `requests`, or over all its knobs where there are none, with so
    /// many seeds from the spec's own on.
    ///
    /// # Errors
    /// [`DesignError`] for an unknown knob, or a value that is none or out of range.
    pub fn new(spec: &JobSpec, requests: &[Request], seeds: u32) -> Result<Self, DesignError> {
        let settings = Settings::new(spec, seeds, JobSpec::single);
        // the last seed must be one a spec may have
        let last = settings.seeds().last().map(|seed| spec.single(*seed));
        checked(last.as_ref().unwrap_or(spec), || "the last seed".to_owned())?;
        let base = spec.single(spec.seed());
        let mut design = Self {
            settings,
            lines: Vec::new(),
            present: 0,
        };
        design.present = design.settings.add(&base);
        let knobs = base.knobs();
        for knob in chosen(&base, &knobs, requests)? {
            let line = design.line(&base, knob)?;
            // a single value says nothing about a knob
            if line.points.len() > 1 || !requests.is_empty() {
                design.lines.push(line);
            }
        }
        Ok(design)
    }

    fn line(&mut self, base: &JobSpec, mut knob: Knob) -> Result<Line, DesignError> {
        let mut finest = base.clone();
        for (name, value) in &knob.reference {
            finest.turn(name, value)?;
        }
        let reference = Point {
            label: label(&knob),
            setting: self.settings.add(checked(&finest, || label(&knob))?),
        };
        let present = knob.present.clone();
        knob.grid.push(present);
        let mut points = Vec::<Point>::new();
        for value in &knob.grid {
            let mut spec = base.clone();
            spec.turn(knob.name, value)?;
            let setting = checked(&spec, || format!("{}={value}", knob.name))?;
            let setting = self.settings.add(setting);
            let is_new = points.iter().all(|point| point.setting != setting);
            if is_new && setting != reference.setting {
                let label = value.clone();
                points.push(Point { label, setting });
            }
        }
        // numbers by how far they are from the reference, words as the kind lists them
        let number = |point: &Point| point.label.parse::<f64>().ok();
        let finest = number(&reference);
        let distance = |point: &Point| Some((number(point)?.ln() - finest?.ln()).abs());
        points.sort_by(|a, b| match (distance(a), distance(b)) {
            (Some(a), Some(b)) => b.total_cmp(&a),
            _ => std::cmp::Ordering::Equal,
        });
        points.push(reference);
        Ok(Line { knob, points })
    }
}

/// The knobs asked for, with the values asked for.
fn chosen(spec: &JobSpec, knobs: &[Knob], requests: &[Request]) -> Result<Vec<Knob>, DesignError> {
    if requests.is_empty() {
        return Ok(knobs.to_vec());
    }
    let chosen = requests.iter().map(|request| {
        let Some(knob) = knobs.iter().find(|knob| knob.name == request.knob) else {
            // which is refused with the list of those there are
            spec.clone().turn(&request.knob, "")?;
            return Ok(Vec::new());
        };
        let mut knob = knob.clone();
        if !request.values.is_empty() {
            measure_against_finest(&mut knob, &request.values);
            knob.grid.clone_from(&request.values);
        }
        Ok(vec![knob])
    });
    let chosen: Result<Vec<Vec<Knob>>, DesignError> = chosen.collect();
    Ok(chosen?.concat())
}

/// Moves the reference of a knob of numbers to the farthest of `values` beyond it.
fn measure_against_finest(knob: &mut Knob, values: &[String]) {
    let number = |value: &str| value.parse::<f64>().ok();
    let coarsest = knob.grid.first().and_then(|value| number(value));
    let own = knob
        .reference
        .iter_mut()
        .find(|(name, _)| *name == knob.name);
    let (Some(coarsest), Some((_, finest))) = (coarsest, own) else {
        return;
    };
    for value in values {
        let (Some(known), Some(new)) = (number(finest), number(value)) else {
            return;
        };
        let is_beyond = if known > coarsest {
            new > known
        } else {
            new < known
        };
        if is_beyond {
            finest.clone_from(value);
        }
    }
}

/// The reference of a knob in words: its value there, and what else is set.
fn label(knob: &Knob) -> String {
    let (own, others): (Vec<_>, Vec<_>) = knob
        .reference
        .iter()
        .partition(|(name, _)| *name == knob.name);
    let own = own
        .first()
        .map_or(knob.present.as_str(), |(_, value)| value);
    let others: Vec<String> = others
        .iter()
        .map(|(name, value)| format!("{name}={value}"))
        .collect();
    if others.is_empty() {
        own.to_owned()
    } else {
        format!("{own} at {}", others.join(", "))
    }
}

fn checked(spec: &JobSpec, setting: impl FnOnce() -> String) -> Result<&JobSpec, DesignError> {
    match spec.check() {
        Ok(()) => Ok(spec),
        Err(violations) => Err(DesignError::Invalid {
            setting: setting(),
            violations,
        }),
    }
}
