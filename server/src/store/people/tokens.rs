//! Access tokens: shown once, kept as their SHA-256.
use loadframe_api::Timestamp;
use loadframe_api::people::{Named, NewToken, Scope, TokenMade, TokenView};
use uuid::Uuid;

use super::super::Store;
use super::super::database::{query, query_as, query_scalar, row};
use super::super::encoding::{variant, wire_name};
use super::super::error::{Result, StoreError};
use super::checks::{clean_name, refused};
use super::invitations::DAY;
use super::secret::Secret;

/// What a token begins with, so that people and secret scanners know it.
const PREFIX: &str = "lf_";

row! {
    struct TokenRow {
        id: Uuid,
        name: String,
        scope: String,
        person: Option<Uuid>,
        person_name: Option<String>,
        created_at: i64,
        expires_at: Option<i64>,
        last_used_at: Option<i64>,
        revoked_at: Option<i64>,
    }
}

impl TokenRow {
    fn view(self) -> Result<TokenView> {
        let person = self.person.zip(self.person_name);
        Ok(TokenView {
            id: self.id,
            name: self.name,
            scope: variant(&self.scope)?,
            person: person.map(|(id, name)| Named { id, name }),
            created_at: Timestamp(self.created_at),
            expires_at: self.expires_at.map(Timestamp),
            last_used_at: self.last_used_at.map(Timestamp),
            revoked_at: self.revoked_at.map(Timestamp),
        })
    }
}

impl Store {
    /// Makes a token of `person`; a worker's is nobody's.
    ///
    /// # Errors
    /// [`StoreError::Refused`] for a name or scope that cannot be: where there are people, what reads or
    /// submits has an owner.
    pub async fn create_token(&self, person: Option<Uuid>, new: NewToken) -> Result<TokenMade> {
        let name = clean_name("/name", &new.name)?;
        if new.scope == Scope::Everything {
            let (detail, allowed) = ("no token does everything", "one of: read, submit, worker");
            return Err(refused("/scope", "scope", detail, "everything", allowed));
        }
        let person = person.filter(|_| new.scope != Scope::Worker);
        let secret = Secret::new(PREFIX);
        let (id, sha256) = (Uuid::now_v7(), secret.sha256);
        let (kept, scope) = (name.clone(), new.scope);
        let expires_at = self
            .write(move |change| {
                Box::pin(async move {
                    let has_people: bool = query_scalar("SELECT EXISTS (SELECT 1 FROM people)")
                        .fetch_one(&mut change.connection)
                        .await?;
                    if has_people && person.is_none() && scope != Scope::Worker {
                        let detail = "this server has people: a token that reads or submits is somebody's";
                        let allowed = "worker, or the name of a person";
                        return Err(refused("/scope", "nobodys", detail, wire_name(&scope)?, allowed));
                    }
                    let now = change.now.as_millis();
                    let expires_at = new.days.map(|days| now + i64::from(days) * DAY);
                    query(
                        "INSERT INTO tokens (id, name, secret_sha256, created_at, person, scope, expires_at)
                         VALUES (?, ?, ?, ?, ?, ?, ?)",
                    )
                    .bind(id)
                    .bind(&kept)
                    .bind(sha256)
                    .bind(now)
                    .bind(person)
                    .bind(wire_name(&scope)?)
                    .bind(expires_at)
                    .execute(&mut change.connection)
                    .await?;
                    let detail = format!("{kept}: {}", wire_name(&scope)?);
                    change.audit("token.made", Some(id), &detail).await?;
                    Ok(expires_at)
                })
            })
            .await?;
        Ok(TokenMade {
            id,
            name,
            scope,
            expires_at: expires_at.map(Timestamp),
            secret: secret.text,
        })
    }

    /// Tokens, the newest first: all, or those of a person.
    ///
    /// # Errors
    /// The database's.
    pub async fn tokens(&self, person: Option<Uuid>) -> Result<Vec<TokenView>> {
        let rows: Vec<TokenRow> = query_as(
            "SELECT t.id, t.name, t.scope, t.person, p.name AS person_name, t.created_at, t.expires_at,
                    t.last_used_at, t.revoked_at
             FROM tokens t LEFT JOIN people p ON p.id = t.person
             WHERE ?1 IS NULL OR t.person = ?1 ORDER BY t.created_at DESC, t.name LIMIT 1000",
        )
        .bind(person)
        .fetch_all(self.reads())
        .await?;
        rows.into_iter().map(TokenRow::view).collect()
    }

    /// Ends a token with the next request that uses it: any, or only one of this person.
    ///
    /// # Errors
    /// [`StoreError::NotFound`].
    pub async fn revoke_token(&self, id: Uuid, of: Option<Uuid>) -> Result<()> {
        self.write(move |change| {
            Box::pin(async move {
                let revoked: Option<String> = query_scalar(
                    "UPDATE tokens SET revoked_at = COALESCE(revoked_at, ?1)
                     WHERE id = ?2 AND (?3 IS NULL OR person = ?3) RETURNING name",
                )
                .bind(change.now.as_millis())
                .bind(id)
                .bind(of)
                .fetch_optional(&mut change.connection)
                .await?;
                let name = revoked.ok_or_else(|| StoreError::NotFound(format!("token {id}")))?;
                change.audit("token.revoked", Some(id), &name).await
            })
        })
        .await
    }

    /// Whether any token is in force.
    ///
    /// # Errors
    /// The database's.
    pub async fn has_tokens(&self) -> Result<bool> {
        let has = query_scalar("SELECT EXISTS (SELECT 1 FROM tokens WHERE revoked_at IS NULL)")
            .fetch_one(self.reads())
            .await?;
        Ok(has)
    }
}
