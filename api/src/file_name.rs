//! Names of result files.

/// The folder in which a failed job has what it had until then: no result.
pub const PARTIAL_FOLDER: &str = "partial/";

/// Why a name is not a result file's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "a file name is 1 to 200 characters of a-z A-Z 0-9 . _ - in parts joined by /, none of which begins or ends with . or is a device of Windows such as con or nul"
)]
pub struct FileNameError;

/// Names that Windows takes for devices in every folder, whatever follows a point (Microsoft, "Naming Files,
/// Paths, and Namespaces").
const DEVICES: [&str; 4] = ["con", "prn", "aux", "nul"];
/// The same with a digit of 1 to 9 behind.
const PORTS: [&str; 2] = ["com", "lpt"];

fn is_device(part: &str) -> bool {
    let stem = part.split('.').next().unwrap_or_default();
    let stem = stem.to_ascii_lowercase();
    let is_port = |port: &&str| {
        let digit = stem.strip_prefix(*port);
        digit.is_some_and(|digit| matches!(digit.as_bytes(), [b'1'..=b'9']))
    };
    DEVICES.contains(&&*stem) || PORTS.iter().any(is_port)
}

/// Accepts relative paths that are safe on every file system and in every archive.
///
/// # Errors
/// [`FileNameError`] for anything else.
pub fn check_file_name(name: &str) -> Result<(), FileNameError> {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '_' | '-');
    let is_part = |part: &str| {
        // Windows leaves points out at the end
        let has_points = part.starts_with('.') || part.ends_with('.');
        !part.is_empty() && !has_points && !is_device(part) && part.chars().all(is_plain)
    };
    if name.len() <= 200 && name.split('/').all(is_part) {
        Ok(())
    } else {
        Err(FileNameError)
    }
}

#[cfg(test)]
mod tests {
    use super::check_file_name;

    #[test]
    fn only_plain_relative_paths_pass() {
        for good in [
            "curve.csv",
            "snapshots/step_00010.vtp",
            "console.csv",
            "com10",
        ] {
            assert!(check_file_name(good).is_ok(), "{good}");
        }
        for bad in [
            "",
            "/etc/passwd",
            "a//b",
            "../a",
            "a/..",
            "a\\b",
            "a b",
            ".hidden",
            "a.",
            "a./b",
            "con",
            "a/NUL.csv",
            "Com1.tar.gz",
            "é",
        ] {
            assert!(check_file_name(bad).is_err(), "{bad}");
        }
    }
}
