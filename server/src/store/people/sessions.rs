//! Browsers in which somebody is signed in.
use loadframe_api::Timestamp;
use loadframe_api::people::SessionView;
use uuid::Uuid;

use super::super::Store;
use super::super::database::{query, query_as, row};
use super::super::error::{Result, StoreError};
use super::callers::LONGEST_IDLE;
use super::secret::Secret;

/// A session ends after this, however much it is used [ms].
const LONGEST: i64 = 30 * 24 * 3_600_000;
/// Longest name of a browser that is kept [characters].
const LONGEST_CLIENT: usize = 200;

/// A session just opened; the only time its secret is seen.
#[derive(Clone, Debug)]
pub struct NewSession {
    pub id: Uuid,
    pub secret: String,
    /// How long it lasts at most [s].
    pub lifetime_s: i64,
}

row! {
    struct SessionRow {
        id: Uuid,
        client: String,
        created_at: i64,
        last_used_at: i64,
        expires_at: i64,
    }
}

impl Store {
    /// Opens a session for a person whose password was right.
    ///
    /// # Errors
    /// The database's.
    pub async fn open_session(
        &self,
        person: Uuid,
        is_secure: bool,
        client: &str,
    ) -> Result<NewSession> {
        let secret = Secret::new("");
        let client: String = client.chars().take(LONGEST_CLIENT).collect();
        let (id, sha256) = (Uuid::now_v7(), secret.sha256);
        self.write(move |change| {
            Box::pin(async move {
                let now = change.now.as_millis();
                query("DELETE FROM sessions WHERE expires_at < ?1 OR last_used_at < ?2")
                    .bind(now)
                    .bind(now - LONGEST_IDLE)
                    .execute(&mut change.connection)
                    .await?;
                query(
                    "INSERT INTO sessions (id, secret_sha256, person, is_secure, client, created_at,
                                           last_used_at, expires_at)
                     VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?6, ?7)",
                )
                .bind(id)
                .bind(sha256)
                .bind(person)
                .bind(is_secure)
                .bind(client)
                .bind(now)
                .bind(now + LONGEST)
                .execute(&mut change.connection)
                .await?;
                change.audit("session.opened", Some(person), "").await
            })
        })
        .await?;
        Ok(NewSession {
            id,
            secret: secret.text,
            lifetime_s: LONGEST / 1000,
        })
    }

    /// Sessions of a person, the one used last first.
    ///
    /// # Errors
    /// The database's.
    pub async fn sessions(&self, person: Uuid, current: Option<Uuid>) -> Result<Vec<SessionView>> {
        let now = self.now().as_millis();
        let rows: Vec<SessionRow> = query_as(
            "SELECT id, client, created_at, last_used_at, expires_at FROM sessions
             WHERE person = ? AND expires_at > ? AND last_used_at > ? ORDER BY last_used_at DESC, id",
        )
        .bind(person)
        .bind(now)
        .bind(now - LONGEST_IDLE)
        .fetch_all(self.reads())
        .await?;
        let view = |row: SessionRow| SessionView {
            current: current == Some(row.id),
            id: row.id,
            created_at: Timestamp(row.created_at),
            last_used_at: Timestamp(row.last_used_at),
            expires_at: Timestamp(row.expires_at),
            client: row.client,
        };
        Ok(rows.into_iter().map(view).collect())
    }

    /// Ends a session of this person.
    ///
    /// # Errors
    /// [`StoreError::NotFound`].
    pub async fn close_session(&self, person: Uuid, id: Uuid) -> Result<()> {
        self.write(move |change| {
            Box::pin(async move {
                let closed = query("DELETE FROM sessions WHERE id = ? AND person = ?")
                    .bind(id)
                    .bind(person)
                    .execute(&mut change.connection)
                    .await?;
                if closed.rows_affected() == 0 {
                    return Err(StoreError::NotFound(format!("session {id}")));
                }
                change.audit("session.closed", Some(person), "").await
            })
        })
        .await
    }
}
