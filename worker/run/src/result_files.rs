//! Result files in a folder, hashed while they are written.
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter, Read, Write};
use std::path::{Path, PathBuf};

use loadframe_api::{FileEntry, check_file_name};
use loadframe_physics::{InterruptSource, Wanted};
use sha2::{Digest, Sha256};

/// Large enough that the system call does not show beside hashing.
const BUFFER_BYTES: usize = 1 << 16;

/// Result files of a run, by name.
#[derive(Debug)]
pub(crate) struct ResultFiles {
    folder: PathBuf,
    entries: BTreeMap<String, FileEntry>,
}

impl ResultFiles {
    /// Files in `folder`, where those of `entries` are known already.
    pub(crate) fn open(folder: &Path, entries: &[FileEntry]) -> Self {
        let known = entries
            .iter()
            .map(|entry| (entry.name.clone(), entry.clone()));
        Self {
            folder: folder.to_owned(),
            entries: known.collect(),
        }
    }

    /// Writes the file `name`; it appears under its name when it is whole, and not when `interrupt` says
    /// meanwhile that nothing of the run is wanted.
    pub(crate) fn write(
        &mut self,
        name: &str,
        interrupt: &dyn InterruptSource,
        write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<FileEntry> {
        check_file_name(name).map_err(|error| {
            io::Error::new(io::ErrorKind::InvalidInput, format!("{name:?}: {error}"))
        })?;
        let path = self.path(name);
        let mut partial = path.clone().into_os_string();
        partial.push(".partial");
        let partial = PathBuf::from(partial);
        let written = write_hashed(&partial, interrupt, write)
            .and_then(|written| std::fs::rename(&partial, &path).map(|()| written))
            .map_err(|error| {
                // a full disk is not kept full by what did not fit on it
                let _ = std::fs::remove_file(&partial);
                io::Error::new(error.kind(), format!("{}: {error}", path.display()))
            })?;
        let entry = FileEntry {
            name: name.to_owned(),
            bytes: written.bytes,
            sha256: hex(written.hash),
        };
        self.entries.insert(name.to_owned(), entry.clone());
        Ok(entry)
    }

    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// All files, in the order of their names.
    pub(crate) fn entries(&self) -> Vec<FileEntry> {
        self.entries.values().cloned().collect()
    }
}

fn write_hashed(
    path: &Path,
    interrupt: &dyn InterruptSource,
    write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
) -> io::Result<Hashed> {
    let wanted = Wanted::new(Hashed::new(created(path)?), interrupt);
    let mut out = BufWriter::with_capacity(BUFFER_BYTES, wanted);
    write(&mut out)?;
    let wanted = out.into_inner().map_err(io::IntoInnerError::into_error)?;
    Ok(wanted.into_inner())
}

/// A new file, in a new folder where there is none yet.
fn created(path: &Path) -> io::Result<File> {
    match (File::create(path), path.parent()) {
        (Err(error), Some(parent)) if error.kind() == io::ErrorKind::NotFound => {
            std::fs::create_dir_all(parent)?;
            File::create(path)
        }
        (file, _) => file,
    }
}

/// SHA-256 of a file's content in hexadecimal digits.
///
/// # Errors
/// When the file cannot be read.
pub fn sha256_of_file(path: &Path) -> io::Result<String> {
    let mut file = File::open(path)?;
    let mut hash = Sha256::new();
    let mut buffer = vec![0; BUFFER_BYTES];
    loop {
        match file.read(&mut buffer)? {
            0 => return Ok(hex(hash)),
            count => hash.update(&buffer[..count]),
        }
    }
}

/// Hashes what goes through it.
struct Hashed {
    file: File,
    hash: Sha256,
    bytes: u64,
}

impl Hashed {
    fn new(file: File) -> Self {
        Self {
            file,
            hash: Sha256::new(),
            bytes: 0,
        }
    }
}

impl Write for Hashed {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.file.write(bytes)?;
        self.hash.update(&bytes[..count]);
        self.bytes += count as u64;
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

fn hex(hash: Sha256) -> String {
    use std::fmt::Write;
    hash.finalize()
        .iter()
        .fold(String::with_capacity(64), |mut text, byte| {
            let _ = write!(text, "{byte:02x}");
            text
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stop::{StopCause, StopSwitch};
    use loadframe_api::sha256_hex;
    use loadframe_physics::Uninterrupted;

    #[test]
    fn an_entry_says_what_is_on_disk() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut files = ResultFiles::open(folder.path(), &[]);
        let content = vec![7_u8; 3 * BUFFER_BYTES + 1];
        let entry = files
            .write("snapshots/a.vtp", &Uninterrupted, &mut |out| {
                out.write_all(&content)
            })
            .expect("written");
        let path = folder.path().join("snapshots/a.vtp");
        assert_eq!(std::fs::read(&path).expect("there"), content);
        assert_eq!(entry.bytes, content.len() as u64);
        assert_eq!(entry.sha256, sha256_hex(&content));
        assert_eq!(sha256_of_file(&path).expect("readable"), entry.sha256);
        assert_eq!(files.entries(), [entry]);
    }

    #[test]
    fn a_failed_write_leaves_no_file_and_no_entry() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut files = ResultFiles::open(folder.path(), &[]);
        let full = files.write("a.csv", &Uninterrupted, &mut |_| {
            Err(io::Error::other("disk full"))
        });
        assert!(full.is_err() && files.entries().is_empty());
        let left = std::fs::read_dir(folder.path()).expect("a folder").count();
        assert_eq!(left, 0);
        let outside = files.write("../a.csv", &Uninterrupted, &mut |_| Ok(()));
        assert!(outside.is_err());
    }

    #[test]
    fn a_large_file_that_nobody_wants_is_given_up_within_a_buffer() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut files = ResultFiles::open(folder.path(), &[]);
        let switch = StopSwitch::default();
        let row = [7_u8; 1000];
        let mut rows = 0;
        let written = files.write("a.csv", &switch, &mut |out| {
            for number in 0..1_000_000 {
                if number == 500 {
                    switch.stop(StopCause::Cancel);
                }
                rows = number;
                out.write_all(&row)?;
            }
            Ok(())
        });
        assert!(written.is_err() && files.entries().is_empty());
        assert!(
            rows - 500 <= BUFFER_BYTES / row.len(),
            "{rows} rows of a million"
        );
        let left = std::fs::read_dir(folder.path()).expect("a folder").count();
        assert_eq!(left, 0);
    }
}
