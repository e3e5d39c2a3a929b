//! What earlier jobs found, for specs that refer to them.
use std::collections::BTreeMap;

use indexmap::IndexMap;
use uuid::Uuid;

use crate::{JobKind, JobStatus, JobView, Quantity};

/// Code of the violation that names a job whose results are not known here.
pub(crate) const UNKNOWN_RESULTS: &str = "unknown_results";

/// Results of earlier jobs, or why there are none.
#[derive(Clone, Debug, Default)]
pub struct Earlier(BTreeMap<Uuid, Result<EarlierJob, String>>);

/// An earlier job that succeeded.
#[derive(Clone, Debug)]
pub struct EarlierJob {
    pub kind: JobKind,
    pub summary: IndexMap<String, Quantity>,
}

impl Earlier {
    /// What is known of a job; `None` when nobody has looked.
    pub fn job(&self, id: Uuid) -> Option<Result<&EarlierJob, &str>> {
        self.0
            .get(&id)
            .map(|found| found.as_ref().map_err(String::as_str))
    }

    /// Takes in what a server says of a job; `None`: there is none of this id.
    pub fn insert(&mut self, id: Uuid, view: Option<JobView>) {
        let found = match view {
            None => Err(format!("there is no job {id}")),
            Some(view) => match view.summary {
                Some(summary) if view.status == JobStatus::Finished => Ok(EarlierJob {
                    kind: view.kind,
                    summary,
                }),
                _ => Err(format!("job {id} has no results: {}", view.reason)),
            },
        };
        self.0.insert(id, found);
    }
}
