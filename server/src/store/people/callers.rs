//! Who a secret belongs to, and whose an object is: what [`crate::access`] decides by.
//!
//! A request reads how often access has changed, and what is [`super::remembered`] under that count still holds:
//! so what was revoked ends with the next request, by whichever process it was revoked. Links, and people whom
//! a proxy vouches for, are read each time.
use std::sync::Arc;

use loadframe_api::Timestamp;
use loadframe_api::people::Scope;
use tokio::sync::watch;
use uuid::Uuid;

use super::super::Store;
use super::super::database::{query, query_as, row};
use super::super::encoding::{parsed, variant};
use super::super::error::{Result, StoreError};
use super::super::jobs::hex_names;
use super::remembered::{Remembered, Secret, Versions};
use crate::access::{Caller, Credential, Identity, JobFacts, Person, ProjectFacts};
use crate::tasks;

/// A session that nobody used for so long has ended [ms].
pub(super) const LONGEST_IDLE: i64 = 7 * 24 * 3_600_000;
/// The last use of a token is written down to this [ms],
const TOKEN_USE: i64 = 60_000;
/// and that of a session to this [ms].
const SESSION_USE: i64 = 600_000;

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
    struct FactsRow {
        job: Option<Uuid>,
        owner: Option<Uuid>,
        project: Option<Uuid>,
        person: Option<Uuid>,
        team: Option<Uuid>,
        visibility: Option<String>,
        archived_at: Option<i64>,
        circle: String,
    }
}

/// The statement that reads whose jobs are, ended by `$which`.
macro_rules! select_job_facts {
    ($which:literal) => {
        concat!(
            "SELECT j.id AS job, j.owner, p.id AS project, p.person, p.team, p.visibility, p.archived_at,
                (SELECT json_group_array(hex(team)) FROM members m WHERE m.person = p.person) AS circle
             FROM jobs j LEFT JOIN projects p ON p.id = j.project AND p.deleted_at IS NULL
             WHERE j.id ",
            $which
        )
    };
}

