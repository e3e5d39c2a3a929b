//! How much each person may use.
use loadframe_api::Estimate;
use loadframe_api::people::{Allowance, PersonLimits, PersonUse};
use uuid::Uuid;

use super::super::Store;
use super::super::database::{Connection, FromRow, Query, Row, query, query_as, query_scalar, row};
use super::super::error::{Result, StoreError};
use super::super::writer::Change;
use super::accounts::PersonRow;
use crate::queue::turns::used;

/// A part of a limit that is told of when it is reached.
const TOLD: f64 = 0.9;

impl Store {
    /// What a person may use, uses, and may still.
    ///
    /// # Errors
    /// [`StoreError::NotFound`].
    pub async fn allowance(&self, person: Uuid) -> Result<Allowance> {
        let mut connection = self.lookups().acquire().await?;
        allowance(&mut connection, person, self.now().as_millis()).await
    }

    /// Sets what a person may use; what is left out has no limit.
    ///
    /// # Errors
    /// [`StoreError::NotFound`]; [`StoreError::Refused`] for a limit below what is used.
    pub async fn set_limits(&self, person: Uuid, limits: PersonLimits) -> Result<Allowance> {
        let set = self.write(move |change| {
            Box::pin(async move {
                let now = change.now.as_millis();
                let before = allowance(&mut change.connection, person, now).await?;
                let violations = limits.violations(&before.used);
                if !violations.is_empty() {
                    return Err(StoreError::Refused(violations));
                }
                query(
                    "UPDATE people SET most_running = ?, most_queued_core_h = ?, most_disk_gb = ?,
                        may_hurry = ? WHERE id = ?",
                )
                .bind(limits.running)
                .bind(limits.queued_core_h)
                .bind(limits.disk_gb)
                .bind(limits.may_hurry)
                .bind(person)
                .execute(&mut change.connection)
                .await?;
                let name = PersonRow::of(&mut change.connection, person)
                    .await?
                    .view()?
                    .name;
                let detail = format!("{name}: {}", told(&limits));
                change
                    .audit("person.limited", Some(person), &detail)
                    .await?;
                // jobs that waited for the limit alone may run now
                change.queued();
                allowance(&mut change.connection, person, now).await
            })
        });
        set.await
    }
}

/// Limits in a line of the audit log.
fn told(limits: &PersonLimits) -> String {
    let number = |limit: Option<f64>, unit: &str| match limit {
        Some(limit) => format!("{limit}{unit}"),
        None => "no limit".to_owned(),
    };
    format!(
        "running {}, queued {}, files {}, priority above 0 {}",
        number(limits.running.map(f64::from), ""),
        number(limits.queued_core_h, " core h"),
        number(limits.disk_gb, " GB"),
        if limits.may_hurry { "yes" } else { "no" }
    )
}

async fn limits(connection: &mut Connection, person: Uuid) -> Result<PersonLimits> {
    Ok(PersonRow::of(connection, person).await?.view()?.limits)
}

async fn allowance(connection: &mut Connection, person: Uuid, now: i64) -> Result<Allowance> {
    let limits = limits(connection, person).await?;
    Ok(Allowance::of(
        limits,
        used_by(connection, person, now).await?,
    ))
}

async fn used_by(connection: &mut Connection, person: Uuid, now: i64) -> Result<PersonUse> {
    let (level, bytes, queued_ms, running): (Option<f64>, i64, i64, u32) = query_as(
        "SELECT p.use_level, p.file_bytes,
            (SELECT CAST(COALESCE(SUM(core_ms), 0) AS BIGINT) FROM waiting_lines WHERE owner = p.id),
            (SELECT COUNT(*) FROM attempts a JOIN jobs j ON j.seq = a.job
             WHERE a.ended_at IS NULL AND j.owner = p.id)
         FROM people p WHERE p.id = ?",
    )
    .bind(person)
    .fetch_one(connection)
    .await?;
    Ok(PersonUse {
        running,
        queued_core_h: queued_ms as f64 / 3.6e6,
        disk_gb: bytes as f64 / 1e9,
        recent_core_h: used(level, now) / 3600.0,
    })
}

