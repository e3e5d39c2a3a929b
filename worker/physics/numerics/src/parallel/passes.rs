//! Short passes one after the other, shared among the threads of a pool.
//!
//! A pass of a step takes some 0.1 ms, and to wake a thread that sleeps takes nearly as long. So the
//! threads stay awake between passes, and every one has its own neighbouring items, the same in pass
//! after pass, before it takes those of others.
use std::{
    collections::VecDeque,
    sync::{
        Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    time::{Duration, Instant},
};

use rayon::Yield;

/// How long a thread without work looks for some before it may sleep.
const PATIENCE: Duration = Duration::from_micros(200);

/// Does `work` in a thread of a pool whose other threads wait for parts of it, awake.
pub(super) fn attended<R: Send>(work: impl FnOnce() -> R + Send) -> R {
    let is_done = AtomicBool::new(false);
    let own = rayon::current_thread_index();
    rayon::in_place_scope(|scope| {
        scope.spawn_broadcast(|_, others| {
            if own != Some(others.index()) {
                await_work(|| is_done.load(Ordering::Relaxed));
            }
        });
        let result = work();
        is_done.store(true, Ordering::Relaxed);
        result
    })
}

/// Does what work there is for this thread until `is_over`, or until there was none for some time.
#[expect(
    clippy::disallowed_methods,
    reason = "how long a thread stays awake is in no result"
)]
fn await_work(is_over: impl Fn() -> bool) {
    let mut idle_since = None;
    while !is_over() {
        if rayon::yield_now() == Some(Yield::Executed) {
            idle_since = None;
        } else {
            let now = Instant::now();
            if now - *idle_since.get_or_insert(now) > PATIENCE {
                return;
            }
            // others on this machine may have work
            std::thread::yield_now();
        }
    }
}

/// The order in which a thread does its own items. What was done last is still in its caches, so that
/// a pass over the same items begins there.
#[derive(Clone, Copy, Debug)]
pub(super) enum Order {
    Forth,
    Back,
}

/// Items that no thread has begun, those for each thread apart.
struct Waiting<T>(Vec<Mutex<VecDeque<(usize, T)>>>);

impl<T> Waiting<T> {
    fn new(items: Vec<T>, threads: usize) -> Self {
        let count = items.len();
        let mut items = items.into_iter().enumerate();
        let share = |thread| (thread + 1) * count / threads - thread * count / threads;
        let shares = (0..threads).map(|thread| items.by_ref().take(share(thread)).collect());
        Self(shares.map(Mutex::new).collect())
    }

    /// The next of a thread's own, else the last of another's.
    fn next(&self, thread: usize, order: Order) -> Option<(usize, T)> {
        let [next, last] = match order {
            Order::Forth => [VecDeque::pop_front, VecDeque::pop_back],
            Order::Back => [VecDeque::pop_back, VecDeque::pop_front],
        };
        let own = next(&mut open(&self.0[thread]));
        let threads = self.0.len();
        own.or_else(|| {
            let mut others = (1..threads).map(|next| &self.0[(thread + next) % threads]);
            others.find_map(|other| last(&mut open(other)))
        })
    }
}

/// What is in a lock; no thread fails while it holds one.
fn open<T>(lock: &Mutex<T>) -> MutexGuard<'_, T> {
    lock.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Does `work` on every item, by all threads of the pool that this one is of; the answers are in the
/// order of the items.
pub(super) fn shared<T: Send, R: Send>(
    items: Vec<T>,
    order: Order,
    work: &(impl Fn(T) -> R + Sync),
) -> Vec<R> {
    let threads = rayon::current_num_threads();
    let helpers = threads.min(items.len()).saturating_sub(1);
    let answers: Vec<Mutex<Option<R>>> = items.iter().map(|_| Mutex::new(None)).collect();
    let waiting = Waiting::new(items, threads);
    let at_work = AtomicUsize::new(helpers);
    let go = || {
        let thread = rayon::current_thread_index().unwrap_or_default();
        while let Some((place, item)) = waiting.next(thread, order) {
            let answer = work(item);
            *open(&answers[place]) = Some(answer);
        }
    };
    rayon::in_place_scope(|scope| {
        for _ in 0..helpers {
            scope.spawn(|_| {
                go();
                at_work.fetch_sub(1, Ordering::Release);
            });
        }
        go();
        await_work(|| at_work.load(Ordering::Acquire) == 0);
    });
    let answers = answers.into_iter();
    answers
        .filter_map(|answer| answer.into_inner().unwrap_or_else(PoisonError::into_inner))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_thread_takes_its_own_first_and_then_the_last_of_others() {
        let waiting = Waiting::new(vec!['a', 'b', 'c', 'd', 'e'], 2);
        let taken = |thread| waiting.next(thread, Order::Forth);
        assert_eq!(taken(1), Some((2, 'c')));
        assert_eq!(taken(0), Some((0, 'a')));
        assert_eq!(taken(0), Some((1, 'b')));
        assert_eq!(taken(0), Some((4, 'e')));
        assert_eq!(taken(1), Some((3, 'd')));
        assert_eq!(taken(1), None);
    }

    #[test]
    fn on_the_way_back_every_thread_begins_with_its_last() {
        let waiting = Waiting::new(vec!['a', 'b', 'c', 'd'], 2);
        let taken = |thread| waiting.next(thread, Order::Back);
        assert_eq!(taken(1), Some((3, 'd')));
        assert_eq!(taken(0), Some((1, 'b')));
        assert_eq!(taken(0), Some((0, 'a')));
        assert_eq!(taken(0), Some((2, 'c')));
        assert_eq!(taken(1), None);
    }

    #[test]
    fn a_pass_that_panics_tells_of_it() -> Result<(), Box<dyn std::error::Error>> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build()?;
        let pass = || {
            pool.install(|| {
                attended(|| shared(vec![1, 2, 3], Order::Forth, &|item| assert!(item < 3)))
            })
        };
        assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(pass)).is_err());
        Ok(())
    }
}
