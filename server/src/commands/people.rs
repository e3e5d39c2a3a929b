//! `loadframe people`: making a server a group's, in its data folder, beside a server that may be
//! running. Everything else people do on the page.
use std::io::IsTerminal;
use std::path::PathBuf;

use clap::{Args, Subcommand};
use loadframe_server::store::people::Actor;
use loadframe_server::store::{DatabasePlace, Store, StoreError, StoreOptions};

use super::database::DatabaseOptions;
use super::failure::{Code, Failure};
use super::secret::secret_in;
use super::terminal::{print_error, print_json, print_line};

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// Make a server of one person a group's: its first administrator, who gets every job there is
    CreateAdmin {
        /// Name to sign in with
        name: String,
        /// File that holds the password; left out, it is asked for
        #[arg(long, value_name = "FILE")]
        password_file: Option<PathBuf>,
        #[command(flatten)]
        folder: DataFolder,
    },
    /// List people
    List {
        #[command(flatten)]
        folder: DataFolder,
    },
    /// Set a password that was forgotten; ends the person's sessions
    SetPassword {
        /// Whose
        name: String,
        /// File that holds the password; left out, it is asked for
        #[arg(long, value_name = "FILE")]
        password_file: Option<PathBuf>,
        #[command(flatten)]
        folder: DataFolder,
    },
}

#[derive(Debug, Args)]
pub(crate) struct DataFolder {
    /// Data folder of the server
    #[arg(long, value_name = "DIR", default_value = "loadframe-data")]
    data: PathBuf,
    #[command(flatten)]
    database: DatabaseOptions,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

impl DataFolder {
    fn options(&self) -> Result<StoreOptions, Failure> {
        Ok(StoreOptions {
            database: self.database.place()?,
            ..StoreOptions::new(&self.data)
        })
    }

    pub(crate) async fn store(&self) -> Result<Store, Failure> {
        let store = Store::open_beside(self.options()?).await;
        Ok(store.map_err(refuse)?.acting(Actor::shell()))
    }

    /// Also before a server was ever started: makes the store, and says so.
    pub(crate) async fn store_or_new(&self) -> Result<Store, Failure> {
        let options = self.options()?;
        let is_new = matches!(options.database, DatabasePlace::Folder) && !Store::is_in(&self.data);
        let store = Store::make_beside(options).await;
        let store = store.map_err(refuse)?.acting(Actor::shell());
        if is_new {
            print_error(&format!(
                "A new store was made in {0}: `loadframe serve --data {0}` serves it.",
                self.data.display()
            ));
        }
        Ok(store)
    }
}

#[expect(clippy::needless_pass_by_value, reason = "it is what map_err gives")]
pub(crate) fn refuse(error: StoreError) -> Failure {
    match &error {
        StoreError::Refused(violations) => {
            let lines: Vec<String> = violations.iter().map(ToString::to_string).collect();
            Failure::new(Code::Usage, lines.join("\n"))
        }
        error => Failure::of(error),
    }
}

pub(crate) async fn perform(arguments: Arguments) -> Result<(), Failure> {
    match arguments.action {
        Action::CreateAdmin {
            name,
            password_file,
            folder,
        } => {
            let store = folder.store_or_new().await?;
            let password = password(password_file).await?;
            let made = store.create_first_administrator(&name, &password).await;
            let made = made.map_err(refuse)?;
            if folder.json {
                return print_json(&made);
            }
            print_line(&format!(
                "{} is the administrator; every job is theirs. Sign in on the page, and invite others there.",
                made.name
            ));
            let tokens = store.tokens(Some(made.id)).await.map_err(refuse)?;
            let in_force = tokens.iter().filter(|token| token.revoked_at.is_none());
            let names: Vec<&str> = in_force.map(|token| token.name.as_str()).collect();
            if !names.is_empty() {
                print_error(&format!(
                    "Tokens of before are theirs, too ({}): revoke those that others hold with `loadframe token revoke ID`.",
                    names.join(", ")
                ));
            }
        }
        Action::List { folder } => {
            let people = folder.store().await?.people().await.map_err(refuse)?;
            if folder.json {
                return print_json(&people);
            }
            if people.is_empty() {
                print_line("nobody: this server is one person's");
            }
            for person in people {
                let left = person
                    .left_at
                    .map_or(String::new(), |at| format!(", left {at}"));
                let role = format!("{:?}", person.role).to_lowercase();
                print_line(&format!("{}  {} ({role}{left})", person.id, person.name));
            }
        }
        Action::SetPassword {
            name,
            password_file,
            folder,
        } => {
            let store = folder.store().await?;
            let known = store.password_of(&name).await.map_err(refuse)?;
            let unknown = || Failure::new(Code::Usage, format!("nobody here is called {name:?}"));
            let (id, _) = known.ok_or_else(unknown)?;
            let password = password(password_file).await?;
            store
                .set_password(id, &password, None)
                .await
                .map_err(refuse)?;
            if !folder.json {
                print_line("The password is set; all sessions have ended.");
            }
        }
    }
    Ok(())
}

/// A password from a file, or asked for without showing it.
async fn password(file: Option<PathBuf>) -> Result<String, Failure> {
    if let Some(path) = file {
        return secret_in(&path);
    }
    if !std::io::stdin().is_terminal() {
        let message =
            "there is no terminal to ask for the password; give a file with --password-file";
        return Err(Failure::new(Code::Usage, message.to_owned()));
    }
    let ask = || {
        let terminal = console::Term::stderr();
        terminal.write_str("Password (12 characters or more): ")?;
        let first = terminal.read_secure_line()?;
        terminal.write_str("The same again: ")?;
        let second = terminal.read_secure_line()?;
        Ok::<_, std::io::Error>((first, second))
    };
    let asked = tokio::task::spawn_blocking(ask).await;
    let (first, second) = asked
        .map_err(|error| Failure::of(&error))?
        .map_err(|error| Failure::of(&error))?;
    if first != second {
        return Err(Failure::new(Code::Usage, "the two differ".to_owned()));
    }
    Ok(first)
}
