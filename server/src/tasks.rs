//! Work beside that of whoever asks for it.
//!
//! Whatever is done is one of two kinds of task: the compiler makes some sixty functions of each kind.
use std::{any::Any, future::Future, pin::Pin};

use tokio::task::{JoinHandle, spawn_blocking};

/// Work that panicked, or that a server which stops did not begin.
#[derive(Clone, Copy, Debug, thiserror::Error)]
#[error("work was not done: it panicked, or the server is stopping")]
pub(crate) struct NotDone;

/// Begins work that goes on by itself.
pub(crate) fn spawn(work: impl Future<Output = ()> + Send + 'static) -> JoinHandle<()> {
    let task: Pin<Box<dyn Future<Output = ()> + Send>> = Box::pin(work);
    tokio::spawn(task)
}

/// Does work that may block where it holds up nobody.
pub(crate) async fn blocking<T: Send + 'static>(
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<T, NotDone> {
    type Task = Box<dyn FnOnce() -> Box<dyn Any + Send> + Send>;
    let task: Task = Box::new(|| Box::new(work()));
    let done = spawn_blocking(task).await.map_err(|_| NotDone)?;
    done.downcast().map(|done| *done).map_err(|_| NotDone)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn work_has_its_result_and_a_panic_is_an_error() {
        assert_eq!(blocking(|| "done").await.ok(), Some("done"));
        let failed = blocking(|| -> usize { Vec::new()[0] }).await;
        assert!(failed.is_err());
    }
}
