//! File descriptors: what the system gives this process.
use nix::sys::resource::{Resource, getrlimit, setrlimit};

/// Enough for every connection with a file of its own, and for the database.
const WANTED: u64 = 16_384;
/// Kept for the database, the log and files on their way.
const RESERVED: usize = 128;
/// A connection, and the file that it sends or receives.
const A_CONNECTION: usize = 2;

/// Raises the limit as far as the system allows and needed, and tells what it is then.
fn raised() -> Option<u64> {
    let (soft, hard) = getrlimit(Resource::RLIMIT_NOFILE).ok()?;
    let wanted = WANTED.min(hard);
    if soft >= wanted {
        return Some(soft);
    }
    match setrlimit(Resource::RLIMIT_NOFILE, wanted, hard) {
        Ok(()) => Some(wanted),
        Err(error) => {
            tracing::warn!(%error, soft, "the limit of file descriptors cannot be raised");
            Some(soft)
        }
    }
}

/// How many of `wanted` connections there can be with the file descriptors of this process.
pub(super) fn affordable(wanted: usize) -> usize {
    // where the limit cannot be known, accepting tells
    let Some(limit) = raised() else { return wanted };
    let limit = usize::try_from(limit).unwrap_or(usize::MAX);
    let affordable = (limit.saturating_sub(RESERVED) / A_CONNECTION).max(1);
    if affordable < wanted {
        tracing::warn!(
            descriptors = limit,
            connections = affordable,
            "the system gives this process few file descriptors: raise `ulimit -n` for more connections"
        );
    }
    affordable.min(wanted)
}
