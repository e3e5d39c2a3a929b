//! Memory asked for a little before it is needed.
//!
//! A processor foresees what lies in a row, but only as far as the next page of memory, and not
//! what an index leads to. Large beds do not fit into its caches, and what it did not foresee it
//! waits for: a bed of 100 000 spheres is a sixth faster when its lists say what comes next.

/// Asks for the line of the cache in which `item` begins, and does not wait for it.
#[inline(always)]
pub(crate) fn ask<T>(item: &T) {
    #[cfg(target_arch = "x86_64")]
    safe_arch::prefetch_t0(item);
    #[cfg(not(target_arch = "x86_64"))]
    let _ = item;
}

/// Asks for each of `items`, none of which is longer than a line.
#[inline(always)]
pub(crate) fn ask_all<T>(items: &[T]) {
    for item in items {
        ask(item);
    }
}
