//! Comparing: many curves in one answer, what tells their jobs apart, measured curves, and comparisons
//! that are kept under a name.
//!
//! Every route begins with a [`selection`]: ids, a kept comparison, or what a list is filtered by. Only
//! what the caller sees is compared; any other id is `missing`, whether or not there is such a job.
//! [`differences`] is asked for first, as it says which columns there are, then [`curves`]. [`fields`]
//! knows nothing of requests.
mod comparisons;
mod curves;
mod differences;
pub(in crate::http) mod fields;
mod measured;
mod selection;

use utoipa_axum::router::OpenApiRouter;

use super::AppState;

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .merge(differences::router())
        .merge(curves::router())
        .merge(measured::router())
        .merge(comparisons::router())
}
