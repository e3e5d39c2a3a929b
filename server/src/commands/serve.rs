//! `loadframe serve`
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use clap::Args;
use ipnet::IpNet;
use loadframe_api::{JobSpec, Preview};
use loadframe_run::{Halt, Interrupt, InterruptSource};
use loadframe_server::connections::{ConnectionLimits, TlsFiles};
use loadframe_server::mail::{MailError, MailSettings, Mailer};
use loadframe_server::single_sign_on::SingleSignOn;
use loadframe_server::store::StoreOptions;
use loadframe_server::{ServeConfig, ServeError, serve};
use tokio_util::sync::CancellationToken;

use super::database::DatabaseOptions;
use super::failure::{Code, Failure, chain};
use super::files::{FilesOptions, WaysOptions};
use super::number::positive;
use super::secret::TokenSource;
use super::signals::stop_signal;
use super::terminal::start_log;

/// Options of a server, for `serve` and `lab`.
#[derive(Clone, Debug, Args)]
pub(crate) struct ServerOptions {
    /// Address to listen on; beyond this machine every request needs a token
    #[arg(long, value_name = "HOST:PORT", default_value = ServeConfig::DEFAULT_LISTEN)]
    listen: String,
    /// Folder of the database and the files
    #[arg(long, value_name = "DIR", default_value = "loadframe-data")]
    data: PathBuf,
    #[command(flatten)]
    database: DatabaseOptions,
    #[command(flatten)]
    files: FilesOptions,
    #[command(flatten)]
    ways: WaysOptions,
    /// Demand a token on this machine too
    #[arg(long)]
    require_token: bool,
    #[command(flatten)]
    token: TokenSource,
    /// Take passwords in the clear over a network, where there is no https
    #[arg(long)]
    plain_sign_in: bool,
    /// File that says who signs people in instead of passwords (see the guide, "Share in a group")
    #[arg(long, value_name = "FILE")]
    single_sign_on: Option<PathBuf>,
    /// A network of private addresses that webhooks may lead to, such as 10.0.0.0/24
    #[arg(long = "webhook-network", value_name = "NETWORK")]
    webhook_networks: Vec<IpNet>,
    /// File that says which server sends e-mail (see the guide, "Share in a group")
    #[arg(long, value_name = "FILE")]
    mail: Option<PathBuf>,
    /// A further name under which a server without tokens answers
    #[arg(long = "allow-host", value_name = "NAME")]
    allowed_hosts: Vec<String>,
    /// Seconds a silent worker keeps its job
    #[arg(long, value_name = "S", default_value_t = 30.0, value_parser = positive)]
    lease_s: f64,
    /// Days that a stored file which no job names waits before it is removed
    #[arg(long, value_name = "DAYS", default_value_t = 7.0, value_parser = positive)]
    unnamed_days: f64,
    /// Days that what was deleted, or removed by a project's rule, can be brought back
    #[arg(long, value_name = "DAYS", default_value_t = 14.0, value_parser = positive)]
    trash_days: f64,
    /// Most seconds of wall time for a job
    #[arg(long, value_name = "S", value_parser = positive)]
    job_time_limit_s: Option<f64>,
    /// Most seconds on one core that a job's estimate may reach
    #[arg(long, value_name = "S", default_value_t = ServeConfig::DEFAULT_LIMITS.wall_s, value_parser = positive)]
    limit_wall_s: f64,
    /// Most memory that a job's estimate may reach
    #[arg(long, value_name = "MB", default_value_t = ServeConfig::DEFAULT_LIMITS.memory_mb, value_parser = positive)]
    limit_memory_mb: f64,
    /// Most bytes of files that a job's estimate may reach
    #[arg(long, value_name = "MB", default_value_t = ServeConfig::DEFAULT_LIMITS.disk_mb, value_parser = positive)]
    limit_disk_mb: f64,
    /// Most connections at once, half of which one address may have
    #[arg(long, value_name = "N", default_value_t = 4096, value_parser = clap::value_parser!(u16).range(2..))]
    connections: u16,
    /// Most requests a second of one token, or of one address without one; twice as many may come at once
    #[arg(long, value_name = "N", default_value_t = ServeConfig::DEFAULT_REQUESTS_PER_S, value_parser = clap::value_parser!(u32).range(1..))]
    requests_per_s: u32,
}

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    server: ServerOptions,
    #[command(flatten)]
    tls: TlsOptions,
}

/// The certificate of a server, where it has one.
#[derive(Clone, Debug, Args)]
struct TlsOptions {
    /// Speak TLS with the certificate in this file (PEM, those between it and its authority after it)
    #[arg(long, value_name = "FILE", requires = "tls_key")]
    tls_certificate: Option<PathBuf>,
    /// Key of the certificate (PEM), which others must not be able to read
    #[arg(long, value_name = "FILE", requires = "tls_certificate")]
    tls_key: Option<PathBuf>,
}

