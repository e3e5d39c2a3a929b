//! Access tokens: shown once, kept as their SHA-256.
use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use loadframe_api::{Timestamp, sha256_hex};
use rand::Rng;
use uuid::Uuid;

use super::error::{Result, StoreError};
use super::row::row;
use super::{NewToken, Store, TokenView};

/// What a token begins with, so that people and secret scanners know it.
const PREFIX: &str = "lf_";
/// Random bytes of a token: beyond guessing, so a plain hash protects it.
const SECRET_BYTES: usize = 32;

row! {
    struct TokenRow {
        id: Uuid,
        name: String,
        created_at: i64,
        revoked_at: Option<i64>,
    }
}

impl Store {
    /// Makes a token.
    ///
    /// # Errors
    /// The database's.
    pub async fn create_token(&self, name: &str) -> Result<NewToken> {
        let mut bytes = [0; SECRET_BYTES];
        rand::rng().fill_bytes(&mut bytes);
        let secret = format!("{PREFIX}{}", URL_SAFE_NO_PAD.encode(bytes));
        let id = self.insert_token(name, &secret).await?;
        let id = id.ok_or(StoreError::Unavailable)?;
        let name = name.to_owned();
        Ok(NewToken { id, name, secret })
    }

    /// Makes `secret` a token, unless it is or was one: a revoked token stays so.
    ///
    /// # Errors
    /// The database's.
    pub async fn ensure_token(&self, name: &str, secret: &str) -> Result<()> {
        self.insert_token(name, secret).await?;
        Ok(())
    }

    /// All tokens, the newest first.
    ///
    /// # Errors
    /// The database's.
    pub async fn tokens(&self) -> Result<Vec<TokenView>> {
        let rows: Vec<TokenRow> = sqlx::query_as(
            "SELECT id, name, created_at, revoked_at FROM tokens ORDER BY created_at DESC, name",
        )
        .fetch_all(self.reads())
        .await?;
        let view = |row: TokenRow| TokenView {
            id: row.id,
            name: row.name,
            created_at: Timestamp(row.created_at),
            revoked_at: row.revoked_at.map(Timestamp),
        };
        Ok(rows.into_iter().map(view).collect())
    }

    /// Ends a token; a running server follows within seconds.
    ///
    /// # Errors
    /// [`StoreError::NotFound`].
    pub async fn revoke_token(&self, id: Uuid) -> Result<()> {
        self.write(move |change| {
            Box::pin(async move {
                let revoked = sqlx::query(
                    "UPDATE tokens SET revoked_at = COALESCE(revoked_at, ?) WHERE id = ?",
                )
                .bind(change.now.as_millis())
                .bind(id)
                .execute(&mut change.connection)
                .await?;
                if revoked.rows_affected() == 1 {
                    Ok(())
                } else {
                    Err(StoreError::NotFound(format!("token {id}")))
                }
            })
        })
        .await?;
        self.token_cache().clear();
        Ok(())
    }

    /// Whether the secret is that of a token in force.
    ///
    /// # Errors
    /// The database's.
    pub async fn check_token(&self, secret: &str) -> Result<bool> {
        let hash = sha256_hex(secret.as_bytes());
        if self.token_cache().contains(&hash) {
            return Ok(true);
        }
        let is_good: bool = sqlx::query_scalar(
            "SELECT EXISTS (SELECT 1 FROM tokens WHERE secret_sha256 = ? AND revoked_at IS NULL)",
        )
        .bind(&hash)
        .fetch_one(self.lookups())
        .await?;
        if is_good {
            self.token_cache().insert(hash);
        }
        Ok(is_good)
    }

    /// Whether any token is in force.
    ///
    /// # Errors
    /// The database's.
    pub async fn has_tokens(&self) -> Result<bool> {
        let has =
            sqlx::query_scalar("SELECT EXISTS (SELECT 1 FROM tokens WHERE revoked_at IS NULL)")
                .fetch_one(self.reads())
                .await?;
        Ok(has)
    }

    /// The new token's id, or `None` when the secret is known already.
    async fn insert_token(&self, name: &str, secret: &str) -> Result<Option<Uuid>> {
        let (name, hash) = (name.to_owned(), sha256_hex(secret.as_bytes()));
        self.write(move |change| {
            Box::pin(async move {
                let id = sqlx::query_scalar(
                    "INSERT INTO tokens (id, name, secret_sha256, created_at) VALUES (?, ?, ?, ?)
                     ON CONFLICT (secret_sha256) DO NOTHING RETURNING id",
                )
                .bind(Uuid::now_v7())
                .bind(name)
                .bind(hash)
                .bind(change.now.as_millis())
                .fetch_optional(&mut change.connection)
                .await?;
                Ok(id)
            })
        })
        .await
    }
}
