//! Values put into a spec as it is written.
use serde_json::{Map, Value};

use crate::Violation;

/// Puts `value` at `pointer` (RFC 6901) in `spec`; objects that are not there are made.
///
/// # Errors
/// A violation at `pointer`, when it leads nowhere.
pub(super) fn put(spec: &mut Value, pointer: &str, value: &Value) -> Result<(), Box<Violation>> {
    let refused = |detail: String| {
        let violation = Violation::new(pointer, "not_allowed", detail).given(value);
        Box::new(violation.allowed("a JSON pointer into the job's spec: /test/strain_step"))
    };
    let Some(path) = pointer.strip_prefix('/') else {
        return Err(refused(format!("{pointer:?} names no place in a spec")));
    };
    let mut place = spec;
    let mut way = String::new();
    for part in path.split('/') {
        let name = part.replace("~1", "/").replace("~0", "~");
        // what is null is as good as not there
        if place.is_null() {
            *place = Value::Object(Map::new());
        }
        place = match place {
            Value::Object(fields) => fields.entry(name).or_insert(Value::Null),
            Value::Array(entries) => {
                let count = entries.len();
                let entry = name
                    .parse()
                    .ok()
                    .and_then(|index: usize| entries.get_mut(index));
                entry.ok_or_else(|| {
                    refused(format!(
                        "{way} is a list of {count} entries, counted from 0"
                    ))
                })?
            }
            other => return Err(refused(format!("{way} is {other}, which holds no fields"))),
        };
        way = format!("{way}/{part}");
    }
    *place = value.clone();
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn values_are_replaced_added_and_given_the_objects_they_need() {
        let mut spec = json!({"a": {"b": [1, {"c": 2}]}, "n": null});
        for (pointer, value) in [
            ("/a/b/1/c", json!(3)),
            ("/a/b/0", json!("x")),
            ("/x/y/z", json!(0.5)),
            ("/n/m", json!([1])),
            ("/a/d~1e~0f", json!(true)),
        ] {
            put(&mut spec, pointer, &value).expect("a place");
            assert_eq!(spec.pointer(pointer), Some(&value));
        }
        assert_eq!(
            spec,
            json!({"a": {"b": ["x", {"c": 3}], "d/e~f": true}, "n": {"m": [1]}, "x": {"y": {"z": 0.5}}})
        );
    }

    #[test]
    fn pointers_that_lead_nowhere_are_refused_with_what_is_there() {
        for (pointer, said) in [
            ("", "names no place"),
            ("a", "names no place"),
            ("/a/2", "/a is a list of 2 entries"),
            ("/a/-", "/a is a list of 2 entries"),
            ("/s/t", "/s is \"word\""),
        ] {
            let mut spec = json!({"a": [1, 2], "s": "word"});
            let violation = put(&mut spec, pointer, &json!(7)).expect_err("nowhere");
            assert!(violation.detail.contains(said), "{violation}");
            assert_eq!(
                (violation.pointer.as_str(), violation.value),
                (pointer, Some(json!(7)))
            );
        }
    }
}
