//! The key that secrets of webhooks and links to addresses of e-mail follow from: in a file of its own in the
//! data folder, so that a copy of the database signs nothing.
//!
//! Servers on one database may each have a data folder. Then files are in a bucket, and the key lies there too:
//! a server that has none takes it from there, and one that has another refuses, for what it signed nobody
//! could verify.
use std::io::Write;
use std::path::Path;

use rand::Rng;

use super::super::Store;
use super::super::error::{Result, StoreError};
use super::super::storage::Storage;

/// Its file in the data folder, and its name in the bucket.
pub(in super::super) const WEBHOOK_KEY: &str = "webhook-key";

pub(super) type Key = [u8; 32];

impl Store {
    /// The key; the first who needs it makes it.
    ///
    /// # Errors
    /// [`StoreError::NotTogether`] when the folder's is not that of the bucket; the file system's and the
    /// bucket's.
    pub(super) async fn webhook_key(&self) -> Result<Key> {
        let key = self.0.webhook_key.get_or_try_init(|| self.find_key());
        key.await.copied()
    }

    /// Holds the folder's key against that of the bucket, where there is one.
    ///
    /// # Errors
    /// As [`Self::webhook_key`].
    pub(in super::super) async fn require_same_key(&self) -> Result<()> {
        let (path, storage) = (self.options().data.join(WEBHOOK_KEY), &self.blobs().storage);
        if storage.bucket().is_some() {
            of_both(&path, storage).await?;
        }
        Ok(())
    }

    async fn find_key(&self) -> Result<Key> {
        let path = self.options().data.join(WEBHOOK_KEY);
        let storage = &self.blobs().storage;
        if storage.bucket().is_none() {
            return match read(&path)? {
                Some(key) => Ok(key),
                None => keep(&path, new()),
            };
        }
        if let Some(key) = of_both(&path, storage).await? {
            return Ok(key);
        }
        // servers that need the first one at once make it one after the other
        let _made_by_one = self.0.sharing.removing_files().await?;
        if let Some(key) = of_both(&path, storage).await? {
            return Ok(key);
        }
        let key = match read(&path)? {
            Some(key) => key,
            None => keep(&path, new())?,
        };
        storage.leave_note(WEBHOOK_KEY, &written(&key)).await?;
        Ok(key)
    }
}

/// The key of folder and bucket, which the folder is given where it has none; `None` when the bucket has none.
async fn of_both(path: &Path, storage: &Storage) -> Result<Option<Key>> {
    let (own, shared) = (read(path)?, storage.note(WEBHOOK_KEY).await?);
    match (own, shared) {
        (_, None) => Ok(None),
        (None, Some(shared)) => {
            let bytes = (0..shared.len() / 2).map(|at| {
                let digits = shared.get(2 * at..2 * at + 2).unwrap_or_default();
                u8::from_str_radix(digits, 16)
            });
            let corrupt = "key of webhooks in the bucket";
            let bytes: Vec<u8> = bytes
                .collect::<std::result::Result<_, _>>()
                .map_err(StoreError::corrupt(corrupt))?;
            let key = bytes.try_into();
            let key = key.map_err(|_| StoreError::corrupt(corrupt)("it has not 32 bytes"))?;
            keep(path, key).map(Some)
        }
        (Some(own), Some(shared)) if written(&own) == shared => Ok(Some(own)),
        (Some(_), Some(_)) => Err(StoreError::NotTogether(format!(
            "{} is not the key that the servers of {storage} have, so nobody could verify what follows from it; \
             move the file away, and the server takes theirs",
            path.display()
        ))),
    }
}

fn written(key: &Key) -> String {
    key.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn new() -> Key {
    let mut key = [0; 32];
    rand::rng().fill_bytes(&mut key);
    key
}

fn read(path: &Path) -> Result<Option<Key>> {
    let failed = StoreError::file(path);
    match std::fs::read(path) {
        Ok(bytes) => match bytes.try_into() {
            Ok(key) => Ok(Some(key)),
            Err(_) => Err(failed(std::io::Error::other(
                "it does not hold a key of 32 bytes",
            ))),
        },
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(failed(error)),
    }
}

/// Writes the key down, whole or not at all and for this user alone, and gives it; another process may have
/// been first, whose key then counts.
fn keep(path: &Path, key: Key) -> Result<Key> {
    let failed = || StoreError::file(path);
    let folder = path.parent().unwrap_or(path);
    let mut file = tempfile::NamedTempFile::new_in(folder).map_err(failed())?;
    file.write_all(&key).map_err(failed())?;
    file.as_file().sync_all().map_err(failed())?;
    match file.persist_noclobber(path) {
        Ok(_) => Ok(key),
        Err(error) if error.error.kind() == std::io::ErrorKind::AlreadyExists => {
            let gone = || failed()(std::io::Error::other("it comes and goes"));
            read(path)?.ok_or_else(gone)
        }
        Err(error) => Err(failed()(error.error)),
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::types::FilesPlace;
    use super::*;

    #[tokio::test]
    async fn servers_with_a_folder_each_have_one_key_or_are_told() {
        let folders = [0; 3].map(|_| tempfile::tempdir().expect("a folder"));
        let [shared, one, two] = &folders;
        let storage = Storage::of(shared.path(), &FilesPlace::Folder).expect("a place");
        let [one, two] = [one, two].map(|of| of.path().join(WEBHOOK_KEY));
        let both = async |path: &Path| of_both(path, &storage).await;
        assert!(both(&one).await.expect("none yet").is_none());
        let key = keep(&one, new()).expect("a key");
        let note = storage.leave_note(WEBHOOK_KEY, &written(&key)).await;
        note.expect("a note");
        assert_eq!(both(&one).await.expect("its own"), Some(key));
        // the second takes it
        assert_eq!(both(&two).await.expect("the first one's"), Some(key));
        assert_eq!(read(&two).expect("a file"), Some(key));
        // one that had made its own is refused, and keeps it
        std::fs::remove_file(&two).expect("it is there");
        let other = keep(&two, new()).expect("a key");
        let refused = both(&two).await;
        assert!(
            matches!(refused, Err(StoreError::NotTogether(_))),
            "{refused:?}"
        );
        assert_eq!(read(&two).expect("a file"), Some(other));
        std::fs::remove_file(&two).expect("it is there");
        for broken in ["", "abc", &"zz".repeat(32), &"a".repeat(63)] {
            let note = storage.leave_note(WEBHOOK_KEY, broken).await;
            note.expect("a note");
            let refused = both(&two).await;
            assert!(
                matches!(refused, Err(StoreError::Corrupt { .. })),
                "{broken}: {refused:?}"
            );
        }
        assert_eq!(read(&two).expect("no file"), None);
    }
}
