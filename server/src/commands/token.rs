//! `loadframe token`: access tokens, in the data folder of a server that may be running.
use std::path::PathBuf;

use clap::{Args, Subcommand};
use loadframe_server::store::{Store, StoreError, StoreOptions};
use uuid::Uuid;

use super::failure::Failure;
use super::terminal::{print_error, print_json, print_line};

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// Make a token; it is shown this once
    Create {
        /// Whose token it is
        #[arg(long)]
        name: String,
        #[command(flatten)]
        folder: DataFolder,
    },
    /// List tokens, without their secrets
    List {
        #[command(flatten)]
        folder: DataFolder,
    },
    /// Put a token out of force
    Revoke {
        /// Id of the token, as `list` shows it
        id: Uuid,
        #[command(flatten)]
        folder: DataFolder,
    },
}

#[derive(Debug, Args)]
struct DataFolder {
    /// Data folder of the server
    #[arg(long, value_name = "DIR", default_value = "loadframe-data")]
    data: PathBuf,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl DataFolder {
    async fn store(&self) -> Result<Store, Failure> {
        let store = Store::open_beside(StoreOptions::new(&self.data)).await;
        store.map_err(refuse)
    }
}

#[expect(clippy::needless_pass_by_value, reason = "it is what map_err gives")]
fn refuse(error: StoreError) -> Failure {
    Failure::of(&error)
}

pub(crate) async fn perform(arguments: Arguments) -> Result<(), Failure> {
    match arguments.action {
        Action::Create { name, folder } => {
            let token = folder
                .store()
                .await?
                .create_token(&name)
                .await
                .map_err(refuse)?;
            if folder.json {
                return print_json(&token);
            }
            print_error("The token, shown this once (it can be revoked, not read again):");
            print_line(&token.secret);
        }
        Action::List { folder } => {
            let tokens = folder.store().await?.tokens().await.map_err(refuse)?;
            if folder.json {
                return print_json(&tokens);
            }
            if tokens.is_empty() {
                print_line("no tokens");
            }
            for token in tokens {
                let state = match token.revoked_at {
                    Some(at) => format!("revoked {at}"),
                    None => "in force".to_owned(),
                };
                print_line(&format!(
                    "{}  {}  made {}, {state}",
                    token.id, token.name, token.created_at
                ));
            }
        }
        Action::Revoke { id, folder } => {
            folder
                .store()
                .await?
                .revoke_token(id)
                .await
                .map_err(refuse)?;
            if !folder.json {
                print_line(&format!("{id} is out of force"));
            }
        }
    }
    Ok(())
}
