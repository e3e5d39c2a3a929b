//! `loadframe token`: access tokens, in the data folder of a server that may be running.
use clap::{Args, Subcommand, ValueEnum};
use loadframe_api::people::{NewToken, Scope};
use uuid::Uuid;

use super::failure::{Code, Failure};
use super::people::{DataFolder, refuse};
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
        /// What it is for
        #[arg(long)]
        name: String,
        /// What it may do
        #[arg(long, value_enum, default_value_t = TokenScope::Submit)]
        scope: TokenScope,
        /// Whose it is, on a server with people; tokens of workers are nobody's
        #[arg(long, value_name = "NAME")]
        person: Option<String>,
        /// Days it is good for; left out, until it is revoked
        #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=3650))]
        days: Option<u32>,
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

/// What a token may do.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum TokenScope {
    /// Read jobs and results
    Read,
    /// That, and submit and change jobs
    Submit,
    /// Claim jobs and work on them, nothing else
    Worker,
}

impl From<TokenScope> for Scope {
    fn from(scope: TokenScope) -> Self {
        match scope {
            TokenScope::Read => Self::Read,
            TokenScope::Submit => Self::Submit,
            TokenScope::Worker => Self::Worker,
        }
    }
}

pub(crate) async fn perform(arguments: Arguments) -> Result<(), Failure> {
    match arguments.action {
        Action::Create {
            name,
            scope,
            person,
            days,
            folder,
        } => {
            let store = folder.store_or_new().await?;
            let person = match person {
                None => None,
                Some(name) => {
                    let known = store.password_of(&name).await.map_err(refuse)?;
                    let unknown =
                        || Failure::new(Code::Usage, format!("nobody here is called {name:?}"));
                    Some(known.ok_or_else(unknown)?.0)
                }
            };
            let new = NewToken {
                name,
                scope: scope.into(),
                days,
            };
            let token = store.create_token(person, new).await.map_err(refuse)?;
            if folder.json {
                return print_json(&token);
            }
            print_error("The token, shown this once (it can be revoked, not read again):");
            print_line(&token.secret);
        }
        Action::List { folder } => {
            let tokens = folder.store().await?.tokens(None).await.map_err(refuse)?;
            if folder.json {
                return print_json(&tokens);
            }
            if tokens.is_empty() {
                print_line("no tokens");
            }
            for token in tokens {
                let state = match (token.revoked_at, token.expires_at) {
                    (Some(at), _) => format!("revoked {at}"),
                    (None, Some(at)) => format!("until {at}"),
                    (None, None) => "in force".to_owned(),
                };
                let scope = format!("{:?}", token.scope).to_lowercase();
                let owner = token
                    .person
                    .map_or(String::new(), |of| format!(" of {}", of.name));
                print_line(&format!(
                    "{}  {} ({scope}{owner})  made {}, {state}",
                    token.id, token.name, token.created_at
                ));
            }
        }
        Action::Revoke { id, folder } => {
            let store = folder.store().await?;
            store.revoke_token(id, None).await.map_err(refuse)?;
            if !folder.json {
                print_line(&format!("{id} is out of force"));
            }
        }
    }
    Ok(())
}
