//! What a message looks like, and how it is signed.
use hmac::{Hmac, KeyInit, Mac};
use loadframe_api::Timestamp;
use serde_json::{Value, json};
use sha2::Sha256;

use crate::store::people::Due;

/// Header that holds moment and signature.
pub const SIGNATURE: &str = "loadframe-signature";

/// The body: every event with its number, by which a receiver knows one that comes twice.
pub(super) fn body(due: &Due, now: Timestamp) -> String {
    let events: Vec<Value> = due
        .events
        .iter()
        .map(|of| json!({ "number": of.number, "event": of.event, "at": of.at.to_string(), "about": of.about }))
        .collect();
    json!({ "webhook": due.id, "sent_at": now.to_string(), "events": events }).to_string()
}

/// `t=SECONDS,v1=HEX`: HMAC-SHA256 (RFC 2104) of `SECONDS.BODY` under the webhook's secret. A receiver
/// compares it, and refuses what is older than five minutes.
pub fn signature(secret: &str, now: Timestamp, body: &str) -> String {
    let seconds = now.as_millis() / 1000;
    let mac = Hmac::<Sha256>::new_from_slice(secret.as_bytes()).map(|mut mac| {
        mac.update(format!("{seconds}.{body}").as_bytes());
        mac.finalize().into_bytes()
    });
    let digits = mac.map(|bytes| bytes.iter().map(|byte| format!("{byte:02x}")).collect());
    // a key of any length is taken
    let digits: String = digits.unwrap_or_default();
    format!("t={seconds},v1={digits}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_signature_is_that_of_the_standard() {
        // Python: hmac.new(b"lfw_x", b'1700000000.{"a":1}', "sha256").hexdigest()
        let signed = signature("lfw_x", Timestamp(1_700_000_000_999), "{\"a\":1}");
        let digits = "2ed92fbf2541a73238e640d8688cd7773ae1ae88c5f06713e12f4fc7e1b810fb";
        assert_eq!(signed, format!("t=1700000000,v1={digits}"));
    }
}
