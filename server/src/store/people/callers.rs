//! Who a secret belongs to, and whose an object is: what [`crate::access`] decides by.
//!
//! Nothing is remembered here from one request to the next, so that what was revoked ends with the next
//! request, by whichever process it was revoked; only whether there are people at all is looked up
//! twice a second, and the number that counts changes of access, for open streams.
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use loadframe_api::Timestamp;
use loadframe_api::people::Scope;
use tokio::sync::watch;
use uuid::Uuid;

use super::super::Store;
use super::super::database::{Pool, query, query_as, query_scalar, row};
use super::super::encoding::{parsed, variant};
use super::super::error::{Result, StoreError};
use crate::access::{Caller, Credential, Identity, JobFacts, Link, Person, ProjectFacts};

/// How often changes by other processes are looked for.
const LOOK_EVERY: Duration = Duration::from_millis(500);
/// A session that nobody used for so long has ended [ms].
pub(super) const LONGEST_IDLE: i64 = 7 * 24 * 3_600_000;
/// The last use of a token is written down to this [ms],
const TOKEN_USE: i64 = 60_000;
/// and that of a session to this [ms].
const SESSION_USE: i64 = 600_000;

/// What is known of access without asking each time.
#[derive(Debug)]
pub struct AccessState {
    has_people: AtomicBool,
    version: watch::Sender<u64>,
}

impl AccessState {
    /// As it is in the database.
    pub(in super::super) async fn read(pool: &Pool) -> Result<Arc<Self>> {
        let state = Self {
            has_people: AtomicBool::new(false),
            version: watch::Sender::new(0),
        };
        state.refresh(pool).await?;
        Ok(Arc::new(state))
    }

    pub(super) async fn refresh(&self, pool: &Pool) -> Result<()> {
        let (version, has_people): (i64, bool) =
            query_as("SELECT version, EXISTS (SELECT 1 FROM people) FROM access")
                .fetch_one(pool)
                .await?;
        self.has_people.store(has_people, Ordering::Release);
        let version = version.unsigned_abs();
        self.version
            .send_if_modified(|known| std::mem::replace(known, version) != version);
        Ok(())
    }

    /// Follows the database until nobody else has this.
    pub(in super::super) async fn keep_fresh(self: Arc<Self>, pool: Pool) {
        while Arc::strong_count(&self) > 1 {
            tokio::time::sleep(LOOK_EVERY).await;
            if let Err(error) = self.refresh(&pool).await {
                tracing::warn!(%error, "who has access could not be read");
            }
        }
    }
}

row! {
    /// A person's session or token.
    struct CredentialRow {
        id: Uuid,
        scope: String,
        expires_at: Option<i64>,
        last_used_at: Option<i64>,
        person: Option<Uuid>,
        name: Option<String>,
        role: Option<String>,
        teams: String,
    }
}

row! {
    struct LinkRow {
        id: Uuid,
        job: Option<Uuid>,
        project: Option<Uuid>,
        comparison: Option<Uuid>,
        shows_files: bool,
        expires_at: i64,
        compared: String,
    }
}

row! {
    struct FactsRow {
        owner: Option<Uuid>,
        project: Option<Uuid>,
        person: Option<Uuid>,
        team: Option<Uuid>,
        visibility: Option<String>,
        archived_at: Option<i64>,
        circle: String,
    }
}

fn ids(text: &str) -> Result<Vec<Uuid>> {
    let ids: Vec<String> = parsed(text, "ids")?;
    let ids = ids.iter().map(|text| Uuid::try_parse(text));
    ids.collect::<Result<_, _>>()
        .map_err(StoreError::corrupt("ids"))
}

impl CredentialRow {
    fn caller(self, credential: Credential) -> Result<Caller> {
        let scope: Scope = variant(&self.scope)?;
        let identity = match (self.person, self.name, self.role) {
            (Some(id), Some(name), Some(role)) => Identity::Person(Person {
                id,
                name,
                role: variant(&role)?,
                groups: ids(&self.teams)?,
            }),
            _ if scope == Scope::Worker => Identity::Worker,
            _ => Identity::Sole,
        };
        Ok(Caller {
            identity,
            scope,
            credential,
            expires_at: self.expires_at.map(Timestamp),
        })
    }
}

impl FactsRow {
    fn project(&self) -> Result<Option<ProjectFacts>> {
        let (Some(id), Some(visibility)) = (self.project, &self.visibility) else {
            return Ok(None);
        };
        Ok(Some(ProjectFacts {
            id,
            person: self.person,
            group: self.team,
            visibility: variant(visibility)?,
            is_archived: self.archived_at.is_some(),
            circle: ids(&self.circle)?,
        }))
    }
}

