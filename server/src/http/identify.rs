//! Who sends a request, by what it was given.
use std::net::IpAddr;
use std::time::Instant;

use axum::http::HeaderMap;
use loadframe_api::people::Scope;
use loadframe_api::sha256_hex;

use super::access::{LINK, PLAIN_COOKIE, SECURE_COOKIE, bearer, cookie, is_same};
use super::permit::Trace;
use super::problem::Result;
use super::state::AppState;
use crate::access::{Caller, Credential};
use crate::single_sign_on::Vouched;
use crate::store::people::{Arrival, Versions};

/// How a request tries to be known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Given {
    Nothing,
    Bearer,
    /// The secret of a link, as a bearer.
    Link,
    Cookie,
    /// The word of a proxy, for this name.
    Proxy(String),
}

/// Who sends a request.
pub(super) struct Identified {
    pub(super) caller: Option<Caller>,
    /// How it tried to be known.
    pub(super) given: Given,
    /// How often things had changed by then, where it was looked up for that.
    pub(super) versions: Option<Versions>,
}

impl Identified {
    fn of(caller: Option<Caller>, given: Given) -> Self {
        Self {
            caller,
            given,
            versions: None,
        }
    }

    fn found(found: Option<(Caller, Versions)>, given: Given) -> Self {
        let (caller, versions) = found.unzip();
        Self {
            caller,
            given,
            versions,
        }
    }
}

/// Who sends a request with these headers, over a connection with `peer`.
pub(super) async fn identify(
    state: &AppState,
    peer: Option<IpAddr>,
    trace: &Trace,
    headers: &HeaderMap,
) -> Result<Identified> {
    let (access, store) = (&state.access, &state.store);
    let has_people = store.has_people();
    if access.is_open && !has_people {
        let sole = Caller::sole(Scope::Everything);
        return Ok(Identified::of(Some(sole), Given::Nothing));
    }
    if let Some(secret) = bearer(headers) {
        let sha256 = sha256_hex(secret.as_bytes());
        if is_same(access.own.as_deref(), &sha256) {
            // among people nobody is without a name: what the server was started with only works
            let caller = match has_people {
                true => Caller::worker(),
                false => Caller::sole(Scope::Everything),
            };
            return Ok(Identified::of(Some(caller), Given::Bearer));
        }
        if is_same(access.workers.as_deref(), &sha256) {
            return Ok(Identified::of(Some(Caller::worker()), Given::Bearer));
        }
        if secret.starts_with(LINK) {
            let caller = store.caller_by_link(&sha256).await?;
            return Ok(Identified::of(caller, Given::Link));
        }
        let found = store.caller_by_token(&sha256).await?;
        return Ok(Identified::found(found, Given::Bearer));
    }
    let sign_on = access.single_sign_on.as_ref().filter(|_| has_people);
    if let Some(vouched) = sign_on.and_then(|of| of.vouched_by_proxy(peer, headers)) {
        let caller = caller_of_proxy(state, trace, &vouched).await?;
        return Ok(Identified::of(caller, Given::Proxy(vouched.subject)));
    }
    for (name, is_secure) in [(SECURE_COOKIE, true), (PLAIN_COOKIE, false)] {
        if let Some(secret) = cookie(headers, name) {
            let sha256 = sha256_hex(secret.as_bytes());
            let found = store.caller_by_session(&sha256, is_secure).await?;
            return Ok(Identified::found(found, Given::Cookie));
        }
    }
    Ok(Identified::of(None, Given::Nothing))
}

/// The person for whom the proxy vouches; who comes for the first time gets an account, if anybody may.
async fn caller_of_proxy(
    state: &AppState,
    trace: &Trace,
    vouched: &Vouched,
) -> Result<Option<Caller>> {
    let (issuer, subject) = (&vouched.issuer, &vouched.subject);
    let known = state.store.caller_by_identity(issuer, subject).await?;
    let Some(sign_on) = state
        .access
        .single_sign_on
        .as_deref()
        .filter(|_| known.is_none())
    else {
        return Ok(known);
    };
    let store = state.store.acting(trace.actor(None));
    let admission = sign_on.admission(vouched);
    match store.arrive(vouched.identity(), None, admission).await? {
        Arrival::Known(..) => Ok(store.caller_by_identity(issuer, subject).await?),
        Arrival::NotAdmitted | Arrival::Taken => Ok(None),
    }
}

/// Counts the visit of a link.
pub(super) async fn note_visit(state: &AppState, caller: &Caller, trace: &Trace) {
    let Credential::Link(id) = caller.credential else {
        return;
    };
    if state.access.is_new_visit(id, trace.address, Instant::now()) {
        let counted = state
            .store
            .acting(trace.actor(Some(caller)))
            .count_visit(id)
            .await;
        if let Err(error) = counted {
            tracing::error!(%error, "a visit was not counted");
        }
    }
}
