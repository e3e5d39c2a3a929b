//! JSON, read so that every error keeps its place and no key is given twice.
use indexmap::IndexMap;
use serde::Deserialize;
use serde::de::{DeserializeSeed, Deserializer, MapAccess, SeqAccess, Visitor};
use serde_json::map::Entry;
use serde_json::value::RawValue;
use serde_json::{Map, Number, Value};

use crate::SubmissionError;
use crate::problem::Violation;
use crate::schema::escape;
use crate::signature;

/// Most values in a body: a network of about 300 000 bonds, each with its strength. A value takes
/// about 70 bytes once read, so that the memory a body takes is bounded beyond its length.
const MOST_VALUES: usize = 4_000_000;

/// How many values the text can hold at most, judged by the marks that begin one.
fn values(text: &[u8]) -> usize {
    let (mut count, mut is_text, mut is_escaped) = (1, false, false);
    for byte in text {
        match byte {
            _ if is_escaped => is_escaped = false,
            b'\\' if is_text => is_escaped = true,
            b'"' => is_text = !is_text,
            b',' | b'[' | b'{' if !is_text => count += 1,
            _ => {}
        }
    }
    count
}

/// Doubled keys that are listed before it is left at those.
const LISTED: usize = 20;

/// Refuses a body that would take too much memory once read.
///
/// # Errors
/// When it holds more than [`MOST_VALUES`].
pub(crate) fn check_size(body: &[u8]) -> Result<(), SubmissionError> {
    if body.len() > MOST_VALUES && values(body) > MOST_VALUES {
        let violation = Violation::new("", "too_large", "the body holds too many values")
            .allowed(format!("at most {MOST_VALUES} values"));
        return Err(SubmissionError::Invalid(vec![violation]));
    }
    Ok(())
}

/// The value of a text.
///
/// # Errors
/// When it is not JSON, or an object in it has a key more than once.
pub(crate) fn parse(body: &[u8]) -> Result<Value, SubmissionError> {
    check_size(body)?;
    if let Some(other) = signature::of(body) {
        let violation = Violation::new("", "syntax", format!("this is no JSON text: it {other}"));
        let violation = violation.allowed("JSON (RFC 8259) in UTF-8 without a byte-order mark");
        return Err(SubmissionError::Syntax(Box::new(violation)));
    }
    let mut doubled = Vec::new();
    let mut reader = serde_json::Deserializer::from_slice(body);
    let unique = Unique {
        place: &Place::Body,
        doubled: &mut doubled,
    };
    let value = unique.deserialize(&mut reader).map_err(|error| {
        // where it is broken is looked for in those that are, so that the others are read quickly
        syntax(place_of_error(body), &error)
    })?;
    reader
        .end()
        .map_err(|error| syntax(String::new(), &error))?;
    if doubled.is_empty() {
        Ok(value)
    } else {
        Err(SubmissionError::Invalid(doubled))
    }
}

/// The pointer of the value at which a text is no JSON.
fn place_of_error(body: &[u8]) -> String {
    let mut reader = serde_json::Deserializer::from_slice(body);
    let mut track = serde_path_to_error::Track::new();
    let unique = Unique {
        place: &Place::Body,
        doubled: &mut Vec::new(),
    };
    let within = serde_path_to_error::Deserializer::new(&mut reader, &mut track);
    // it fails here as it failed before
    let _ = unique.deserialize(within);
    pointer(&track.path())
}

/// Where a value stands: what is around it, and its index or key therein.
enum Place<'a> {
    Body,
    Entry(&'a Place<'a>, usize),
    Field(&'a Place<'a>, &'a str),
}

impl Place<'_> {
    fn pointer(&self) -> String {
        match self {
            Self::Body => String::new(),
            Self::Entry(around, index) => format!("{}/{index}", around.pointer()),
            Self::Field(around, key) => format!("{}/{}", around.pointer(), escape(key)),
        }
    }
}

/// Reads a value and notes the keys that an object has more than once, of which JSON readers keep the
/// last without a word.
struct Unique<'a> {
    place: &'a Place<'a>,
    doubled: &'a mut Vec<Violation>,
}

impl<'de> DeserializeSeed<'de> for Unique<'_> {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Value, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Unique<'_> {
    type Value = Value;

