//! Which server a command speaks with.
use clap::Args;
use loadframe_client::ServerClient;

use super::failure::Failure;
use super::secret::TokenSource;

/// Options of every command that speaks with a server.
#[derive(Clone, Debug, Args)]
pub(crate) struct Connection {
    /// Address of the server
    #[arg(
        long,
        env = "LOADFRAME_SERVER",
        default_value = "http://127.0.0.1:8400",
        value_name = "URL"
    )]
    server: String,
    #[command(flatten)]
    token: TokenSource,
}

impl Connection {
    pub(crate) fn client(&self) -> Result<ServerClient, Failure> {
        Ok(ServerClient::new(&self.server, self.token.read()?)?)
    }
}
