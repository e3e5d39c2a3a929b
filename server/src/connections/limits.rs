//! How many connections there may be, and how long a client may take over what it has begun.
use std::time::Duration;

/// Limits of connections.
#[derive(Clone, Copy, Debug)]
pub struct ConnectionLimits {
    /// Connections at once. Fewer where the system gives the process too few file descriptors.
    pub in_all: usize,
    /// Connections of one address at once (of IPv6, one network of 64 bits).
    pub per_address: usize,
    /// Time for the head of a request, and for the handshake of TLS.
    pub head: Duration,
    /// Time between a request's answer and the next request.
    pub idle: Duration,
    /// Longest wait for the next byte of a body, or for a client to take a byte of its answer.
    pub silence: Duration,
    /// A client may be waited for so long in all over one body or answer, and longer by
    /// [`Self::bytes_per_s`].
    pub grace: Duration,
    /// Slowest mean speed of a body, and of an answer that the client does not take at once [bytes/s].
    pub bytes_per_s: u32,
}

impl Default for ConnectionLimits {
    /// For a laboratory: some hundred workers of four connections each behind one address, and
    /// telephones in a cellar. A slower link than a modem's of 64 kbit/s is taken for none.
    fn default() -> Self {
        Self::with_places(4096)
    }
}

impl ConnectionLimits {
    /// The usual times, for at most `in_all` connections, half of which one address may have.
    pub fn with_places(in_all: usize) -> Self {
        Self {
            in_all,
            per_address: in_all.div_ceil(2),
            head: Duration::from_secs(10),
            idle: Duration::from_secs(75),
            silence: Duration::from_secs(30),
            grace: Duration::from_secs(30),
            bytes_per_s: 8_000,
        }
    }
}
