//! A server's life: open the store, bind, answer until told to stop.
use std::net::SocketAddr;
use std::pin::Pin;
use std::sync::Arc;
use std::time::Duration;

use tokio::net::TcpListener;
use tokio::task::JoinHandle;
use tokio_util::task::AbortOnDropHandle;

use crate::config::{SHUTDOWN_GRACE, ServeConfig};
use crate::connections::{Listening, Tls, TlsError};
use crate::http::{self, AppState};
use crate::store::{Store, StoreError};
use crate::{tasks, telling};

/// Wait before a task that ended is started again.
const BEFORE_RESTART: Duration = Duration::from_secs(1);

/// Why a server could not start or go on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ServeError {
    #[error("the store in {data} could not be opened")]
    Store {
        data: String,
        #[source]
        source: StoreError,
    },
    #[error("cannot listen on {listen}")]
    Listen {
        listen: String,
        #[source]
        source: std::io::Error,
    },
    #[error("the certificate cannot be used")]
    Tls(#[source] TlsError),
}

/// Serves until `shutdown` resolves; calls `ready` with the bound address once requests are taken.
///
/// # Errors
/// [`ServeError`] when the store cannot be opened or the address is taken.
pub fn serve<'a>(
    config: ServeConfig,
    ready: impl FnOnce(SocketAddr) + 'a,
    shutdown: impl Future<Output = ()> + 'a,
) -> impl Future<Output = Result<(), ServeError>> {
    serving(config, Box::new(ready), Box::pin(shutdown))
}

/// A server's life. Boxed here, it is compiled once and not again in everything that serves.
type Serving<'a> = Pin<Box<dyn Future<Output = Result<(), ServeError>> + 'a>>;

type Ready<'a> = Box<dyn FnOnce(SocketAddr) + 'a>;
type Shutdown<'a> = Pin<Box<dyn Future<Output = ()> + 'a>>;

fn serving<'a>(config: ServeConfig, ready: Ready<'a>, shutdown: Shutdown<'a>) -> Serving<'a> {
    Box::pin(serve_until(config, ready, shutdown))
}

async fn serve_until(
    config: ServeConfig,
    ready: Ready<'_>,
    shutdown: Shutdown<'_>,
) -> Result<(), ServeError> {
    let store_error = |source| ServeError::Store {
        data: config.store.data.display().to_string(),
        source,
    };
    let listen_error = |source| ServeError::Listen {
        listen: config.listen.clone(),
        source,
    };
    let tls = config.tls.clone().map(Tls::open).transpose();
    let tls = tls.map_err(ServeError::Tls)?.map(Arc::new);
    // the address first: a second server on it must not touch the store
    let listener = TcpListener::bind(&config.listen)
        .await
        .map_err(listen_error)?;
    let address = listener.local_addr().map_err(listen_error)?;
    let store = Store::open(config.store.clone())
        .await
        .map_err(store_error)?;
    let state = AppState::new(store.clone(), &config, address);
    let is_closed = state.access.needs_tokens() && !store.has_people();
    if is_closed && !store.has_tokens().await.map_err(store_error)? {
        tracing::warn!(
            "every request needs a token and there is none yet: `loadframe token create` makes one"
        );
    }
    let stopping = state.stopping.clone();
    let (scrubbed, filled, ordered) = (store.clone(), store.clone(), store.clone());
    let sweeping = keep_up("sweeping", move || store.clone().keep_sweeping());
    // what one of several servers on a database does for all is its duty
    let scrubbing = keep_up("scrubbing", move || {
        as_duty(scrubbed.clone(), "scrubbing", Store::keep_scrubbing)
    });
    let looking = keep_up("looking for room", move || {
        filled.clone().keep_looking_for_room()
    });
    let retaining = keep_up("applying rules of projects", move || {
        as_duty(ordered.clone(), "retaining", Store::keep_retaining)
    });
    let gathered = state.store.clone();
    let gathering = keep_up("gathering values for lists", move || {
        as_duty(gathered.clone(), "gathering", Store::keep_filling_values)
    });
    let (told, ways) = (state.store.clone(), state.ways.clone());
    let telling = keep_up("telling what happens", move || {
        let ways = ways.clone();
        as_duty(told.clone(), "telling", |store| {
            telling::keep_telling(store, ways)
        })
    });
    let announcer = state.clone();
    let announcing = keep_up("announcing", move || announcer.announce());
    let folding = keep_up("folding metrics", http::keep_metrics_folded);

    if tls.is_none() && !address.ip().is_loopback() {
        tracing::warn!(
            "without --tls-certificate everybody between here and the clients can read tokens and results"
        );
    }
    let mut tasks = vec![
        sweeping, scrubbing, looking, retaining, gathering, telling, announcing, folding,
    ];
    if let Some(tls) = tls.clone() {
        tasks.push(keep_up("renewing the certificate", move || {
            tls.clone().keep_renewed()
        }));
    }
    let listening = Listening {
        listener,
        tls,
        limits: config.connections,
        stopping: stopping.clone(),
        app: http::router(state),
    };
    let serving = listening.serve();
    tokio::pin!(serving);
    tracing::info!(%address, "serving");
    ready(address);

    tokio::select! {
        () = &mut serving => {}
        () = shutdown => {
            tracing::info!("stopping");
            stopping.cancel();
            // a client that never finishes its request does not keep the server
            let _ = tokio::time::timeout(SHUTDOWN_GRACE, serving).await;
        }
    }
    for task in tasks {
        task.abort();
    }
    Ok(())
}

/// Does some work on a store on one server of its database at a time.
async fn as_duty<F: Future<Output = ()>>(
    store: Store,
    name: &'static str,
    work: impl FnOnce(Store) -> F,
) {
    store.as_duty(name, work(store.clone())).await;
}

/// Runs a task that should not end, and again should it end after all, until aborted.
fn keep_up<F: Future<Output = ()> + Send + 'static>(
    name: &'static str,
    task: impl Fn() -> F + Send + 'static,
) -> JoinHandle<()> {
    kept_up(name, Box::new(move || tasks::spawn(task())))
}

fn kept_up(name: &'static str, begin: Box<dyn Fn() -> JoinHandle<()> + Send>) -> JoinHandle<()> {
    tasks::spawn(async move {
        loop {
            let end = AbortOnDropHandle::new(begin()).await;
            tracing::error!(task = name, ?end, "a task ended and is started again");
            tokio::time::sleep(BEFORE_RESTART).await;
        }
    })
}
