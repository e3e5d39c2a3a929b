//! Links that show one job, one project or one comparison to whoever has them.
use loadframe_api::people::{Named, NewShare, Scope, ShareMade, ShareView};
use loadframe_api::{Page, Timestamp};
use uuid::Uuid;

use super::super::Store;
use super::super::database::{query, query_as, row};
use super::super::error::{Result, StoreError};
use super::callers::ids;
use super::invitations::DAY;
use super::secret::Secret;
use crate::access::{Action, Caller, Credential, Identity, Link, Object, Verdict, may};

/// What the secret of a link begins with.
pub(super) const PREFIX: &str = "lfs_";
/// Links on a page.
const LONGEST_PAGE: u32 = 1000;

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
    }
}

row! {
    /// A link in force, as far as time goes.
    struct LinkRow {
        id: Uuid,
        job: Option<Uuid>,
        project: Option<Uuid>,
        comparison: Option<Uuid>,
        shows_files: bool,
        person: Uuid,
        expires_at: i64,
        compared: String,
    }
}

/// Which links to list.
#[derive(Clone, Debug, Default)]
pub struct ShareFilter {
    pub job: Option<Uuid>,
    pub comparison: Option<Uuid>,
    /// `next` of the page before.
    pub cursor: Option<String>,
    pub limit: u32,
}

/// The projects that person ?1 holds.
macro_rules! held {
    () => {
        "(SELECT r.id FROM projects r WHERE r.person = ?1 OR r.team IN (SELECT m.team FROM members m
            JOIN people h ON h.id = m.person WHERE m.person = ?1 AND h.role <> 'guest'))"
    };
}

