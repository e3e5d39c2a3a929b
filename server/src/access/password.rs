//! Passwords: Argon2id with the costs its crate recommends (19 MiB, two passes, one lane, as OWASP's
//! password storage cheat sheet does), in the PHC form that carries salt and costs.
//!
//! A hash takes tens of milliseconds of a core, so callers run it off the threads that answer. Who
//! does not exist costs the same as who gave a wrong password.
use std::sync::OnceLock;

use argon2::Argon2;
use argon2::password_hash::rand_core::OsRng;
use argon2::password_hash::{PasswordHash, PasswordHasher, PasswordVerifier, SaltString};

/// Fewest characters of a password.
pub const SHORTEST: usize = 12;

/// A password could not be hashed; with fixed costs this does not happen.
#[derive(Debug, thiserror::Error)]
#[error("the password could not be hashed: {0}")]
pub struct HashError(argon2::password_hash::Error);

/// What is kept of a password.
///
/// # Errors
/// [`HashError`].
pub fn hash(password: &str) -> Result<String, HashError> {
    let salt = SaltString::generate(&mut OsRng);
    let hash = Argon2::default().hash_password(password.as_bytes(), &salt);
    Ok(hash.map_err(HashError)?.to_string())
}

/// Whether `password` is the one of `kept`; takes the same time where nothing is kept.
pub fn is_right(password: &str, kept: Option<&str>) -> bool {
    static NOBODYS: OnceLock<String> = OnceLock::new();
    let nobodys = || NOBODYS.get_or_init(|| hash("nobody has this password").unwrap_or_default());
    let text = kept.unwrap_or_else(|| nobodys());
    let Ok(parsed) = PasswordHash::new(text) else {
        return false;
    };
    let is_right = Argon2::default()
        .verify_password(password.as_bytes(), &parsed)
        .is_ok();
    is_right && kept.is_some()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_password_is_known_again_and_no_other_is() {
        let kept = hash("correct horse battery").expect("hashed");
        assert!(
            kept.starts_with("$argon2id$v=19$m=19456,t=2,p=1$"),
            "{kept}"
        );
        assert!(is_right("correct horse battery", Some(&kept)));
        assert!(!is_right("correct horse batterz", Some(&kept)));
        assert_ne!(kept, hash("correct horse battery").expect("hashed"));
    }

    #[test]
    fn nobody_has_no_password_not_even_the_one_of_the_comparison() {
        assert!(!is_right("nobody has this password", None));
        assert!(!is_right("anything", Some("no hash")));
    }
}
