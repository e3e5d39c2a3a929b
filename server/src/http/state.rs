//! What all handlers share.
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use loadframe_api::Limits;
use tokio::sync::Semaphore;
use tokio_util::sync::CancellationToken;

use super::access::Access;
use super::body_budget::BodyBudget;
use super::checks::Checks;
use super::events::announcements::Announcements;
use super::worker::reports::Reports;
use crate::ServeConfig;
use crate::config::DrawSpecimen;
use crate::store::Store;
use crate::telling::Ways;
use crate::webhooks::Addresses;

/// Archives written at once, each until it has a piece to send: compressing takes a core each.
const ARCHIVES_AT_ONCE: usize = 4;

/// Comparisons read at once, each of which may take some tens of MB.
const COMPARISONS_AT_ONCE: usize = 4;

/// What all handlers share; a clone is another handle on the same.
#[derive(Clone, Debug)]
pub struct AppState {
    pub store: Store,
    /// What the estimate of a job may reach.
    pub limits: Limits,
    /// Cancelled when the server stops: whatever waits must end its wait.
    pub stopping: CancellationToken,
    pub(crate) access: Arc<Access>,
    pub(crate) ways: Ways,
    pub(super) preview: Option<DrawSpecimen>,
    /// How long that may take.
    pub(super) preview_time: Duration,
    pub(super) bodies: BodyBudget,
    pub(super) checks: Checks,
    pub(super) pictures: Checks,
    pub(super) archives: Arc<Semaphore>,
    pub(super) comparisons: Arc<Semaphore>,
    pub(super) announcements: Announcements,
    /// What batch systems give to workers.
    pub(super) allocations: Reports,
}

impl AppState {
    /// State of a server that listens on `address`.
    pub fn new(store: Store, config: &ServeConfig, address: SocketAddr) -> Self {
        Self {
            store,
            limits: config.limits,
            stopping: CancellationToken::new(),
            access: Arc::new(Access::new(config, address)),
            ways: Ways {
                addresses: Addresses::new(config.webhook_networks.clone()),
                mailer: config.mailer.clone(),
            },
            preview: config.preview,
            preview_time: config.preview_time,
            bodies: BodyBudget::default(),
            checks: Checks::default(),
            pictures: Checks::of_pictures(),
            archives: Arc::new(Semaphore::new(ARCHIVES_AT_ONCE)),
            comparisons: Arc::new(Semaphore::new(COMPARISONS_AT_ONCE)),
            announcements: Announcements::default(),
            allocations: Reports::default(),
        }
    }

    /// How people and machines are told what happens.
    pub fn ways(&self) -> &Ways {
        &self.ways
    }

    /// Announces new events to all who follow, until dropped.
    pub fn announce(&self) -> impl Future<Output = ()> + use<> {
        self.announcements.clone().run(self.store.clone())
    }
}
