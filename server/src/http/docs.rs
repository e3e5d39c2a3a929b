//! `/docs`: the OpenAPI document as a page for people.
use axum::Router;

use super::AppState;

pub(super) fn router() -> Router<AppState> {
    Router::new()
}
