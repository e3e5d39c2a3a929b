//! How values stand in the database: names as on the wire (statuses, outcomes, kinds), and JSON.
use loadframe_api::FileEntry;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::error::{Result, StoreError};

/// The name of a unit variant, as on the wire.
pub(super) fn wire_name<T: Serialize>(value: &T) -> Result<String> {
    match serde_json::to_value(value) {
        Ok(serde_json::Value::String(word)) => Ok(word),
        Ok(other) => Err(StoreError::corrupt("word")(format!("{other} is no word"))),
        Err(error) => Err(StoreError::corrupt("word")(error)),
    }
}

/// The variant behind a name.
pub(super) fn variant<T: DeserializeOwned>(word: &str) -> Result<T> {
    let value = serde_json::Value::String(word.to_owned());
    serde_json::from_value(value).map_err(StoreError::corrupt("word"))
}

/// As JSON text.
pub(super) fn json<T: Serialize>(value: &T) -> Result<String> {
    serde_json::to_string(value).map_err(StoreError::corrupt("JSON"))
}

/// From JSON text.
pub(super) fn parsed<T: DeserializeOwned>(text: &str, what: &'static str) -> Result<T> {
    serde_json::from_str(text).map_err(StoreError::corrupt(what))
}

/// A file from its row.
pub(super) fn entry((name, bytes, sha256): (String, i64, String)) -> FileEntry {
    FileEntry {
        name,
        bytes: bytes.unsigned_abs(),
        sha256,
    }
}
