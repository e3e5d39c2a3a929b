//! Files in a folder of this machine: `blobs/` with the bytes under their SHA-256, in 256 folders by its
//! first two digits, and small notes of the store beside them.
//!
//! Bytes are durable under a temporary name before they are renamed, and the name is durable before a row
//! may have it. What is not what its name says is moved to `set-aside/`.
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use tempfile::TempPath;

use super::arriving::Received;
use super::disk::{blocking, hash_of, sync_folder};
use super::error::{Loss, Result, StoreError};

/// Puts bytes that are durable under a temporary name in their place, durably.
fn put(bytes: TempPath, place: &Path) -> std::io::Result<()> {
    bytes.persist(place)?;
    sync_folder(place.parent().unwrap_or(place))
}

/// The folder of files.
#[derive(Clone, Debug)]
pub(super) struct Folder {
    root: PathBuf,
    /// What is not what its name says is moved here.
    set_aside: PathBuf,
}

impl Folder {
    /// That of the store in `data`, which may not be there yet.
    pub(super) fn of(data: &Path) -> Self {
        Self {
            root: data.join("blobs"),
            set_aside: data.join("set-aside"),
        }
    }

    pub(super) fn root(&self) -> &Path {
        &self.root
    }

    pub(super) async fn prepare(&self) -> Result<()> {
        let root = self.root.clone();
        blocking(&self.root, move || {
            // all folders at once, so that storing a file makes no folder durable but its own
            for byte in 0..=u8::MAX {
                std::fs::create_dir_all(root.join(format!("{byte:02x}")))?;
            }
            sync_folder(&root)
        })
        .await
    }

    /// Where the bytes of `sha256` are.
    pub(super) fn path(&self, sha256: &str) -> PathBuf {
        let folder = sha256.get(..2).unwrap_or_default();
        self.root.join(folder).join(sha256)
    }

    /// Puts bytes that are durable under a temporary name in their place, in the place of others.
    pub(super) async fn place(&self, sha256: &str, bytes: TempPath) -> Result<()> {
        let place = self.path(sha256);
        blocking(&self.path(sha256), move || put(bytes, &place)).await
    }

    /// Length of a stored file; `None` when it is not there.
    pub(super) async fn length(&self, sha256: &str) -> Option<u64> {
        let found = tokio::fs::metadata(self.path(sha256)).await;
        found.ok().map(|file| file.len())
    }

    /// Holds a stored file against its name and sets it aside if it is another; tells what is wrong.
    pub(super) async fn examine(&self, sha256: &str, bytes: u64) -> Result<Option<Loss>> {
        let (folder, name) = (self.clone(), sha256.to_owned());
        blocking(&self.path(sha256), move || folder.examined(&name, bytes)).await
    }

    /// Puts a file that has arrived in its place, durably, unless it is there already and still what its name
    /// says: then it is as durable as this. All in one go where it may block: a way to another thread and back
    /// takes as long as most of what is done there.
    pub(super) async fn keep(&self, received: Received, incoming: &Path) -> Result<()> {
        let (folder, incoming) = (self.clone(), incoming.to_owned());
        let place = self.path(&received.sha256);
        blocking(&place.clone(), move || {
            if folder.examined(&received.sha256, received.bytes)?.is_none() {
                return Ok(());
            }
            put(received.on_disk(&incoming)?, &place)
        })
        .await
    }

