//! Where a database may lie: on a disk of this machine.
//!
//! SQLite's write-ahead log is shared by mapped memory, which "does not work over a network filesystem"
//! (sqlite.org/wal.html, "all processes using a database must be on the same host computer"), and locks of
//! some of them hold nobody off. What comes of it is a broken database, later; so it is refused at once.
use std::path::Path;

use super::error::{Result, StoreError};

/// Types of network file systems by their number (statfs(2), and the headers of the kernel and of those
/// that are not in it), with the name people know.
const NETWORK: [(i64, &str); 11] = [
    (0x6969, "NFS"),
    (0x517b, "SMB"),
    (0xfe53_4d42, "SMB"),
    (0xff53_4d42, "CIFS"),
    (0x5346_414f, "AFS"),
    (0x7375_7245, "Coda"),
    (0x00c3_6400, "Ceph"),
    (0x0bd0_0bd0, "Lustre"),
    (0x4750_4653, "GPFS"),
    (0x1983_0326, "BeeGFS"),
    (0x0116_1970, "GFS2"),
];

/// Refuses a folder on a network file system.
///
/// # Errors
/// [`StoreError::NetworkDisk`]. Where the system does not say what file system it is, there is none.
pub(super) fn refuse_network(data: &Path) -> Result<()> {
    match nix::sys::statfs::statfs(data) {
        Ok(found) => judge(data, found.filesystem_type().0),
        Err(_) => Ok(()),
    }
}

fn judge(data: &Path, kind: i64) -> Result<()> {
    // some architectures keep the number in 32 bits, with a sign
    let kind = kind & 0xffff_ffff;
    match NETWORK.iter().find(|(known, _)| *known == kind) {
        Some((_, system)) => Err(StoreError::NetworkDisk {
            folder: data.to_owned(),
            system,
        }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_database_on_nfs_is_refused_with_a_sentence() {
        let refused = judge(Path::new("/home/lab/data"), 0x6969).expect_err("NFS");
        let sentence = refused.to_string();
        assert!(sentence.contains("/home/lab/data is on NFS"), "{sentence}");
        assert!(sentence.contains("local disk"), "{sentence}");
        // the same number as a signed one of 32 bits
        let cifs = i64::from(0xff53_4d42_u32.cast_signed());
        assert!(judge(Path::new("/mnt"), cifs).is_err());
    }

    #[test]
    fn disks_of_the_machine_are_taken() {
        // ext4, xfs, btrfs, tmpfs, overlayfs, zfs
        for local in [
            0xef53,
            0x5846_5342,
            0x9123_683e,
            0x0102_1994,
            0x794c_7630,
            0x2fc1_2fc1,
        ] {
            assert!(judge(Path::new("/srv"), local).is_ok(), "{local:x}");
        }
        assert!(refuse_network(&std::env::temp_dir()).is_ok());
    }
}
