//! Checking bodies, off the threads that answer.
//!
//! A check takes processor time and memory in proportion to its body, and a body may be large. So
//! checks have threads of their own, as many at once as there are cores; a client has all of these
//! but one, and so many of its bodies wait. Who leaves while waiting is not checked; a check that has
//! begun keeps its turn and its body's room until it ends, whether or not anybody waits for it.
use std::collections::HashMap;
use std::hash::{BuildHasher, RandomState};
use std::net::{IpAddr, SocketAddr};
use std::sync::{Arc, Mutex, Weak};
use std::time::Duration;

use axum::extract::{ConnectInfo, Request};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::timeout;

use super::access::bearer;
use super::problem::{ApiError, Result, TOO_MANY_REQUESTS};
use crate::tasks::blocking;

/// Bodies of one client that are checked or wait for it.
const A_CLIENT: usize = 256;
/// Pictures of one client that are drawn or wait for it: a page asks for one.
const PICTURES_OF_A_CLIENT: usize = 4;
/// How long a body waits for its turn: several of the longest checks.
const LONGEST_WAIT: Duration = Duration::from_secs(20);
/// When to come again [s].
const RETRY_S: u32 = 5;

/// Who sent a request: a token, or an address where there are none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Client {
    Token(u64),
    Address(Option<IpAddr>),
}

/// Turns to check bodies, or to draw what they describe.
#[derive(Clone, Debug)]
pub(super) struct Checks(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    turns: Arc<Semaphore>,
    turns_of_a_client: usize,
    places_of_a_client: usize,
    /// What a client is told who has no place left.
    no_place: &'static str,
    clients: Mutex<HashMap<Client, Weak<Share>>>,
    /// Names tokens without holding them.
    names: RandomState,
}

/// What one client may have.
#[derive(Debug)]
struct Share {
    places: Arc<Semaphore>,
    turns: Arc<Semaphore>,
}

/// A turn and a place, until dropped.
#[derive(Debug)]
struct Turn {
    _share: Arc<Share>,
    _permits: [OwnedSemaphorePermit; 3],
}

impl Default for Checks {
    fn default() -> Self {
        Self::with_turns(cores())
    }
}

fn cores() -> usize {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    cores.max(2)
}

impl Checks {
    fn with_turns(turns: usize) -> Self {
        let no_place = "of your bodies are being checked or wait for it";
        Self::of(turns, A_CLIENT, no_place)
    }

    /// Turns to draw pictures, which take longer than checks and do not hold these up.
    pub(super) fn of_pictures() -> Self {
        let no_place = "of your pictures are being drawn or wait for it";
        Self::of(cores(), PICTURES_OF_A_CLIENT, no_place)
    }

    fn of(turns: usize, places_of_a_client: usize, no_place: &'static str) -> Self {
        Self(Arc::new(Inner {
            turns: Arc::new(Semaphore::new(turns)),
            turns_of_a_client: turns - 1,
            places_of_a_client,
            no_place,
            clients: Mutex::default(),
            names: RandomState::new(),
        }))
    }

    /// Who sent the request.
    pub(super) fn client(&self, request: &Request) -> Client {
        if let Some(secret) = bearer(request.headers()) {
            return Client::Token(self.0.names.hash_one(secret));
        }
        let peer = request.extensions().get::<ConnectInfo<SocketAddr>>();
        Client::Address(peer.map(|ConnectInfo(address)| address.ip()))
    }

