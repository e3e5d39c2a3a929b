//! Invitations: links by which people open their account.
use loadframe_api::people::{
    Acceptance, InvitationMade, InvitationView, NewInvitation, PersonView, Role,
};
use loadframe_api::{Timestamp, sha256_hex};
use uuid::Uuid;

use super::super::Store;
use super::super::database::{query, query_as, query_scalar, row};
use super::super::encoding::{json, parsed, variant, wire_name};
use super::super::error::{Result, StoreError};
use super::accounts::{PersonRow, hashed};
use super::checks::{clean_name, refused};
use super::identities::clean_email;
use super::secret::Secret;

pub(super) const DAY: i64 = 24 * 3_600_000;

row! {
    struct InvitationRow {
        id: Uuid,
        role: String,
        groups: String,
        created_at: i64,
        expires_at: i64,
        accepted_at: Option<i64>,
        revoked_at: Option<i64>,
        email: Option<String>,
    }
}

impl Store {
    /// Invites somebody.
    ///
    /// # Errors
    /// [`StoreError::Refused`] for a group that is not there, or an address that is none.
    pub async fn invite(&self, new: NewInvitation) -> Result<InvitationMade> {
        let email = match new.email.as_deref() {
            None => None,
            Some(given) => Some(clean_email(given).ok_or_else(|| {
                let detail = "this is not an e-mail address";
                refused(
                    "/email",
                    "email",
                    detail,
                    given,
                    "an address such as anna@example.org",
                )
            })?),
        };
        let secret = Secret::new("lfi_");
        let (id, sha256) = (Uuid::now_v7(), secret.sha256);
        let expires_at = self
            .write(move |change| {
                Box::pin(async move {
                    for (index, group) in new.groups.iter().enumerate() {
                        change.check_group(&format!("/groups/{index}"), *group).await?;
                    }
                    let now = change.now.as_millis();
                    let expires_at = now + i64::from(new.days) * DAY;
                    query(
                        "INSERT INTO invitations (id, secret_sha256, role, groups, created_at, expires_at, email)
                         VALUES (?, ?, ?, ?, ?, ?, ?)",
                    )
                    .bind(id)
                    .bind(sha256)
                    .bind(wire_name(&new.role)?)
                    .bind(json(&new.groups)?)
                    .bind(now)
                    .bind(expires_at)
                    .bind(email)
                    .execute(&mut change.connection)
                    .await?;
                    let role = wire_name(&new.role)?;
                    change.audit("invitation.made", Some(id), &role).await?;
                    Ok(expires_at)
                })
            })
            .await?;
        Ok(InvitationMade {
            id,
            path: format!("/invitation#{}", secret.text),
            expires_at: Timestamp(expires_at),
        })
    }

    /// All invitations, the newest first.
    ///
    /// # Errors
    /// The database's.
    pub async fn invitations(&self) -> Result<Vec<InvitationView>> {
        let rows: Vec<InvitationRow> = query_as(
            "SELECT id, role, groups, created_at, expires_at, accepted_at, revoked_at, email
             FROM invitations ORDER BY created_at DESC, id LIMIT 1000",
        )
        .fetch_all(self.reads())
        .await?;
        let view = |row: InvitationRow| {
            Ok(InvitationView {
                id: row.id,
                role: variant::<Role>(&row.role)?,
                groups: parsed(&row.groups, "groups")?,
                created_at: Timestamp(row.created_at),
                expires_at: Timestamp(row.expires_at),
                accepted_at: row.accepted_at.map(Timestamp),
                revoked_at: row.revoked_at.map(Timestamp),
                email: row.email,
            })
        };
        rows.into_iter().map(view).collect()
    }

    /// Takes an invitation back.
    ///
    /// # Errors
    /// [`StoreError::NotFound`]; [`StoreError::Conflict`] when it was accepted already.
    pub async fn revoke_invitation(&self, id: Uuid) -> Result<()> {
        self.write(move |change| {
            Box::pin(async move {
                let accepted: Option<Option<i64>> = query_scalar(
                    "UPDATE invitations SET revoked_at = COALESCE(revoked_at, ?) WHERE id = ?
                     RETURNING accepted_at",
                )
                .bind(change.now.as_millis())
                .bind(id)
                .fetch_optional(&mut change.connection)
                .await?;
                match accepted {
                    None => Err(StoreError::NotFound(format!("invitation {id}"))),
                    Some(Some(_)) => Err(StoreError::Conflict(
                        "the invitation was accepted; end the person's account instead".to_owned(),
                    )),
                    Some(None) => change.audit("invitation.revoked", Some(id), "").await,
                }
            })
        })
        .await
    }

    /// Opens the account that an invitation offers.
    ///
    /// # Errors
    /// [`StoreError::Refused`] where the invitation is not in force, or the name is taken.
    pub async fn accept_invitation(&self, given: Acceptance) -> Result<PersonView> {
        let name = clean_name("/name", &given.name)?;
        let sha256 = sha256_hex(given.secret.as_bytes());
        // looked at before the password is hashed, which costs time that a guess must not take
        self.offer(&sha256).await?;
        let kept = hashed("/password", given.password).await?;
        self.write(move |change| {
            Box::pin(async move {
                let offered: Option<(Uuid, String, String)> = query_as(
                    "UPDATE invitations SET accepted_at = ?1
                     WHERE secret_sha256 = ?2 AND accepted_at IS NULL AND revoked_at IS NULL
                       AND expires_at > ?1 RETURNING id, role, groups",
                )
                .bind(change.now.as_millis())
                .bind(sha256)
                .fetch_optional(&mut change.connection)
                .await?;
                let (invitation, role, groups) = offered.ok_or_else(out_of_force)?;
                let groups: Vec<Uuid> = parsed(&groups, "groups")?;
                let id = change.add_person(&name, variant(&role)?, &kept).await?;
                for group in groups {
                    change.add_member(group, id).await?;
                }
                change.act_as(&name, id);
                let detail = format!("{name}: {role}");
                change
                    .audit("invitation.accepted", Some(invitation), &detail)
                    .await?;
                PersonRow::of(&mut change.connection, id).await?.view()
            })
        })
        .await
    }

    async fn offer(&self, sha256: &str) -> Result<()> {
        let is_in_force: bool = query_scalar(
            "SELECT EXISTS (SELECT 1 FROM invitations WHERE secret_sha256 = ? AND accepted_at IS NULL
                AND revoked_at IS NULL AND expires_at > ?)",
        )
        .bind(sha256)
        .bind(self.now().as_millis())
        .fetch_one(self.lookups())
        .await?;
        if is_in_force {
            Ok(())
        } else {
            Err(out_of_force())
        }
    }
}

/// The same for an invitation that was never made: it tells nothing.
fn out_of_force() -> StoreError {
    let detail = "this invitation is not in force: it was accepted, taken back or is too old; ask for a new one";
    refused(
        "/secret",
        "not_in_force",
        detail,
        "…",
        "the secret of an invitation in force",
    )
}
