//! Work shared among threads so that the result does not know how many there were.
//!
//! A floating sum depends on its order. Here every pass is cut into chunks of a fixed size, each
//! chunk is summed from front to back, and the chunk sums are folded in order; one thread walks
//! the same chunks. A plain parallel sum would change its bits with the thread count.
//!
//! What is generic here only wraps what it is given: all that knows of threads takes `dyn` work, and is
//! compiled once. For each kind of work the compiler would make hundreds of functions of it.
mod passes;

use std::{
    mem,
    sync::{Mutex, PoisonError},
};

use passes::{Order, open};
use rayon::{ThreadPool, prelude::*};

/// Items in a chunk: long enough to hide the cost of handing it out (about 10 µs of work for
/// bonds), short enough to share a few ten thousand bonds among 8 threads.
const CHUNK: usize = 2048;

/// The operating system refused the threads of a team.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{threads} threads could not be started: {reason}")]
pub struct ThreadsError {
    pub threads: usize,
    pub reason: String,
}

/// The threads of a run.
#[derive(Debug)]
pub struct Team {
    pool: Option<rayon::ThreadPool>,
}

impl Team {
    /// A team of `threads`; one thread (or none) works in the caller.
    ///
    /// # Errors
    /// When the operating system refuses the threads.
    pub fn new(threads: usize) -> Result<Self, ThreadsError> {
        let pool = if threads > 1 {
            let built = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            Some(built.map_err(|error| ThreadsError {
                threads,
                reason: error.to_string(),
            })?)
        } else {
            None
        };
        Ok(Self { pool })
    }

    /// One thread, the caller's.
    pub fn alone() -> Self {
        Self { pool: None }
    }

    /// Whether all work is done by the caller.
    pub fn is_alone(&self) -> bool {
        self.pool.is_none()
    }

    /// How many there are.
    pub fn threads(&self) -> usize {
        self.pool
            .as_ref()
            .map_or(1, |pool| pool.current_num_threads())
    }

    /// Does `work` with the team at hand, so that each of its passes need not call them together.
    pub fn gather<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match &self.pool {
            Some(pool) if pool.current_thread_index().is_none() => {
                let mut task = Task::of(work);
                within(pool, &mut || passes::attended(&mut || task.work()));
                task.result()
            }
            _ => work(),
        }
    }

    /// Does two things at once.
    pub fn both<A: Send, B: Send>(
        &self,
        first: impl FnOnce() -> A + Send,
        second: impl FnOnce() -> B + Send,
    ) -> (A, B) {
        match &self.pool {
            Some(pool) => {
                let (mut first, mut second) = (Task::of(first), Task::of(second));
                join(pool, &mut || first.work(), &mut || second.work());
                (first.result(), second.result())
            }
            None => (first(), second()),
        }
    }

    /// Does `work` on every item; the answers are in the order of the items.
    pub fn map<T: Send, R: Send>(
        &self,
        items: Vec<T>,
        work: impl Fn(T) -> R + Sync + Send,
    ) -> Vec<R> {
        self.map_in(Order::Forth, items, work)
    }

    /// The same, but each thread begins with its last: after [`Team::map`] over the same items what
    /// belongs to those is still in its caches.
    pub fn map_back<T: Send, R: Send>(
        &self,
        items: Vec<T>,
        work: impl Fn(T) -> R + Sync + Send,
    ) -> Vec<R> {
        self.map_in(Order::Back, items, work)
    }

    fn map_in<T: Send, R: Send>(
        &self,
        order: Order,
        items: Vec<T>,
        work: impl Fn(T) -> R + Sync + Send,
    ) -> Vec<R> {
        let pool = match &self.pool {
            Some(pool) if items.len() > 1 => pool,
            _ => return items.into_iter().map(work).collect(),
        };
        let tasks = items.into_iter().map(|item| Task::of(|| work(item)));
        let tasks: Vec<_> = tasks.map(Mutex::new).collect();
        within(pool, &mut || {
            passes::shared(tasks.len(), order, &|place| open(&tasks[place]).work());
        });
        let done = tasks.into_iter().map(Mutex::into_inner);
        done.map(|task| task.unwrap_or_else(PoisonError::into_inner).result())
            .collect()
    }

    /// Lets `work` fill chunk after chunk of `items` and sums what it returns. `work` is given the
    /// index of its first item.
    pub fn fill<T: Send>(
        &self,
        items: &mut [T],
        work: impl Fn(usize, &mut [T]) -> f64 + Sync,
    ) -> f64 {
        match &self.pool {
            Some(pool) if items.len() > CHUNK => {
                let chunks: Vec<_> = items.chunks_mut(CHUNK).map(Mutex::new).collect();
                let sums = sums(pool, chunks.len(), &|chunk| {
                    work(chunk * CHUNK, &mut open(&chunks[chunk]))
                });
                sums.iter().sum()
            }
            _ => {
                let chunks = items.chunks_mut(CHUNK).enumerate();
                chunks
                    .map(|(chunk, items)| work(chunk * CHUNK, items))
                    .sum()
            }
        }
    }
}

/// Work to be done once, and its result.
enum Task<W, R> {
    Waiting(W),
    Begun,
    Done(R),
}

impl<W: FnOnce() -> R, R> Task<W, R> {
    fn of(work: W) -> Self {
        Self::Waiting(work)
    }

    fn work(&mut self) {
        if let Self::Waiting(work) = mem::replace(self, Self::Begun) {
            *self = Self::Done(work());
        }
    }

    /// # Panics
    /// When it was not done: who works with others has panicked before, if any of them did.
    fn result(self) -> R {
        match self {
            Self::Done(result) => result,
            Self::Waiting(_) | Self::Begun => unreachable!("the work was done"),
        }
    }
}

/// Does `work` in a thread of the pool.
fn within(pool: &ThreadPool, work: &mut (dyn FnMut() + Send)) {
    pool.install(work);
}

fn join(pool: &ThreadPool, first: &mut (dyn FnMut() + Send), second: &mut (dyn FnMut() + Send)) {
    pool.join(first, second);
}

/// What `work` returns for each of so many places.
fn sums(pool: &ThreadPool, count: usize, work: &(dyn Fn(usize) -> f64 + Sync)) -> Vec<f64> {
    pool.install(|| (0..count).into_par_iter().map(work).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_have_the_same_bits_on_any_number_of_threads() -> Result<(), ThreadsError> {
        let term = |index: usize| (index as f64 * 0.7).sin() * 1e3_f64.powi(index as i32 % 7);
        let work = |start: usize, items: &mut [f64]| {
            for (offset, item) in items.iter_mut().enumerate() {
                *item = term(start + offset);
            }
            items.iter().sum()
        };
        let mut items = vec![0.0; 100_003];
        let expected = Team::new(1)?.fill(&mut items, work).to_bits();
        for threads in [1, 2, 3, 8] {
            let mut items = vec![0.0; 100_003];
            let sum = Team::new(threads)?.fill(&mut items, work);
            assert_eq!(sum.to_bits(), expected, "{threads} threads");
        }
        Ok(())
    }
}
