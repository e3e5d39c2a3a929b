//! The middleware before every route: it finds out who asks, by [`super::access`], and refuses whoever
//! is nobody. What is allowed then is asked by the routes themselves, by [`super::permit`].
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::extract::{ConnectInfo, Request, State};
use axum::http::{HeaderValue, Method, header};
use axum::middleware::Next;
use axum::response::Response;
use uuid::Uuid;

use super::access::{Sender, is_guarded};
use super::identify::{Given, Identified, identify, note_visit};
use super::origin::is_safe;
use super::permit::{Call, Trace};
use super::problem::{
    ApiError, FORBIDDEN, Result, SIGN_IN_NEEDED, TOKEN_NEEDED, TOO_MANY_GUESSES, TOO_MANY_REQUESTS,
};
use super::state::AppState;
use crate::access::{Caller, Pace};

/// How long every further guess takes.
const PAUSE: Duration = Duration::from_secs(1);

/// Routes for who is nobody yet.
const BEFORE_SIGN_IN: &[(Method, &str)] = &[
    (Method::POST, "/v1/sessions"),
    (Method::POST, "/v1/invitations/accept"),
    (Method::GET, "/v1/sign-in"),
    (Method::HEAD, "/v1/sign-in"),
    (Method::POST, "/v1/sign-in/provider"),
    (Method::GET, "/v1/sign-in/provider"),
];

/// Lets a request pass or refuses it.
pub(super) async fn guard(
    State(state): State<AppState>,
    mut request: Request,
    next: Next,
) -> Result<Response> {
    let peer = request.extensions().get::<ConnectInfo<SocketAddr>>();
    let peer = peer.map(|ConnectInfo(address)| address.ip());
    let trace = Trace {
        request: Uuid::now_v7(),
        address: state.access.client_address(peer, request.headers()),
    };
    let names = &state.access.names;
    if state.access.is_open() {
        names.check_host(request.uri(), request.headers())?;
        names.check_origin(request.method(), request.uri(), request.headers())?;
    }
    if is_guarded(request.uri().path()) {
        let identified = identify(&state, peer, &trace, request.headers()).await?;
        let Identified {
            caller,
            given,
            versions,
        } = identified;
        let comes_by_itself = matches!(given, Given::Cookie | Given::Proxy(_));
        if comes_by_itself && !is_safe(request.method()) {
            names.demand_origin(request.method(), request.uri(), request.headers())?;
        }
        let path = request.uri().path();
        let is_open = |(method, of): &(Method, &str)| method == request.method() && *of == path;
        let pace = match is_heartbeat(request.method(), path) {
            true => &state.access.heartbeats,
            false => &state.access.pace,
        };
        count(pace, caller.as_ref(), &trace)?;
        match caller {
            Some(caller) => {
                note_visit(&state, &caller, &trace).await;
                let call = Call {
                    caller,
                    trace,
                    versions,
                };
                request.extensions_mut().insert(Arc::new(call));
            }
            None if BEFORE_SIGN_IN.iter().any(is_open) => {}
            None => return Err(refuse(&state, &given, &trace).await),
        }
    } else {
        count(&state.access.pace, None, &trace)?;
    }
    request.extensions_mut().insert(trace);
    let mut response = next.run(request).await;
    let id = HeaderValue::try_from(trace.request.to_string());
    if let Ok(id) = id {
        response.headers_mut().insert("x-request-id", id);
    }
    Ok(response)
}

fn is_heartbeat(method: &Method, path: &str) -> bool {
    let lease = path.strip_prefix("/v1/worker/leases/");
    method == Method::POST && lease.is_some_and(|lease| lease.ends_with("/heartbeat"))
}

/// Counts a request with those of its sender.
///
/// # Errors
/// 429 when they are too many a second.
fn count(pace: &Pace<Sender>, caller: Option<&Caller>, trace: &Trace) -> Result<()> {
    let Some(sender) = Sender::of(caller, trace.address) else {
        return Ok(());
    };
    let Err(wait) = pace.take(sender, Instant::now()) else {
        return Ok(());
    };
    let (of, whose) = match sender {
        Sender::Address(_) => ("address", "from your address"),
        Sender::Credential(_) | Sender::Workers | Sender::Owner => ("token", "with this token"),
    };
    metrics::counter!("loadframe_requests_refused_total", "of" => of).increment(1);
    let detail = format!(
        "requests {whose} come faster than {} a second",
        pace.per_s()
    );
    Err(ApiError::later(TOO_MANY_REQUESTS, detail, seconds(wait)))
}

/// Whole seconds to wait.
fn seconds(wait: Duration) -> u32 {
    u32::try_from(wait.as_secs() + 1).unwrap_or(u32::MAX)
}

/// What to say to somebody who is nobody.
async fn refuse(state: &AppState, given: &Given, trace: &Trace) -> ApiError {
    let (kind, how) = match state.store.has_people() {
        true => (
            SIGN_IN_NEEDED,
            "sign in on the page, or send `Authorization: Bearer TOKEN`",
        ),
        false => (
            TOKEN_NEEDED,
            "send `Authorization: Bearer TOKEN`; `loadframe token create` on the server makes one",
        ),
    };
    let refusal = |detail: &str| {
        let bearer = HeaderValue::from_static("Bearer realm=\"loadframe\"");
        ApiError::new(kind, detail).with(header::WWW_AUTHENTICATE, bearer)
    };
    match given {
        Given::Nothing => return refusal(how),
        Given::Proxy(name) => {
            let detail = format!(
                "{name:?} has no account here and is not invited; ask an administrator of this server"
            );
            return ApiError::new(FORBIDDEN, detail);
        }
        Given::Cookie => return refusal("the session has ended; sign in again"),
        Given::Bearer | Given::Link => {}
    }
    let counted = trace.address.map(|address| {
        let wrong_tokens = &state.access.wrong_tokens;
        wrong_tokens.count(address, Instant::now())
    });
    match counted {
        Some(Err(wait)) => {
            // a right token always passes, so that one lost worker cannot lock out its whole network
            tokio::time::sleep(PAUSE).await;
            too_many("too many wrong tokens came from your address", wait)
        }
        _ if *given == Given::Link => refusal(
            "this link is not in force: it has expired or was taken back, or what it showed was deleted",
        ),
        _ => refusal("this token is not in force"),
    }
}

/// 429: the guesses were too many.
pub(super) fn too_many(detail: &str, wait: Duration) -> ApiError {
    ApiError::later(TOO_MANY_GUESSES, detail, seconds(wait))
}
