//! What a server is told when it starts.
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use ipnet::IpNet;
use loadframe_api::{JobSpec, Limits, Preview};
use tokio_util::sync::CancellationToken;

use crate::connections::{ConnectionLimits, TlsFiles};
use crate::mail::Mailer;
use crate::single_sign_on::SingleSignOn;
use crate::store::StoreOptions;

/// Draws the specimen of a spec, or says why there is none; nothing when it was given up, which the token says.
pub type DrawSpecimen = fn(&JobSpec, &CancellationToken) -> Result<Option<Preview>, String>;
/// How long one may take, unless it is told.
pub const PREVIEW_TIME: Duration = Duration::from_secs(10);

/// Everything `loadframe serve` and `loadframe lab` can choose.
#[derive(Clone, Debug)]
pub struct ServeConfig {
    /// Address as `HOST:PORT`; port 0 takes a free one.
    pub listen: String,
    /// Folder of the database and the files, lease, time limit of a job.
    pub store: StoreOptions,
    /// What the estimate of a single job may reach.
    pub limits: Limits,
    /// Demand a token on a loopback address too; elsewhere it is always demanded.
    pub require_token: bool,
    /// Secret that is a valid token as long as this server runs (`LOADFRAME_TOKEN`): it does everything
    /// on a server without people, and only works for one with people.
    pub token: Option<String>,
    /// Secret of the server's own workers, which only works, as long as this server runs.
    pub worker_token: Option<String>,
    /// Take passwords in the clear over a network.
    pub plain_sign_in: bool,
    /// Who vouches for people.
    pub single_sign_on: Option<Arc<SingleSignOn>>,
    /// Networks of private addresses that webhooks may lead to.
    pub webhook_networks: Vec<IpNet>,
    /// The server's e-mail, where it has any.
    pub mailer: Option<Arc<Mailer>>,
    /// What draws specimens before their jobs are submitted: the engine, which this library does not know.
    pub preview: Option<DrawSpecimen>,
    /// How long drawing a specimen may take.
    pub preview_time: Duration,
    /// Names besides `localhost`, `127.0.0.1` and `[::1]` under which an open server answers.
    pub allowed_hosts: Vec<String>,
    /// How many connections there may be, and how long clients may take.
    pub connections: ConnectionLimits,
    /// Requests a second of one token, or of one address without one, on average over two seconds.
    pub requests_per_s: u32,
    /// The certificate under which the server speaks TLS; without it, plain HTTP.
    pub tls: Option<TlsFiles>,
}

impl ServeConfig {
    /// Where a server listens unless told otherwise.
    pub const DEFAULT_LISTEN: &str = "127.0.0.1:8400";

    /// A week on one core, 8 GB and 20 GB: what a lab's machine can give a single job without
    /// the others noticing.
    pub const DEFAULT_LIMITS: Limits = Limits {
        wall_s: 7.0 * 24.0 * 3600.0,
        memory_mb: 8_000.0,
        disk_mb: 20_000.0,
    };

    /// What two hundred workers that share a token ask, with short jobs; more than a small machine answers, and
    /// less than keeps others from a large one.
    pub const DEFAULT_REQUESTS_PER_S: u32 = 5_000;

    /// A server on this machine alone, with its data in `data`.
    pub fn new(data: impl Into<PathBuf>) -> Self {
        Self {
            listen: Self::DEFAULT_LISTEN.to_owned(),
            store: StoreOptions::new(data),
            limits: Self::DEFAULT_LIMITS,
            require_token: false,
            token: None,
            worker_token: None,
            plain_sign_in: false,
            single_sign_on: None,
            webhook_networks: Vec::new(),
            mailer: None,
            preview: None,
            preview_time: PREVIEW_TIME,
            allowed_hosts: Vec::new(),
            connections: ConnectionLimits::default(),
            requests_per_s: Self::DEFAULT_REQUESTS_PER_S,
            tls: None,
        }
    }
}

/// How long a stopping server waits for answers under way.
pub(crate) const SHUTDOWN_GRACE: Duration = Duration::from_secs(10);
