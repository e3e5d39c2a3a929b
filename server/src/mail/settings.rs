//! Which server sends e-mail, and from whom: a file, as `--mail` names it.
use std::path::{Path, PathBuf};

use lettre::message::Mailbox;
use serde::Deserialize;
use url::Url;

/// What the file holds.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MailSettings {
    /// Server of SMTP and its port, such as `smtp.example.org:587`.
    pub server: String,
    #[serde(default)]
    pub security: Security,
    /// Name with which to sign in there, where that is asked for.
    #[serde(default)]
    pub user: Option<String>,
    /// File with the password.
    #[serde(default)]
    pub password_file: Option<PathBuf>,
    /// Certificate (PEM) of an authority that vouches for the server, besides those of the system.
    #[serde(default)]
    pub ca_file: Option<PathBuf>,
    /// Who writes, such as `Loadframe <lab@example.org>`.
    pub from: String,
    /// This server as browsers see it, for the links.
    pub address: Url,
}

/// How the way to the server is kept private.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Security {
    /// TLS is demanded after the greeting (RFC 3207), usually at port 587.
    #[default]
    Starttls,
    /// TLS from the beginning (RFC 8314), usually at port 465.
    Tls,
    /// None: without a password only.
    None,
}

/// Why the settings cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MailSettingsError {
    #[error("{path} cannot be read")]
    File {
        path: String,
        #[source]
        source: std::io::Error,
    },
    #[error("{path} is not as it should be")]
    Json {
        path: String,
        #[source]
        source: serde_json::Error,
    },
    #[error("{field} is {value:?}: {allowed}")]
    Field {
        field: &'static str,
        value: String,
        allowed: &'static str,
    },
}

fn wrong(field: &'static str, value: impl ToString, allowed: &'static str) -> MailSettingsError {
    MailSettingsError::Field {
        field,
        value: value.to_string(),
        allowed,
    }
}

/// The text of a file.
///
/// # Errors
/// [`MailSettingsError::File`].
pub(super) fn text_of(path: &Path) -> Result<String, MailSettingsError> {
    std::fs::read_to_string(path).map_err(|source| MailSettingsError::File {
        path: path.display().to_string(),
        source,
    })
}

impl MailSettings {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// [`MailSettingsError`] names the field, its value and what is allowed.
    pub fn read(path: &Path) -> Result<Self, MailSettingsError> {
        let text = text_of(path)?;
        let settings: Self =
            serde_json::from_str(&text).map_err(|source| MailSettingsError::Json {
                path: path.display().to_string(),
                source,
            })?;
        settings.host_and_port()?;
        settings.sender()?;
        if !matches!(settings.address.scheme(), "http" | "https") {
            let allowed = "this server's address, of https or http";
            return Err(wrong("address", &settings.address, allowed));
        }
        match (&settings.user, &settings.password_file) {
            (Some(user), _) if settings.security == Security::None => {
                let allowed = "a password goes over TLS only; leave `user` out, or have `security`";
                Err(wrong("user", user, allowed))
            }
            (Some(user), None) => Err(wrong("user", user, "`password_file` goes with it")),
            (None, Some(path)) => Err(wrong(
                "password_file",
                path.display(),
                "`user` goes with it",
            )),
            _ => Ok(settings),
        }
    }

    /// Host and port of the server.
    ///
    /// # Errors
    /// [`MailSettingsError::Field`].
    pub(super) fn host_and_port(&self) -> Result<(&str, u16), MailSettingsError> {
        let parts = self.server.rsplit_once(':');
        let parts = parts.and_then(|(host, port)| Some((host, port.parse::<u16>().ok()?)));
        let parts = parts.filter(|(host, port)| !host.is_empty() && *port > 0);
        parts.ok_or_else(|| {
            wrong(
                "server",
                &self.server,
                "a name and a port, such as smtp.example.org:587",
            )
        })
    }

    /// Who writes.
    ///
    /// # Errors
    /// [`MailSettingsError::Field`].
    pub(super) fn sender(&self) -> Result<Mailbox, MailSettingsError> {
        let sender = self.from.parse();
        sender.map_err(|_| {
            wrong(
                "from",
                &self.from,
                "an address, such as Loadframe <lab@example.org>",
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<MailSettings, MailSettingsError> {
        let mut file = tempfile::NamedTempFile::new().expect("a file");
        std::io::Write::write_all(&mut file, text.as_bytes()).expect("written");
        MailSettings::read(file.path())
    }

    #[test]
    fn a_file_says_where_from_whom_and_under_which_address() {
        let text = r#"{ "server": "smtp.example.org:587", "from": "Loadframe <lab@example.org>",
            "user": "lab", "password_file": "/etc/loadframe/mail", "address": "https://lab.example.org" }"#;
        let settings = read(text).expect("settings");
        assert_eq!(settings.security, Security::Starttls);
        assert_eq!(
            settings.host_and_port().expect("both"),
            ("smtp.example.org", 587)
        );
    }

    #[test]
    fn each_mistake_is_named() {
        for (text, words) in [
            (
                r#"{ "server": "smtp", "from": "a@b.org", "address": "https://c.org" }"#,
                "server is \"smtp\"",
            ),
            (
                r#"{ "server": "a:25", "from": "nobody", "address": "https://c.org" }"#,
                "from is \"nobody\"",
            ),
            (
                r#"{ "server": "a:25", "from": "a@b.org", "address": "ftp://c.org" }"#,
                "address is",
            ),
            (
                r#"{ "server": "a:25", "from": "a@b.org", "address": "https://c.org", "user": "x" }"#,
                "password_file",
            ),
            (
                r#"{ "server": "a:25", "security": "none", "from": "a@b.org", "address": "https://c.org", "user": "x",
                    "password_file": "/p" }"#,
                "over TLS only",
            ),
        ] {
            let error = read(text).expect_err(text).to_string();
            assert!(error.contains(words), "{error}");
        }
        assert!(matches!(read("{}"), Err(MailSettingsError::Json { .. })));
    }
}