impl Store {
    /// Whether this server has accounts; a running one follows other processes within a second.
    pub fn has_people(&self) -> bool {
        self.access_state().has_people.load(Ordering::Acquire)
    }

    /// Wakes after changes of who may see what; holds their count.
    pub fn access_changes(&self) -> watch::Receiver<u64> {
        self.access_state().version.subscribe()
    }

    /// Counts changes of who may see what.
    ///
    /// # Errors
    /// The database's.
    pub async fn access_version(&self) -> Result<u64> {
        let version: i64 = query_scalar("SELECT version FROM access")
            .fetch_one(self.lookups())
            .await?;
        Ok(version.unsigned_abs())
    }

    /// Who has the token whose secret has this SHA-256.
    ///
    /// # Errors
    /// The database's.
    pub async fn caller_by_token(&self, sha256: &str) -> Result<Option<Caller>> {
        self.token_caller(Some(sha256), None).await
    }

    /// Who is signed in by the session whose secret has this SHA-256, in a cookie of that kind.
    ///
    /// # Errors
    /// The database's.
    pub async fn caller_by_session(&self, sha256: &str, is_secure: bool) -> Result<Option<Caller>> {
        self.session_caller(Some((sha256, is_secure)), None).await
    }

    /// What the link whose secret has this SHA-256 shows.
    ///
    /// # Errors
    /// The database's.
    pub async fn caller_by_link(&self, sha256: &str) -> Result<Option<Caller>> {
        self.link_caller(Some(sha256), None).await
    }

    /// The caller as it is now; nothing where its credential is not in force any more.
    ///
    /// # Errors
    /// The database's.
    pub async fn caller_again(&self, caller: &Caller) -> Result<Option<Caller>> {
        match caller.credential {
            // on the day a server gets people, who was nobody has to sign in
            Credential::Local if caller.identity == Identity::Sole && self.has_people() => Ok(None),
            Credential::Local => Ok(Some(caller.clone())),
            Credential::Token(id) => self.token_caller(None, Some(id)).await,
            Credential::Session(id) => self.session_caller(None, Some(id)).await,
            Credential::Link(id) => self.link_caller(None, Some(id)).await,
            Credential::Proxy(person) => self.person_caller(person, caller.credential).await,
        }
    }

    async fn token_caller(&self, sha256: Option<&str>, id: Option<Uuid>) -> Result<Option<Caller>> {
        let now = self.now().as_millis();
        let row: Option<CredentialRow> = query_as(
            "SELECT t.id, t.scope, t.expires_at, t.last_used_at, t.person, p.name, p.role,
                    (SELECT json_group_array(hex(team)) FROM members m WHERE m.person = t.person) AS teams
             FROM tokens t LEFT JOIN people p ON p.id = t.person
             WHERE (t.secret_sha256 = ?1 OR t.id = ?2) AND t.revoked_at IS NULL
               AND (t.expires_at IS NULL OR t.expires_at > ?3) AND p.left_at IS NULL",
        )
        .bind(sha256)
        .bind(id)
        .bind(now)
        .fetch_optional(self.lookups())
        .await?;
        let Some(row) = row else { return Ok(None) };
        if row.last_used_at.is_none_or(|used| used + TOKEN_USE < now) {
            self.note_use(
                "UPDATE tokens SET last_used_at = ?1 WHERE id = ?2",
                row.id,
                now,
            );
        }
        let (id, is_owned) = (row.id, row.person.is_some());
        let caller = row.caller(Credential::Token(id))?;
        // a token of before there were people is the first administrator's; another one is nobody's
        let is_nobodys = !is_owned && caller.identity == Identity::Sole && self.has_people();
        Ok(Some(caller).filter(|_| !is_nobodys))
    }

    async fn session_caller(
        &self,
        secret: Option<(&str, bool)>,
        id: Option<Uuid>,
    ) -> Result<Option<Caller>> {
        let now = self.now().as_millis();
        let row: Option<CredentialRow> = query_as(
            "SELECT s.id, 'everything' AS scope, s.expires_at, s.last_used_at, s.person, p.name, p.role,
                    (SELECT json_group_array(hex(team)) FROM members m WHERE m.person = s.person) AS teams
             FROM sessions s JOIN people p ON p.id = s.person
             WHERE (s.id = ?1 OR (s.secret_sha256 = ?2 AND s.is_secure = ?3))
               AND s.expires_at > ?4 AND s.last_used_at > ?5 AND p.left_at IS NULL",
        )
        .bind(id)
        .bind(secret.map(|(sha256, _)| sha256))
        .bind(secret.map(|(_, is_secure)| is_secure))
        .bind(now)
        .bind(now - LONGEST_IDLE)
        .fetch_optional(self.lookups())
        .await?;
        let Some(row) = row else { return Ok(None) };
        if row.last_used_at.is_none_or(|used| used + SESSION_USE < now) {
            self.note_use(
                "UPDATE sessions SET last_used_at = ?1 WHERE id = ?2",
                row.id,
                now,
            );
        }
        let id = row.id;
        row.caller(Credential::Session(id)).map(Some)
    }

