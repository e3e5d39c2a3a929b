//! The audit log: a line in the transaction of each change that somebody makes. It only grows; the
//! database itself refuses to change or delete a line.
use std::sync::Arc;

use loadframe_api::people::AuditEntry;
use loadframe_api::{Page, Timestamp};
use serde::Serialize;
use uuid::Uuid;

use super::super::Store;
use super::super::database::{LastStatement, query_as, row};
use super::super::encoding::json;
use super::super::error::{Result, StoreError};
use super::super::writer::Change;
use super::actor::Actor;

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

/// A line that is to be written with the transaction.
#[derive(Debug)]
pub(in super::super) struct Line {
    at: Timestamp,
    actor: Arc<Actor>,
    action: String,
    object: Option<Uuid>,
    detail: String,
}

/// Writes lines, given as a JSON array of their columns.
macro_rules! write_lines {
    ($end:literal) => {
        concat!(
            "INSERT INTO audit (at, who, person, credential, action, object, detail, request, address)
             SELECT CAST(json_extract(value, '$[0]') AS BIGINT), json_extract(value, '$[1]'),
                    unhex(json_extract(value, '$[2]')), unhex(json_extract(value, '$[3]')),
                    json_extract(value, '$[4]'), unhex(json_extract(value, '$[5]')),
                    json_extract(value, '$[6]'), unhex(json_extract(value, '$[7]')),
                    json_extract(value, '$[8]')
             FROM json_each(?1) ORDER BY key",
            $end
        )
    };
}
const LINES: LastStatement = LastStatement {
    alone: write_lines!(""),
    and_commit: write_lines!("; COMMIT"),
};

impl Line {
    fn columns(&self) -> impl Serialize + '_ {
        let Actor {
            who,
            person,
            credential,
            request,
            address,
        } = &*self.actor;
        let id = |id: Option<Uuid>| id.map(|id| format!("{:X}", id.simple()));
        (
            self.at.as_millis(),
            who,
            id(*person),
            id(*credential),
            &self.action,
            id(self.object),
            &self.detail,
            id(*request),
            address,
        )
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

    /// Commits the transaction with its lines, in their order. All in one go, at its end: every statement is a
    /// way to the database and back, for which all commands of the transaction would wait one after the other.
    pub(in super::super) async fn commit_with_lines(&mut self, lines: &[Line]) -> Result<()> {
        let columns: Vec<_> = lines.iter().map(Line::columns).collect();
        self.connection.commit_with(LINES, json(&columns)?).await
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
