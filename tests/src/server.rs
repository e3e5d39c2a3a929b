//! A `loadframe serve` process.
use crate::turn::Turn;
use crate::{Client, Process, loadframe, until};
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A server with its own data folder. Only one lives at a time in a test process, so that the labs
/// of different tests do not compete for the machine.
#[derive(Debug)]
pub struct Server {
    pub process: Process,
    pub client: Client,
    pub url: String,
    address: String,
    options: Vec<String>,
    folder: TempDir,
    _turn: Turn,
}

/// Short enough that tests of lost workers take seconds, long enough that a busy machine still
/// gets a heartbeat through.
const LEASE_S: &str = "2";

impl Server {
    /// Starts a server with a lease of [`LEASE_S`] and waits until it is ready.
    pub fn start() -> Self {
        Self::start_with(&["--lease-s", LEASE_S])
    }

    /// Starts a server with further options of `serve`.
    pub fn start_with(options: &[&str]) -> Self {
        Self::start_on("127.0.0.1", options)
    }

    /// Starts a server that listens on an address of this machine.
    pub fn start_on(host: &str, options: &[&str]) -> Self {
        let turn = Turn::wait();
        let folder = TempDir::with_prefix("loadframe-test-").unwrap();
        let free = TcpListener::bind((host, 0)).unwrap();
        let port = free.local_addr().unwrap().port();
        drop(free);
        let options: Vec<String> = options.iter().map(|text| (*text).to_owned()).collect();
        let address = format!("{host}:{port}");
        let url = format!("http://127.0.0.1:{port}");
        let server = Self {
            process: spawn(&address, folder.path(), &options),
            client: Client::new(&url),
            url,
            address,
            options,
            folder,
            _turn: turn,
        };
        server.wait_until_ready();
        server
    }

    /// Starts again at the same address on the same data.
    pub fn restart(&mut self) {
        self.process = spawn(&self.address, self.folder.path(), &self.options);
    }

    pub fn wait_until_ready(&self) {
        let ready = || {
            let answer = self.client.send("GET", "/readyz", &[], b"");
            answer
                .is_ok_and(|answer| answer.status == 200)
                .then_some(())
        };
        until("the server is ready", ready);
    }

    /// A place for files of the test, beside the data folder.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// The server's data folder.
    pub fn data(&self) -> PathBuf {
        self.folder.path().join("data")
    }
}

fn spawn(address: &str, folder: &Path, options: &[String]) -> Process {
    let mut command = loadframe();
    command
        .args(["serve", "--listen", address, "--data"])
        .arg(folder.join("data"))
        .args(options);
    Process::start(command, folder.join("server.log"))
}
