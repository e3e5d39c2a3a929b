//! What lies in the trash, and whose it is.
use loadframe_api::people::{Deleted, Named, TrashView};
use loadframe_api::{JobKind, Page, Timestamp};
use uuid::Uuid;

use super::super::Store;
use super::super::database::{query_as, row};
use super::super::encoding::variant;
use super::super::error::{Result, StoreError};

/// Longest page.
const LONGEST_PAGE: u32 = 1000;

/// Whose deleted things are listed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrashSight {
    Everything,
    /// Those of this person.
    Of(Uuid),
}

pub(super) fn missing(id: Uuid) -> StoreError {
    StoreError::NotFound(format!("deleted job or project {id}"))
}

row! {
    struct TrashRow {
        what: String,
        id: Uuid,
        name: String,
        kind: Option<String>,
        owner: Option<Uuid>,
        owner_name: Option<String>,
        project: Option<Uuid>,
        project_name: Option<String>,
        deleted_at: i64,
        deleted_by: String,
        jobs: i64,
        files: i64,
        bytes: i64,
    }
}

impl TrashRow {
    fn view(self, stays: i64) -> Result<TrashView> {
        let named = |id: Option<Uuid>, name: Option<String>| {
            id.zip(name).map(|(id, name)| Named { id, name })
        };
        Ok(TrashView {
            id: self.id,
            what: variant::<Deleted>(&self.what)?,
            name: self.name,
            kind: self.kind.as_deref().map(variant::<JobKind>).transpose()?,
            owner: named(self.owner, self.owner_name),
            project: named(self.project, self.project_name),
            deleted_at: Timestamp(self.deleted_at),
            deleted_by: self.deleted_by,
            gone_at: Timestamp(self.deleted_at + stays),
            jobs: self.jobs.unsigned_abs(),
            files: self.files.unsigned_abs(),
            bytes: self.bytes.unsigned_abs(),
        })
    }
}

impl Store {
    /// A page of the trash as of `now`, the last deleted first; `cursor` is the `next` of the page before.
    ///
    /// # Errors
    /// [`StoreError::Invalid`] for a cursor that was never given out.
    pub async fn trash(
        &self,
        sight: TrashSight,
        cursor: Option<&str>,
        limit: u32,
        now: Timestamp,
    ) -> Result<Page<TrashView>> {
        let limit = limit.clamp(1, LONGEST_PAGE);
        let before = cursor.map(|text| place(text).ok_or_else(no_cursor));
        let (at, id) = before.transpose()?.unwrap_or((i64::MAX, Uuid::max()));
        let person = match sight {
            TrashSight::Everything => None,
            TrashSight::Of(person) => Some(person),
        };
        let mut rows: Vec<TrashRow> = query_as(
            "SELECT d.*, o.name AS owner_name, p.name AS project_name
             FROM (SELECT * FROM (SELECT 'job' AS what, id, name, kind, owner, project, deleted_at,
                        deleted_by, 1 AS jobs, files, bytes
                    FROM trash WHERE NOT (with_project AND EXISTS (SELECT 1 FROM projects x
                            WHERE x.id = trash.project AND x.deleted_at IS NOT NULL))
                        AND (?1 IS NULL OR owner = ?1) AND deleted_at > ?2 AND (deleted_at, id) < (?3, ?4)
                    ORDER BY deleted_at DESC, id DESC LIMIT ?5) jobs_deleted
                UNION ALL
                SELECT 'project', r.id, r.name, NULL, r.person, NULL, r.deleted_at,
                    COALESCE(r.deleted_by, ''), COUNT(t.job), CAST(COALESCE(SUM(t.files), 0) AS BIGINT),
                    CAST(COALESCE(SUM(t.bytes), 0) AS BIGINT)
                FROM projects r LEFT JOIN trash t ON t.project = r.id AND t.with_project
                WHERE (?1 IS NULL OR r.person = ?1) AND r.deleted_at > ?2 GROUP BY r.id
                UNION ALL
                SELECT 'files', r.id, r.name, NULL, r.person, NULL, MIN(f.removed_at), 'rule',
                    COUNT(DISTINCT j.seq), COUNT(*), CAST(SUM(f.bytes) AS BIGINT)
                FROM attempt_files f JOIN attempts a ON a.seq = f.attempt JOIN jobs j ON j.seq = a.job
                    JOIN projects r ON r.id = j.project
                WHERE f.removed_at > ?2 AND (?1 IS NULL OR r.person = ?1) GROUP BY r.id) d
             LEFT JOIN people o ON o.id = d.owner LEFT JOIN projects p ON p.id = d.project
             WHERE (d.deleted_at, d.id) < (?3, ?4) ORDER BY d.deleted_at DESC, d.id DESC LIMIT ?5",
        )
        .bind(person)
        .bind(now.as_millis() - self.trash_millis())
        .bind(at)
        .bind(id)
        .bind(limit + 1)
        .fetch_all(self.reads())
        .await?;
        let is_last = rows.len() <= limit as usize;
        rows.truncate(limit as usize);
        let next = rows.last().filter(|_| !is_last);
        let next = next.map(|row| format!("{}-{}", row.deleted_at, row.id.simple()));
        let views = rows.into_iter().map(|row| row.view(self.trash_millis()));
        Ok(Page {
            items: views.collect::<Result<_>>()?,
            next,
            unreadable: 0,
            stopped_after: None,
            newest_only: false,
            gathering: false,
        })
    }

    /// What `id` names in the trash, and whose it is.
    ///
    /// # Errors
    /// [`StoreError::NotFound`].
    pub async fn in_trash(&self, id: Uuid) -> Result<(Deleted, Option<Uuid>)> {
        let row: Option<(String, Option<Uuid>)> = query_as(
            "SELECT 'job', owner FROM trash WHERE id = ?1 AND deleted_at > ?2
                AND NOT (with_project AND EXISTS (SELECT 1 FROM projects x
                    WHERE x.id = trash.project AND x.deleted_at IS NOT NULL))
             UNION ALL SELECT 'project', person FROM projects WHERE id = ?1 AND deleted_at > ?2
             UNION ALL SELECT 'files', person FROM projects r WHERE id = ?1 AND deleted_at IS NULL
                AND EXISTS (SELECT 1 FROM jobs j JOIN attempts a ON a.job = j.seq
                    JOIN attempt_files f ON f.attempt = a.seq
                    WHERE j.project = r.id AND f.removed_at IS NOT NULL)
             LIMIT 1",
        )
        .bind(id)
        .bind(self.now().as_millis() - self.trash_millis())
        .fetch_optional(self.lookups())
        .await?;
        let (what, owner) = row.ok_or_else(|| missing(id))?;
        Ok((variant::<Deleted>(&what)?, owner))
    }
}

fn no_cursor() -> StoreError {
    StoreError::Invalid("the cursor is not one that a page gave as `next`".to_owned())
}

fn place(cursor: &str) -> Option<(i64, Uuid)> {
    let (at, id) = cursor.split_once('-')?;
    Some((at.parse().ok()?, Uuid::try_parse(id).ok()?))
}