row! {
    /// What a person may use, and what they use where that is limited.
    struct Admission {
        most_running: Option<u32>,
        most_queued_core_h: Option<f64>,
        most_disk_gb: Option<f64>,
        may_hurry: bool,
        file_bytes: i64,
        queued_ms: i64,
        running: u32,
    }
}

/// What [`Change::check_limits`] is to know of a person. Most have no limits, and every submission waits here.
pub(in crate::store) fn admission(person: Uuid) -> Query {
    let known = query(
        "SELECT most_running, most_queued_core_h, most_disk_gb,
            may_hurry OR role = 'administrator' AS may_hurry, file_bytes,
            CASE WHEN most_queued_core_h IS NULL THEN 0 ELSE
                (SELECT CAST(COALESCE(SUM(core_ms), 0) AS BIGINT) FROM waiting_lines WHERE owner = p.id)
                END AS queued_ms,
            CASE WHEN most_running IS NULL THEN 0 ELSE
                (SELECT COUNT(*) FROM attempts a JOIN jobs j ON j.seq = a.job
                 WHERE a.ended_at IS NULL AND j.owner = p.id) END AS running
         FROM people p WHERE id = ?",
    );
    known.bind(person)
}

impl Change {
    /// Refuses a job that a person may not submit, of whom `known` is what [`admission`] told before.
    pub(in crate::store) async fn check_limits(
        &mut self,
        person: Uuid,
        known: &Row,
        priority: i32,
        estimate: &Estimate,
    ) -> Result<()> {
        let known = Admission::from_row(known)?;
        let limits = PersonLimits {
            running: known.most_running,
            queued_core_h: known.most_queued_core_h,
            disk_gb: known.most_disk_gb,
            may_hurry: known.may_hurry,
        };
        let used = PersonUse {
            running: known.running,
            queued_core_h: known.queued_ms as f64 / 3.6e6,
            disk_gb: known.file_bytes as f64 / 1e9,
            ..PersonUse::default()
        };
        let allowance = Allowance::of(limits, used);
        let violations = allowance.violations(priority, estimate);
        if !violations.is_empty() {
            return Err(StoreError::Refused(violations));
        }
        let before = allowance.used.queued_core_h;
        let queued = before + estimate.wall_s / 3600.0;
        match allowance.limits.queued_core_h {
            Some(limit) if before < TOLD * limit && queued >= TOLD * limit => {
                self.tell_of_queue(person, queued, limit).await
            }
            _ => Ok(()),
        }
    }

    /// Tells who wants to know that the person's queued jobs have come near the limit. Of files the database
    /// tells by itself: they grow by many ways.
    async fn tell_of_queue(&mut self, person: Uuid, queued: f64, limit: f64) -> Result<()> {
        let name = PersonRow::of(&mut self.connection, person)
            .await?
            .view()?
            .name;
        let about = serde_json::json!({
            "person": name, "used_core_h": queued, "limit_core_h": limit
        });
        query(
            "INSERT INTO outbox (webhook, event, at, body)
             SELECT w.id, 'quota', ?, ? FROM webhooks w
             WHERE w.removed_at IS NULL AND w.project IS NULL AND w.person = ?
               AND EXISTS (SELECT 1 FROM json_each(w.events) e WHERE e.value = 'quota')",
        )
        .bind(self.now.as_millis())
        .bind(about.to_string())
        .bind(person)
        .execute(&mut self.connection)
        .await?;
        Ok(())
    }

    /// Refuses to raise the priority of a job where the person may not.
    pub(in crate::store) async fn check_hurry(
        &mut self,
        priority: Option<i32>,
        job: i64,
    ) -> Result<()> {
        let person = self.actor.as_ref().and_then(|actor| actor.person);
        let (Some(person), Some(priority)) = (person, priority) else {
            return Ok(());
        };
        let before: i32 = query_scalar("SELECT priority FROM jobs WHERE seq = ?")
            .bind(job)
            .fetch_one(&mut self.connection)
            .await?;
        if priority <= before {
            return Ok(());
        }
        let limits = PersonRow::of(&mut self.connection, person)
            .await?
            .view()?
            .limits;
        let allowance = Allowance::of(limits, PersonUse::default());
        match allowance.hurry(priority) {
            Some(violation) => Err(StoreError::Refused(vec![violation])),
            None => Ok(()),
        }
    }
}
