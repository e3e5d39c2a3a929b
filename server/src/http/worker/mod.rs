//! The worker's side: claims, and what is written under a lease.
//!
//! A lease is its id in the path and its token in the `Loadframe-Lease-Token` header. Whatever is
//! written under one that is no longer held is refused with 409 and changes nothing.
mod allocations;
mod claims;
mod leases;
pub(super) mod reports;
mod request;
mod uploads;

use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::state::AppState;

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(claims::claim))
        .routes(routes!(leases::heartbeat))
        .routes(routes!(leases::progress))
        .routes(routes!(leases::complete))
        .routes(routes!(leases::fail))
        .routes(routes!(leases::fault))
        .routes(routes!(leases::release))
        .merge(uploads::router())
        .merge(allocations::router())
}
