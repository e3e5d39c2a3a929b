//! A store in a temporary folder, with users and workers that do as they are told.
use futures_util::future::BoxFuture;
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::time::Duration;

use futures_util::TryStreamExt;
use loadframe_api::people::{Acceptance, NewInvitation, Role};
use loadframe_api::worker::{
    CheckpointInfo, CheckpointQuery, ClaimRequest, CompleteRequest, Lease,
};
use loadframe_api::{Calibration, FileEntry, JobKind, JobView, Submission, sha256_hex};
use loadframe_server::store::people::Actor;
use loadframe_server::store::{
    BucketKeys, BucketSettings, Content, FilesPlace, LeaseKey, Store, StoreError, StoreOptions,
};
use serde_json::{Value, json};
use tempfile::TempDir;
use uuid::Uuid;

use crate::outcome::outcome;

/// A store that is gone with its folder.
pub(crate) struct Lab {
    pub(crate) store: Store,
    pub(crate) folder: TempDir,
}

impl Deref for Lab {
    type Target = Store;

    fn deref(&self) -> &Store {
        &self.store
    }
}

/// Leases that no test outlives.
pub(crate) const LONG: Duration = Duration::from_secs(3600);
/// Leases that have run out when the next sweep looks, and not before it.
pub(crate) const NONE: Duration = Duration::ZERO;

impl Lab {
    pub(crate) fn open(lease: Duration) -> BoxFuture<'static, Self> {
        Box::pin(async move {
            let folder = tempfile::tempdir().unwrap();
            let store = Store::open(options(&folder, lease)).await.unwrap();
            Self { store, folder }
        })
    }

    /// Closes the store and opens it again.
    pub(crate) fn reopen(self, lease: Duration) -> BoxFuture<'static, Self> {
        Box::pin(async move {
            let Self { store, folder } = self;
            drop(store);
            let store = Store::open(options(&folder, lease)).await.unwrap();
            Self { store, folder }
        })
    }

    pub(crate) async fn submit(&self) -> Uuid {
        self.submit_with("", 0).await
    }

    pub(crate) fn submit_with<'a>(&'a self, name: &'a str, priority: i32) -> BoxFuture<'a, Uuid> {
        Box::pin(async move {
            let submission = submission(name, priority);
            self.enqueue(&submission, None).await.unwrap().job.id
        })
    }

    pub(crate) fn lease(&self) -> BoxFuture<'_, Lease> {
        Box::pin(async move { self.claim(&worker("bench")).await.unwrap().unwrap() })
    }

    pub(crate) fn view(&self, id: Uuid) -> BoxFuture<'_, JobView> {
        Box::pin(async move { self.job(id).await.unwrap() })
    }

    /// Uploads a file under a lease.
    pub(crate) fn put<'a>(
        &'a self,
        lease: &'a Lease,
        name: &'a str,
        content: &'a [u8],
    ) -> BoxFuture<'a, FileEntry> {
        Box::pin(async move {
            let sha256 = sha256_hex(content);
            let upload = self.upload(key(lease), name, &sha256, content);
            upload.await.unwrap()
        })
    }

    /// Leaves a checkpoint after `wall_s` of work.
    pub(crate) fn checkpoint_with<'a>(
        &'a self,
        lease: &'a Lease,
        state: &'a [u8],
        wall_s: f64,
    ) -> BoxFuture<'a, ()> {
        Box::pin(async move {
            let query = CheckpointQuery {
                sha256: sha256_hex(state),
                wall_s,
                cpu_s: wall_s,
            };
            self.save_checkpoint(key(lease), &query, state)
                .await
                .unwrap();
        })
    }

    /// Uploads and completes what a worker with one extra file would.
    pub(crate) fn finish<'a>(&'a self, lease: &'a Lease) -> BoxFuture<'a, CompleteRequest> {
        Box::pin(async move {
            let request = self.result(lease).await;
            self.complete(key(lease), &request).await.unwrap();
            request
        })
    }

    /// A result that has been uploaded, not completed.
    pub(crate) fn result<'a>(&'a self, lease: &'a Lease) -> BoxFuture<'a, CompleteRequest> {
        Box::pin(async move {
            let mut files = vec![self.put(lease, "curve.csv", b"a,b\n1,2\n").await];
            let outcome = outcome(lease, &files);
            let text = serde_json::to_vec(&outcome).unwrap();
            files.push(self.put(lease, "outcome.json", &text).await);
            CompleteRequest { outcome, files }
        })
    }

    /// A file on this machine with the bytes of a file of the job's result: the stored one, where files are
    /// in a folder.
    pub(crate) fn content<'a>(
        &'a self,
        id: Uuid,
        file: &'a FileEntry,
    ) -> BoxFuture<'a, Result<PathBuf, StoreError>> {
        Box::pin(async move {
            let content = self.store.content(id, file).await?;
            Ok(self.local(&content, file.bytes).await)
        })
    }

    /// The same of the checkpoint to go on from.
    pub(crate) fn checkpoint<'a>(
        &'a self,
        key: LeaseKey,
        before: Option<&'a str>,
    ) -> BoxFuture<'a, Result<(CheckpointInfo, PathBuf), StoreError>> {
        Box::pin(async move {
            let (info, content) = self.store.checkpoint(key, before).await?;
            let path = self.local(&content, info.bytes).await;
            Ok((info, path))
        })
    }

    fn local<'a>(&'a self, content: &'a Content, bytes: u64) -> BoxFuture<'a, PathBuf> {
        Box::pin(async move {
            if let Some(path) = content.path() {
                return path.to_owned();
            }
            let pieces: Vec<_> = content
                .read(0..bytes)
                .await
                .unwrap()
                .try_collect()
                .await
                .unwrap();
            let copy = self.folder.path().join(Uuid::new_v4().to_string());
            std::fs::write(&copy, pieces.concat()).unwrap();
            copy
        })
    }

    /// How many blobs lie in the folder.
    pub(crate) async fn blobs(&self) -> usize {
        stored(self.folder.path()).len()
    }
}

