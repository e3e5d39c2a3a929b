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
pub(super) fn attended(work: &mut (dyn FnMut() + Send)) {
    let is_done = AtomicBool::new(false);
    let own = rayon::current_thread_index();
    rayon::in_place_scope(|scope| {
        scope.spawn_broadcast(|_, others| {
            if own != Some(others.index()) {
                await_work(|| is_done.load(Ordering::Relaxed));
            }
        });
        work();
        is_done.store(true, Ordering::Relaxed);
    });
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

/// Places of items that no thread has begun, those for each thread apart.
struct Waiting(Vec<Mutex<VecDeque<usize>>>);

impl Waiting {
    fn new(count: usize, threads: usize) -> Self {
        let begin = |thread| thread * count / threads;
        let shares = (0..threads).map(|thread| (begin(thread)..begin(thread + 1)).collect());
        Self(shares.map(Mutex::new).collect())
    }

    /// The next of a thread's own, else the last of another's.
    fn next(&self, thread: usize, order: Order) -> Option<usize> {
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

/// What is in a lock, even if its last holder panicked: the pass ends with that panic.
pub(super) fn open<T>(lock: &Mutex<T>) -> MutexGuard<'_, T> {
    lock.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Does `work` for each of so many places, by all threads of the pool that this one is of.
pub(super) fn shared(count: usize, order: Order, work: &(dyn Fn(usize) + Sync)) {
    let threads = rayon::current_num_threads();
    let helpers = threads.min(count).saturating_sub(1);
    let waiting = Waiting::new(count, threads);
    let at_work = AtomicUsize::new(helpers);
    let go = || {
        let thread = rayon::current_thread_index().unwrap_or_default();
        while let Some(place) = waiting.next(thread, order) {
            work(place);
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
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_thread_takes_its_own_first_and_then_the_last_of_others() {
        let waiting = Waiting::new(5, 2);
        let taken = |thread| waiting.next(thread, Order::Forth);
        assert_eq!(taken(1), Some(2));
        assert_eq!(taken(0), Some(0));
        assert_eq!(taken(0), Some(1));
        assert_eq!(taken(0), Some(4));
        assert_eq!(taken(1), Some(3));
        assert_eq!(taken(1), None);
    }

    #[test]
    fn on_the_way_back_every_thread_begins_with_its_last() {
        let waiting = Waiting::new(4, 2);
        let taken = |thread| waiting.next(thread, Order::Back);
        assert_eq!(taken(1), Some(3));
        assert_eq!(taken(0), Some(1));
        assert_eq!(taken(0), Some(0));
        assert_eq!(taken(0), Some(2));
        assert_eq!(taken(1), None);
    }

    #[test]
    fn a_pass_that_panics_tells_of_it() -> Result<(), Box<dyn std::error::Error>> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build()?;
        let pass = || {
            pool.install(|| {
                attended(&mut || shared(3, Order::Forth, &|place| assert!(place < 2)));
            });
        };
        assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(pass)).is_err());
        Ok(())
    }
}
