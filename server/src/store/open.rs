//! Opening the store.
use std::fs::{File, TryLockError};
use std::path::Path;
use std::sync::{Arc, Mutex};

use futures_util::future::BoxFuture;
use tokio::sync::{OnceCell, watch};

use super::blobs::Blobs;
use super::calls::Calls;
use super::clock::Clock;
use super::collector::Reports;
use super::database::{
    Connection, Database, DatabasePlace, FILE as DATABASE, Reading, Undo, query_scalar,
};
use super::error::{Result, StoreError};
use super::handle::{Inner, Store};
use super::identity::{Opening, identify, refuse_new_beside_files, require_database};
use super::people::AccessState;
use super::place::refuse_network;
use super::private::{private_database, private_folder};
use super::removal::Removal;
use super::reserve::{Reserve, is_full};
use super::storage::Storage;
use super::supervision::Restarts;
use super::types::StoreOptions;
use super::where_files::{place_beside, record, require_same};
use super::writer::{Announcements, Guards, Writer};
use crate::tasks;

/// Reads at once.
const READERS: u32 = 4;
/// Reads at once that take a moment.
const LOOKUPS: u32 = 3;

impl Store {
    /// Opens the store of a server, which has the folder for itself: brings the schema up to date,
    /// gives running attempts a fresh lease, removes files that a crash left half-received.
    ///
    /// # Errors
    /// [`StoreError::InUse`] when another server has the folder; [`StoreError::NotTogether`] when the
    /// database and the files are not those of one store; file and database errors.
    pub fn open(options: StoreOptions) -> BoxFuture<'static, Result<Self>> {
        // boxed, it is compiled once and not again in everything that opens a store
        Box::pin(Self::open_alone(options))
    }

    async fn open_alone(options: StoreOptions) -> Result<Self> {
        private_folder(&options.data)?;
        if matches!(options.database, DatabasePlace::Folder) {
            refuse_network(&options.data)?;
        }
        let lock = lock(&options.data, &options.database)?;
        require_same(&options.data, &options.files)?;
        let store = Self::connect(options, Some(lock)).await?;
        store.require_same_key().await?;
        store.renew_leases().await?;
        store.blobs().recover().await?;
        tasks::spawn(store.clone().sweep_bucket());
        Ok(store)
    }

    /// Opens the store beside a server that may be running, for commands on tokens.
    ///
    /// # Errors
    /// [`StoreError::Invalid`] where there is no store; file and database errors.
    pub fn open_beside(options: StoreOptions) -> BoxFuture<'static, Result<Self>> {
        Box::pin(async move {
            if matches!(options.database, DatabasePlace::Folder) {
                require_database(&options.data.join(DATABASE))?;
            }
            Self::make_beside(options).await
        })
    }

    /// Whether a store is in this folder, but for one whose database is elsewhere.
    pub fn is_in(data: &Path) -> bool {
        require_database(&data.join(DATABASE)).is_ok()
    }

    /// As [`Self::open_beside`], but makes the store where there is none yet.
    ///
    /// # Errors
    /// File and database errors.
    pub fn make_beside(mut options: StoreOptions) -> BoxFuture<'static, Result<Self>> {
        Box::pin(async move {
            private_folder(&options.data)?;
            if matches!(options.database, DatabasePlace::Folder) {
                refuse_network(&options.data)?;
            }
            options.files = place_beside(&options.data, options.files)?;
            Self::connect(options, None).await
        })
    }

    /// Opens it; where the disk is too full for that, on the room of the reserve.
    async fn connect(mut options: StoreOptions, lock: Option<File>) -> Result<Self> {
        let is_shared = matches!(options.database, DatabasePlace::Server(_));
        if is_shared && matches!(options.clock, Clock::System) {
            options.clock = Clock::Shared(Arc::default());
        }
        let data = options.data.clone();
        let mut connected = Self::prepare(&options, lock.is_some()).await;
        if connected.as_ref().is_err_and(is_full) && Reserve::release(&data) {
            connected = Self::prepare(&options, lock.is_some()).await;
        }
        let (database, connection, is_behind) = connected?;
        Self::start(options, lock, database, connection, is_behind).await
    }

    /// Brings the schema up to date, and holds the database against the files.
    async fn prepare(
        options: &StoreOptions,
        is_server: bool,
    ) -> Result<(Database, Connection, bool)> {
        let storage = Storage::of(&options.data, &options.files)?;
        // commands on tokens and people have no business with a bucket, and often no keys
        let knows_files = is_server || storage.bucket().is_none();
        let database = Database::at(&options.database, &options.data);
        if knows_files && !database.is_shared() {
            refuse_new_beside_files(&options.data, &storage).await?;
        }
        let mut connection = database.connect().await?;
        connection.migrate().await?;
        let opening = if is_server {
            Opening::Server
        } else {
            Opening::Beside
        };
        if !knows_files {
            return Ok((database, connection, false));
        }
        // of servers that start at once one does this after the other
        if database.is_shared()
            && let Some(moment) = connection.begin_writing().await?
        {
            options.clock.follow(moment);
        }
        let identity = identify(&mut connection, &options.data, &storage, opening).await?;
        if database.is_shared() {
            connection.commit().await?;
        }
        record(&options.data, &options.files)?;
        if identity.is_behind {
            tracing::warn!(
                "the database is older than its files, as one from a backup is: files that it does not know stay until `loadframe scrub --remove-unnamed`"
            );
        }
        Ok((database, connection, identity.is_behind))
    }

    async fn start(
        options: StoreOptions,
        lock: Option<File>,
        database: Database,
        mut connection: Connection,
        is_behind: bool,
    ) -> Result<Self> {
        connection.keep_undo(Undo::InMemory).await?;
        let last: Option<i64> = query_scalar("SELECT MAX(seq) FROM events")
            .fetch_one(&mut connection)
            .await?;
        let reads = database.reading(READERS, Reading::Lists).await?;
        let lookups = database.reading(LOOKUPS, Reading::Lookups).await?;
        if !database.is_shared() {
            private_database(&options.data);
        }
        let sharing = database.sharing().await?;
        let access = AccessState::read(&lookups).await?;
        tasks::spawn(access.clone().keep_fresh(lookups.clone()));

        let (last_event, last_event_receiver) =
            watch::channel(last.unwrap_or_default().unsigned_abs());
        let (queued, queued_receiver) = watch::channel(0);
        let (garbage, reports) = Reports::channel();
        let storage = Storage::of(&options.data, &options.files)?;
        let blobs = Blobs::open(&options.data, storage, garbage.clone(), sharing.clone()).await?;
        let wait = options.unnamed_wait;
        let restarts = Arc::<Restarts>::default();
        let reserve = Arc::new(Reserve::open(&options.data, lock.is_some()));
        let removal = Removal::of(&options.data)?;
        let restarted = Arc::clone(&restarts);
        let collector = blobs.collector(reads.clone(), wait, is_behind, restarted, removal);
        tasks::spawn(collector.run(reports));
        let announcements = Announcements {
            last_event,
            queued,
            server: sharing.server(),
            garbage,
        };
        let listening = sharing.clone();
        tasks::spawn(listening.keep_listening(
            announcements.last_event.clone(),
            announcements.queued.clone(),
        ));
        let calls = Arc::<Calls>::default();
        tasks::spawn(Arc::clone(&calls).keep_calling(lookups.clone(), queued_receiver.clone()));
        let guards = Guards {
            reserve: Arc::clone(&reserve),
            restarts: Arc::clone(&restarts),
        };
        let clock = options.clock.clone();
        Ok(Self(
            Arc::new(Inner {
                options,
                writer: Writer::start(connection, database, clock, announcements, guards),
                reserve,
                restarts,
                reads,
                lookups,
                blobs,
                pulses: Arc::default(),
                last_event: last_event_receiver,
                queued: queued_receiver,
                calls,
                speed: Mutex::default(),
                access,
                webhook_key: OnceCell::new(),
                sharing,
                _lock: lock,
            }),
            None,
        ))
    }
}

/// Takes the folder for this process, or for servers that share a database; the system gives it back when
/// the process ends, however.
pub(super) fn lock(data: &Path, database: &DatabasePlace) -> Result<File> {
    let path = data.join("lock");
    let file = File::create(&path).map_err(StoreError::file(&path))?;
    let locked = match database {
        DatabasePlace::Folder => file.try_lock(),
        DatabasePlace::Server(_) => file.try_lock_shared(),
    };
    match locked {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(StoreError::InUse(data.to_owned())),
        Err(TryLockError::Error(error)) => Err(StoreError::file(path)(error)),
    }
}