/// Makes it a group's lab of an administrator and members: each person, and a handle on the store.
pub(crate) async fn group<const N: usize>(lab: &Lab, names: [&str; N]) -> [(Uuid, Store); N] {
    const PASSWORD: &str = "a password for tests";
    let mut people = Vec::new();
    for name in names {
        let id = if people.is_empty() {
            let first = lab.create_first_administrator(name, PASSWORD).await;
            first.unwrap().id
        } else {
            let new = NewInvitation {
                role: Role::Member,
                email: None,
                groups: Vec::new(),
                days: 1,
            };
            let made = lab.invite(new).await.unwrap();
            let accept = Acceptance {
                secret: made.path.split_once('#').unwrap().1.to_owned(),
                name: name.to_owned(),
                password: PASSWORD.to_owned(),
            };
            let shell = lab.acting(Actor::shell());
            shell.accept_invitation(accept).await.unwrap().id
        };
        let actor = Actor {
            person: Some(id),
            ..Actor::shell()
        };
        people.push((id, lab.acting(actor)));
    }
    people.try_into().expect("one for each name")
}

/// All stored files of the store in `data`.
pub(crate) fn stored(data: &Path) -> Vec<PathBuf> {
    let folders = std::fs::read_dir(data.join("blobs")).unwrap();
    let folders = folders.map(|folder| folder.unwrap().path());
    let files = folders.filter(|folder| folder.is_dir()).flat_map(|folder| {
        let files = std::fs::read_dir(folder).unwrap();
        files.map(|file| file.unwrap().path())
    });
    files.collect()
}

pub(crate) fn options(folder: &TempDir, lease: Duration) -> StoreOptions {
    StoreOptions {
        database: crate::database::place(folder.path()),
        files: place_of_files(folder),
        lease,
        ..StoreOptions::new(folder.path())
    }
}

/// In the folder; or, for those of these tests that do not look into it (`tests/bucket` runs them so), below
/// a prefix of its own in the bucket `lab` of the server at `LOADFRAME_TEST_BUCKET`.
fn place_of_files(folder: &TempDir) -> FilesPlace {
    let Ok(endpoint) = std::env::var("LOADFRAME_TEST_BUCKET") else {
        return FilesPlace::Folder;
    };
    let name = folder.path().file_name().unwrap().to_string_lossy();
    let prefix = name.trim_start_matches('.');
    let address = format!("s3://lab/{prefix}");
    let settings = BucketSettings::at(&address, Some(&endpoint), "us-east-1").unwrap();
    let (id, secret) = ("S3RVER".to_owned(), "S3RVER".to_owned());
    let session = None;
    FilesPlace::Bucket(BucketSettings {
        keys: Some(BucketKeys {
            id,
            secret,
            session,
        }),
        ..settings
    })
}

pub(crate) fn key(lease: &Lease) -> LeaseKey {
    LeaseKey {
        id: lease.id,
        token: lease.token,
    }
}

/// The smallest example, under a name.
pub(crate) fn submission(name: &str, priority: i32) -> Submission {
    let example = JobKind::NonwovenTensile.examples()[2];
    let mut body: Value = serde_json::from_str(example.body).unwrap();
    body["name"] = json!(name);
    body["priority"] = json!(priority);
    Submission::from_slice(body.to_string().as_bytes()).unwrap()
}

/// A worker process just started.
pub(crate) fn worker(name: &str) -> ClaimRequest {
    ClaimRequest {
        calibration: Some(Calibration {
            bond_evaluations_per_s: 2.0e8,
        }),
        ..ClaimRequest::new(Uuid::new_v4(), name, "lab", "1")
    }
}

pub(crate) fn is_lost<T>(result: Result<T, StoreError>) -> bool {
    matches!(result, Err(StoreError::LeaseLost))
}

pub(crate) fn is_conflict<T>(result: Result<T, StoreError>) -> bool {
    matches!(result, Err(StoreError::Conflict(_)))
}

pub(crate) fn is_invalid<T>(result: Result<T, StoreError>) -> bool {
    matches!(result, Err(StoreError::Invalid(_)))
}

pub(crate) fn is_missing<T>(result: Result<T, StoreError>) -> bool {
    matches!(result, Err(StoreError::NotFound(_)))
}
