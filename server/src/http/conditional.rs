//! Entity tags: an answer the client has already is not sent again.
use axum::Json;
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use loadframe_api::sha256_hex;
use serde::Serialize;

use super::problem::{ApiError, CHANGED_SINCE, Result};

/// An entity tag.
#[derive(Clone, Debug)]
pub(super) struct EntityTag(HeaderValue);

impl EntityTag {
    /// Weak tag of something that changes when `version` does, or when the service itself does.
    pub(super) fn weak(version: impl std::fmt::Display) -> Self {
        Self::of(format!("W/\"{}-{version}\"", crate::COMMIT))
    }

    /// Weak tag of a job of this version in a project of this name.
    pub(super) fn of_job((version, project): (u64, Option<String>)) -> Self {
        match project {
            // the version last, where [`Self::version_to_match`] looks for it
            Some(name) => Self::weak(format_args!(
                "{}-{version}",
                &sha256_hex(name.as_bytes())[..16]
            )),
            None => Self::weak(version),
        }
    }

    /// Strong tag of bytes with this hash.
    pub(super) fn strong(hash: &str) -> Self {
        Self::of(format!("\"{hash}\""))
    }

    fn of(text: String) -> Self {
        let value = HeaderValue::try_from(text);
        Self(value.unwrap_or_else(|_| HeaderValue::from_static("W/\"\"")))
    }

    /// The value of an `ETag` header.
    pub(super) fn header(&self) -> HeaderValue {
        self.0.clone()
    }

    /// Whether `If-None-Match` names this tag.
    pub(super) fn is_known(&self, headers: &HeaderMap) -> bool {
        let own = opaque(self.0.to_str().unwrap_or(""));
        headers
            .get_all(header::IF_NONE_MATCH)
            .iter()
            .filter_map(|value| value.to_str().ok())
            .flat_map(|value| value.split(','))
            .any(|tag| tag.trim() == "*" || opaque(tag.trim()) == own)
    }

    /// The newest version that `If-Match` names, in tags of [`Self::weak`] of this build or another, or
    /// as the number of an event; `None` when any will do.
    ///
    /// Tags of jobs are weak, because jobs change while nobody edits them; and so they are compared here,
    /// where RFC 9110 (13.1.1) would have none of them match.
    ///
    /// # Errors
    /// 412 when there is no version among the tags.
    pub(super) fn version_to_match(headers: &HeaderMap) -> Result<Option<u64>> {
        let values = headers.get_all(header::IF_MATCH).iter();
        let texts = values.map(|value| value.to_str().unwrap_or(""));
        let tags: Vec<&str> = texts
            .flat_map(|text| text.split(','))
            .map(str::trim)
            .collect();
        if tags.is_empty() || tags.contains(&"*") {
            return Ok(None);
        }
        let version = |tag: &str| {
            let inner = opaque(tag).strip_prefix('"')?.strip_suffix('"')?;
            let number = inner.rsplit_once('-').map_or(inner, |(_, number)| number);
            number.parse().ok()
        };
        match tags.into_iter().filter_map(version).max() {
            Some(newest) => Ok(Some(newest)),
            None => {
                let detail = "If-Match names no `ETag` of this job; read it again";
                Err(ApiError::new(CHANGED_SINCE, detail))
            }
        }
    }

    /// Whether a range may be sent: there is no `If-Range`, or it names exactly this tag.
    pub(super) fn allows_range(&self, headers: &HeaderMap) -> bool {
        headers
            .get(header::IF_RANGE)
            .is_none_or(|tag| tag == self.0)
    }

    /// 304, for a client that has this already.
    pub(super) fn not_modified(&self) -> Response {
        let headers = [
            (header::ETAG, self.header()),
            (header::CACHE_CONTROL, HeaderValue::from_static("no-cache")),
        ];
        (StatusCode::NOT_MODIFIED, headers).into_response()
    }

    /// `value` as JSON under this tag.
    pub(super) fn json(&self, value: &impl Serialize) -> Response {
        let headers = [
            (header::ETAG, self.header()),
            (header::CACHE_CONTROL, HeaderValue::from_static("no-cache")),
        ];
        (headers, Json(value)).into_response()
    }
}

/// The part that weak comparison compares (RFC 9110, 8.8.3.2).
fn opaque(tag: &str) -> &str {
    tag.strip_prefix("W/").unwrap_or(tag)
}
