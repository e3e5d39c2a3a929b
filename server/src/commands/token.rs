//! `loadframe token`: access tokens, in the data folder of a server that may be running.
use std::path::PathBuf;

use clap::{Args, Subcommand};
use loadframe_server::store::{Store, StoreError, StoreOptions};
use uuid::Uuid;

use super::failure::Failure;
use super::terminal::{complain, say, say_json};

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
        place: Place,
    },
    /// List tokens, without their secrets
    List {
        #[command(flatten)]
        place: Place,
    },
    /// Put a token out of force
    Revoke {
        /// Id of the token, as `list` shows it
        id: Uuid,
        #[command(flatten)]
        place: Place,
    },
}

#[derive(Debug, Args)]
struct Place {
    /// Data folder of the server
    #[arg(long, value_name = "DIR", default_value = "loadframe-data")]
    data: PathBuf,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Place {
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
        Action::Create { name, place } => {
            let token = place
                .store()
                .await?
                .create_token(&name)
                .await
                .map_err(refuse)?;
            if place.json {
                return say_json(&token);
            }
            complain("The token, shown this once (it can be revoked, not read again):");
            say(&token.secret);
        }
        Action::List { place } => {
            let tokens = place.store().await?.tokens().await.map_err(refuse)?;
            if place.json {
                return say_json(&tokens);
            }
            if tokens.is_empty() {
                say("no tokens");
            }
            for token in tokens {
                let state = match token.revoked_at {
                    Some(at) => format!("revoked {at}"),
                    None => "in force".to_owned(),
                };
                say(&format!(
                    "{}  {}  made {}, {state}",
                    token.id, token.name, token.created_at
                ));
            }
        }
        Action::Revoke { id, place } => {
            place
                .store()
                .await?
                .revoke_token(id)
                .await
                .map_err(refuse)?;
            if !place.json {
                say(&format!("{id} is out of force"));
            }
        }
    }
    Ok(())
}