pub(super) fn ids(text: &str) -> Result<Vec<Uuid>> {
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
        self.access_state().has_people()
    }

    /// Wakes after changes of who may see what; holds their count.
    pub fn access_changes(&self) -> watch::Receiver<u64> {
        self.access_state().changes()
    }

    /// Counts changes of who may see what.
    ///
    /// # Errors
    /// The database's.
    pub async fn access_version(&self) -> Result<u64> {
        Ok(self.access_state().versions(self.lookups()).await?.access)
    }

    /// [`Self::access_version`] and [`Self::jobs_version`], of the same moment.
    ///
    /// # Errors
    /// The database's.
    pub async fn versions(&self) -> Result<Versions> {
        self.access_state().versions(self.lookups()).await
    }

    /// Who has the token whose secret has this SHA-256, and how often things had changed before that was read.
    ///
    /// # Errors
    /// The database's.
    pub async fn caller_by_token(&self, sha256: &str) -> Result<Option<(Caller, Versions)>> {
        let secret = Secret::Token(sha256.to_owned());
        let (versions, known) = self.remembered(&secret).await?;
        let found = match known {
            Some(caller) => Some(caller),
            None => {
                let found = self.token_caller(Some(sha256), None).await?;
                self.remember(versions.access, secret, found)
            }
        };
        let found = found.filter(|caller| !self.is_nobodys(caller));
        Ok(found.map(|caller| (caller, versions)))
    }

    /// Who is signed in by the session whose secret has this SHA-256, in a cookie of that kind; and the same.
    ///
    /// # Errors
    /// The database's.
    pub async fn caller_by_session(
        &self,
        sha256: &str,
        is_secure: bool,
    ) -> Result<Option<(Caller, Versions)>> {
        let secret = Secret::Session(sha256.to_owned(), is_secure);
        let (versions, known) = self.remembered(&secret).await?;
        let found = match known {
            Some(caller) => Some(caller),
            None => {
                let found = self.session_caller(Some((sha256, is_secure)), None).await?;
                self.remember(versions.access, secret, found)
            }
        };
        Ok(found.map(|caller| (caller, versions)))
    }

    /// The caller with this secret, where it is remembered under the versions as they are now.
    async fn remembered(&self, secret: &Secret) -> Result<(Versions, Option<Caller>)> {
        let versions = self.versions().await?;
        let known = self
            .access_state()
            .caller(versions.access, secret, self.now());
        Ok((versions, known))
    }

    fn remember(&self, access: u64, secret: Secret, found: Option<Remembered>) -> Option<Caller> {
        let found = found?;
        let caller = found.caller.clone();
        self.access_state().remember(access, secret, found);
        Some(caller)
    }

    /// A token of before there were people is the first administrator's; another one is nobody's.
    fn is_nobodys(&self, caller: &Caller) -> bool {
        caller.identity == Identity::Sole && self.has_people()
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
            Credential::Token(id) => {
                let found = self.token_caller(None, Some(id)).await?;
                let caller = found.map(|found| found.caller);
                Ok(caller.filter(|caller| !self.is_nobodys(caller)))
            }
            Credential::Session(id) => {
                let found = self.session_caller(None, Some(id)).await?;
                Ok(found.map(|found| found.caller))
            }
            Credential::Link(id) => self.link_caller(None, Some(id)).await,
            Credential::Proxy(person) => self.person_caller(person, caller.credential).await,
        }
    }

    async fn token_caller(
        &self,
        sha256: Option<&str>,
        id: Option<Uuid>,
    ) -> Result<Option<Remembered>> {
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
        let statement = "UPDATE tokens SET last_used_at = ?1 WHERE id = ?2";
        let until = self.used_until(&row, TOKEN_USE, statement, now);
        let credential = Credential::Token(row.id);
        let caller = row.caller(credential)?;
        Ok(Some(Remembered { caller, until }))
    }

    async fn session_caller(
        &self,
        secret: Option<(&str, bool)>,
        id: Option<Uuid>,
    ) -> Result<Option<Remembered>> {
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
        let statement = "UPDATE sessions SET last_used_at = ?1 WHERE id = ?2";
        let until = self.used_until(&row, SESSION_USE, statement, now);
        let credential = Credential::Session(row.id);
        let caller = row.caller(credential)?;
        Ok(Some(Remembered { caller, until }))
    }

    /// Until when [ms since 1970] the use of a credential is written down, to `every`; done where it is due.
    fn used_until(
        &self,
        row: &CredentialRow,
        every: i64,
        statement: &'static str,
        now: i64,
    ) -> i64 {
        let noted = row.last_used_at.filter(|used| used + every >= now);
        noted.unwrap_or_else(|| {
            self.note_use(statement, row.id, now);
            now
        }) + every
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

    /// Writes down that a credential was used, without making its request wait for the disk.
    fn note_use(&self, statement: &'static str, id: Uuid, now: i64) {
        let store = self.clone();
        tasks::spawn(async move {
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
        let row: Option<FactsRow> = query_as(select_job_facts!("= ?"))
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

    /// Whose those of these jobs are that are there.
    pub(super) async fn facts_of_jobs(&self, jobs: &[Uuid]) -> Result<Vec<JobFacts>> {
        let which = select_job_facts!("IN (SELECT unhex(value) FROM json_each(?))");
        let rows: Vec<FactsRow> = query_as(which)
            .bind(hex_names(jobs)?)
            .fetch_all(self.lookups())
            .await?;
        let facts = rows.iter().map(|row| {
            Ok(JobFacts {
                id: row.job.unwrap_or_default(),
                owner: row.owner,
                project: row.project()?,
            })
        });
        facts.collect()
    }

    /// Whose every project is.
    ///
    /// # Errors
    /// The database's.
    pub async fn project_facts(&self) -> Result<Arc<[ProjectFacts]>> {
        let access = self.access_version().await?;
        self.project_facts_of(access).await
    }

    /// The same, where access has changed so often by now.
    ///
    /// # Errors
    /// The database's.
    pub async fn project_facts_of(&self, access: u64) -> Result<Arc<[ProjectFacts]>> {
        if let Some(known) = self.access_state().projects(access) {
            return Ok(known);
        }
        let rows: Vec<FactsRow> = query_as(
            "SELECT NULL AS job, NULL AS owner, p.id AS project, p.person, p.team, p.visibility, p.archived_at,
                    (SELECT json_group_array(hex(team)) FROM members m WHERE m.person = p.person) AS circle
             FROM projects p WHERE p.deleted_at IS NULL ORDER BY p.id",
        )
        .fetch_all(self.lookups())
        .await?;
        let facts = rows.iter().filter_map(|row| row.project().transpose());
        let facts: Arc<[ProjectFacts]> = facts.collect::<Result<_>>()?;
        self.access_state()
            .remember_projects(access, Arc::clone(&facts));
        Ok(facts)
    }
}
