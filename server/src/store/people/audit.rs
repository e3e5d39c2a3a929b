//! The audit log: a line in the transaction of each change that somebody makes. It only grows; the
//! database itself refuses to change or delete a line.
use loadframe_api::people::AuditEntry;
use loadframe_api::{Page, Timestamp};
use uuid::Uuid;

use super::super::Store;
use super::super::database::{query_as, row};
use super::super::error::{Result, StoreError};
use super::super::writer::Change;
use super::line::Line;

/// Longest page.
const LONGEST_PAGE: u32 = 1000;

/// Which lines to read.
#[derive(Clone, Debug, Default)]
pub struct AuditFilter {
    pub person: Option<Uuid>,
    pub object: Option<Uuid>,
    /// Lines before this number; left out, from the newest on.
    pub before: Option<u64>,
    pub limit: u32,
}

row! {
    struct AuditRow {
        number: i64,
        at: i64,
        who: String,
        person: Option<Uuid>,
        credential: Option<Uuid>,
        action: String,
        object: Option<Uuid>,
        detail: String,
        request: Option<Uuid>,
        address: String,
    }
}

impl Change {
    /// Writes down that the actor of this change did `action` to `object`; without an actor it is the
    /// server itself that changes something, or the one person of a server without accounts.
    pub(in super::super) async fn audit(
        &mut self,
        action: &str,
        object: Option<Uuid>,
        detail: &str,
    ) -> Result<()> {
        if let Some(actor) = self.actor.clone() {
            self.note_line(Line {
                at: self.now,
                actor,
                action: action.to_owned(),
                object,
                // a line that the database cannot write would cost the whole transaction
                detail: detail.replace('\0', "\u{fffd}"),
            });
        }
        Ok(())
    }
}

impl Store {
    /// Lines of the audit log, the newest first.
    ///
    /// # Errors
    /// The database's.
    pub async fn audit(&self, filter: &AuditFilter) -> Result<Page<AuditEntry>> {
        let limit = filter.limit.clamp(1, LONGEST_PAGE);
        let before = filter.before.map(i64::try_from).transpose();
        let before = before.map_err(|_| StoreError::Invalid("there is no such line".to_owned()))?;
        let mut rows: Vec<AuditRow> = query_as(
            "SELECT number, at, who, person, credential, action, object, detail, request, address
             FROM audit WHERE (?1 IS NULL OR number < ?1) AND (?2 IS NULL OR person = ?2)
                AND (?3 IS NULL OR object = ?3)
             ORDER BY number DESC LIMIT ?4",
        )
        .bind(before)
        .bind(filter.person)
        .bind(filter.object)
        .bind(limit + 1)
        .fetch_all(self.reads())
        .await?;
        let is_last = rows.len() <= limit as usize;
        rows.truncate(limit as usize);
        let next = rows.last().filter(|_| !is_last);
        let next = next.map(|row| row.number.to_string());
        let entry = |row: AuditRow| AuditEntry {
            number: row.number.unsigned_abs(),
            at: Timestamp(row.at),
            who: row.who,
            person: row.person,
            credential: row.credential,
            action: row.action,
            object: row.object,
            detail: row.detail,
            request: row.request,
            address: row.address,
        };
        let items = rows.into_iter().map(entry).collect();
        Ok(Page {
            items,
            next,
            unreadable: 0,
            stopped_after: None,
            newest_only: false,
            gathering: false,
        })
    }
}