    /// [`Self::examine`]; blocks.
    fn examined(&self, sha256: &str, bytes: u64) -> std::io::Result<Option<Loss>> {
        let place = self.path(sha256);
        match hash_of(&place) {
            Ok((found, length)) if found == sha256 && length == bytes => return Ok(None),
            Ok(_) => {}
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Some(Loss::Missing)),
            // a disk that cannot read it back has lost it as well
            Err(error) => {
                tracing::error!(path = %place.display(), %error, "a stored file cannot be read");
            }
        }
        self.set_aside(sha256)?;
        Ok(Some(Loss::Changed))
    }

    fn set_aside(&self, sha256: &str) -> std::io::Result<()> {
        let (place, folder) = (self.path(sha256), &self.set_aside);
        let name = format!("{sha256}-{}", loadframe_api::Timestamp::now().as_millis());
        tracing::error!(sha256, folder = %folder.display(), "a stored file is not what its name says; it is set aside");
        std::fs::create_dir_all(folder)?;
        std::fs::rename(&place, folder.join(name))?;
        sync_folder(place.parent().unwrap_or(&place))
    }

    /// Copies a stored file to `to`; whether it was there.
    pub(super) async fn copy_to(&self, sha256: &str, to: &Path) -> Result<bool> {
        let (source, to) = (self.path(sha256), to.to_owned());
        blocking(&self.path(sha256), move || {
            match std::fs::copy(source, to) {
                Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
                copied => copied.map(|_| true),
            }
        })
        .await
    }

    /// Names of all stored files.
    pub(super) async fn names(&self) -> Result<Vec<String>> {
        let folder = self.root.clone();
        blocking(&self.root, move || {
            let mut names = Vec::new();
            for folder in std::fs::read_dir(folder)? {
                let folder = folder?;
                if folder.file_type()?.is_dir() {
                    for file in std::fs::read_dir(folder.path())? {
                        names.extend(file?.file_name().into_string());
                    }
                }
            }
            Ok(names)
        })
        .await
    }

    pub(super) async fn remove(&self, names: Vec<String>) -> Result<()> {
        let paths: Vec<PathBuf> = names.iter().map(|name| self.path(name)).collect();
        blocking(&self.root, move || {
            let mut failed = Ok(());
            for path in paths {
                match std::fs::remove_file(path) {
                    Err(error) if error.kind() != ErrorKind::NotFound => {
                        // one that cannot be removed keeps no other
                        failed = failed.and(Err(error));
                    }
                    _ => {}
                }
            }
            failed
        })
        .await
    }

    /// Whether any file lies there.
    pub(super) fn has_files(&self) -> Result<bool> {
        let look = || -> std::io::Result<bool> {
            for folder in std::fs::read_dir(&self.root)? {
                let folder = folder?;
                if folder.file_type()?.is_dir()
                    && std::fs::read_dir(folder.path())?.next().is_some()
                {
                    return Ok(true);
                }
            }
            Ok(false)
        };
        match look() {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
            looked => looked.map_err(StoreError::file(&self.root)),
        }
    }

    /// A note of the store beside the files, if it is there.
    pub(super) fn note(&self, name: &str) -> Result<Option<String>> {
        let path = self.root.join(name);
        match std::fs::read_to_string(&path) {
            Ok(text) => Ok(Some(text)),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Err(error) => Err(StoreError::file(path)(error)),
        }
    }

    /// Leaves a note, durably.
    pub(super) fn leave_note(&self, name: &str, text: &str) -> Result<()> {
        let path = self.root.join(name);
        let write = || -> std::io::Result<()> {
            std::fs::create_dir_all(&self.root)?;
            let mut file = tempfile::NamedTempFile::new_in(&self.root)?;
            std::io::Write::write_all(&mut file, text.as_bytes())?;
            file.as_file().sync_all()?;
            file.persist(&path)?;
            sync_folder(&self.root)
        };
        write().map_err(StoreError::file(&path))
    }

    /// A folder for files on their way to a place here.
    pub(super) fn staging(&self, sha256: &str) -> Result<PathBuf> {
        let place = self.path(sha256);
        let folder = place.parent().unwrap_or(&self.root).to_owned();
        std::fs::create_dir_all(&folder).map_err(StoreError::file(&folder))?;
        Ok(folder)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_file_that_cannot_be_removed_keeps_no_other() {
        let data = tempfile::tempdir().expect("a folder");
        let folder = Folder::of(data.path());
        folder.prepare().await.expect("its folders");
        // what lies in the place of the first is no file
        let [first, last] = ["0", "f"].map(|digit| digit.repeat(64));
        std::fs::create_dir(folder.path(&first)).expect("a folder in its place");
        std::fs::write(folder.path(&last), "bytes").expect("a file");
        let removed = folder.remove(vec![first, last.clone()]).await;
        assert!(removed.is_err());
        assert!(!folder.path(&last).exists());
    }
}
