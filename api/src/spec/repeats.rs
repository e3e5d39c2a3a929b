//! Repeats of a test with seeds that count on, as several kinds have them.
use crate::Violation;

/// Seeds beyond 2⁵³ − 1 are not exact in every language's JSON.
const LARGEST_SEED: u64 = (1 << 53) - 1;

/// Whether the last of so many seeds is still one; `of` is what has them.
pub(super) fn check_seeds(seed: u64, count: u32, of: &str) -> Option<Violation> {
    let largest = LARGEST_SEED - u64::from(count.saturating_sub(1));
    (seed > largest).then(|| {
        let detail =
            format!("the seeds of the {of}, which count on from this one, become too large");
        Violation::new("/seed", "out_of_range", detail)
            .value(seed)
            .allowed(format!("0 … {largest}"))
    })
}

/// As many as there are where nothing is said.
pub(super) fn one_repeat() -> u32 {
    1
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
pub(super) fn is_one_repeat(repeats: &u32) -> bool {
    *repeats == one_repeat()
}
