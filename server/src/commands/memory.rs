//! Whether this machine can hold what is to run on it.
use clap::Args;
use loadframe_api::{Estimate, Limits};
use loadframe_run::free_memory_mb;

use super::failure::{Code, Failure};
use super::terminal::size;

/// Option of every command that computes here without a server.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct MemoryCheck {
    /// Start even if the estimated memory is more than this machine has free
    #[arg(long)]
    even_if_large: bool,
}

impl MemoryCheck {
    /// Refuses what would need more memory than this machine has free; where the system does not
    /// say how much that is, nothing is refused.
    pub(crate) fn admit(self, estimate: &Estimate) -> Result<(), Failure> {
        if self.even_if_large {
            return Ok(());
        }
        match free_memory_mb() {
            Some(free) => within(estimate, free),
            None => Ok(()),
        }
    }
}

/// Refuses what needs more than `free` [MB].
fn within(estimate: &Estimate, free: f64) -> Result<(), Failure> {
    let limits = Limits {
        memory_mb: free,
        ..Limits::NONE
    };
    match limits.exceeded(estimate).first() {
        None => Ok(()),
        Some(excess) => Err(Failure::new(
            Code::Usage,
            format!(
                "this needs about {} of memory, and this machine has {} free; make it smaller, use fewer threads, or start it all the same with --even-if-large",
                size(excess.estimate),
                size(excess.limit)
            ),
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn needing(memory_mb: f64) -> Estimate {
        Estimate {
            // time and files are the user's own here
            wall_s: 1e12,
            memory_mb,
            disk_mb: 1e12,
            calibrated: false,
            threads_wall_s: None,
            sharing: loadframe_api::Sharing::ALONE,
        }
    }

    #[test]
    fn only_what_memory_cannot_hold_is_refused_with_both_numbers() {
        assert!(within(&needing(20_999.0), 21_000.0).is_ok());
        let refused = within(&needing(35_000.0), 21_000.0).expect_err("too large");
        let text = refused.to_string();
        assert!(text.contains("needs about 35.0 GB"), "{text}");
        assert!(text.contains("has 21.0 GB free"), "{text}");
        assert!(text.contains("--even-if-large"), "{text}");
    }

    #[test]
    fn this_machine_tells_what_it_has_free_and_the_option_overrides_it() {
        let beyond = needing(1e12);
        let check = |even_if_large| MemoryCheck { even_if_large };
        assert!(check(false).admit(&beyond).is_err());
        assert!(check(true).admit(&beyond).is_ok());
        assert!(check(false).admit(&needing(1e-3)).is_ok());
    }
}
