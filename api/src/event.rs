//! What `GET /v1/jobs/{id}/events` and `GET /v1/events` stream.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use uuid::Uuid;

use crate::JobView;

/// A server-sent event: its `event:` field is the variant's name, its `data:` the content.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "event", content = "data", rename_all = "snake_case")]
pub enum Event {
    /// The job changed.
    Job(Box<JobView>),
    Progress(ProgressNow),
    /// There are new curve points to fetch.
    Points(PointsReady),
    Deleted(JobDeleted),
}

/// How far a running job is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ProgressNow {
    pub job_id: Uuid,
    pub progress: f64,
    pub phase: String,
    pub eta_s: Option<f64>,
}

/// The curve has grown.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct PointsReady {
    pub job_id: Uuid,
    pub attempt: u32,
    /// Points there are now.
    pub total: u64,
}

/// The job is gone.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct JobDeleted {
    pub job_id: Uuid,
}

impl Event {
    /// The `event:` field.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Job(_) => "job",
            Self::Progress(_) => "progress",
            Self::Points(_) => "points",
            Self::Deleted(_) => "deleted",
        }
    }

    /// The job it is about.
    pub fn job_id(&self) -> Uuid {
        match self {
            Self::Job(job) => job.id,
            Self::Progress(progress) => progress.job_id,
            Self::Points(points) => points.job_id,
            Self::Deleted(deleted) => deleted.job_id,
        }
    }
}
