//! The middleware that lets requests pass or refuses them, by the rules of [`super::access`].
use std::net::{IpAddr, SocketAddr};
use std::time::{Duration, Instant};

use axum::extract::{ConnectInfo, Request, State};
use axum::http::{HeaderMap, HeaderValue, header};
use axum::middleware::Next;
use axum::response::Response;

use super::access::{Access, WrongTokens, bearer, check_names, is_guarded};
use super::problem::{ApiError, Result, TOKEN_NEEDED, TOO_MANY_GUESSES};
use super::state::AppState;

/// How long every further guess takes.
const PAUSE: Duration = Duration::from_secs(1);

/// Lets a request pass or refuses it.
pub(super) async fn guard(
    State(state): State<AppState>,
    request: Request,
    next: Next,
) -> Result<Response> {
    match &*state.access {
        Access::Open { hosts } => check_names(hosts, request.uri(), request.headers())?,
        Access::Token { wrong_tokens } if is_guarded(request.uri().path()) => {
            let peer = request.extensions().get::<ConnectInfo<SocketAddr>>();
            let peer = peer.map(|ConnectInfo(address)| address.ip());
            check_token(&state, wrong_tokens, request.headers(), peer).await?;
        }
        Access::Token { .. } => {}
    }
    Ok(next.run(request).await)
}

async fn check_token(
    state: &AppState,
    wrong_tokens: &WrongTokens,
    headers: &HeaderMap,
    peer: Option<IpAddr>,
) -> Result<()> {
    let refuse = |detail: &str| {
        ApiError::new(TOKEN_NEEDED, detail).with(
            header::WWW_AUTHENTICATE,
            HeaderValue::from_static("Bearer realm=\"loadframe\""),
        )
    };
    let Some(secret) = bearer(headers) else {
        return Err(refuse(
            "send `Authorization: Bearer TOKEN`; `loadframe token create` on the server makes one",
        ));
    };
    if state.store.check_token(secret).await? {
        return Ok(());
    }
    let Some(peer) = peer else {
        return Err(refuse("this token is not in force"));
    };
    match wrong_tokens.count(peer, Instant::now()) {
        Ok(()) => Err(refuse("this token is not in force")),
        Err(wait) => {
            // a right token always passes, so that one lost worker cannot lock out its whole network
            tokio::time::sleep(PAUSE).await;
            let detail = "too many wrong tokens came from your address";
            let seconds = u32::try_from(wait.as_secs() + 1).unwrap_or(u32::MAX);
            Err(ApiError::new(TOO_MANY_GUESSES, detail).with(header::RETRY_AFTER, seconds.into()))
        }
    }
}
