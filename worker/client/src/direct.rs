//! Messages of a worker that sends large contents to the server's bucket by itself.
//!
//! A claim is answered with the header [`DIRECT_FROM_HEADER`] where that may be. The worker then asks for
//! addresses ([`DirectRequest`]), sends the parts there, and says so ([`DirectEnd`]); the answer is how many
//! bytes of the content are kept: all, or none when the upload is gone and has to begin anew.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Header of a lease: files and checkpoints of so many bytes [B] or more may be sent directly.
pub const DIRECT_FROM_HEADER: &str = "loadframe-direct-from";

/// `POST /v1/worker/leases/{id}/uploads`: asks where the parts of a large file are to be sent.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DirectRequest {
    /// Of the whole content.
    #[schemars(length(equal = 64))]
    pub sha256: String,
    /// Length of the content [B].
    pub bytes: u64,
    /// An upload of it that was begun under this lease, to be gone on with.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(max = 2000))]
    pub upload: Option<String>,
}

/// Where the parts of a content go.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DirectUpload {
    pub upload: String,
    /// Length of each part but the last [B].
    pub part_bytes: u64,
    /// An address for the PUT of each part, in order.
    pub addresses: Vec<String>,
    /// How long the addresses are good for [s].
    pub good_for_s: f64,
}

/// `POST /v1/worker/leases/{id}/uploads/{sha256}`: all parts have been sent.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DirectEnd {
    #[schemars(length(max = 2000))]
    pub upload: String,
    /// Length of the content [B].
    pub bytes: u64,
    /// `ETag` of each part, in order.
    #[schemars(length(max = 10_000))]
    pub parts: Vec<String>,
    pub becomes: Becomes,
}

/// What a content that a worker has sent is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Becomes {
    /// A file of the result; uploading a name again replaces it.
    File {
        #[schemars(length(min = 1, max = 200))]
        name: String,
    },
    /// A checkpoint, to which all files uploaded so far by this attempt belong.
    Checkpoint {
        /// Wall and processor time [s] of the work up to it.
        #[schemars(range(min = 0.0))]
        wall_s: f64,
        #[schemars(range(min = 0.0))]
        cpu_s: f64,
    },
}
