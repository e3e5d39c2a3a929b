//! Which server a command speaks with.
use std::path::PathBuf;

use clap::Args;
use loadframe_client::{ServerClient, ServerError};

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
    /// Certificates in PEM that alone are believed, for a server with one of your own making
    #[arg(long, env = "LOADFRAME_CA", value_name = "FILE")]
    ca: Option<PathBuf>,
}

impl Connection {
    /// Options by which a command in another place speaks with the same server, for the same caller. A
    /// token of the environment goes with the environment.
    ///
    /// # Errors
    /// When there is no working folder to find a file from.
    pub(crate) fn options_elsewhere(&self) -> Result<Vec<String>, Failure> {
        let mut options = vec!["--server".to_owned(), self.server.clone()];
        let files = [
            ("--token-file", self.token.file()),
            ("--ca", self.ca.as_deref()),
        ];
        for (option, path) in files {
            if let Some(path) = path {
                let path = std::path::absolute(path).map_err(|error| Failure::of(&error))?;
                options.extend([option.to_owned(), path.display().to_string()]);
            }
        }
        Ok(options)
    }

    pub(crate) fn client(&self) -> Result<ServerClient, Failure> {
        let read = |path: &PathBuf| {
            std::fs::read(path).map_err(|error| ServerError::File {
                path: path.display().to_string(),
                reason: error.to_string(),
            })
        };
        let ca = self.ca.as_ref().map(read).transpose()?;
        let token = self.token.read()?;
        Ok(ServerClient::trusting(&self.server, token, ca.as_deref())?)
    }
}
