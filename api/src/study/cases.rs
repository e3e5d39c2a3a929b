//! The cases of a study file, each checked as a job of its own.
use indexmap::IndexMap;
use serde_json::Value;
use serde_json::value::RawValue;

use super::ParameterStudy;
use super::apply::put;
use crate::json::{parse, typed};
use crate::schema::escape;
use crate::{Envelope, Example, JobKind, JobSpec, SubmissionError, Violation};

/// Most cases of a study.
const MOST_CASES: usize = 1000;
/// Most violations that are listed.
const LISTED: usize = 100;
/// Characters of a value in a label.
const LABEL_VALUE: usize = 60;

/// A case that can be run.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    pub label: String,
    /// What is different in it, by JSON pointer into the spec.
    pub set: IndexMap<String, Value>,
    pub spec: JobSpec,
}

/// A case as the file has it.
struct Draft {
    label: String,
    /// Pointer of the case in the file.
    place: String,
    settings: Vec<Setting>,
}

/// A value that is set.
struct Setting {
    /// Into the spec.
    pointer: String,
    value: Value,
    /// Pointer of the value in the file.
    place: String,
}

impl ParameterStudy {
    /// The cases in their order, as specs.
    ///
    /// # Errors
    /// Everything that is wrong with the job or any case of it, with pointers into the file.
    pub fn cases(&self) -> Result<Vec<Case>, Vec<Violation>> {
        let (kind, job) = self.job()?;
        let base = read(kind, job.get()).map_err(|violations| {
            let within = violations.into_iter().map(|mut violation| {
                violation.pointer.insert_str(0, "/job");
                violation
            });
            within.collect::<Vec<Violation>>()
        })?;
        let written = parse(job.get().as_bytes()).map_err(SubmissionError::violations)?;
        let last_seed = base.seed().saturating_add(u64::from(self.seeds.max(1)) - 1);
        if base.realisation(last_seed).check().is_err() {
            let detail = format!("a specimen would have the seed {last_seed}, which is too large");
            let violation = Violation::new("/seeds", "out_of_range", detail);
            return Err(vec![violation.value(self.seeds)]);
        }
        let drafts = self.drafts()?;
        let mut violations = distinct(&drafts);
        let mut cases = Vec::with_capacity(drafts.len());
        for draft in drafts {
            match draft.read(kind, &base, written.clone()) {
                Ok(case) => cases.push(case),
                Err(found) => add(&mut violations, found),
            }
        }
        if violations.is_empty() {
            Ok(cases)
        } else {
            violations.truncate(LISTED);
            Err(violations)
        }
    }

    /// The kind of the job and its spec as it is written.
    fn job(&self) -> Result<(JobKind, Box<RawValue>), Vec<Violation>> {
        match (&self.job, &self.example) {
            (Some(job), None) => Ok((job.kind, job.spec.clone())),
            (None, Some(name)) => {
                let body = example(name)?.body;
                let envelope: Result<Envelope, _> = typed(body.as_bytes(), "");
                let envelope = envelope.map_err(SubmissionError::violations)?;
                Ok((envelope.kind, envelope.spec))
            }
            (given, _) => {
                let detail = match given {
                    Some(_) => "a study has one job, and two are given",
                    None => "there is no job to study",
                };
                let violation = Violation::new("", "missing_field", detail);
                Err(vec![violation.allowed("job or example, one of them")])
            }
        }
    }

    fn drafts(&self) -> Result<Vec<Draft>, Vec<Violation>> {
        let refused = |place: String, count: usize, allowed: String| {
            let detail = format!("{count} are given");
            vec![Violation::new(place, "wrong_length", detail).allowed(allowed)]
        };
        if let Some((pointer, _)) = self.vary.iter().find(|(_, values)| values.is_empty()) {
            let place = format!("/vary/{}", escape(pointer));
            return Err(refused(place, 0, "one value at least".to_owned()));
        }
        let counts = self.vary.values().map(Vec::len);
        let varied = counts.reduce(usize::saturating_mul).unwrap_or(0);
        let count = self.cases.len().saturating_add(varied);
        if !(1..=MOST_CASES).contains(&count) {
            let place = if varied == 0 { "/cases" } else { "/vary" };
            let allowed = format!("1 … {MOST_CASES} cases, those of vary among them");
            return Err(refused(place.to_owned(), count, allowed));
        }
        let named = self.cases.iter().enumerate().map(|(index, case)| {
            let place = format!("/cases/{index}");
            let settings = case.set.iter().map(|(pointer, value)| Setting {
                place: format!("{place}/set/{}", escape(pointer)),
                pointer: pointer.clone(),
                value: value.clone(),
            });
            Draft {
                label: case.label.clone(),
                settings: settings.collect(),
                place,
            }
        });
        let varied = (0..varied).map(|index| self.combination(index));
        Ok(named.chain(varied).collect())
    }

