//! `loadframe lab`: server, page and workers on this machine.
//!
//! The server lives in this process; every worker is a child process of the same executable, so
//! that a crash of one touches nothing else. Stopping goes the other way round: workers first,
//! while the server still takes their checkpoints.
mod children;
mod demo;

use std::net::SocketAddr;

use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use clap::Args;
use loadframe_client::ServerClient;
use loadframe_run::available_threads;
use loadframe_server::serve;
use rand::Rng;
use tokio::sync::oneshot;
use tokio_util::sync::CancellationToken;

use super::failure::Failure;
use super::serve::{ServerOptions, failure, reachable};
use super::signals::stop_signal;
use super::terminal::{print_error, print_line, start_log};
use children::Children;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    server: ServerOptions,
    /// Worker processes; when left out, one for each group of `--threads` cores
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(0..=1024))]
    workers: Option<u16>,
    /// Threads of each worker
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=4096))]
    threads: u16,
    /// Submit an example job and show its progress and results
    #[arg(long)]
    demo: bool,
    /// Stop when the demo is done
    #[arg(long, requires = "demo")]
    once: bool,
    /// Open the lab page in the browser
    #[arg(long)]
    open: bool,
}

pub(crate) async fn perform(arguments: Arguments) -> Result<(), Failure> {
    start_log("warn");
    let (ready, is_ready) = oneshot::channel();
    let stop_server = CancellationToken::new();
    // its own workers have a secret of their own, which lives as long as this lab and only works
    let mut config = arguments.server.config()?;
    let worker_token = fresh_secret();
    config.worker_token = Some(worker_token.clone());
    let token = config.token.clone();
    let serving = serve(
        config,
        |address| {
            let _ = ready.send(address);
        },
        stop_server.clone().cancelled_owned(),
    );
    let has_ended = CancellationToken::new();
    let (served, end) = tokio::join!(
        async {
            let end = serving.await;
            has_ended.cancel();
            end
        },
        async {
            // a server that cannot start drops its end of the channel, and says why by its error
            let end = match is_ready.await {
                Ok(address) => {
                    let secrets = Secrets {
                        token,
                        worker_token,
                    };
                    open(&arguments, address, secrets, &has_ended).await
                }
                Err(_) => Ok(()),
            };
            stop_server.cancel();
            end
        }
    );
    served.map_err(|error| failure(&error)).and(end)
}

/// What the lab itself is known by: to the server as its user, and its workers.
struct Secrets {
    token: Option<String>,
    worker_token: String,
}

fn fresh_secret() -> String {
    let mut bytes = [0_u8; 32];
    rand::rng().fill_bytes(&mut bytes);
    URL_SAFE_NO_PAD.encode(bytes)
}

/// The lab around a server at `address`: workers, demo, and waiting for the end.
async fn open(
    arguments: &Arguments,
    address: SocketAddr,
    secrets: Secrets,
    server_has_ended: &CancellationToken,
) -> Result<(), Failure> {
    let url = format!("http://{}", reachable(address));
    let client = ServerClient::new(&url, secrets.token)?;
    let workers = arguments.workers.map_or_else(
        || (available_threads() / usize::from(arguments.threads)).max(1),
        usize::from,
    );
    let children = Children::start(workers, arguments.threads, &url, secrets.worker_token)
        .map_err(|error| Failure::of(&error))?;
    print_line(&format!(
        "The lab is open at {url} ({})",
        describe_workers(workers, arguments.threads)
    ));
    if arguments.open {
        open_browser(&url);
    }
    let work = async {
        if arguments.demo {
            demo::run(&client).await?;
            if arguments.once {
                return Ok(());
            }
        }
        print_line("Ctrl-C closes the lab; nothing that was accepted is lost.");
        std::future::pending().await
    };
    let end = tokio::select! {
        // a demo is told to stop as well, but here that is how a lab ends
        biased;
        () = stop_signal() => Ok(()),
        end = work => end,
        () = server_has_ended.cancelled() => Ok(()),
    };
    if !arguments.once {
        print_error("closing: the workers save their jobs");
    }
    children.stop().await;
    end
}

fn describe_workers(workers: usize, threads: u16) -> String {
    let workers = match workers {
        0 => return "no workers".to_owned(),
        1 => "1 worker".to_owned(),
        workers => format!("{workers} workers"),
    };
    match threads {
        1 => workers,
        threads => format!("{workers} of {threads} threads"),
    }
}

fn open_browser(url: &str) {
    let opener = if cfg!(target_os = "macos") {
        "open"
    } else {
        "xdg-open"
    };
    let quiet = std::process::Stdio::null;
    let opened = std::process::Command::new(opener)
        .arg(url)
        .stdin(quiet())
        .stdout(quiet())
        .stderr(quiet())
        .spawn();
    if let Err(error) = opened {
        print_error(&format!(
            "no browser could be opened ({opener}: {error}); open {url} yourself"
        ));
    }
}
