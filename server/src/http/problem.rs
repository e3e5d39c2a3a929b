//! Errors as `application/problem+json`, whoever made them.
use std::error::Error;
use std::io;

use axum::body::{Body, to_bytes};
use axum::extract::Request;
use axum::http::{HeaderName, HeaderValue, Response as HttpResponse, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use loadframe_api::{Problem, SubmissionError, Violation};

use super::query::violation;
use crate::store::StoreError;
use crate::tasks::NotDone;

/// Media type of every error answer.
pub const PROBLEM_JSON: &str = "application/problem+json";

/// A kind of problem: its stable name and what it always says.
#[derive(Clone, Copy, Debug)]
pub struct ProblemKind {
    pub status: u16,
    pub slug: &'static str,
    pub title: &'static str,
}

macro_rules! problem_kinds {
    ($($name:ident = $status:literal, $slug:literal, $title:literal;)+) => {
        $(pub const $name: ProblemKind = ProblemKind { status: $status, slug: $slug, title: $title };)+

        /// Every kind the service answers with.
        pub const ALL: &[ProblemKind] = &[$($name),+];
    };
}

problem_kinds! {
    BAD_REQUEST = 400, "bad-request", "The request cannot be read";
    NOT_JSON = 400, "not-json", "The body is not JSON";
    TOKEN_NEEDED = 401, "token-needed", "A token is needed";
    SIGN_IN_NEEDED = 401, "sign-in-needed", "Signing in is needed";
    FORBIDDEN = 403, "not-allowed", "This is not for you to do";
    WRONG_PASSWORD = 403, "wrong-password", "Name or password is wrong";
    FOREIGN_ORIGIN = 403, "foreign-origin", "A page of another origin sent this";
    IN_THE_CLEAR = 403, "in-the-clear", "A password would travel in the clear";
    FOREIGN_HOST = 403, "foreign-host", "This server answers its own machine only";
    NOT_FOUND = 404, "not-found", "There is no such thing";
    METHOD_NOT_ALLOWED = 405, "method-not-allowed", "This cannot be done here";
    TOO_SLOW = 408, "too-slow", "The body did not arrive in time";
    CONFLICT = 409, "conflict", "The job's state does not allow it";
    LEASE_LOST = 409, "lease-lost", "The lease is no longer held";
    CHANGED_SINCE = 412, "changed-since", "The job has been changed since";
    TOO_LARGE = 413, "too-large", "The body is too large";
    NOT_JSON_TYPE = 415, "unsupported-media-type", "The body must be sent as JSON";
    RANGE = 416, "range-not-satisfiable", "The file has no such range";
    INVALID_JOB = 422, "invalid-job", "The job cannot be accepted";
    INVALID = 422, "invalid-request", "The request cannot be accepted";
    KEY_REUSED = 422, "idempotency-key-reused", "The Idempotency-Key was used before";
    TOO_MANY_REQUESTS = 429, "too-many-requests", "Too many requests";
    TOO_MANY_GUESSES = 429, "too-many-guesses", "Too many wrong tokens or passwords";
    INTERNAL = 500, "internal", "The server failed";
    FILE_LOST = 500, "file-lost", "A stored file is lost";
    STORAGE_FULL = 507, "storage-full", "The server's disk is full";
    BUSY = 503, "busy", "The server is busy";
}

/// An error on its way to a client.
#[derive(Debug)]
pub struct ApiError {
    problem: Box<Problem>,
    headers: Vec<(HeaderName, HeaderValue)>,
}

/// What handlers return.
pub type Result<T, E = ApiError> = std::result::Result<T, E>;

impl ApiError {
    pub fn new(kind: ProblemKind, detail: impl Into<String>) -> Self {
        Problem::new(kind.status, kind.slug, kind.title, detail).into()
    }

    /// 404: `what` is not there.
    pub fn not_found(what: impl std::fmt::Display) -> Self {
        Self::new(NOT_FOUND, format!("there is no {what}"))
    }

    /// With each thing wrong with the request.
    pub fn violations(mut self, violations: Vec<Violation>) -> Self {
        self.problem.violations = violations;
        self
    }

    /// 503: try again after `seconds`.
    pub fn busy(detail: &str, seconds: u32) -> Self {
        Self::later(BUSY, detail, seconds)
    }

    /// What may be tried again after `seconds`.
    pub fn later(kind: ProblemKind, detail: impl Into<String>, seconds: u32) -> Self {
        Self::new(kind, detail).with(header::RETRY_AFTER, seconds.into())
    }

    /// Its status code.
    pub(super) fn status(&self) -> u16 {
        self.problem.status
    }

    /// Whether it says that something is not there.
    pub(super) fn is_missing(&self) -> bool {
        self.status() == NOT_FOUND.status
    }

    /// With a header.
    pub fn with(mut self, name: HeaderName, value: HeaderValue) -> Self {
        self.headers.push((name, value));
        self
    }
}

impl From<Problem> for ApiError {
    fn from(problem: Problem) -> Self {
        Self {
            problem: Box::new(problem),
            headers: Vec::new(),
        }
    }
}

impl From<SubmissionError> for ApiError {
    fn from(error: SubmissionError) -> Self {
        error.into_problem().into()
    }
}

impl From<NotDone> for ApiError {
    fn from(error: NotDone) -> Self {
        Self::internal(&error)
    }
}

impl From<StoreError> for ApiError {
    fn from(error: StoreError) -> Self {
        let detail = error.to_string();
        match error {
            StoreError::NotFound(_) => Self::new(NOT_FOUND, detail),
            StoreError::Conflict(_) => Self::new(CONFLICT, detail),
            StoreError::LeaseLost => Self::new(LEASE_LOST, detail),
            StoreError::Edited => Self::new(CHANGED_SINCE, detail),
            StoreError::KeyReused => Self::new(KEY_REUSED, detail),
            StoreError::Invalid(_) => Self::new(INVALID, detail),
            StoreError::Refused(violations) => {
                Self::new(INVALID, "see what is wrong with it").violations(violations)
            }
            StoreError::TooLarge { .. } => Self::new(TOO_LARGE, detail),
            StoreError::Lost { .. } => {
                tracing::error!(error = %detail, "a stored file is lost");
                Self::new(FILE_LOST, detail)
            }
            StoreError::Interrupted(ref cause) if is_too_slow(cause) => too_slow(),
            StoreError::Interrupted(_) => Self::new(BAD_REQUEST, detail),
            StoreError::Full => Self::later(STORAGE_FULL, detail, 10),
            StoreError::Bucket { .. } => {
                tracing::error!(error = %crate::store::chain(&error), "the bucket of files");
                Self::busy(&detail, 5)
            }
            StoreError::Unavailable | StoreError::InUse(_) => Self::busy(&detail, 1),
            fault => Self::internal(&fault),
        }
    }
}

impl ApiError {
    /// 500: the cause goes to the log, not to the client.
    pub fn internal(fault: &dyn std::error::Error) -> Self {
        let mut chain = fault.to_string();
        let mut cause = fault.source();
        while let Some(error) = cause {
            chain.push_str(&format!(": {error}"));
            cause = error.source();
        }
        tracing::error!(error = %chain, "a request failed by the server's fault");
        Self::new(INTERNAL, "the server's log says more")
    }
}

impl IntoResponse for ApiError {
    fn into_response(self) -> Response {
        let status =
            StatusCode::from_u16(self.problem.status).unwrap_or(StatusCode::INTERNAL_SERVER_ERROR);
        let body = serde_json::to_vec(&self.problem).unwrap_or_default();
        let mut response = (status, [(header::CONTENT_TYPE, PROBLEM_JSON)], body).into_response();
        response.headers_mut().extend(self.headers);
        response
    }
}

/// Answer to a method a route does not have; axum adds `Allow`.
pub async fn method_not_allowed(request: Request) -> ApiError {
    let detail = format!("{} has no {}", request.uri().path(), request.method());
    ApiError::new(METHOD_NOT_ALLOWED, detail)
}

/// Answer to a request whose handler panicked.
pub fn after_panic(cause: Box<dyn std::any::Any + Send>) -> HttpResponse<Body> {
    let text = cause
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| cause.downcast_ref::<&str>().copied());
    tracing::error!(
        panic = text.unwrap_or("without a message"),
        "a handler panicked"
    );
    ApiError::new(INTERNAL, "the server's log says more").into_response()
}

