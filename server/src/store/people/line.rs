//! Lines of the audit log on their way into the transaction that they are part of.
use std::sync::Arc;

use loadframe_api::Timestamp;
use serde::Serialize;
use uuid::Uuid;

use super::super::database::{Connection, LastStatement};
use super::super::encoding::json;
use super::super::error::Result;
use super::actor::Actor;

/// A line that is to be written with the transaction.
#[derive(Debug)]
pub(in super::super) struct Line {
    pub(super) at: Timestamp,
    pub(super) actor: Arc<Actor>,
    pub(super) action: String,
    pub(super) object: Option<Uuid>,
    pub(super) detail: String,
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

    /// Commits a transaction with its lines, in their order. All in one go, at its end: every statement is a
    /// way to the database and back, for which all commands of the transaction would wait one after the other.
    ///
    /// # Errors
    /// The database's; what was written is then undone.
    pub(in super::super) async fn commit(
        lines: &[Self],
        connection: &mut Connection,
    ) -> Result<()> {
        let columns: Vec<_> = lines.iter().map(Self::columns).collect();
        connection.commit_with(LINES, json(&columns)?).await
    }
}
