//! Where a store's database is.
use std::str::FromStr;

use sqlx::ConnectOptions;
use sqlx::postgres::PgConnectOptions;

use super::super::error::StoreError;

/// Where the database is.
#[derive(Clone, Debug, Default)]
pub enum DatabasePlace {
    /// SQLite, in the data folder.
    #[default]
    Folder,
    /// PostgreSQL, shared by servers.
    Server(DatabaseAddress),
}

/// How a PostgreSQL server is reached, and who asks. It may hold a password, which is shown nowhere.
#[derive(Clone)]
pub struct DatabaseAddress(pub(super) Box<PgConnectOptions>);

impl FromStr for DatabaseAddress {
    type Err = StoreError;

    /// Reads `postgres://USER:PASSWORD@HOST:PORT/DATABASE`.
    ///
    /// # Errors
    /// [`StoreError::Invalid`]; the text is not repeated.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let is_one = ["postgres://", "postgresql://"]
            .iter()
            .any(|scheme| text.starts_with(scheme));
        let options = PgConnectOptions::from_str(text).ok().filter(|_| is_one);
        let options = options.ok_or_else(|| {
            let sentence = "the database is named as postgres://USER:PASSWORD@HOST:PORT/DATABASE, with special characters of the password as %XX";
            StoreError::Invalid(sentence.to_owned())
        })?;
        let options = options.application_name("loadframe");
        Ok(Self(Box::new(options.disable_statement_logging())))
    }
}

impl std::fmt::Display for DatabaseAddress {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (host, port) = (self.0.get_host(), self.0.get_port());
        let name = self.0.get_database().unwrap_or(self.0.get_username());
        write!(f, "PostgreSQL database {name} on {host}:{port}")
    }
}

impl std::fmt::Debug for DatabaseAddress {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{self}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_is_shown_without_its_password() {
        let address = DatabaseAddress::from_str("postgres://lab:s3cret@db.example:5433/loadframe");
        let address = address.expect("an address");
        for shown in [address.to_string(), format!("{address:?}")] {
            assert_eq!(shown, "PostgreSQL database loadframe on db.example:5433");
        }
        for wrong in [
            "mysql://lab:s3cret@db/x",
            "lab:s3cret@db",
            "postgres://[::s3cret",
        ] {
            let refused = DatabaseAddress::from_str(wrong).expect_err("no address");
            assert!(!format!("{refused} {refused:?}").contains("s3cret"));
        }
    }
}
