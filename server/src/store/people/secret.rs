//! Secrets: random, shown once, kept as their SHA-256.
use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use loadframe_api::sha256_hex;
use rand::Rng;

/// Random bytes of a secret: beyond guessing, so a plain hash protects it.
const BYTES: usize = 32;

/// A fresh secret, and what is kept of it.
pub(super) struct Secret {
    pub(super) text: String,
    pub(super) sha256: String,
}

impl Secret {
    /// A secret that begins with `prefix`, by which people and secret scanners know it.
    pub(super) fn new(prefix: &str) -> Self {
        let mut bytes = [0; BYTES];
        rand::rng().fill_bytes(&mut bytes);
        let text = format!("{prefix}{}", URL_SAFE_NO_PAD.encode(bytes));
        Self {
            sha256: sha256_hex(text.as_bytes()),
            text,
        }
    }
}
