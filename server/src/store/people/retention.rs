//! What of a project's old jobs is removed: snapshots before curves, never the outcome.
//!
//! A rule is announced before it is in force. What it removes is hidden at once and gone for good only
//! later; until then all of it can be brought back.
use loadframe_api::Timestamp;
use loadframe_api::people::{FilesOfJobs, RetentionRule, RetentionView};
use uuid::Uuid;

use super::super::Store;
use super::super::database::{Connection, query, query_as, query_scalar};
use super::super::error::Result;
use super::super::writer::Change;
use super::Actor;
use super::checks::refused;
use super::invitations::DAY;

/// A rule removes nothing for so long after it was set [ms].
pub const ANNOUNCED: i64 = 7 * DAY;
/// Jobs cleared, and files forgotten, in one change: others wait for it.
const AT_ONCE: u32 = 200;
/// How often rules are applied.
const EVERY: std::time::Duration = std::time::Duration::from_secs(3600);

/// How far a job is cleared, the kinds of files that go with it, and their days in a rule.
type Step = (u32, &'static str, fn(&RetentionRule) -> Option<u32>);
const STEPS: [Step; 2] = [
    (1, "snapshots", |rule| rule.snapshots_days),
    (2, "curves", |rule| rule.curves_days),
];

fn check(rule: &RetentionRule) -> Result<()> {
    let Some(curves) = rule.curves_days else {
        return Ok(());
    };
    let snapshots = rule.snapshots_days.unwrap_or(u32::MAX);
    if snapshots <= curves {
        return Ok(());
    }
    let detail = "snapshots are removed before curves";
    let allowed = match rule.snapshots_days {
        Some(days) => format!("at least {days}, the days of snapshots"),
        None => "left out, as long as snapshots are kept for ever".to_owned(),
    };
    Err(refused(
        "/curves_days",
        "before_snapshots",
        detail,
        curves,
        &allowed,
    ))
}

async fn rule_of(
    connection: &mut Connection,
    project: Uuid,
) -> Result<(RetentionRule, Option<Timestamp>)> {
    let found: Option<(Option<u32>, Option<u32>, i64)> = query_as(
        "SELECT snapshots_days, curves_days, in_force_at FROM retention WHERE project = ?",
    )
    .bind(project)
    .fetch_optional(connection)
    .await?;
    Ok(found.map_or(
        (RetentionRule::default(), None),
        |(snapshots_days, curves_days, at)| {
            let rule = RetentionRule {
                snapshots_days,
                curves_days,
            };
            (rule, Some(Timestamp(at)))
        },
    ))
}

fn counted((jobs, files, bytes): (i64, i64, i64)) -> FilesOfJobs {
    FilesOfJobs {
        jobs: jobs.unsigned_abs(),
        files: files.unsigned_abs(),
        bytes: bytes.unsigned_abs(),
    }
}

impl Store {
    /// The rule of a project, what it or `asked` would remove now, and what can be brought back.
    ///
    /// # Errors
    /// [`super::super::StoreError::Refused`] for a rule that cannot be.
    pub async fn retention(
        &self,
        project: Uuid,
        asked: Option<RetentionRule>,
        now: Timestamp,
    ) -> Result<RetentionView> {
        let mut snapshot = self.reads().begin().await?;
        let (rule, in_force_at) = rule_of(&mut snapshot, project).await?;
        let asked = asked.unwrap_or(rule);
        check(&asked)?;
        let before = |days: Option<u32>| days.map(|days| now.as_millis() - i64::from(days) * DAY);
        let would_remove = query_as(
            "SELECT COUNT(DISTINCT j.seq), COUNT(*), CAST(COALESCE(SUM(f.bytes), 0) AS BIGINT)
             FROM jobs j JOIN attempts a ON a.job = j.seq JOIN attempt_files f ON f.attempt = a.seq
             WHERE j.project = ?1 AND f.removed_at IS NULL
               AND ((f.kind = 'snapshots' AND j.cleared < 1 AND j.finished_at < ?2)
                 OR (f.kind = 'curves' AND j.cleared < 2 AND j.finished_at < ?3))",
        )
        .bind(project)
        .bind(before(asked.snapshots_days))
        .bind(before(asked.curves_days))
        .fetch_one(&mut snapshot)
        .await?;
        let (jobs, files, bytes, since): (i64, i64, i64, Option<i64>) = query_as(
            "SELECT COUNT(DISTINCT j.seq), COUNT(*), CAST(COALESCE(SUM(f.bytes), 0) AS BIGINT), MIN(f.removed_at)
             FROM attempt_files f JOIN attempts a ON a.seq = f.attempt JOIN jobs j ON j.seq = a.job
             WHERE f.removed_at IS NOT NULL AND j.project = ?",
        )
        .bind(project)
        .fetch_one(&mut snapshot)
        .await?;
        Ok(RetentionView {
            rule,
            in_force_at,
            would_remove: counted(would_remove),
            removed: counted((jobs, files, bytes)),
            gone_at: since.map(|since| Timestamp(since + self.trash_millis())),
        })
    }

    /// Sets the rule of a project, in force after it was announced for a while; an empty one keeps all.
    ///
    /// # Errors
    /// [`super::super::StoreError::Refused`] for a rule that cannot be.
    pub async fn set_retention(&self, project: Uuid, rule: RetentionRule) -> Result<()> {
        check(&rule)?;
        self.write(move |change| {
            Box::pin(async move {
                if rule == RetentionRule::default() {
                    query("DELETE FROM retention WHERE project = ?")
                        .bind(project)
                        .execute(&mut change.connection)
                        .await?;
                } else {
                    let now = change.now.as_millis();
                    query(
                        "INSERT INTO retention (project, snapshots_days, curves_days, set_at, in_force_at)
                         VALUES (?1, ?2, ?3, ?4, ?5)
                         ON CONFLICT (project) DO UPDATE SET snapshots_days = ?2, curves_days = ?3,
                            set_at = ?4, in_force_at = ?5",
                    )
                    .bind(project)
                    .bind(rule.snapshots_days)
                    .bind(rule.curves_days)
                    .bind(now)
                    .bind(now + ANNOUNCED)
                    .execute(&mut change.connection)
                    .await?;
                }
                let days = |days: Option<u32>| {
                    days.map_or("for ever".to_owned(), |days| format!("{days} days"))
                };
                let detail = format!(
                    "snapshots {}, curves {}",
                    days(rule.snapshots_days),
                    days(rule.curves_days)
                );
                change.audit("retention.set", Some(project), &detail).await
            })
        })
        .await
    }

    /// Brings back what was removed from a project and is not gone for good, and ends its rule, which
    /// would remove it again. Tells how many files.
    ///
    /// # Errors
    /// The database's.
    pub async fn undo_retention(&self, project: Uuid) -> Result<u64> {
        self.write_large(move |change| {
            Box::pin(async move {
                let files = query(
                    "UPDATE attempt_files SET removed_at = NULL WHERE removed_at IS NOT NULL
                        AND attempt IN (SELECT a.seq FROM attempts a JOIN jobs j ON j.seq = a.job
                                        WHERE j.project = ?)",
                )
                .bind(project)
                .execute(&mut change.connection)
                .await?
                .rows_affected();
                for statement in [
                    "UPDATE jobs SET cleared = 0 WHERE project = ? AND cleared > 0 AND finished_at IS NOT NULL",
                    "DELETE FROM retention WHERE project = ?",
                ] {
                    query(statement)
                        .bind(project)
                        .execute(&mut change.connection)
                        .await?;
                }
                let detail = format!("{files} files brought back");
                change.audit("retention.undone", Some(project), &detail).await?;
                Ok(files)
            })
        })
        .await
    }

    /// Applies the rules in force as of `now`, and forgets what was removed long ago. Tells how many files
    /// were removed and how many are gone for good.
    ///
    /// # Errors
    /// The database's; the first of those of single rules.
    pub async fn retain(&self, now: Timestamp) -> Result<(u64, u64)> {
        let rules: Vec<(Uuid, Option<u32>, Option<u32>)> = query_as(
            "SELECT project, snapshots_days, curves_days FROM retention WHERE in_force_at <= ?",
        )
        .bind(now.as_millis())
        .fetch_all(self.reads())
        .await?;
        let gone_before = now.as_millis() - self.trash_millis();
        let server = self.acting(Actor::named("server"));
        // of webhooks whose person may not be told any more
        self.write_from_reserve(move |change| {
            Box::pin(async move {
                query("DELETE FROM outbox WHERE at < ?")
                    .bind(now.as_millis() - 2 * DAY)
                    .execute(&mut change.connection)
                    .await?;
                Ok(())
            })
        })
        .await?;
        let (mut removed, mut gone, mut failed) = (0, 0, None);
        for (project, snapshots_days, curves_days) in rules {
            let rule = RetentionRule {
                snapshots_days,
                curves_days,
            };
            // one that cannot be applied keeps no other from it
            match server.apply(project, &rule, now).await {
                Ok(files) => removed += files,
                Err(error) => failed = failed.or(Some(error)),
            }
        }
        loop {
            let forgotten = self
                .write_from_reserve(move |change| {
                    Box::pin(async move { change.forget(gone_before).await })
                })
                .await?;
            gone += forgotten as u64;
            if forgotten < AT_ONCE as usize {
                return failed.map_or(Ok((removed, gone)), Err);
            }
        }
    }

    /// Removes what the rule of a project does; tells how many files.
    async fn apply(&self, project: Uuid, rule: &RetentionRule, now: Timestamp) -> Result<u64> {
        let mut removed = 0;
        for (cleared, kind, days) in STEPS {
            let Some(days) = days(rule) else { continue };
            let before = now.as_millis() - i64::from(days) * DAY;
            loop {
                let (jobs, files) = self
                    .write_from_reserve(move |change| {
                        Box::pin(
                            async move { change.clear(project, cleared, kind, before, now).await },
                        )
                    })
                    .await?;
                removed += files;
                if jobs < AT_ONCE as usize {
                    break;
                }
            }
        }
        Ok(removed)
    }

    /// Applies the rules and empties the trash every hour, until dropped.
    pub async fn keep_retaining(self) {
        loop {
            tokio::time::sleep(EVERY).await;
            match self.retain(self.now()).await {
                Ok((0, 0)) => {}
                Ok((removed, gone)) => {
                    tracing::info!(removed, gone, "files removed by rules of projects");
                }
                Err(error) => tracing::error!(%error, "the rules of projects could not be applied"),
            }
            match self.empty_trash(self.now()).await {
                Ok(0) => {}
                Ok(jobs) => tracing::info!(jobs, "deleted jobs whose time was over are gone"),
                Err(error) => tracing::error!(%error, "the trash could not be emptied"),
            }
        }
    }
}

impl Change {
    /// Removes files of this kind of the next jobs that ended before; tells how many jobs and files.
    async fn clear(
        &mut self,
        project: Uuid,
        cleared: u32,
        kind: &'static str,
        before: i64,
        now: Timestamp,
    ) -> Result<(usize, u64)> {
        let jobs: Vec<i64> = query_scalar(
            "UPDATE jobs SET cleared = ?2 WHERE seq IN (
                SELECT seq FROM jobs WHERE project = ?1 AND cleared < ?2 AND finished_at < ?3 LIMIT ?4)
             RETURNING seq",
        )
        .bind(project)
        .bind(cleared)
        .bind(before)
        .bind(AT_ONCE)
        .fetch_all(&mut self.connection)
        .await?;
        let mut files = 0;
        for job in &jobs {
            let removed = query(
                "UPDATE attempt_files SET removed_at = ?3 WHERE removed_at IS NULL AND kind = ?2
                    AND attempt IN (SELECT seq FROM attempts WHERE job = ?1)",
            )
            .bind(job)
            .bind(kind)
            .bind(now.as_millis())
            .execute(&mut self.connection)
            .await?;
            files += removed.rows_affected();
        }
        if files > 0 {
            let detail = format!("{kind} of {} jobs: {files} files", jobs.len());
            self.audit("retention.removed", Some(project), &detail)
                .await?;
        }
        Ok((jobs.len(), files))
    }

    /// Forgets the next files that were removed long ago, with the points of curves; tells how many.
    async fn forget(&mut self, before: i64) -> Result<usize> {
        let gone: Vec<(i64, String, String)> = query_as(
            "DELETE FROM attempt_files WHERE (attempt, name) IN (
                SELECT attempt, name FROM attempt_files WHERE removed_at < ? LIMIT ?)
             RETURNING attempt, name, sha256",
        )
        .bind(before)
        .bind(AT_ONCE)
        .fetch_all(&mut self.connection)
        .await?;
        for (attempt, name, _) in &gone {
            if name.ends_with("curve.csv") {
                query("DELETE FROM curve_blocks WHERE attempt = ?")
                    .bind(attempt)
                    .execute(&mut self.connection)
                    .await?;
            }
        }
        let count = gone.len();
        self.garbage(gone.into_iter().map(|(_, _, sha256)| sha256));
        Ok(count)
    }
}
