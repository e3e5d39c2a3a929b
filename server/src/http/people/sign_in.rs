//! `/v1/sign-in`: single sign-on by a provider of OpenID Connect.
//!
//! The page begins a sign-in and gets the provider's address; the browser keeps what must come back in a
//! sealed cookie, goes there, and comes back with a code, whatever became of it. What went wrong is told
//! by the page, in words that tell nothing of accounts; the log says more.
use std::sync::Arc;
use std::time::Instant;

use axum::Json;
use axum::extract::{Extension, Query, State};
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, Uri, header};
use axum::response::{IntoResponse, Response};
use loadframe_api::Timestamp;
use loadframe_api::people::{SignInBegun, SignInWays};
use serde::Deserialize;
use utoipa::IntoParams;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

use super::super::AppState;
use super::super::access::cookie as cookie_of;
use super::super::bounded::Text;
use super::super::guard::too_many;
use super::super::permit::{Call, Trace};
use super::super::problem::{ApiError, BUSY, Result};
use super::sessions::{demand_accounts, is_secure, session_cookie};
use crate::access::Credential;
use crate::single_sign_on::{LONGEST, Provider, SingleSignOn};
use crate::store::people::Arrival;

/// Cookie of a sign-in under way, over TLS and within one machine.
const SECURE: &str = "__Host-loadframe-sign-in";
const PLAIN: &str = "loadframe-sign-in";

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(ways))
        .routes(routes!(begin, end))
}

/// How can people sign in?
#[utoipa::path(get, operation_id = "read_sign_in", path = "/v1/sign-in", tag = "People",
    responses((status = 200, description = "The ways in", body = ref("#/components/schemas/SignInWays"))))]
async fn ways(State(state): State<AppState>) -> Json<SignInWays> {
    let provider = state.access.single_sign_on.as_deref();
    let provider = provider.and_then(SingleSignOn::provider);
    Json(SignInWays {
        accounts: state.store.has_people(),
        provider: provider.map(|of| of.name().to_owned()),
    })
}

/// Begin single sign-on
///
/// Answers where the browser goes on, with a cookie that it must bring back. Who is signed in already
/// gives that identity to their account.
#[utoipa::path(post, operation_id = "begin_sign_in", path = "/v1/sign-in/provider", tag = "People",
    responses((status = 200, description = "It has begun", body = ref("#/components/schemas/SignInBegun"), headers(("Set-Cookie" = String))),
              (status = 404, description = "This server has no provider of single sign-on"),
              (status = 409, description = "This server has no accounts"),
              (status = 503, description = "The provider does not answer")))]
async fn begin(
    State(state): State<AppState>,
    call: Option<Extension<Arc<Call>>>,
    method: Method,
    uri: Uri,
    headers: HeaderMap,
) -> Result<Response> {
    demand_accounts(&state)?;
    state.access.names.demand_origin(&method, &uri, &headers)?;
    is_secure(&state, &headers)?;
    let (sign_on, provider) = provider(&state)?;
    let signed_in = call.filter(|call| matches!(call.caller.credential, Credential::Session(_)));
    let person = signed_in.and_then(|call| call.caller.person().map(|person| person.id));
    let (address, started) = provider.begin(person).await.map_err(|error| {
        tracing::error!(error = %chain(&error), "single sign-on cannot begin");
        let detail = format!(
            "{} does not answer; the server's log says more",
            provider.name()
        );
        ApiError::later(BUSY, detail, 10)
    })?;
    let sealed = sign_on.seal().close(&started).unwrap_or_default();
    let mut response = Json(SignInBegun { address }).into_response();
    let cookie = cookie(&sealed, LONGEST / 1000, provider.is_secure())?;
    response.headers_mut().append(header::SET_COOKIE, cookie);
    Ok(response)
}

/// What a provider sends back with the browser.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
struct Returned {
    /// What to ask the provider with.
    #[param(value_type = String, required = false, min_length = 1, max_length = 4000)]
    code: Option<Text<1, 4000>>,
    /// What this server gave the browser on its way.
    #[param(value_type = String, required = false, min_length = 1, max_length = 200)]
    state: Option<Text<1, 200>>,
    /// Who answers (RFC 9207).
    #[param(value_type = String, required = false, min_length = 1, max_length = 1000)]
    iss: Option<Text<1, 1000>>,
}

/// End single sign-on
///
/// The address to which the provider sends the browser back. Leads on to the page, signed in or with the
/// reason why not.
#[utoipa::path(get, operation_id = "end_sign_in", path = "/v1/sign-in/provider", tag = "People",
    params(Returned),
    responses((status = 303, description = "To the page", headers(("Location" = String), ("Set-Cookie" = String))),
              (status = 404, description = "This server has no provider of single sign-on"),
              (status = 409, description = "This server has no accounts")))]
