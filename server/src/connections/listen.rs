//! Accepting connections and answering what comes over them.
use std::convert::Infallible;
use std::io;
use std::net::SocketAddr;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll, ready};
use std::time::Duration;

use axum::Router;
use axum::body::{Body, Bytes, HttpBody};
use axum::extract::{ConnectInfo, Request};
use axum::response::Response;
use hyper::body::{Frame, Incoming, SizeHint};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::TokioIo;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::{TcpListener, TcpStream};
use tokio::time::timeout;
use tokio_util::sync::CancellationToken;
use tokio_util::task::TaskTracker;
use tower::ServiceExt;

use super::descriptors::affordable;
use super::limits::ConnectionLimits;
use super::line::Line;
use super::places::{Place, Places};
use super::standing::{Phase, Standing};
use super::tls::Tls;

/// Largest head of a request, and what is collected of an answer before it is written [bytes].
const BUFFER: usize = 64 << 10;
/// Wait after the system gave no connection.
const AFTER_FAILURE: Duration = Duration::from_millis(50);
/// Said to who finds no place, where it can be said without a handshake.
const NO_PLACE: &str = r#"{"type":"/problems/busy","title":"The server is busy","status":503,"detail":"all connections are in use"}"#;

/// A listener with all that a connection needs.
#[derive(Debug)]
pub struct Listening {
    pub listener: TcpListener,
    /// What answers.
    pub app: Router,
    /// With it, TLS is spoken.
    pub tls: Option<Arc<Tls>>,
    pub limits: ConnectionLimits,
    /// Cancelled when no more requests are to be taken.
    pub stopping: CancellationToken,
}

/// What all connections share.
#[derive(Debug)]
struct Shared {
    app: Router,
    tls: Option<Arc<Tls>>,
    limits: ConnectionLimits,
    stopping: CancellationToken,
}

impl Listening {
    /// Answers until told to stop, and then until the last answer is given.
    pub async fn serve(self) {
        let limits = ConnectionLimits {
            in_all: affordable(self.limits.in_all),
            ..self.limits
        };
        let places = Places::new(&limits);
        let shared = Arc::new(Shared {
            app: self.app,
            tls: self.tls,
            limits,
            stopping: self.stopping,
        });
        let connections = TaskTracker::new();
        loop {
            let accepted = tokio::select! {
                accepted = self.listener.accept() => accepted,
                () = shared.stopping.cancelled() => break,
            };
            match accepted {
                Ok((stream, peer)) => match places.take(peer.ip()) {
                    Some(place) => {
                        metrics::gauge!("loadframe_connections").set(places.count() as f64);
                        connections.spawn(connection(shared.clone(), stream, peer, place));
                    }
                    None => refuse(&stream, shared.tls.is_none()),
                },
                Err(error) if is_of_the_client(&error) => {}
                Err(error) => {
                    let displaced = places.displace_one();
                    tracing::warn!(%error, displaced, "the system gives no further connection");
                    tokio::time::sleep(AFTER_FAILURE).await;
                }
            }
        }
        // a client that comes now finds nobody instead of waiting for what does not come
        drop(self.listener);
        connections.close();
        connections.wait().await;
    }
}

fn refuse(stream: &TcpStream, can_be_told: bool) {
    metrics::counter!("loadframe_connections_ended_total", "cause" => "refused").increment(1);
    if can_be_told {
        let answer = format!(
            "HTTP/1.1 503 Service Unavailable\r\nContent-Type: application/problem+json\r\nRetry-After: 5\r\nConnection: close\r\nContent-Length: {}\r\n\r\n{NO_PLACE}",
            NO_PLACE.len()
        );
        // a fresh connection takes so few bytes at once, or its client is gone
        let _ = stream.try_write(answer.as_bytes());
    }
}

/// Whether accepting failed by the fault of who connected.
fn is_of_the_client(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::ConnectionRefused
            | io::ErrorKind::ConnectionAborted
            | io::ErrorKind::ConnectionReset
    )
}