impl TlsOptions {
    fn files(self) -> Option<TlsFiles> {
        let (certificate, key) = self.tls_certificate.zip(self.tls_key)?;
        Some(TlsFiles { certificate, key })
    }
}

impl ServerOptions {
    pub(crate) fn config(&self) -> Result<ServeConfig, Failure> {
        let single_sign_on = self.single_sign_on.as_deref().map(SingleSignOn::read);
        let single_sign_on = single_sign_on
            .transpose()
            .map_err(|error| Failure::new(Code::Usage, chain(&error)))?;
        let mailer = self.mail.as_deref().map(|path| {
            let settings = MailSettings::read(path).map_err(MailError::from)?;
            Mailer::new(&settings).map(Arc::new)
        });
        let mailer = mailer
            .transpose()
            .map_err(|error: MailError| Failure::new(Code::Usage, chain(&error)))?;
        Ok(ServeConfig {
            listen: self.listen.clone(),
            store: StoreOptions {
                database: self.database.place()?,
                files: self.ways.of(self.files.place()?),
                lease: Duration::from_secs_f64(self.lease_s),
                job_time_limit: self.job_time_limit_s.map(Duration::from_secs_f64),
                unnamed_wait: Duration::from_secs_f64(86_400.0 * self.unnamed_days),
                trash: Duration::from_secs_f64(86_400.0 * self.trash_days),
                ..StoreOptions::new(&self.data)
            },
            limits: loadframe_api::Limits {
                wall_s: self.limit_wall_s,
                memory_mb: self.limit_memory_mb,
                disk_mb: self.limit_disk_mb,
            },
            require_token: self.require_token,
            token: self.token.read()?,
            worker_token: None,
            plain_sign_in: self.plain_sign_in,
            single_sign_on: single_sign_on.map(Arc::new),
            webhook_networks: self.webhook_networks.clone(),
            mailer,
            preview: Some(draw_specimen),
            preview_time: loadframe_server::config::PREVIEW_TIME,
            allowed_hosts: self.allowed_hosts.clone(),
            connections: ConnectionLimits::with_places(self.connections.into()),
            requests_per_s: self.requests_per_s,
            tls: None,
        })
    }
}

/// Whether a picture is still wanted, as the engine asks it.
struct Wanted<'a>(&'a CancellationToken);

impl InterruptSource for Wanted<'_> {
    fn interrupt(&self) -> Option<Interrupt> {
        self.0.is_cancelled().then_some(Interrupt::Cancel)
    }
}

/// The specimen of a spec, drawn by the engine.
fn draw_specimen(spec: &JobSpec, given_up: &CancellationToken) -> Result<Option<Preview>, String> {
    match loadframe_run::preview(spec, &Wanted(given_up)) {
        Ok(preview) => Ok(Some(preview)),
        Err(Halt::Interrupted(_)) => Ok(None),
        Err(Halt::Failed(error)) => Err(chain(&error)),
    }
}

pub(crate) async fn perform(arguments: Arguments) -> Result<(), Failure> {
    start_log("info");
    let config = ServeConfig {
        tls: arguments.tls.files(),
        ..arguments.server.config()?
    };
    let scheme = if config.tls.is_some() {
        "https"
    } else {
        "http"
    };
    let ready =
        |address| tracing::info!("open {scheme}://{}/ for the lab page", reachable(address));
    serve(config, ready, stop_signal())
        .await
        .map_err(|error| failure(&error))
}

/// Why a server did not start, and what to do about it.
pub(crate) fn failure(error: &ServeError) -> Failure {
    match error {
        ServeError::Listen { listen, source } => {
            let advice = match source.kind() {
                std::io::ErrorKind::AddrInUse => {
                    "another program listens there, perhaps another lab; choose an address with --listen HOST:PORT"
                }
                _ => "choose an address of this machine with --listen HOST:PORT",
            };
            let message = format!("cannot listen on {listen} ({source}): {advice}");
            Failure::new(Code::Usage, message)
        }
        ServeError::Tls(_) => Failure::new(Code::Usage, chain(error)),
        error => Failure::new(Code::Failed, chain(error)),
    }
}

/// The address under which this machine itself reaches a server bound to `address`.
pub(crate) fn reachable(address: SocketAddr) -> SocketAddr {
    let ip = match address.ip() {
        IpAddr::V4(ip) if ip.is_unspecified() => Ipv4Addr::LOCALHOST.into(),
        IpAddr::V6(ip) if ip.is_unspecified() => Ipv6Addr::LOCALHOST.into(),
        ip => ip,
    };
    SocketAddr::new(ip, address.port())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_server_on_all_addresses_is_reached_over_loopback() {
        for (bound, reached) in [
            ("0.0.0.0:80", "127.0.0.1:80"),
            ("[::]:80", "[::1]:80"),
            ("192.0.2.1:80", "192.0.2.1:80"),
        ] {
            let bound: SocketAddr = bound.parse().expect("an address");
            assert_eq!(reachable(bound).to_string(), reached);
        }
    }
}
