//! A specimen in pictures, before its job is submitted.
use base64::{Engine as _, prelude::BASE64_STANDARD};
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// About how much there is to draw of a specimen, as far as its spec tells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Bonds, particles, cells or the like, whichever are most.
    pub parts: f64,
    /// What they are, in the plural.
    pub what: &'static str,
}

/// The specimen of a spec as it is before its test.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Preview {
    /// What the pictures show, in a sentence or two.
    pub shows: String,
    /// Snapshots of one moment, in the form of those that the job will have.
    pub files: Vec<PreviewFile>,
}

/// A picture of VTK (`.vtp`).
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct PreviewFile {
    /// As the job's own file of that moment, where it has one.
    pub name: String,
    /// The file, in base64.
    #[serde(serialize_with = "written", deserialize_with = "read")]
    #[schemars(with = "String")]
    pub content: Vec<u8>,
}

fn written<S: Serializer>(bytes: &[u8], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&BASE64_STANDARD.encode(bytes))
}

fn read<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<u8>, D::Error> {
    let text = String::deserialize(deserializer)?;
    BASE64_STANDARD
        .decode(text)
        .map_err(serde::de::Error::custom)
}
