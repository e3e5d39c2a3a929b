//! What fills the disk, by person, project and kind.
use loadframe_api::people::{DiskUse, FileKind, Named};
use uuid::Uuid;

use super::super::Store;
use super::super::database::{query_as, row};
use super::super::encoding::variant;
use super::super::error::Result;

row! {
    struct UseRow {
        person: Option<Uuid>,
        person_name: Option<String>,
        project: Option<Uuid>,
        project_name: Option<String>,
        kind: String,
        files: i64,
        bytes: i64,
    }
}

impl Store {
    /// Everything that is stored, the largest first. Files are counted as they come and go; checkpoints
    /// and deleted jobs, of which there are few, when asked.
    ///
    /// # Errors
    /// The database's.
    pub async fn disk_use(&self) -> Result<Vec<DiskUse>> {
        let rows: Vec<UseRow> = query_as(
            "SELECT NULLIF(u.person, x'') AS person, o.name AS person_name,
                    NULLIF(u.project, x'') AS project, p.name AS project_name, u.kind, u.files, u.bytes
             FROM (SELECT person, project, kind, files, bytes FROM disk_use WHERE files > 0
                   UNION ALL
                   SELECT COALESCE(j.owner, x''), COALESCE(j.project, x''), 'checkpoints', COUNT(*),
                          CAST(SUM(c.bytes) AS BIGINT)
                   FROM checkpoints c JOIN jobs j ON j.seq = c.job GROUP BY 1, 2
                   UNION ALL
                   SELECT COALESCE(owner, x''), COALESCE(project, x''), 'trash', CAST(SUM(files) AS BIGINT),
                          CAST(SUM(bytes) AS BIGINT)
                   FROM trash WHERE bytes > 0 GROUP BY 1, 2) u
             LEFT JOIN people o ON o.id = u.person LEFT JOIN projects p ON p.id = u.project
             ORDER BY u.bytes DESC, u.person, u.project, u.kind",
        )
        .fetch_all(self.reads())
        .await?;
        rows.into_iter().map(UseRow::view).collect()
    }
}

impl UseRow {
    fn view(self) -> Result<DiskUse> {
        let named = |id: Option<Uuid>, name: Option<String>| {
            id.zip(name).map(|(id, name)| Named { id, name })
        };
        Ok(DiskUse {
            person: named(self.person, self.person_name),
            project: named(self.project, self.project_name),
            kind: variant::<FileKind>(&self.kind)?,
            files: self.files.unsigned_abs(),
            bytes: self.bytes.unsigned_abs(),
        })
    }
}
