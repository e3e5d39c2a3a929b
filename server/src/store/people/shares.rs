//! Links that show one job, one project or one comparison to whoever has them.
use loadframe_api::Timestamp;
use loadframe_api::people::{Named, NewShare, ShareMade, ShareView};
use uuid::Uuid;

use super::super::Store;
use super::super::database::{query, query_as, row};
use super::super::error::{Result, StoreError};
use super::invitations::DAY;
use super::secret::Secret;
use crate::access::Sight;

/// What the secret of a link begins with.
pub(super) const PREFIX: &str = "lfs_";

row! {
    struct ShareRow {
        id: Uuid,
        job: Option<Uuid>,
        project: Option<Uuid>,
        comparison: Option<Uuid>,
        shows_files: bool,
        person: Uuid,
        person_name: String,
        created_at: i64,
        expires_at: i64,
        revoked_at: Option<i64>,
        uses: i64,
        last_used_at: Option<i64>,
        /// Of its job, for who may see the link.
        owner: Option<Uuid>,
        job_project: Option<Uuid>,
    }
}

impl ShareRow {
    fn view(self) -> ShareView {
        ShareView {
            id: self.id,
            job: self.job,
            project: self.project,
            comparison: self.comparison,
            files: self.shows_files,
            person: Named {
                id: self.person,
                name: self.person_name,
            },
            created_at: Timestamp(self.created_at),
            expires_at: Timestamp(self.expires_at),
            revoked_at: self.revoked_at.map(Timestamp),
            uses: self.uses.unsigned_abs(),
            last_used_at: self.last_used_at.map(Timestamp),
        }
    }
}

impl Store {
    /// Makes a link of `person` that shows what the request names, which they may share.
    ///
    /// # Errors
    /// The database's.
    pub async fn create_share(&self, person: Uuid, new: NewShare) -> Result<ShareMade> {
        let secret = Secret::new(PREFIX);
        let (id, sha256) = (Uuid::now_v7(), secret.sha256);
        let expires_at = self
            .write(move |change| {
                Box::pin(async move {
                    let now = change.now.as_millis();
                    let expires_at = now + i64::from(new.days) * DAY;
                    query(
                        "INSERT INTO shares (id, secret_sha256, job, project, comparison, shows_files,
                                             person, created_at, expires_at)
                         VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)",
                    )
                    .bind(id)
                    .bind(sha256)
                    .bind(new.job)
                    .bind(new.project)
                    .bind(new.comparison)
                    .bind(new.files)
                    .bind(person)
                    .bind(now)
                    .bind(expires_at)
                    .execute(&mut change.connection)
                    .await?;
                    let what = match (new.job, new.project) {
                        (Some(_), _) => "job",
                        (_, Some(_)) => "project",
                        _ => "comparison",
                    };
                    let files = if new.files { "with" } else { "without" };
                    let detail = format!("link {id} to a {what}, {files} files");
                    change
                        .audit("share.made", new.job.or(new.project).or(new.comparison), &detail)
                        .await?;
                    Ok(expires_at)
                })
            })
            .await?;
        Ok(ShareMade {
            id,
            path: format!("/shared#{}", secret.text),
            expires_at: Timestamp(expires_at),
        })
    }

    /// Links to what `sight` shows and this person could take back: their own, or all for
    /// administrators; the newest first.
    ///
    /// # Errors
    /// The database's.
    pub async fn shares(
        &self,
        person: Uuid,
        sight: &Sight,
        job: Option<Uuid>,
        comparison: Option<Uuid>,
    ) -> Result<Vec<ShareView>> {
        let rows: Vec<ShareRow> = query_as(
            "SELECT s.id, s.job, s.project, s.comparison, s.shows_files, s.person, p.name AS person_name,
                    s.created_at, s.expires_at, s.revoked_at, s.uses, s.last_used_at, j.owner,
                    j.project AS job_project
             FROM shares s JOIN people p ON p.id = s.person LEFT JOIN jobs j ON j.id = s.job
             WHERE (?1 IS NULL OR s.job = ?1) AND (?2 IS NULL OR s.comparison = ?2)
             ORDER BY s.created_at DESC, s.id LIMIT 1000",
        )
        .bind(job)
        .bind(comparison)
        .fetch_all(self.reads())
        .await?;
        let is_theirs = |row: &ShareRow| {
            let is_job = row
                .job
                .is_some_and(|id| sight.shows(id, row.owner, row.job_project));
            row.person == person || (sight.everything) || (row.owner == Some(person) && is_job)
        };
        let rows = rows.into_iter().filter(is_theirs);
        Ok(rows.map(ShareRow::view).collect())
    }

    /// Takes a link back: the person's own, one to a job of theirs, or any for administrators.
    ///
    /// # Errors
    /// [`StoreError::NotFound`].
    pub async fn revoke_share(&self, person: Uuid, is_administrator: bool, id: Uuid) -> Result<()> {
        self.write(move |change| {
            Box::pin(async move {
                let revoked: Option<(Option<Uuid>,)> = query_as(
                    "UPDATE shares SET revoked_at = COALESCE(revoked_at, ?1)
                     WHERE id = ?2 AND (?3 OR person = ?4
                        OR EXISTS (SELECT 1 FROM jobs j WHERE j.id = shares.job AND j.owner = ?4))
                     RETURNING COALESCE(job, project, comparison)",
                )
                .bind(change.now.as_millis())
                .bind(id)
                .bind(is_administrator)
                .bind(person)
                .fetch_optional(&mut change.connection)
                .await?;
                let missing = || StoreError::NotFound(format!("share link {id}"));
                let (shown,) = revoked.ok_or_else(missing)?;
                let detail = format!("link {id}");
                change.audit("share.revoked", shown, &detail).await
            })
        })
        .await
    }

    /// Counts a visit through a link.
    ///
    /// # Errors
    /// The database's.
    pub async fn count_visit(&self, id: Uuid) -> Result<()> {
        self.write(move |change| {
            Box::pin(async move {
                let shown: Option<(Option<Uuid>,)> = query_as(
                    "UPDATE shares SET uses = uses + 1, last_used_at = ? WHERE id = ?
                     RETURNING COALESCE(job, project, comparison)",
                )
                .bind(change.now.as_millis())
                .bind(id)
                .fetch_optional(&mut change.connection)
                .await?;
                let Some((shown,)) = shown else {
                    return Ok(());
                };
                let detail = format!("link {id}");
                change.audit("share.read", shown, &detail).await
            })
        })
        .await
    }
}
