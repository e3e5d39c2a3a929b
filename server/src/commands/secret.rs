//! Secrets that a command is given: from a file or the environment, never on the command line, which
//! every user of the machine can read in the list of processes.
use std::path::{Path, PathBuf};

use clap::Args;

use super::failure::{Code, Failure};

/// The variable that holds a token.
pub(crate) const TOKEN: &str = "LOADFRAME_TOKEN";
/// Longer files hold no token [bytes].
const LONGEST: u64 = 4096;

/// Where the token of a command comes from.
#[derive(Clone, Debug, Args)]
pub(crate) struct TokenSource {
    /// File that holds the access token; left out, the variable LOADFRAME_TOKEN does
    #[arg(long, value_name = "FILE")]
    token_file: Option<PathBuf>,
    /// Refused: every user of this machine would see it
    #[arg(long, hide = true, value_name = "TOKEN")]
    token: Option<String>,
}

impl TokenSource {
    /// The file that holds the token, where it comes from one.
    pub(crate) fn file(&self) -> Option<&Path> {
        self.token_file.as_deref()
    }

    /// The token, if there is one.
    ///
    /// # Errors
    /// When the file cannot be read or holds none, or when the token was given on the command line.
    pub(crate) fn read(&self) -> Result<Option<String>, Failure> {
        if self.token.is_some() {
            let sentence = "a token on the command line is seen by every user of this machine: put it into a file for --token-file or into LOADFRAME_TOKEN, and make a new one, for this one was seen";
            return Err(Failure::new(Code::Usage, sentence.to_owned()));
        }
        match &self.token_file {
            Some(path) => secret_in(path).map(Some),
            None => Ok(std::env::var(TOKEN).ok().filter(|token| !token.is_empty())),
        }
    }
}

/// The one line of a file.
///
/// # Errors
/// When it cannot be read, is empty, or holds more than a line.
pub(crate) fn secret_in(path: &Path) -> Result<String, Failure> {
    let refuse = |why: String| Failure::new(Code::Usage, format!("{}: {why}", path.display()));
    let size = std::fs::metadata(path).map_err(|error| refuse(error.to_string()))?;
    if size.len() > LONGEST {
        return Err(refuse(format!("{} bytes are no secret", size.len())));
    }
    let text = std::fs::read_to_string(path).map_err(|error| refuse(error.to_string()))?;
    let secret = text.trim();
    if secret.is_empty() || secret.contains('\n') {
        return Err(refuse("it should hold one line, the secret".to_owned()));
    }
    Ok(secret.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_token_is_taken_from_the_command_line() {
        let source = TokenSource {
            token_file: None,
            token: Some("lf_secret".to_owned()),
        };
        let refusal = source.read().expect_err("it is refused").to_string();
        assert!(refusal.contains("--token-file") && !refusal.contains("lf_secret"));
    }

    #[test]
    fn a_file_holds_one_secret_in_one_line() {
        let folder = tempfile::TempDir::new().expect("a folder");
        let path = folder.path().join("token");
        let read = |text: &str| {
            std::fs::write(&path, text).expect("written");
            secret_in(&path).ok()
        };
        assert_eq!(read("lf_abc\n"), Some("lf_abc".to_owned()));
        assert_eq!(read("\n"), None);
        assert_eq!(read("a\nb\n"), None);
        assert_eq!(read(&"a".repeat(5000)), None);
        assert!(secret_in(&folder.path().join("missing")).is_err());
    }
}
