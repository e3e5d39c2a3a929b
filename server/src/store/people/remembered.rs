//! What is known of access without asking each time.
//!
//! The database counts every change of who may see and do what, whichever process makes it (`access.version`,
//! kept by triggers). A request reads this count first; what was read before under the same count is so still.
//! The count is always read before what is remembered under it, which is thus as new as the count or newer.
//!
//! Requests that come while the count is being read share the next reading, as commands share a commit: so a
//! hundred at once are a reading or two.
//!
//! Whether there are people at all is looked up twice a second, and the count too, for open streams.
use std::collections::{BTreeSet, HashMap};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use loadframe_api::Timestamp;
use tokio::sync::watch;
use uuid::Uuid;

use super::super::database::{Pool, query_as};
use super::super::error::Result;
use crate::access::{Caller, ProjectFacts};

/// How often changes by other processes are looked for.
const LOOK_EVERY: Duration = Duration::from_millis(500);
/// So many callers are remembered; a group has some hundred, each of half a kB.
const MOST_CALLERS: usize = 4096;

/// What is known of access without asking each time.
#[derive(Debug)]
pub struct AccessState {
    has_people: AtomicBool,
    version: watch::Sender<u64>,
    known: Mutex<Known>,
    /// Readings of the versions that have begun.
    begun: AtomicU64,
    last: tokio::sync::Mutex<Reading>,
}

/// What the versions were.
#[derive(Clone, Copy, Debug, Default)]
struct Reading {
    /// As how many readings had begun with it.
    number: u64,
    versions: Versions,
}

/// How often things had changed at one moment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Versions {
    /// Who may see and do what.
    pub access: u64,
    /// Jobs: the number of the last event.
    pub jobs: u64,
}

/// What was read since access changed last.
#[derive(Debug, Default)]
struct Known {
    version: u64,
    callers: HashMap<Secret, Remembered>,
    projects: Option<Arc<[ProjectFacts]>>,
    /// Names of people and projects that lists had in them.
    names: Names,
}

/// Names of people and projects.
pub(in super::super) type Names = HashMap<Uuid, Arc<str>>;

/// By the SHA-256 of which secret a caller is known.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Secret {
    Token(String),
    /// In a secure cookie, or in a plain one.
    Session(String, bool),
}

/// A caller, and until when it need not be read again [ms since 1970]: then its use is to be written down.
#[derive(Clone, Debug)]
pub(super) struct Remembered {
    pub(super) caller: Caller,
    pub(super) until: i64,
}

impl Known {
    fn at(version: u64) -> Self {
        Self {
            version,
            ..Self::default()
        }
    }
}

impl AccessState {
    /// As it is in the database.
    pub(in super::super) async fn read(pool: &Pool) -> Result<Arc<Self>> {
        let state = Self {
            has_people: AtomicBool::new(false),
            version: watch::Sender::new(0),
            known: Mutex::default(),
            begun: AtomicU64::new(0),
            last: tokio::sync::Mutex::default(),
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

    /// The versions, by a reading that begins after the call does.
    pub(in super::super) async fn versions(&self, pool: &Pool) -> Result<Versions> {
        let begun = self.begun.load(Ordering::SeqCst);
        let mut last = self.last.lock().await;
        if last.number <= begun {
            let number = self.begun.fetch_add(1, Ordering::SeqCst) + 1;
            let (access, jobs): (i64, Option<i64>) =
                query_as("SELECT version, (SELECT MAX(seq) FROM events) FROM access")
                    .fetch_one(pool)
                    .await?;
            let versions = Versions {
                access: access.unsigned_abs(),
                jobs: jobs.unwrap_or_default().unsigned_abs(),
            };
            *last = Reading { number, versions };
        }
        Ok(last.versions)
    }

    pub(super) fn has_people(&self) -> bool {
        self.has_people.load(Ordering::Acquire)
    }

    pub(super) fn changes(&self) -> watch::Receiver<u64> {
        self.version.subscribe()
    }

    /// The caller with this secret, where it was read under this count and still holds.
    pub(super) fn caller(&self, version: u64, secret: &Secret, now: Timestamp) -> Option<Caller> {
        let known = self.known_at(version)?;
        let found = known.callers.get(secret)?;
        let has_ended = found.caller.expires_at.is_some_and(|end| end <= now);
        (!has_ended && now.as_millis() <= found.until).then(|| found.caller.clone())
    }

    /// Remembers a caller that was read after this count.
    pub(super) fn remember(&self, version: u64, secret: Secret, found: Remembered) {
        let Some(mut known) = self.known_at(version) else {
            return;
        };
        if known.callers.len() >= MOST_CALLERS {
            known.callers.clear();
        }
        known.callers.insert(secret, found);
    }

    /// The projects, where they were read under this count.
    pub(super) fn projects(&self, version: u64) -> Option<Arc<[ProjectFacts]>> {
        self.known_at(version)?.projects.clone()
    }

    /// Remembers the projects, which were read after this count.
    pub(super) fn remember_projects(&self, version: u64, projects: Arc<[ProjectFacts]>) {
        if let Some(mut known) = self.known_at(version) {
            known.projects = Some(projects);
        }
    }

    /// Of these people and projects, the names that were read under this count.
    pub(super) fn names(&self, version: u64, of: &BTreeSet<Uuid>) -> Names {
        let known = self.known_at(version);
        let name = |id: &Uuid| Some((*id, known.as_ref()?.names.get(id)?.clone()));
        of.iter().filter_map(name).collect()
    }

    /// Remembers names, which were read after this count.
    pub(super) fn remember_names(&self, version: u64, names: &Names) {
        if let Some(mut known) = self.known_at(version) {
            let names = names.iter().map(|(id, name)| (*id, Arc::clone(name)));
            known.names.extend(names);
        }
    }

    /// What is known under this count, of which nothing is left from before; nothing for a request that is
    /// slower than a change that another one has seen.
    fn known_at(&self, version: u64) -> Option<MutexGuard<'_, Known>> {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if known.version < version {
            *known = Known::at(version);
        }
        (known.version == version).then_some(known)
    }
}
