//! Where a bucket is and who may use it.
use std::fmt;
use std::path::Path;

use serde::{Deserialize, Serialize};
use url::Url;

/// From this size on [bytes] it pays to send a file directly: a small one costs more messages than bytes.
const DIRECT_FROM: u64 = 16 << 20;

/// A bucket, its server, and what this server of ours does with it. Without keys it can be named, not used.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BucketSettings {
    pub bucket: String,
    /// What keys begin with, without slashes at its ends; may be empty.
    pub prefix: String,
    /// Address of the bucket's server; `None` for Amazon's.
    pub endpoint: Option<String>,
    pub region: String,
    #[serde(skip)]
    pub keys: Option<BucketKeys>,
    /// Files of so many bytes or more are sent to the bucket by workers themselves; `None` for none.
    #[serde(skip)]
    pub direct_from: Option<u64>,
    /// Whether whoever fetches a file is sent to the bucket for it.
    #[serde(skip)]
    pub redirects: bool,
}

/// Keys of a bucket, which are never shown.
#[derive(Clone, PartialEq, Eq)]
pub struct BucketKeys {
    pub id: String,
    pub secret: String,
    /// Of keys that end.
    pub session: Option<String>,
}

impl fmt::Debug for BucketKeys {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("BucketKeys")
    }
}

impl fmt::Display for BucketSettings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "s3://{}", self.bucket)?;
        if !self.prefix.is_empty() {
            write!(f, "/{}", self.prefix)?;
        }
        match &self.endpoint {
            Some(endpoint) => write!(f, " at {endpoint}"),
            None => Ok(()),
        }
    }
}

impl BucketSettings {
    /// Of an address `s3://bucket/prefix`.
    ///
    /// # Errors
    /// A sentence on what is wrong with it.
    pub fn at(address: &str, endpoint: Option<&str>, region: &str) -> Result<Self, String> {
        let wrong =
            |what: &str| format!("{address:?} {what}; it should be like s3://bucket/prefix");
        let rest = address
            .strip_prefix("s3://")
            .ok_or_else(|| wrong("is not the address of a bucket"))?;
        let (bucket, prefix) = rest.split_once('/').unwrap_or((rest, ""));
        let is_plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || ".-".contains(c);
        if !(3..=63).contains(&bucket.len()) || !bucket.chars().all(is_plain) {
            return Err(wrong(
                "names no bucket (3 to 63 lower-case letters, digits, dots and dashes)",
            ));
        }
        let prefix = prefix.trim_matches('/');
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "._-/".contains(c);
        let is_odd = |part: &str| matches!(part, "" | "." | "..");
        if !prefix.is_empty() && (!prefix.chars().all(is_plain) || prefix.split('/').any(is_odd)) {
            return Err(wrong(
                "has a prefix of other characters than letters, digits, dots, dashes and slashes",
            ));
        }
        if let Some(endpoint) = endpoint {
            let parsed = Url::parse(endpoint).ok();
            // keys have no place in an address, which is shown
            let is_good = parsed.is_some_and(|url| {
                matches!(url.scheme(), "http" | "https")
                    && url.host().is_some()
                    && url.username().is_empty()
                    && url.password().is_none()
                    && url.query().is_none()
            });
            if !is_good {
                return Err(
                    "the address of the bucket's server should be like https://garage:3900"
                        .to_owned(),
                );
            }
        }
        Ok(Self {
            bucket: bucket.to_owned(),
            prefix: prefix.to_owned(),
            endpoint: endpoint.map(|endpoint| endpoint.trim_end_matches('/').to_owned()),
            region: region.to_owned(),
            keys: None,
            direct_from: Some(DIRECT_FROM),
            redirects: false,
        })
    }

    /// Whether both are the same place, however it is used.
    pub(in super::super) fn is_same_place(&self, other: &Self) -> bool {
        (&self.bucket, &self.prefix, &self.endpoint)
            == (&other.bucket, &other.prefix, &other.endpoint)
    }
}

impl BucketKeys {
    /// Reads a file of two lines, id and secret, that others cannot read.
    ///
    /// # Errors
    /// A sentence on what is wrong with it, without anything of its content.
    pub fn read(file: &Path) -> Result<Self, String> {
        let name = file.display();
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            let mode = std::fs::metadata(file).map(|file| file.permissions().mode());
            if mode.is_ok_and(|mode| mode & 0o077 != 0) {
                return Err(format!("others can read {name}: chmod 600 it"));
            }
        }
        let text = std::fs::read_to_string(file);
        let text = text.map_err(|error| format!("{name} cannot be read: {error}"))?;
        let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
        match (lines.next(), lines.next(), lines.next()) {
            (Some(id), Some(secret), None) => Ok(Self {
                id: id.to_owned(),
                secret: secret.to_owned(),
                session: None,
            }),
            _ => Err(format!(
                "{name} should have two lines: the id of the key, and its secret"
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_is_a_bucket_and_a_prefix() {
        let at = |address| BucketSettings::at(address, Some("http://garage:3900/"), "garage");
        let settings = at("s3://lab/loadframe/one/").expect("a good address");
        assert_eq!(
            (settings.bucket.as_str(), settings.prefix.as_str()),
            ("lab", "loadframe/one")
        );
        assert_eq!(
            settings.to_string(),
            "s3://lab/loadframe/one at http://garage:3900"
        );
        assert_eq!(at("s3://lab").expect("no prefix").prefix, "");
        for bad in [
            "lab",
            "s3://",
            "s3://L/x",
            "s3://lab/../x",
            "s3://lab/a//b",
            "s3://lab/a b",
            "file:///srv",
        ] {
            assert!(at(bad).expect_err(bad).contains("s3://bucket/prefix"));
        }
        for bad in ["garage:3900", "ftp://x", "https://me:secret@x"] {
            let refused = BucketSettings::at("s3://lab", Some(bad), "x").expect_err(bad);
            assert!(!refused.contains("secret"), "{refused}");
        }
    }

    #[test]
    fn keys_are_two_lines_that_nobody_else_reads_and_are_never_shown() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("keys");
        let write = |text: &str, mode| {
            std::fs::write(&file, text).expect("written");
            std::fs::set_permissions(&file, std::fs::Permissions::from_mode(mode)).expect("set");
        };
        write("GK12\nhidden\n", 0o600);
        let keys = BucketKeys::read(&file).expect("good keys");
        assert_eq!((keys.id.as_str(), keys.secret.as_str()), ("GK12", "hidden"));
        assert!(!format!("{keys:?}").contains("hidden"));
        write("GK12\nhidden\n", 0o644);
        assert!(BucketKeys::read(&file).expect_err("open").contains("chmod"));
        write("GK12 hidden", 0o600);
        let refused = BucketKeys::read(&file).expect_err("one line");
        assert!(!refused.contains("hidden"), "{refused}");
    }
}