/// Whether person ?1 may take back the link `s`: they made it, or hold what it shows, or (?2) administer.
macro_rules! is_theirs {
    () => {
        concat!(
            "(?2 OR s.person = ?1 OR s.project IN ",
            held!(),
            " OR EXISTS (SELECT 1 FROM jobs j WHERE j.id = s.job AND (j.owner = ?1 OR j.project IN ",
            held!(),
            ")) OR EXISTS (SELECT 1 FROM comparisons c WHERE c.id = s.comparison
                AND (c.owner = ?1 OR c.project IN ",
            held!(),
            ")))"
        )
    };
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

    /// A page of the links that this person may take back: their own and those to what they hold, or all for
    /// administrators; the newest first. `cursor` is the `next` of the page before.
    ///
    /// # Errors
    /// [`StoreError::Invalid`] for a cursor that was never given out.
    pub async fn shares(
        &self,
        person: Uuid,
        is_administrator: bool,
        filter: &ShareFilter,
    ) -> Result<Page<ShareView>> {
        let limit = filter.limit.clamp(1, LONGEST_PAGE);
        let before = filter.cursor.as_deref();
        let before = before.map(|text| place(text).ok_or_else(no_cursor));
        let (at, id) = before.transpose()?.unwrap_or((i64::MAX, Uuid::max()));
        let mut rows: Vec<ShareRow> = query_as(concat!(
            "SELECT s.id, s.job, s.project, s.comparison, s.shows_files, s.person, p.name AS person_name,
                    s.created_at, s.expires_at, s.revoked_at, s.uses, s.last_used_at
             FROM shares s JOIN people p ON p.id = s.person
             WHERE (?3 IS NULL OR s.job = ?3) AND (?4 IS NULL OR s.comparison = ?4)
               AND (s.created_at, s.id) < (?5, ?6) AND ",
            is_theirs!(),
            " ORDER BY s.created_at DESC, s.id DESC LIMIT ?7",
        ))
        .bind(person)
        .bind(is_administrator)
        .bind(filter.job)
        .bind(filter.comparison)
        .bind(at)
        .bind(id)
        .bind(limit + 1)
        .fetch_all(self.reads())
        .await?;
        let is_last = rows.len() <= limit as usize;
        rows.truncate(limit as usize);
        let next = rows.last().filter(|_| !is_last);
        Ok(Page {
            next: next.map(|row| format!("{}-{}", row.created_at, row.id.simple())),
            ..Page::whole(rows.into_iter().map(ShareRow::view).collect())
        })
    }

    /// Takes a link back: the person's own, one to what they hold, or any for administrators.
    ///
    /// # Errors
    /// [`StoreError::NotFound`].
    pub async fn revoke_share(&self, person: Uuid, is_administrator: bool, id: Uuid) -> Result<()> {
        self.write(move |change| {
            Box::pin(async move {
                let revoked: Option<(Option<Uuid>,)> = query_as(concat!(
                    "UPDATE shares SET revoked_at = COALESCE(revoked_at, ?4)
                     WHERE id IN (SELECT s.id FROM shares s WHERE s.id = ?3 AND ",
                    is_theirs!(),
                    ") RETURNING COALESCE(job, project, comparison)",
                ))
                .bind(person)
                .bind(is_administrator)
                .bind(id)
                .bind(change.now.as_millis())
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

    /// Who has the link with this secret or id: it shows what it was made for as long as who made it may
    /// change that.
    pub(super) async fn link_caller(
        &self,
        sha256: Option<&str>,
        id: Option<Uuid>,
    ) -> Result<Option<Caller>> {
        let row: Option<LinkRow> = query_as(
            "SELECT s.id, s.job, s.project, s.comparison, s.shows_files, s.person, s.expires_at,
                    (SELECT json_group_array(hex(job)) FROM comparison_jobs n
                     WHERE n.comparison = s.comparison) AS compared
             FROM shares s
             WHERE (s.secret_sha256 = ?1 OR s.id = ?2) AND s.revoked_at IS NULL AND s.expires_at > ?3",
        )
        .bind(sha256)
        .bind(id)
        .bind(self.now().as_millis())
        .fetch_optional(self.lookups())
        .await?;
        let Some(row) = row else { return Ok(None) };
        let compared = ids(&row.compared)?;
        if !self.could_be_made(&row, &compared).await? {
            return Ok(None);
        }
        Ok(Some(Caller {
            identity: Identity::Link(Link {
                job: row.job,
                project: row.project,
                comparison: row.comparison,
                compared,
                shows_files: row.shows_files,
            }),
            scope: Scope::Read,
            credential: Credential::Link(row.id),
            expires_at: Some(Timestamp(row.expires_at)),
        }))
    }

    /// Whether who made the link could make it now: what it shows is there, and theirs to change.
    async fn could_be_made(&self, link: &LinkRow, compared: &[Uuid]) -> Result<bool> {
        let maker = self.person_caller(link.person, Credential::Proxy(link.person));
        let Some(maker) = maker.await? else {
            return Ok(false);
        };
        let may_share = |object: Object| may(&maker, Action::Change, object) == Verdict::Yes;
        if let Some(job) = link.job {
            let facts = self.facts_of_jobs(&[job]).await?;
            return Ok(facts.iter().any(|of| may_share(Object::Job(of))));
        }
        let projects = self.project_facts().await?;
        if let Some(project) = link.project {
            let of = projects.iter().find(|of| of.id == project);
            return Ok(of.is_some_and(|of| may_share(Object::Project(of))));
        }
        let Some(comparison) = link.comparison else {
            return Ok(false);
        };
        match self.comparison_facts(comparison, &projects).await {
            Ok(of) if may_share(Object::Comparison(&of)) => {}
            Ok(_) | Err(StoreError::NotFound(_)) => return Ok(false),
            Err(error) => return Err(error),
        }
        // of a comparison every job; one that is deleted shows nothing to anybody
        let jobs = self.facts_of_jobs(compared).await?;
        Ok(jobs.iter().all(|of| may_share(Object::Job(of))))
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

fn no_cursor() -> StoreError {
    StoreError::Invalid("the cursor is not one that a page gave as `next`".to_owned())
}

fn place(cursor: &str) -> Option<(i64, Uuid)> {
    let (at, id) = cursor.split_once('-')?;
    Some((at.parse().ok()?, Uuid::try_parse(id).ok()?))
}