    /// Runs `check` when it is the client's turn.
    ///
    /// # Errors
    /// 429 when too many bodies of the client wait, 503 when its turn does not come in time.
    pub(super) async fn run<T: Send + 'static>(
        &self,
        client: Client,
        check: impl FnOnce() -> T + Send + 'static,
    ) -> Result<T> {
        let turn = self.turn(client).await?;
        let checked = blocking(move || {
            let done = check();
            drop(turn);
            done
        });
        Ok(checked.await?)
    }

    async fn turn(&self, client: Client) -> Result<Turn> {
        let share = self.share(client);
        let Ok(place) = share.places.clone().try_acquire_owned() else {
            let detail = format!("{} {}", self.0.places_of_a_client, self.0.no_place);
            return Err(ApiError::later(TOO_MANY_REQUESTS, detail, RETRY_S));
        };
        let turns = async {
            let own = share.turns.clone().acquire_owned().await.ok()?;
            let one = self.0.turns.clone().acquire_owned().await.ok()?;
            Some([place, own, one])
        };
        match timeout(LONGEST_WAIT, turns).await {
            Ok(Some(permits)) => Ok(Turn {
                _share: share,
                _permits: permits,
            }),
            _ => Err(ApiError::busy("too many others wait for the same", RETRY_S)),
        }
    }

    fn share(&self, client: Client) -> Arc<Share> {
        let clients = self.0.clients.lock();
        let mut clients = clients.unwrap_or_else(|poisoned| poisoned.into_inner());
        if let Some(share) = clients.get(&client).and_then(Weak::upgrade) {
            return share;
        }
        // who has nothing under way is forgotten, so that there are no more than there are requests
        clients.retain(|_, share| share.strong_count() > 0);
        let share = Arc::new(Share {
            places: Arc::new(Semaphore::new(self.0.places_of_a_client)),
            turns: Arc::new(Semaphore::new(self.0.turns_of_a_client)),
        });
        clients.insert(client, Arc::downgrade(&share));
        share
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;

    use super::*;

    const ONE: Client = Client::Token(1);
    const OTHER: Client = Client::Token(2);

    /// Begins a check that ends when the sender is dropped, and waits until it runs.
    async fn occupy(checks: &Checks, client: Client) -> mpsc::Sender<()> {
        let (end, ends) = mpsc::channel::<()>();
        let (began, begins) = tokio::sync::oneshot::channel();
        let checks = checks.clone();
        tokio::spawn(async move {
            let check = move || {
                let _ = began.send(());
                let _ = ends.recv();
            };
            let _ = checks.run(client, check).await;
        });
        begins.await.expect("it begins");
        end
    }

    #[tokio::test]
    async fn one_client_leaves_a_turn_to_others() {
        let checks = Checks::with_turns(2);
        let busy = occupy(&checks, ONE).await;
        let mut next = Box::pin(checks.run(ONE, || "mine"));
        let waited = timeout(Duration::from_millis(50), &mut next).await;
        assert!(waited.is_err(), "a client with one turn of two waits");
        assert_eq!(checks.run(OTHER, || "other").await.ok(), Some("other"));
        drop(busy);
        assert_eq!(next.await.ok(), Some("mine"));
    }

    #[tokio::test]
    async fn who_sends_too_many_is_told_to_come_later_and_who_leaves_is_not_checked() {
        let checks = Checks::with_turns(2);
        let busy = occupy(&checks, ONE).await;
        let (ran, runs) = mpsc::channel();
        let wait = |number: usize| {
            let (checks, ran) = (checks.clone(), ran.clone());
            tokio::spawn(async move { checks.run(ONE, move || ran.send(number)).await.is_ok() })
        };
        let waiting: Vec<_> = (1..A_CLIENT).map(wait).collect();
        let share = checks.share(ONE);
        while share.places.available_permits() > 0 {
            tokio::task::yield_now().await;
        }
        let refused = checks.run(ONE, || ()).await.expect_err("no place is left");
        assert_eq!(refused.status(), 429);
        for client in &waiting {
            client.abort();
        }
        for client in waiting {
            assert!(client.await.is_err());
        }
        drop(busy);
        assert!(checks.run(ONE, || ()).await.is_ok());
        drop(ran);
        assert_eq!(runs.iter().count(), 0);
        drop(share);
        assert!(checks.run(OTHER, || ()).await.is_ok());
        let clients = checks.0.clients.lock().expect("nobody panics");
        assert!(!clients.contains_key(&ONE), "it is forgotten");
    }
}
