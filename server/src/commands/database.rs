//! Where a server's database is: options of `serve`, `lab` and of commands beside a server.
use std::path::PathBuf;

use clap::Args;
use loadframe_server::store::DatabasePlace;
use url::Url;

use super::failure::{Code, Failure};
use super::secret::secret_in;

/// The variable that names a database.
const DATABASE: &str = "LOADFRAME_DATABASE";

/// A database server, where the database is not in the data folder.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct DatabaseOptions {
    /// Keep the database on a PostgreSQL server, which servers may share, instead of the data folder; with a
    /// password the address comes from --database-file or the variable `LOADFRAME_DATABASE`
    #[arg(
        long,
        value_name = "postgres://USER@HOST/NAME",
        conflicts_with = "database_file"
    )]
    database: Option<String>,
    /// File of one line, that address, which others must not be able to read
    #[arg(long, value_name = "FILE")]
    database_file: Option<PathBuf>,
}

impl DatabaseOptions {
    /// Where the database is.
    ///
    /// # Errors
    /// When the address is none, or one with a password stands on the command line.
    pub(crate) fn place(&self) -> Result<DatabasePlace, Failure> {
        let address = match (&self.database, &self.database_file) {
            (Some(address), _) => {
                let has_password = |address: &Url| address.password().is_some();
                if Url::parse(address).is_ok_and(|address| has_password(&address)) {
                    let sentence = "a password on the command line is seen by every user of this machine: put the address into a file for --database-file or into LOADFRAME_DATABASE, and choose another password, for this one was seen";
                    return Err(Failure::new(Code::Usage, sentence.to_owned()));
                }
                Some(address.clone())
            }
            (None, Some(path)) => Some(secret_in(path)?),
            (None, None) => std::env::var(DATABASE).ok(),
        };
        match address.filter(|address| !address.is_empty()) {
            None => Ok(DatabasePlace::Folder),
            Some(address) => address
                .parse()
                .map(DatabasePlace::Server)
                .map_err(|error| Failure::of(&error)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(address: &str) -> Result<DatabasePlace, Failure> {
        let options = DatabaseOptions {
            database: Some(address.to_owned()),
            database_file: None,
        };
        options.place()
    }

    #[test]
    fn an_address_with_a_password_is_not_taken_from_the_command_line() {
        let refusal = named("postgres://lab:s3cret@db/lab").expect_err("it is refused");
        let refusal = refusal.to_string();
        assert!(refusal.contains("--database-file") && !refusal.contains("s3cret"));
        assert!(matches!(
            named("postgres://lab@db/lab"),
            Ok(DatabasePlace::Server(_))
        ));
        assert!(named("sqlite://lab").is_err());
    }
}
