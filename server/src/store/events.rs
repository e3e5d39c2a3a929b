//! Events: numbers that say which job changed and how, shown as the job is when they are read.
use std::collections::HashMap;

use loadframe_api::{Event, JobDeleted, JobView, PointsReady, ProgressNow};
use tokio::sync::watch;
use uuid::Uuid;

use super::Store;
use super::database::{query_as, row};
use super::error::Result;
use super::jobs::hex_names;
use super::writer::EventType;

row! {
    struct EventRow {
        seq: i64,
        job: Uuid,
        kind: String,
        /// The rest is null for a job that is gone.
        progress: Option<f64>,
        phase: Option<String>,
        eta_s: Option<f64>,
        number: Option<u32>,
        points: Option<i64>,
        /// Whose the job is or was.
        owner: Option<Uuid>,
        project: Option<Uuid>,
    }
}

/// An event, and whose the job is that it tells of.
#[derive(Clone, Debug)]
pub struct StoredEvent {
    pub number: u64,
    pub event: Event,
    pub owner: Option<Uuid>,
    pub project: Option<Uuid>,
}

impl Store {
    /// Wakes after every commit that made events; holds the last one's number.
    pub fn changes(&self) -> watch::Receiver<u64> {
        self.last_event_receiver()
    }

    /// Number of the last event.
    pub async fn last_event(&self) -> u64 {
        *self.changes().borrow()
    }

    /// Events after number `seq`, oldest first, of all jobs or of some. Of several changes of one
    /// kind to one job only the last is told.
    ///
    /// # Errors
    /// The database's.
    pub async fn events_after(
        &self,
        seq: u64,
        jobs: Option<&[Uuid]>,
        limit: u32,
    ) -> Result<Vec<StoredEvent>> {
        let names = jobs.map(hex_names).transpose()?;
        let rows: Vec<EventRow> = query_as(
            "SELECT e.seq, e.job, e.type AS kind, j.progress, j.phase, j.eta_s, a.number, a.points,
                    COALESCE(j.owner, e.owner) AS owner, COALESCE(j.project, e.project) AS project
             FROM events e LEFT JOIN jobs j ON j.id = e.job
             LEFT JOIN attempts a ON a.seq = (SELECT seq FROM attempts b WHERE b.job = j.seq
                AND e.type = 'points' ORDER BY b.points DESC, b.seq DESC LIMIT 1)
             WHERE e.seq > ?1 AND (?2 IS NULL OR e.job IN (SELECT unhex(value) FROM json_each(?2)))
             ORDER BY e.seq LIMIT ?3",
        )
        .bind(i64::try_from(seq).unwrap_or(i64::MAX))
        .bind(names)
        .bind(limit)
        .fetch_all(self.reads())
        .await?;
        let changed = rows.iter().filter(|row| row.kind == EventType::Job.name());
        let changed: Vec<Uuid> = changed.map(|row| row.job).collect();
        let views = self.jobs_by_id(&changed).await?;
        let mut views: HashMap<Uuid, JobView> =
            views.into_iter().map(|view| (view.id, view)).collect();
        let events = rows.into_iter().filter_map(|row| {
            let (number, owner, project) = (row.seq.unsigned_abs(), row.owner, row.project);
            row.event(&mut views).map(|event| StoredEvent {
                number,
                event,
                owner,
                project,
            })
        });
        Ok(events.collect())
    }
}

impl EventRow {
    /// The event, unless its job was deleted meanwhile: an event about that follows.
    fn event(self, views: &mut HashMap<Uuid, JobView>) -> Option<Event> {
        let job_id = self.job;
        if self.kind == EventType::Job.name() {
            Some(Event::Job(Box::new(views.remove(&job_id)?)))
        } else if self.kind == EventType::Progress.name() {
            Some(Event::Progress(ProgressNow {
                job_id,
                progress: self.progress?,
                phase: self.phase?,
                eta_s: self.eta_s,
            }))
        } else if self.kind == EventType::Points.name() {
            Some(Event::Points(PointsReady {
                job_id,
                attempt: self.number?,
                total: self.points?.unsigned_abs(),
            }))
        } else {
            Some(Event::Deleted(JobDeleted { job_id }))
        }
    }
}
