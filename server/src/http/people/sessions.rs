//! `/v1/sessions`: signing in and out.
//!
//! Guessing is slowed down by address and by account, whether the account is there or not; a wrong name
//! costs the same time and gets the same answer as a wrong password.
use std::sync::Arc;
use std::time::Instant;

use axum::Json;
use axum::extract::{Extension, Path, State};
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, Uri, header};
use axum::response::{IntoResponse, Response};
use loadframe_api::Page;
use loadframe_api::people::{SessionView, SignIn};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

use super::super::AppState;
use super::super::access::{PLAIN_COOKIE, SECURE_COOKIE};
use super::super::body::{JsonBody, message};
use super::super::guard::too_many;
use super::super::origin::{Way, way};
use super::super::permit::{ManageOwn, Permit, Trace};
use super::super::problem::{ApiError, CONFLICT, FORBIDDEN, IN_THE_CLEAR, Result, WRONG_PASSWORD};
use crate::access::{Credential, password};
use crate::tasks::blocking;

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(list, sign_in))
        .routes(routes!(sign_out))
}

/// Sign in
///
/// Answers with a cookie that only this server's own page can use.
#[utoipa::path(post, operation_id = "sign_in", path = "/v1/sessions", tag = "People",
    request_body(content = ref("#/components/schemas/SignIn"), description = "Name and password"),
    responses((status = 204, description = "Signed in", headers(("Set-Cookie" = String))),
              (status = 403, description = "Name or password is wrong, the page is of another origin, or the password would travel in the clear"),
              (status = 408, description = "The body did not arrive in time"),
              (status = 409, description = "This server has no accounts"),
              (status = 413, description = "The body is too large"),
              (status = 415, description = "The body is not declared as JSON"),
              (status = 422, description = "The message does not fit its schema")))]
async fn sign_in(
    State(state): State<AppState>,
    Extension(trace): Extension<Trace>,
    method: Method,
    uri: Uri,
    headers: HeaderMap,
    body: JsonBody,
) -> Result<Response> {
    demand_accounts(&state)?;
    state.access.names.demand_origin(&method, &uri, &headers)?;
    let is_secure = is_secure(&state, &headers)?;
    let SignIn { name, password } = message(&state, body).await?;
    let person = check_password(&state, &trace, &name, password).await?;
    let client = headers.get(header::USER_AGENT);
    let client = client.and_then(|value| value.to_str().ok()).unwrap_or("");
    let mut actor = trace.actor(None);
    (actor.who, actor.person) = (name.trim().to_owned(), Some(person));
    let store = state.store.acting(actor);
    let session = store.open_session(person, is_secure, client).await?;
    let cookie = session_cookie(&session.secret, session.lifetime_s, is_secure);
    answer_with([cookie])
}

/// List my sessions
#[utoipa::path(get, operation_id = "list_sessions", path = "/v1/sessions", tag = "People",
    responses((status = 200, description = "Where you are signed in", body = ref("#/components/schemas/SessionViewPage"))))]
async fn list(permit: Permit<ManageOwn>) -> Result<Json<Page<SessionView>>> {
    let person = permit.call.person()?.id;
    let current = permit.call.caller.credential.id();
    let items = permit.store.sessions(person, current).await?;
    Ok(Json(Page::whole(items)))
}

/// End a session
///
/// `current` as id is the one that asks: signing out.
#[utoipa::path(delete, operation_id = "end_session", path = "/v1/sessions/{id}", tag = "People",
    params(("id" = String, Path, description = "Id of the session, or `current`", min_length = 1, max_length = 36)),
    responses((status = 204, description = "It has ended"),
              (status = 404, description = "You have no such session")))]
async fn sign_out(permit: Permit<ManageOwn>, Path(id): Path<String>) -> Result<Response> {
    let current = match permit.call.caller.credential {
        Credential::Session(id) => id,
        Credential::Proxy(_) => {
            let detail = "the proxy before this server signs you in; sign out there";
            return Err(ApiError::new(FORBIDDEN, detail));
        }
        _ => return Err(ApiError::new(FORBIDDEN, "you are not signed in")),
    };
    let id = match id.as_str() {
        "current" => current,
        text => {
            Uuid::try_parse(text).map_err(|_| ApiError::not_found(format!("session {text:?}")))?
        }
    };
    let person = permit.call.person()?.id;
    permit.store.close_session(person, id).await?;
    if id != current {
        return answer_with([]);
    }
    answer_with([session_cookie("", 0, true), session_cookie("", 0, false)])
}

/// Refuses to sign anybody in where there is nobody.
pub(super) fn demand_accounts(state: &AppState) -> Result<()> {
    if state.store.has_people() {
        return Ok(());
    }
    let detail = "this server is one person's: `loadframe people create-admin` makes it a group's";
    Err(ApiError::new(CONFLICT, detail))
}

/// Whether the page came over TLS; refuses passwords in the clear over a network.
pub(super) fn is_secure(state: &AppState, headers: &HeaderMap) -> Result<bool> {
    match way(headers) {
        Way::Secure => Ok(true),
        Way::Loopback => Ok(false),
        Way::Plain if state.access.plain_sign_in => Ok(false),
        Way::Plain => {
            let detail = "over a network, signing in needs https: give the server a certificate or a proxy that has one; `--plain-sign-in` takes passwords in the clear all the same";
            Err(ApiError::new(IN_THE_CLEAR, detail))
        }
    }
}

/// The person whose name and password these are.
pub(super) async fn check_password(
    state: &AppState,
    trace: &Trace,
    name: &str,
    given: String,
) -> Result<Uuid> {
    let access = &state.access;
    let account = name.trim().to_lowercase();
    let now = Instant::now();
    let slow = |wait| too_many("too many wrong passwords, wait a moment", wait);
    // counted before the comparison, which takes time: many at once are no way around
    access
        .wrong_passwords
        .count(trace.address, now)
        .map_err(slow)?;
    access
        .wrong_for_account
        .count(account.clone(), now)
        .map_err(slow)?;
    let known = state.store.password_of(&account).await?;
    let kept = known.as_ref().and_then(|(_, kept)| kept.clone());
    let turn = Arc::clone(&access.hashing).acquire_owned().await;
    let turn = turn.map_err(|error| ApiError::internal(&error))?;
    let compare = move || {
        let is_right = password::is_right(&given, kept.as_deref());
        drop(turn);
        is_right
    };
    let is_right = blocking(compare).await?;
    match known {
        Some((person, _)) if is_right => {
            access.wrong_passwords.forgive(&trace.address);
            access.wrong_for_account.forgive(&account);
            Ok(person)
        }
        _ => Err(ApiError::new(
            WRONG_PASSWORD,
            "try again, or ask an administrator",
        )),
    }
}

/// A session's cookie, for this very host, unseen by scripts, never sent by another site.
pub(super) fn session_cookie(secret: &str, lifetime_s: i64, is_secure: bool) -> String {
    let (name, secure) = match is_secure {
        true => (SECURE_COOKIE, " Secure;"),
        false => (PLAIN_COOKIE, ""),
    };
    format!("{name}={secret}; Path=/; HttpOnly;{secure} SameSite=Strict; Max-Age={lifetime_s}")
}

fn answer_with<const N: usize>(cookies: [String; N]) -> Result<Response> {
    let mut response = StatusCode::NO_CONTENT.into_response();
    for cookie in cookies {
        let value = HeaderValue::try_from(cookie).map_err(|error| ApiError::internal(&error))?;
        response.headers_mut().append(header::SET_COOKIE, value);
    }
    Ok(response)
}
