//! The cases of a study file as settings.
use indexmap::IndexMap;
use loadframe_api::study::ParameterStudy;
use loadframe_api::{JobKind, JobSpec, Violation};
use serde_json::Value;

use crate::settings::Settings;

/// A study of parameters that can be run.
#[derive(Clone, Debug)]
pub struct Design {
    pub(super) title: String,
    pub(super) source: String,
    pub(super) statement: String,
    pub(super) kind: JobKind,
    /// Results to be shown; empty for those that the kind compares.
    pub(super) results: Vec<String>,
    pub(super) cases: Vec<DesignCase>,
    pub(super) settings: Settings,
}

/// A case; two of them may be the same setting.
#[derive(Clone, Debug)]
pub(super) struct DesignCase {
    pub(super) label: String,
    pub(super) set: IndexMap<String, Value>,
    pub(super) setting: usize,
}

impl Design {
    /// The study that the file asks for.
    ///
    /// # Errors
    /// Everything that is wrong with its cases, with pointers into the file.
    pub fn new(study: &ParameterStudy) -> Result<Self, Vec<Violation>> {
        let cases = study.cases()?;
        // a study has a case at least, and all cases are of one kind and seed
        let Some(first) = cases.first().map(|case| case.spec.clone()) else {
            return Err(Vec::new());
        };
        let mut settings = Settings::new(&first, study.seeds, JobSpec::realisation);
        let cases = cases.into_iter().map(|case| DesignCase {
            setting: settings.add(&case.spec),
            label: case.label,
            set: case.set,
        });
        Ok(Self {
            title: study.title.clone(),
            source: study.source.clone(),
            statement: study.statement.clone(),
            kind: first.kind(),
            results: study.results.clone(),
            cases: cases.collect(),
            settings,
        })
    }
}