    /// The combination of this number, in which the last pointer's digit is the lowest.
    fn combination(&self, index: usize) -> Draft {
        let mut rest = index;
        let mut settings = Vec::new();
        for (pointer, values) in self.vary.iter().rev() {
            let digit = rest % values.len();
            rest /= values.len();
            settings.push(Setting {
                pointer: pointer.clone(),
                value: values[digit].clone(),
                place: format!("/vary/{}/{digit}", escape(pointer)),
            });
        }
        settings.reverse();
        let parts = settings.iter().map(|setting| {
            let name = self.short(&setting.pointer);
            format!("{name} = {}", text(&setting.value))
        });
        let label = parts.collect::<Vec<String>>().join(", ");
        let place = settings
            .last()
            .map_or_else(String::new, |last| last.place.clone());
        Draft {
            label,
            place,
            settings,
        }
    }

    /// The last part of a varied pointer, or all of it where that names another one too.
    fn short<'a>(&self, pointer: &'a str) -> &'a str {
        let last = |pointer: &'a str| pointer.rsplit('/').next().unwrap_or(pointer);
        let same = |other: &&String| other.rsplit('/').next() == Some(last(pointer));
        match self.vary.keys().filter(same).count() {
            1 => last(pointer),
            _ => pointer.trim_start_matches('/'),
        }
    }
}

impl Draft {
    fn read(self, kind: JobKind, base: &JobSpec, mut spec: Value) -> Result<Case, Vec<Violation>> {
        for setting in &self.settings {
            if let Err(violation) = put(&mut spec, &setting.pointer, &setting.value) {
                return Err(vec![self.located(&violation, Some(setting))]);
            }
        }
        let spec = read(kind, &spec.to_string()).map_err(|violations| {
            violations
                .iter()
                .map(|v| self.placed(v))
                .collect::<Vec<_>>()
        })?;
        if spec.seed() != base.seed() {
            let setting = self
                .settings
                .iter()
                .find(|setting| setting.pointer == "/seed");
            let detail = "the seeds of all cases count on from the job's own";
            let violation = Violation::new("/seed", "not_allowed", detail).value(spec.seed());
            let violation = violation.allowed("seeds, the number of specimens");
            return Err(vec![self.located(&violation, setting)]);
        }
        let set = self.settings.into_iter();
        Ok(Case {
            label: self.label,
            set: set
                .map(|setting| (setting.pointer, setting.value))
                .collect(),
            spec,
        })
    }

    /// A violation of the case's spec, said of the value that led to it where one stands there.
    fn placed(&self, violation: &Violation) -> Violation {
        let own = violation.pointer.strip_prefix("/spec");
        let own = own.unwrap_or(&violation.pointer);
        let holds = |outer: &str, inner: &str| {
            let rest = inner.strip_prefix(outer);
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
        };
        let is_cause = |setting: &&Setting| {
            holds(&setting.pointer, own) || (!own.is_empty() && holds(own, &setting.pointer))
        };
        let cause = self.settings.iter().filter(is_cause);
        self.located(violation, cause.max_by_key(|setting| setting.pointer.len()))
    }

    fn located(&self, violation: &Violation, cause: Option<&Setting>) -> Violation {
        let own = violation.pointer.strip_prefix("/spec");
        let own = own.unwrap_or(&violation.pointer);
        let rest = cause.and_then(|cause| own.strip_prefix(cause.pointer.as_str()));
        let pointer = match cause {
            Some(cause) => format!("{}{}", cause.place, rest.unwrap_or_default()),
            None => self.place.clone(),
        };
        let where_it_is = match rest {
            Some(_) => String::new(),
            None => format!("{own}: "),
        };
        let detail = format!("case {:?}: {where_it_is}{}", self.label, violation.detail);
        Violation {
            pointer,
            detail,
            ..violation.clone()
        }
    }
}

/// Labels that are given more than once.
fn distinct(drafts: &[Draft]) -> Vec<Violation> {
    let mut seen = std::collections::BTreeSet::new();
    let again = drafts.iter().filter(|draft| !seen.insert(&draft.label));
    let violations = again.map(|draft| {
        let detail = "a case of this name is there already";
        Violation::new(draft.place.clone(), "not_unique", detail).value(draft.label.as_str())
    });
    violations.collect()
}

/// Adds what is not known yet: one value may be in many cases.
fn add(violations: &mut Vec<Violation>, found: Vec<Violation>) {
    for violation in found {
        let same = |known: &Violation| {
            (&known.pointer, &known.code, &known.value)
                == (&violation.pointer, &violation.code, &violation.value)
        };
        if !violations.iter().any(same) {
            violations.push(violation);
        }
    }
}

fn read(kind: JobKind, text: &str) -> Result<JobSpec, Vec<Violation>> {
    JobSpec::from_text(kind, text).map_err(SubmissionError::violations)
}

fn example(name: &str) -> Result<&'static Example, Vec<Violation>> {
    Example::named(name).map_err(|error| {
        let violation = Violation::new("/example", "not_allowed", error.to_string());
        vec![violation.value(name)]
    })
}

/// A value in a label.
fn text(value: &Value) -> String {
    let text = match value {
        Value::String(word) => word.clone(),
        value => value.to_string(),
    };
    if text.chars().count() <= LABEL_VALUE {
        return text;
    }
    let beginning: String = text.chars().take(LABEL_VALUE).collect();
    beginning + "…"
}