async fn connection(shared: Arc<Shared>, stream: TcpStream, peer: SocketAddr, place: Place) {
    // an answer is often one small packet: waiting to fill it would add 40 ms
    if let Err(error) = stream.set_nodelay(true) {
        tracing::debug!(%error, "TCP_NODELAY was refused");
    }
    let standing = place.standing.clone();
    let line = Line::new(stream, standing.clone(), shared.limits);
    let talk = async {
        match &shared.tls {
            None => answer(&shared, line, peer, &standing).await,
            Some(tls) => match timeout(shared.limits.head, tls.acceptor().accept(line)).await {
                Ok(Ok(line)) => answer(&shared, line, peer, &standing).await,
                Ok(Err(error)) => tracing::debug!(%error, %peer, "a handshake failed"),
                Err(_) => tracing::debug!(%peer, "a handshake took too long"),
            },
        }
    };
    tokio::select! {
        () = talk => {}
        () = standing.displaced.cancelled() => {}
    }
}

/// Answers the requests of one connection.
async fn answer<S>(shared: &Shared, line: S, peer: SocketAddr, standing: &Arc<Standing>)
where
    S: AsyncRead + AsyncWrite + Unpin + Send + 'static,
{
    let service = service_fn(|request: Request<Incoming>| {
        let phase = match request.body().is_end_stream() {
            true => Phase::Answer,
            false => Phase::Body,
        };
        standing.enter(phase);
        let end = AtEnd::new(standing, Phase::Body, Phase::Answer);
        let mut request = request.map(|body| Body::new(Watched { body, end }));
        request.extensions_mut().insert(ConnectInfo(peer));
        let answered = AtEnd::new(standing, Phase::Answer, Phase::Idle);
        let response = shared.app.clone().oneshot(request);
        async move {
            let response: Response = response.await?;
            // an answer may come before the end of its request
            answered.standing.leave(Phase::Body, Phase::Answer);
            let watch = |body| Watched {
                body,
                end: answered,
            };
            Ok::<_, Infallible>(response.map(watch))
        }
    });
    // the line knows all waits; hyper would take those between requests for those within
    let connection = http1::Builder::new()
        .header_read_timeout(None)
        .max_buf_size(BUFFER)
        .serve_connection(TokioIo::new(line), service);
    tokio::pin!(connection);
    let end = tokio::select! {
        end = connection.as_mut() => end,
        () = shared.stopping.cancelled() => {
            connection.as_mut().graceful_shutdown();
            connection.await
        }
    };
    if let Err(error) = end {
        tracing::debug!(%error, %peer, "a connection broke off");
    }
}

/// Takes a connection from one phase to the next when it is dropped.
#[derive(Debug)]
struct AtEnd {
    standing: Arc<Standing>,
    from: Phase,
    to: Phase,
}

impl AtEnd {
    fn new(standing: &Arc<Standing>, from: Phase, to: Phase) -> Self {
        Self {
            standing: standing.clone(),
            from,
            to,
        }
    }
}

impl Drop for AtEnd {
    fn drop(&mut self) {
        self.standing.leave(self.from, self.to);
    }
}

/// A body whose end is noted.
#[derive(Debug)]
struct Watched<B> {
    body: B,
    end: AtEnd,
}

impl<B: HttpBody<Data = Bytes> + Unpin> HttpBody for Watched<B> {
    type Data = Bytes;
    type Error = B::Error;

    fn poll_frame(
        self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, B::Error>>> {
        let watched = self.get_mut();
        let frame = ready!(Pin::new(&mut watched.body).poll_frame(context));
        let end = &watched.end;
        if end.from == Phase::Body && (frame.is_none() || watched.body.is_end_stream()) {
            // read to its end: what the client waits for now is the answer
            end.standing.leave(end.from, end.to);
        }
        Poll::Ready(frame)
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}