    fn expecting(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(Value::Bool(value))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E>(self, value: f64) -> Result<Value, E> {
        Ok(Number::from_f64(value).map_or(Value::Null, Value::Number))
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_string<E>(self, value: String) -> Result<Value, E> {
        Ok(Value::String(value))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<Value, A::Error> {
        let mut list = Vec::new();
        while let Some(entry) = entries.next_element_seed(Unique {
            place: &Place::Entry(self.place, list.len()),
            doubled: self.doubled,
        })? {
            list.push(entry);
        }
        Ok(Value::Array(list))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Value, A::Error> {
        let mut fields = Map::new();
        while let Some(key) = entries.next_key::<String>()? {
            let value = entries.next_value_seed(Unique {
                place: &Place::Field(self.place, &key),
                doubled: self.doubled,
            })?;
            match fields.entry(key) {
                Entry::Vacant(field) => _ = field.insert(value),
                Entry::Occupied(mut field) => {
                    if self.doubled.len() < LISTED {
                        self.doubled.push(doubled(self.place, field.key()));
                    }
                    field.insert(value);
                }
            }
        }
        Ok(Value::Object(fields))
    }
}

fn doubled(place: &Place<'_>, key: &str) -> Violation {
    let detail = format!("duplicate field `{key}`");
    let violation = Violation::new(place.pointer(), "duplicate_field", detail);
    violation.value(key).allowed("every key once")
}

fn syntax(pointer: String, error: &serde_json::Error) -> SubmissionError {
    let code = if error.is_eof() {
        "truncated"
    } else {
        "syntax"
    };
    let violation = Violation::new(pointer, code, error.to_string())
        .value(format!("line {}, column {}", error.line(), error.column()))
        .allowed("JSON (RFC 8259): finite numbers within ±1.8e308, at most 127 levels deep");
    SubmissionError::Syntax(Box::new(violation))
}

/// Parses into `T`; what is refused is said with its pointer under `prefix`.
pub(crate) fn typed<'de, T: Deserialize<'de>>(
    text: &'de [u8],
    prefix: &str,
) -> Result<T, SubmissionError> {
    serde_json::from_slice(text).map_err(|error| refused(text, prefix, &error))
}

fn refused(text: &[u8], prefix: &str, error: &serde_json::Error) -> SubmissionError {
    let place = format!("{prefix}{}", place_at(text, end_of(text, error)));
    let detail = error.to_string();
    // its line and column are those of the spec alone
    let told = detail.rsplit_once(" at line ");
    let detail = told.map_or(&*detail, |(detail, _)| detail);
    SubmissionError::Invalid(vec![Violation::new(place, "wrong_type", detail)])
}

/// Bytes of a text up to the end of what was refused, or into it: an array or object of which none is wanted is
/// refused before it is read.
fn end_of(text: &[u8], error: &serde_json::Error) -> usize {
    let lines = text.split_inclusive(|byte| *byte == b'\n');
    let before: usize = lines
        .take(error.line().saturating_sub(1))
        .map(<[u8]>::len)
        .sum();
    let read = before + error.column();
    read + usize::from(matches!(text.get(read), Some(b'[' | b'{')))
}

/// The pointer of the innermost value of a JSON text that ends at so many bytes, or goes on there.
///
/// Types are read without a trace of where they are: one for each of them takes longer to compile than all
/// else here.
fn place_at(text: &[u8], end: usize) -> String {
    let mut place = String::new();
    let mut within = text;
    while let Some((segment, value)) = entries(within).into_iter().find(|(_, value)| {
        let from = value.get().as_ptr().addr() - text.as_ptr().addr();
        from < end && end <= from + value.get().len()
    }) {
        place.push('/');
        place.push_str(&segment);
        within = value.get().as_bytes();
    }
    place
}

/// What an array or an object consists of: pieces of the text, each with its segment of a pointer.
fn entries(text: &[u8]) -> Vec<(String, &RawValue)> {
    if let Ok(fields) = serde_json::from_slice::<IndexMap<String, _>>(text) {
        let fields = fields.into_iter();
        fields.map(|(key, value)| (escape(&key), value)).collect()
    } else if let Ok(list) = serde_json::from_slice::<Vec<_>>(text) {
        let list = list.into_iter().enumerate();
        list.map(|(index, value)| (index.to_string(), value))
            .collect()
    } else {
        Vec::new()
    }
}

fn pointer(path: &serde_path_to_error::Path) -> String {
    use serde_path_to_error::Segment;
    path.iter()
        .filter_map(|segment| match segment {
            Segment::Seq { index } => Some(format!("/{index}")),
            Segment::Map { key } => Some(format!("/{}", escape(key))),
            Segment::Enum { variant } => Some(format!("/{}", escape(variant))),
            Segment::Unknown => None,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn violations(text: &[u8]) -> Vec<Violation> {
        parse(text).expect_err("it is refused").violations()
    }

    #[test]
    fn values_are_those_of_the_text() {
        let text = r#"{"a": [1, -2, 1.5, 1e300, true, null, "x\u00e9"], "b": {"c": {}}, "d": 18446744073709551615}"#;
        let expected: Value = serde_json::from_str(text).expect("JSON");
        assert_eq!(parse(text.as_bytes()).expect("JSON"), expected);
    }

    #[test]
    fn doubled_keys_are_refused_wherever_they_stand() {
        let found =
            violations(br#"{"a": {"x": 1, "x": 2}, "b": [{}, {"y/z": {"k": 1, "k": 1}}], "a": 3}"#);
        let places: Vec<_> = found
            .iter()
            .map(|v| (v.pointer.as_str(), v.value.as_ref().and_then(Value::as_str)))
            .collect();
        let expected = [("/a", Some("x")), ("/b/1/y~1z", Some("k")), ("", Some("a"))];
        assert_eq!(places, expected);
        assert!(found.iter().all(|v| v.code == "duplicate_field"));
    }

    #[test]
    fn what_is_no_json_text_says_what_it_is() {
        for (text, word) in [
            (&b"\x1f\x8b\x08\x00"[..], "gzip"),
            (b"\xef\xbb\xbf{}", "byte-order mark"),
            (b"\xff\xfe{\0}\0", "UTF-16"),
            (b"PK\x03\x04", "ZIP"),
        ] {
            let found = violations(text);
            assert!(found[0].detail.contains(word), "{found:?}");
        }
    }

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    #[allow(dead_code, reason = "it is read, and refused")]
    struct Read {
        #[serde(default, rename = "a/b~")]
        counts: Vec<[u8; 2]>,
        #[serde(default)]
        one_of: Option<OneOf>,
        #[serde(default)]
        within: std::collections::BTreeMap<String, Option<Box<Read>>>,
        #[serde(default)]
        word: String,
    }

    #[derive(Debug, Deserialize)]
    #[serde(rename_all = "snake_case")]
    #[allow(dead_code, reason = "it is read, and refused")]
    enum OneOf {
        Plain,
        Share(f64),
        Full { from: u32 },
    }

    #[test]
    fn what_is_of_another_type_is_named_by_its_place() {
        for (text, place) in [
            ("7", ""),
            (r#"{"word": 1}"#, "/word"),
            (r#"{"word": true , "within": {}}"#, "/word"),
            (
                "{\n  \"within\": {\"word\": {\n\"word\":\t[ 1 ] }}\n}",
                "/within/word/word",
            ),
            (r#"{"a/b~": [[1, 2], [3, 4.0]]}"#, "/a~1b~0/1/1"),
            (r#"{"a/b~": [[1, 2], [3, 256], [7]]}"#, "/a~1b~0/1/1"),
            (r#"{"a/b~": [[1, -2]]}"#, "/a~1b~0/0/1"),
            (r#"{"a/b~": [[1]]}"#, "/a~1b~0/0"),
            (r#"{"word": "}", "a/b~": [[1, 2, 3]]}"#, "/a~1b~0/0/2"),
            (r#"{"one_of": {"share": "half"}}"#, "/one_of/share"),
            (r#"{"one_of": {"full": {}}}"#, "/one_of/full"),
            (r#"{"one_of": "other"}"#, "/one_of"),
            (
                r#"{"within": {"x": null, "\u00e9\"]": {"one_of": {"full": {"from": 1e3}}}}}"#,
                "/within/é\"]/one_of/full/from",
            ),
        ] {
            let found = typed::<Read>(text.as_bytes(), "/spec").expect_err(text);
            let found = found.violations();
            assert_eq!(found[0].pointer, format!("/spec{place}"), "{text}");
            assert!(!found[0].detail.contains("column"), "{found:?}");
        }
    }
}
