//! Which server a command speaks with.
use clap::Args;
use loadframe_client::{ServerClient, ServerError};

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
    /// Access token, where the server demands one
    #[arg(
        long,
        env = "LOADFRAME_TOKEN",
        hide_env_values = true,
        value_name = "TOKEN"
    )]
    token: Option<String>,
}

impl Connection {
    pub(crate) fn client(&self) -> Result<ServerClient, ServerError> {
        ServerClient::new(&self.server, self.token.clone())
    }
}