    /// A person whom somebody else vouches for; nothing for who has left.
    pub(super) async fn person_caller(
        &self,
        person: Uuid,
        credential: Credential,
    ) -> Result<Option<Caller>> {
        let row: Option<CredentialRow> = query_as(
            "SELECT p.id, 'everything' AS scope, NULL AS expires_at, NULL AS last_used_at,
                    p.id AS person, p.name, p.role,
                    (SELECT json_group_array(hex(team)) FROM members m WHERE m.person = p.id) AS teams
             FROM people p WHERE p.id = ? AND p.left_at IS NULL",
        )
        .bind(person)
        .fetch_optional(self.lookups())
        .await?;
        row.map(|row| row.caller(credential)).transpose()
    }

    async fn link_caller(&self, sha256: Option<&str>, id: Option<Uuid>) -> Result<Option<Caller>> {
        let row: Option<LinkRow> = query_as(
            "SELECT s.id, s.job, s.project, s.comparison, s.shows_files, s.expires_at,
                    (SELECT json_group_array(hex(job)) FROM comparison_jobs n
                     WHERE n.comparison = s.comparison) AS compared
             FROM shares s
             WHERE (s.secret_sha256 = ?1 OR s.id = ?2) AND s.revoked_at IS NULL AND s.expires_at > ?3
               AND (s.job IS NULL OR EXISTS (SELECT 1 FROM jobs j WHERE j.id = s.job))
               AND (s.project IS NULL OR EXISTS
                    (SELECT 1 FROM projects r WHERE r.id = s.project AND r.deleted_at IS NULL))
               AND (s.comparison IS NULL OR EXISTS
                    (SELECT 1 FROM comparisons c WHERE c.id = s.comparison))",
        )
        .bind(sha256)
        .bind(id)
        .bind(self.now().as_millis())
        .fetch_optional(self.lookups())
        .await?;
        let Some(row) = row else { return Ok(None) };
        Ok(Some(Caller {
            identity: Identity::Link(Link {
                job: row.job,
                project: row.project,
                comparison: row.comparison,
                compared: ids(&row.compared)?,
                shows_files: row.shows_files,
            }),
            scope: Scope::Read,
            credential: Credential::Link(row.id),
            expires_at: Some(Timestamp(row.expires_at)),
        }))
    }

    /// Writes down that a credential was used, without making its request wait for the disk.
    fn note_use(&self, statement: &'static str, id: Uuid, now: i64) {
        let store = self.clone();
        tokio::spawn(async move {
            let noted = store.write(move |change| {
                Box::pin(async move {
                    query(statement)
                        .bind(now)
                        .bind(id)
                        .execute(&mut change.connection)
                        .await?;
                    Ok(())
                })
            });
            if let Err(error) = noted.await {
                tracing::debug!(%error, "the use of a credential was not written down");
            }
        });
    }

    /// Whose the job is.
    ///
    /// # Errors
    /// [`StoreError::NotFound`].
    pub async fn job_facts(&self, id: Uuid) -> Result<JobFacts> {
        let row: Option<FactsRow> = query_as(
            "SELECT j.owner, p.id AS project, p.person, p.team, p.visibility, p.archived_at,
                    (SELECT json_group_array(hex(team)) FROM members m WHERE m.person = p.person) AS circle
             FROM jobs j LEFT JOIN projects p ON p.id = j.project AND p.deleted_at IS NULL
             WHERE j.id = ?",
        )
        .bind(id)
        .fetch_optional(self.lookups())
        .await?;
        let row = row.ok_or_else(|| StoreError::NotFound(format!("job {id}")))?;
        Ok(JobFacts {
            id,
            owner: row.owner,
            project: row.project()?,
        })
    }

    /// Whose every project is.
    ///
    /// # Errors
    /// The database's.
    pub async fn project_facts(&self) -> Result<Vec<ProjectFacts>> {
        let rows: Vec<FactsRow> = query_as(
            "SELECT NULL AS owner, p.id AS project, p.person, p.team, p.visibility, p.archived_at,
                    (SELECT json_group_array(hex(team)) FROM members m WHERE m.person = p.person) AS circle
             FROM projects p WHERE p.deleted_at IS NULL ORDER BY p.id",
        )
        .fetch_all(self.lookups())
        .await?;
        let facts = rows.iter().map(FactsRow::project);
        Ok(facts
            .collect::<Result<Vec<_>>>()?
            .into_iter()
            .flatten()
            .collect())
    }
}