/// Puts the framework's own refusals, which are plain text or nothing, into the common form.
pub async fn only_problems(request: Request, next: Next) -> Response {
    /// A refusal's text is a sentence; more is not meant for people.
    const LONGEST_TEXT: usize = 4096;
    let uri = request.uri().clone();
    let response = next.run(request).await;
    let status = response.status();
    let is_error = status.is_client_error() || status.is_server_error();
    let media_type = response.headers().get(header::CONTENT_TYPE);
    if !is_error || media_type.is_some_and(|value| value == PROBLEM_JSON) {
        return response;
    }
    let (mut parts, body) = response.into_parts();
    let text = to_bytes(body, LONGEST_TEXT).await.unwrap_or_default();
    let text = String::from_utf8_lossy(&text);
    let kind = ALL.iter().find(|kind| kind.status == status.as_u16());
    let title = kind.map_or("The request was refused", |kind| kind.title);
    let slug = kind.map_or("refused", |kind| kind.slug);
    let detail = match text.trim() {
        "" => status.canonical_reason().unwrap_or(title),
        text if status.is_client_error() => text,
        _ => "the server's log says more",
    };
    let (violations, detail) = match violation(&uri, detail) {
        Some((violation, sentence)) => (vec![violation], sentence),
        None => (Vec::new(), detail.to_owned()),
    };
    let problem = ApiError::from(Problem::new(status.as_u16(), slug, title, detail));
    let problem = problem.violations(violations);
    parts.headers.remove(header::CONTENT_TYPE);
    parts.headers.remove(header::CONTENT_LENGTH);
    let mut response = problem.into_response();
    response.headers_mut().extend(parts.headers);
    response
}

/// Of a body that came too slowly.
pub(super) fn too_slow() -> ApiError {
    ApiError::new(TOO_SLOW, "the body did not go on in time")
}

/// Whether the connection ended the body because it came too slowly.
pub(super) fn is_too_slow(error: &(dyn Error + 'static)) -> bool {
    let mut cause = Some(error);
    while let Some(error) = cause {
        let own = error.downcast_ref::<io::Error>();
        if own.is_some_and(|error| error.kind() == io::ErrorKind::TimedOut) {
            return true;
        }
        cause = error.source();
    }
    false
}
