//! Which build this executable is: the one place that knows, for everything it starts.
use loadframe_run::Engine;

/// What computes in this executable.
pub(crate) const ENGINE: Engine = Engine {
    version: loadframe_server::VERSION,
    commit: loadframe_server::COMMIT,
};

/// What `loadframe --version` says.
pub(crate) const VERSION: &str = concat!(
    env!("CARGO_PKG_VERSION"),
    " (",
    env!("LOADFRAME_COMMIT"),
    ")"
);
