//! Names of result files.

/// The folder in which a failed job has what it had until then: no result.
pub const PARTIAL_FOLDER: &str = "partial/";

/// Why a name is not a result file's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "a file name is 1 to 200 characters of a-z A-Z 0-9 . _ - in parts joined by /, none of them . or .."
)]
pub struct FileNameError;

/// Accepts relative paths that are safe on every file system and in every archive.
///
/// # Errors
/// [`FileNameError`] for anything else.
pub fn check_file_name(name: &str) -> Result<(), FileNameError> {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '_' | '-');
    let is_part =
        |part: &str| !part.is_empty() && !part.starts_with('.') && part.chars().all(is_plain);
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
        for good in ["curve.csv", "snapshots/step_00010.vtp"] {
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
            "é",
        ] {
            assert!(check_file_name(bad).is_err(), "{bad}");
        }
    }
}
