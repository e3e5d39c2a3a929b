//! What names and other fields of requests may be.
use loadframe_api::Violation;

use super::super::error::{Result, StoreError};

/// Longest name of a person, group, project or token [characters].
const LONGEST_NAME: usize = 60;

/// A name without spaces around it.
///
/// # Errors
/// [`StoreError::Refused`] where it is empty, long or has characters that cannot be seen.
pub(super) fn clean_name(pointer: &str, name: &str) -> Result<String> {
    let trimmed = name.trim();
    let count = trimmed.chars().count();
    // direction marks and the like would let one name look like another's
    let is_seen = |c: char| {
        !c.is_control()
            && !matches!(c, '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}')
    };
    if (1..=LONGEST_NAME).contains(&count) && trimmed.chars().all(is_seen) {
        return Ok(trimmed.to_owned());
    }
    let detail = "this is not a name that others can read";
    let violation = Violation::new(pointer, "name", detail).value(name);
    let allowed = format!("1 … {LONGEST_NAME} characters that can be seen");
    Err(StoreError::Refused(vec![violation.allowed(allowed)]))
}

/// The form in which names are compared.
pub(super) fn folded(name: &str) -> String {
    name.to_lowercase()
}

/// One thing wrong with a request.
pub(super) fn refused(
    pointer: &str,
    code: &str,
    detail: impl Into<String>,
    value: impl Into<serde_json::Value>,
    allowed: &str,
) -> StoreError {
    let violation = Violation::new(pointer, code, detail).value(value);
    StoreError::Refused(vec![violation.allowed(allowed)])
}
