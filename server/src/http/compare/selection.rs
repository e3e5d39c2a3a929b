//! Which jobs are compared.
use loadframe_api::comparison::MOST_COMPARED;
use loadframe_api::{JobKind, JobOutcome, JobStatus, Violation};
use tokio::sync::SemaphorePermit;
use tokio::time::{Duration, timeout};
use uuid::Uuid;

use super::super::AppState;
use super::super::bounded::{Listed, Text};
use super::super::permit::{Permit, Read};
use super::super::problem::{ApiError, INVALID, Result};
use crate::access::{Action, Identity};
use crate::store::{Compared, JobFilter};

/// How long a comparison waits for its turn.
const LONGEST_WAIT: Duration = Duration::from_secs(20);

/// Declares the query of a route that compares: the jobs, and what else the route is asked.
macro_rules! comparing {
    ($(#[$attribute:meta])* struct $name:ident { $($(#[$field_attribute:meta])* $field:ident: $type:ty,)* }) => {
        $(#[$attribute])*
        #[derive(Debug, serde::Deserialize, utoipa::IntoParams)]
        #[serde(deny_unknown_fields)]
        #[into_params(parameter_in = Query)]
        pub(super) struct $name {
            /// Ids of the jobs, in the order of the answer, with or without hyphens.
            #[param(value_type = Vec<uuid::Uuid>, required = false, style = Form, explode = false, max_items = 1000)]
            #[serde(default, deserialize_with = "crate::http::compare::selection::none_or_listed")]
            jobs: Option<$crate::http::bounded::Listed<uuid::Uuid, 1000>>,
            /// The jobs of this comparison.
            #[param(value_type = uuid::Uuid, required = false)]
            comparison: Option<uuid::Uuid>,
            /// Jobs with this tag.
            #[param(value_type = String, required = false, min_length = 1, max_length = 50)]
            tag: Option<$crate::http::bounded::Text<1, 50>>,
            /// Jobs in this project.
            #[param(value_type = uuid::Uuid, required = false)]
            project: Option<uuid::Uuid>,
            /// Jobs with this text in name, notes or tags, or whose id begins with it.
            #[param(value_type = String, required = false, min_length = 1, max_length = 200)]
            q: Option<$crate::http::bounded::Text<1, 200>>,
            /// Jobs of this kind.
            #[param(schema_with = $crate::http::jobs::kind_schema, required = false)]
            kind: Option<loadframe_api::JobKind>,
            /// Jobs in this status.
            #[param(schema_with = $crate::http::jobs::status_schema, required = false)]
            status: Option<loadframe_api::JobStatus>,
            /// Jobs that ended so.
            #[param(schema_with = $crate::http::jobs::outcome_schema, required = false)]
            outcome: Option<loadframe_api::JobOutcome>,
            $($(#[$field_attribute])* $field: $type,)*
        }

        impl $name {
            fn selection(&mut self) -> $crate::http::compare::selection::Selection {
                $crate::http::compare::selection::Selection {
                    jobs: self.jobs.take(),
                    comparison: self.comparison,
                    tag: self.tag.take(),
                    project: self.project,
                    q: self.q.take(),
                    kind: self.kind,
                    status: self.status,
                    outcome: self.outcome,
                }
            }
        }
    };
}
pub(super) use comparing;

/// Which jobs are asked for: by id, by comparison, or by what a list is filtered by.
#[derive(Debug)]
pub(super) struct Selection {
    pub(super) jobs: Option<Listed<Uuid, MOST_COMPARED>>,
    pub(super) comparison: Option<Uuid>,
    pub(super) tag: Option<Text<1, 50>>,
    pub(super) project: Option<Uuid>,
    pub(super) q: Option<Text<1, 200>>,
    pub(super) kind: Option<JobKind>,
    pub(super) status: Option<JobStatus>,
    pub(super) outcome: Option<JobOutcome>,
}

/// The jobs that are compared, and a turn to do so until dropped.
#[derive(Debug)]
pub(super) struct Selected<'a> {
    pub(super) jobs: Vec<Compared>,
    pub(super) missing: Vec<Uuid>,
    pub(super) more: bool,
    _turn: SemaphorePermit<'a>,
}

/// A list that may be empty: of no jobs there is nothing to compare, and no mistake.
pub(in crate::http) fn none_or_listed<'de, D: serde::Deserializer<'de>>(
    deserializer: D,
) -> std::result::Result<Option<Listed<Uuid, MOST_COMPARED>>, D::Error> {
    use serde::{Deserialize, de::IntoDeserializer};
    let text = String::deserialize(deserializer)?;
    if text.is_empty() {
        return Ok(Some(Listed(Vec::new())));
    }
    Listed::deserialize(text.into_deserializer()).map(Some)
}

impl Selection {
    /// Reads the jobs that the caller sees, when it is the caller's turn.
    pub(super) async fn read<'a>(
        self,
        state: &'a AppState,
        permit: &Permit<Read>,
    ) -> Result<Selected<'a>> {
        let turn = timeout(LONGEST_WAIT, state.comparisons.acquire()).await;
        let Ok(Ok(turn)) = turn else {
            return Err(ApiError::busy("too many jobs are being compared", 5));
        };
        let filter = self.filter();
        let ways = [
            self.jobs.is_some(),
            self.comparison.is_some(),
            filter.is_some(),
        ];
        if ways.iter().filter(|is_given| **is_given).count() != 1 {
            let detail =
                "jobs are chosen in one of three ways: by id, by comparison, or by what they have";
            let violation = Violation::new("", "one_choice", detail)
                .allowed("jobs; comparison; or any of tag, project, q, kind, status, outcome");
            let refusal = ApiError::new(INVALID, "see what is wrong with it");
            return Err(refusal.violations(vec![violation]));
        }
        let store = &permit.store;
        let sight = permit.call.sight(store).await?;
        let (mut ids, mut more) = match (self.jobs, self.comparison) {
            (Some(Listed(ids)), _) => (ids, false),
            (_, Some(id)) => {
                permit
                    .call
                    .ask_of_comparison(store, Action::Read, id)
                    .await?;
                (store.comparison_jobs(id).await?, false)
            }
            _ => (Vec::new(), false),
        };
        if let Some(mut filter) = filter {
            if permit.call.caller.identity != Identity::Sole {
                filter.sight = Some(match filter.project {
                    Some(_) => sight.clone(),
                    None => sight
                        .clone()
                        .without_archived(&store.project_facts().await?),
                });
            }
            let page = store.jobs(&filter, None, MOST_COMPARED as u32).await?;
            more = page.next.is_some();
            ids = page.items.iter().map(|job| job.id).collect();
        }
        let asked = std::mem::take(&mut ids);
        for id in asked {
            if !ids.contains(&id) {
                ids.push(id);
            }
        }
        let jobs = store.compared(&ids, &sight).await?;
        let mut found = jobs.iter().map(|job| job.id).peekable();
        ids.retain(|id| found.next_if_eq(id).is_none());
        Ok(Selected {
            jobs,
            missing: ids,
            more,
            _turn: turn,
        })
    }

    /// What lists are filtered by, where anything is.
    fn filter(&self) -> Option<JobFilter> {
        let filter = JobFilter {
            status: self.status,
            outcome: self.outcome,
            kind: self.kind,
            tag: self.tag.clone().map(|Text(tag)| tag),
            q: self.q.clone().map(|Text(text)| text),
            project: self.project,
            ..JobFilter::default()
        };
        (!filter.narrows_nothing_else()).then_some(filter)
    }
}
