//! Tasks of the store that go on after a panic, and what they have come to, for people.
use std::any::Any;
use std::panic::AssertUnwindSafe;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use futures_util::FutureExt;

/// First and longest pause before something is tried again.
const FIRST_PAUSE: Duration = Duration::from_millis(50);
const LONGEST_PAUSE: Duration = Duration::from_secs(5);

/// How often the tasks of a store had to be taken up again.
#[derive(Debug, Default)]
pub(super) struct Restarts {
    pub(super) writer: AtomicU64,
    pub(super) collector: AtomicU64,
}

/// A task that panicked.
#[derive(Debug, thiserror::Error)]
#[error("it panicked: {0}")]
pub(super) struct Panicked(String);

/// Runs some work and catches its panic, which is logged and counted.
pub(super) async fn caught<T>(
    task: &'static str,
    restarts: &AtomicU64,
    work: impl Future<Output = T>,
) -> Result<T, Panicked> {
    AssertUnwindSafe(work)
        .catch_unwind()
        .await
        .map_err(|panic| {
            let panicked = Panicked(message(panic.as_ref()));
            tracing::error!(task, error = %panicked, "a task of the store is taken up again");
            restarts.fetch_add(1, Ordering::Relaxed);
            panicked
        })
}

/// Tries until it succeeds, with growing pauses.
pub(super) async fn until_done<T, E, F>(task: &'static str, mut attempt: impl FnMut() -> F) -> T
where
    E: std::fmt::Display,
    F: Future<Output = Result<T, E>>,
{
    let mut pause = FIRST_PAUSE;
    loop {
        match attempt().await {
            Ok(done) => return done,
            Err(error) => {
                tracing::error!(task, %error, "it is tried again");
                tokio::time::sleep(pause).await;
                pause = (2 * pause).min(LONGEST_PAUSE);
            }
        }
    }
}

fn message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("without a message")
        .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_panic_is_caught_and_counted() {
        let restarts = AtomicU64::new(0);
        let fine = caught("a task", &restarts, async { 3 }).await;
        assert_eq!((fine.ok(), restarts.load(Ordering::Relaxed)), (Some(3), 0));
        let panicked = caught("a task", &restarts, async { panic!("index {}", 7) }).await;
        let panicked: Result<(), Panicked> = panicked;
        let said = panicked.expect_err("it panicked").to_string();
        assert_eq!(said, "it panicked: index 7");
        assert_eq!(restarts.load(Ordering::Relaxed), 1);
    }

    #[tokio::test]
    async fn what_fails_is_tried_until_it_succeeds() {
        let mut left = 4;
        let done = until_done("a task", || {
            left -= 1;
            let answer = if left > 0 { Err("not yet") } else { Ok(left) };
            async move { answer }
        });
        assert_eq!(done.await, 0);
    }
}