async fn end(
    State(state): State<AppState>,
    Extension(trace): Extension<Trace>,
    headers: HeaderMap,
    Query(returned): Query<Returned>,
) -> Result<Response> {
    demand_accounts(&state)?;
    let (sign_on, provider) = provider(&state)?;
    let wrong = &state.access.wrong_passwords;
    let slow = |wait| too_many("too many sign-ins from here failed, wait a moment", wait);
    wrong.check(&trace.address, Instant::now()).map_err(slow)?;
    let arrived = arrive(&state, sign_on, provider, &trace, &headers, returned).await?;
    let (place, session) = match arrived {
        Ok((person, name, place)) => {
            let client = headers.get(header::USER_AGENT);
            let client = client.and_then(|value| value.to_str().ok()).unwrap_or("");
            let mut actor = trace.actor(None);
            (actor.who, actor.person) = (name, Some(person));
            let store = state.store.acting(actor);
            let session = store
                .open_session(person, provider.is_secure(), client)
                .await?;
            (place.to_owned(), Some(session))
        }
        Err(reason) => {
            // the next one waits; what is told is told all the same
            let _ = wrong.count(trace.address, Instant::now());
            (format!("/sign-in?refused={reason}"), None)
        }
    };
    let place = HeaderValue::try_from(place).map_err(|error| ApiError::internal(&error))?;
    let mut response = (StatusCode::SEE_OTHER, [(header::LOCATION, place)]).into_response();
    let over = cookie("", 0, provider.is_secure())?;
    response.headers_mut().append(header::SET_COOKIE, over);
    if let Some(session) = session {
        let cookie = session_cookie(&session.secret, session.lifetime_s, provider.is_secure());
        let cookie = HeaderValue::try_from(cookie).map_err(|error| ApiError::internal(&error))?;
        response.headers_mut().append(header::SET_COOKIE, cookie);
    }
    Ok(response)
}

/// Who came, under which name, and where to; or why not, in a word that the page explains.
async fn arrive(
    state: &AppState,
    sign_on: &SingleSignOn,
    provider: &Provider,
    trace: &Trace,
    headers: &HeaderMap,
    returned: Returned,
) -> Result<std::result::Result<(Uuid, String, &'static str), &'static str>> {
    let name = if provider.is_secure() { SECURE } else { PLAIN };
    let kept =
        cookie_of(headers, name).and_then(|text| sign_on.seal().open(text, Timestamp::now()));
    let Some(started) = kept else {
        return Ok(Err("ended"));
    };
    // another browser's answer, or one to an earlier question
    if returned.state.map(|Text(state)| state).as_ref() != Some(&started.state) {
        return Ok(Err("ended"));
    }
    if returned
        .iss
        .is_some_and(|Text(issuer)| !provider.is_issuer(&issuer))
    {
        return Ok(Err("provider"));
    }
    let Some(Text(code)) = returned.code else {
        return Ok(Err("denied"));
    };
    let vouched = match provider.end(code, &started).await {
        Ok(vouched) => vouched,
        Err(error) => {
            tracing::warn!(error = %chain(&error), "single sign-on failed");
            return Ok(Err("provider"));
        }
    };
    let admission = sign_on.admission(&vouched);
    let store = state.store.acting(trace.actor(None));
    let arrival = store
        .arrive(vouched.identity(), started.person, admission)
        .await?;
    let place = if started.person.is_some() {
        "/account"
    } else {
        "/"
    };
    Ok(match arrival {
        Arrival::Known(person, name) => Ok((person, name, place)),
        Arrival::NotAdmitted => Err("not_admitted"),
        Arrival::Taken => Err("taken"),
    })
}

fn provider(state: &AppState) -> Result<(&SingleSignOn, &Provider)> {
    let sign_on = state.access.single_sign_on.as_deref();
    let found = sign_on.and_then(|of| Some((of, of.provider()?)));
    found.ok_or_else(|| ApiError::not_found("provider of single sign-on here"))
}

/// The cookie of a sign-in under way: the provider's page leads back here, so it may come from there.
fn cookie(value: &str, lifetime_s: i64, is_secure: bool) -> Result<HeaderValue> {
    let (name, secure) = if is_secure {
        (SECURE, " Secure;")
    } else {
        (PLAIN, "")
    };
    let text =
        format!("{name}={value}; Path=/; HttpOnly;{secure} SameSite=Lax; Max-Age={lifetime_s}");
    HeaderValue::try_from(text).map_err(|error| ApiError::internal(&error))
}

/// An error with its causes.
fn chain(error: &dyn std::error::Error) -> String {
    let causes = std::iter::successors(Some(error), |error| error.source());
    let causes: Vec<String> = causes.map(ToString::to_string).collect();
    causes.join(": ")
}
