//! Being told to stop: Ctrl-C, SIGTERM, or the end of the parent process.
use std::io::{self, Read};

use loadframe_run::StopSwitch;
use signal_hook::consts::{SIGINT, SIGTERM};
use tokio::signal::unix::{SignalKind, signal};

/// Waits for Ctrl-C or SIGTERM. Where signals cannot be watched, it waits for ever.
pub(crate) async fn stop_signal() {
    let (Ok(mut interrupt), Ok(mut terminate)) = (
        signal(SignalKind::interrupt()),
        signal(SignalKind::terminate()),
    ) else {
        tracing::error!("signals cannot be watched; stop this process with SIGKILL");
        return std::future::pending().await;
    };
    tokio::select! {
        _ = interrupt.recv() => {}
        _ = terminate.recv() => {}
    }
}

/// Waits for whatever tells a worker to stop: the same, and SIGUSR1, which batch systems are asked to send
/// before the end (`sbatch --signal=B:USR1@120`).
pub(crate) async fn worker_stop_signal() {
    let Ok(mut warning) = signal(SignalKind::user_defined1()) else {
        return stop_signal().await;
    };
    tokio::select! {
        () = stop_signal() => {}
        _ = warning.recv() => {}
    }
}

/// A switch for simulations in this process that Ctrl-C or SIGTERM turns, without a thread that waits.
pub(crate) fn stop_switch() -> StopSwitch {
    let switch = StopSwitch::default();
    for signal in [SIGINT, SIGTERM] {
        if signal_hook::flag::register(signal, switch.shutdown()).is_err() {
            tracing::error!("signals cannot be watched; stop this process with SIGKILL");
        }
    }
    switch
}

/// Waits until standard input ends, as it does for a child whose parent is gone.
pub(crate) async fn end_of_input() {
    let (gone, is_gone) = tokio::sync::oneshot::channel();
    // a thread of its own: reading standard input cannot be broken off
    std::thread::spawn(move || {
        let _ = io::copy(&mut io::stdin().lock().by_ref(), &mut io::sink());
        let _ = gone.send(());
    });
    let _ = is_gone.await;
}
