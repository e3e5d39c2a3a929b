//! Text of a file: byte-order marks, UTF-16, and files that are no text at all.
use base64::{Engine as _, prelude::BASE64_STANDARD};

use super::{Place, Refusal};
use crate::signature;

/// Fewest characters of base64 that are taken for a file: shorter texts may be words.
const SHORTEST_FILE: usize = 24;
/// The text of a table, and how it was coded where that is worth a word.
///
/// # Errors
/// When it is no text.
pub(super) fn text(given: &str) -> Result<(String, Option<String>), Refusal> {
    let marks = [',', ';', '\t', '\n', '\r', ' ', '|'];
    let trimmed = given.trim();
    if trimmed.len() >= SHORTEST_FILE
        && !trimmed.contains(marks)
        && let Ok(bytes) = BASE64_STANDARD.decode(trimmed)
    {
        return decode(&bytes);
    }
    // a file of UTF-16 that was read as if each of its bytes were a character
    if given.contains('\0') {
        let bytes: Option<Vec<u8>> = given.chars().map(|c| u8::try_from(c).ok()).collect();
        let bytes = bytes.unwrap_or_else(|| {
            // bytes that were no characters became marks of replacement
            let lost = given.trim_start_matches('\u{fffd}').chars();
            lost.map(|c| u8::try_from(c).unwrap_or(b'?')).collect()
        });
        return decode(&bytes);
    }
    let plain = given
        .trim_start_matches('\u{feff}')
        .trim_start_matches("\u{ef}\u{bb}\u{bf}");
    Ok((plain.to_owned(), None))
}

fn decode(bytes: &[u8]) -> Result<(String, Option<String>), Refusal> {
    if let Some(rest) = bytes.strip_prefix(b"\xff\xfe") {
        return utf16(rest, u16::from_le_bytes);
    }
    if let Some(rest) = bytes.strip_prefix(b"\xfe\xff") {
        return utf16(rest, u16::from_be_bytes);
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if let Some(other) = signature::of(bytes) {
        return Err(no_text(&format!("this file {other}")));
    }
    // the high bytes of Western letters are 0
    let zeros = |offset: usize| {
        let halves = bytes.iter().skip(offset).step_by(2);
        halves.filter(|byte| **byte == 0).count()
    };
    if bytes.contains(&0) {
        return if zeros(1) > zeros(0) {
            utf16(bytes, u16::from_le_bytes)
        } else {
            utf16(bytes, u16::from_be_bytes)
        };
    }
    Ok(match std::str::from_utf8(bytes) {
        Ok(text) => (text.to_owned(), None),
        Err(_) => (
            bytes.iter().map(|byte| char::from(*byte)).collect(),
            Some("text in Latin-1".to_owned()),
        ),
    })
}

fn utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Result<(String, Option<String>), Refusal> {
    let units: Vec<u16> = bytes
        .chunks_exact(2)
        .map(|pair| unit([pair[0], pair[1]]))
        .collect();
    let text = String::from_utf16(&units)
        .map_err(|_| no_text("it holds zero bytes and is not UTF-16 either"))?;
    if text.contains('\0') {
        return Err(no_text("it holds zero bytes and is not UTF-16 either"));
    }
    Ok((
        text.trim_start_matches('\u{feff}').to_owned(),
        Some("text in UTF-16".to_owned()),
    ))
}

fn no_text(detail: &str) -> Refusal {
    let allowed = "text in UTF-8, or a file of UTF-8, UTF-16 or Latin-1 in base64";
    Refusal::new(Place::Text, "syntax", detail, allowed)
}
