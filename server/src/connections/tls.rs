//! The server's certificate: read from two files, and again when they have changed.
use std::fs::{self, Metadata};
use std::io;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use rustls::ServerConfig;
use rustls::crypto::ring;
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use sha2::{Digest, Sha256};
use tokio::signal::unix::{SignalKind, signal};
use tokio_rustls::TlsAcceptor;

/// How often the files are looked at.
const LOOK_EVERY: Duration = Duration::from_secs(10);
/// Permissions that the key must not give: to read it to everybody, to write it to the group or
/// everybody. A group may read it, as Debian's `ssl-cert` does.
const NOT_OF_A_KEY: u32 = 0o027;

/// Where the certificate and its key are, both in PEM.
#[derive(Clone, Debug)]
pub struct TlsFiles {
    /// The server's certificate, then those between it and the authority that clients trust.
    pub certificate: PathBuf,
    pub key: PathBuf,
}

/// Why a certificate cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TlsError {
    #[error("{} cannot be read", path.display())]
    Unreadable {
        path: PathBuf,
        #[source]
        source: io::Error,
    },
    #[error(
        "{} has the permissions {mode:03o}: others could take the key; `chmod 600` it", path.display()
    )]
    Exposed { path: PathBuf, mode: u32 },
    #[error("{} has no {what} in PEM", path.display())]
    Missing { path: PathBuf, what: &'static str },
    #[error("{} and {} cannot be used together", files.certificate.display(), files.key.display())]
    Unusable {
        files: Box<TlsFiles>,
        #[source]
        source: rustls::Error,
    },
    #[error("signals cannot be listened to")]
    Signal(#[source] io::Error),
}

/// A certificate in use.
#[derive(Debug)]
pub struct Tls {
    files: TlsFiles,
    current: Mutex<Current>,
}

#[derive(Debug)]
struct Current {
    config: Arc<ServerConfig>,
    /// Of both files.
    sha256: [u8; 32],
}

/// Both files as they were at one moment.
struct Read {
    certificate: Vec<u8>,
    key: Vec<u8>,
    sha256: [u8; 32],
}

impl Tls {
    /// Reads the files.
    ///
    /// # Errors
    /// [`TlsError`] when they cannot be used, or others can read the key.
    pub fn open(files: TlsFiles) -> Result<Self, TlsError> {
        let read = read(&files)?;
        let current = Mutex::new(Current {
            config: config(&files, &read)?,
            sha256: read.sha256,
        });
        Ok(Self { files, current })
    }

    /// For a new connection; those at hand go on as they began.
    pub(super) fn acceptor(&self) -> TlsAcceptor {
        let current = self.current.lock().unwrap_or_else(PoisonError::into_inner);
        TlsAcceptor::from(current.config.clone())
    }

    /// Reads the files again; whether they are others.
    ///
    /// # Errors
    /// [`TlsError`], and then what was read last stays in use.
    pub fn renew(&self) -> Result<bool, TlsError> {
        let read = read(&self.files)?;
        let is_new = |current: &Current| current.sha256 != read.sha256;
        if !is_new(&self.current.lock().unwrap_or_else(PoisonError::into_inner)) {
            return Ok(false);
        }
        let config = config(&self.files, &read)?;
        let mut current = self.current.lock().unwrap_or_else(PoisonError::into_inner);
        *current = Current {
            config,
            sha256: read.sha256,
        };
        Ok(true)
    }

    /// Follows the files, until dropped: every ten seconds, and at once on SIGHUP.
    pub(crate) async fn keep_renewed(self: Arc<Self>) {
        let mut hang_up = match signal(SignalKind::hangup()) {
            Ok(hang_up) => hang_up,
            Err(error) => {
                tracing::error!(error = %TlsError::Signal(error), "certificates are not renewed");
                return std::future::pending().await;
            }
        };
        let mut last_failure = String::new();
        loop {
            tokio::select! {
                () = tokio::time::sleep(LOOK_EVERY) => {}
                _ = hang_up.recv() => {}
            }
            match self.renew() {
                Ok(true) => tracing::info!("the certificate is renewed"),
                Ok(false) => {}
                // while one file is new and the other is not yet, they do not fit
                Err(error) => {
                    let failure = chain(&error);
                    if failure != last_failure {
                        tracing::warn!(error = %failure, "the certificate read before stays in use");
                    }
                    last_failure = failure;
                    continue;
                }
            }
            last_failure.clear();
        }
    }
}

fn read(files: &TlsFiles) -> Result<Read, TlsError> {
    let bytes = |path: &Path| {
        let unreadable = |source| TlsError::Unreadable {
            path: path.to_owned(),
            source,
        };
        let metadata = fs::metadata(path).map_err(unreadable)?;
        Ok((fs::read(path).map_err(unreadable)?, metadata))
    };
    let (certificate, _) = bytes(&files.certificate)?;
    let (key, metadata): (Vec<u8>, Metadata) = bytes(&files.key)?;
    let mode = metadata.permissions().mode() & 0o777;
    if mode & NOT_OF_A_KEY != 0 {
        let path = files.key.clone();
        return Err(TlsError::Exposed { path, mode });
    }
    let hash = Sha256::new();
    let hash = hash.chain_update(&certificate).chain_update([0]);
    Ok(Read {
        sha256: hash.chain_update(&key).finalize().into(),
        certificate,
        key,
    })
}

fn config(files: &TlsFiles, read: &Read) -> Result<Arc<ServerConfig>, TlsError> {
    let missing = |path: &Path, what| TlsError::Missing {
        path: path.to_owned(),
        what,
    };
    let chain: Result<Vec<_>, _> = CertificateDer::pem_slice_iter(&read.certificate).collect();
    let chain = chain.ok().filter(|chain| !chain.is_empty());
    let chain = chain.ok_or_else(|| missing(&files.certificate, "certificate"))?;
    let key = PrivateKeyDer::from_pem_slice(&read.key);
    let key = key.map_err(|_| missing(&files.key, "private key"))?;
    let unusable = |source| TlsError::Unusable {
        files: Box::new(files.clone()),
        source,
    };
    let mut config = ServerConfig::builder_with_provider(Arc::new(ring::default_provider()))
        .with_safe_default_protocol_versions()
        .map_err(unusable)?
        .with_no_client_auth()
        .with_single_cert(chain, key)
        .map_err(unusable)?;
    config.alpn_protocols = vec![b"http/1.1".to_vec()];
    Ok(Arc::new(config))
}

/// An error with its causes.
fn chain(error: &dyn std::error::Error) -> String {
    let causes = std::iter::successors(Some(error), |error| error.source());
    let causes: Vec<String> = causes.map(ToString::to_string).collect();
    causes.join(": ")
}
