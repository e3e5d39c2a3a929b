//! The fields in which specs differ.
//!
//! Specs are looked at twice: once to find out which fields differ, of which only the first value is kept,
//! and once for the values of those that do. So memory is that of the answer, not of the specs.
use indexmap::IndexMap;
use loadframe_api::sha256_hex;
use serde_json::Value;

/// Longest text or list that is told value by value [bytes of JSON, entries].
const LONGEST_TOLD: usize = 200;
const LONGEST_LIST: usize = 16;
/// Fields of all specs that are looked at.
const MOST_LOOKED_AT: usize = 20_000;
/// Fields that differ and are listed.
const MOST_FIELDS: usize = 200;

/// What is found in specs, by their pointers.
#[derive(Debug, Default)]
pub(in crate::http) struct Fields {
    seen: IndexMap<String, Seen>,
    specs: usize,
    left_out: u64,
}

#[derive(Debug)]
struct Seen {
    first: Value,
    /// Specs that have the field.
    count: usize,
    differs: bool,
}

impl Fields {
    /// Looks at one more spec.
    pub(in crate::http) fn look_at(&mut self, spec: &Value) {
        self.specs += 1;
        let mut pointer = String::new();
        self.walk(spec, &mut pointer);
    }

    fn walk(&mut self, value: &Value, pointer: &mut String) {
        let length = pointer.len();
        match value {
            Value::Object(fields) if !fields.is_empty() => {
                for (name, field) in fields {
                    pointer.push('/');
                    pointer.push_str(&name.replace('~', "~0").replace('/', "~1"));
                    self.walk(field, pointer);
                    pointer.truncate(length);
                }
            }
            Value::Array(items) if is_told_by_item(items) => {
                for (index, item) in items.iter().enumerate() {
                    pointer.push('/');
                    pointer.push_str(&index.to_string());
                    self.walk(item, pointer);
                    pointer.truncate(length);
                }
            }
            leaf => self.note(pointer, told(leaf)),
        }
    }

    fn note(&mut self, pointer: &str, value: Value) {
        if let Some(seen) = self.seen.get_mut(pointer) {
            seen.count += 1;
            seen.differs |= seen.first != value;
        } else if self.seen.len() < MOST_LOOKED_AT {
            let seen = Seen {
                first: value,
                count: 1,
                differs: false,
            };
            self.seen.insert(pointer.to_owned(), seen);
        } else {
            self.left_out += 1;
        }
    }

    /// Pointers of all fields that were seen, and how many specs have each.
    pub(in crate::http) fn every(self) -> impl Iterator<Item = (String, usize)> {
        let seen = self.seen.into_iter();
        seen.map(|(pointer, seen)| (pointer, seen.count))
    }

    /// Pointers of the fields that differ, in the order of the specs, and how many more there are.
    pub(super) fn that_differ(self) -> (Vec<String>, u64) {
        let specs = self.specs;
        let differing = self
            .seen
            .into_iter()
            .filter(|(_, seen)| seen.differs || seen.count < specs);
        let mut pointers: Vec<String> = differing.map(|(pointer, _)| pointer).collect();
        let beyond = pointers.len().saturating_sub(MOST_FIELDS);
        pointers.truncate(MOST_FIELDS);
        (pointers, self.left_out + beyond as u64)
    }
}

/// Short lists are compared entry by entry.
fn is_told_by_item(items: &[Value]) -> bool {
    (1..=LONGEST_LIST).contains(&items.len())
}

/// The value as it is listed: what is long by its length and the beginning of its SHA-256.
pub(super) fn told(value: &Value) -> Value {
    let (text, size) = match value {
        Value::Null | Value::Bool(_) | Value::Number(_) => return value.clone(),
        Value::String(text) => (text.clone(), format!("{} characters", text.chars().count())),
        Value::Array(items) => (value.to_string(), format!("{} entries", items.len())),
        Value::Object(fields) => (value.to_string(), format!("{} fields", fields.len())),
    };
    if text.len() <= LONGEST_TOLD {
        return value.clone();
    }
    let digest = sha256_hex(text.as_bytes());
    let beginning: String = digest.chars().take(16).collect();
    Value::String(format!("{size}, SHA-256 {beginning}…"))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn differing(specs: &[Value]) -> Vec<String> {
        let mut fields = Fields::default();
        specs.iter().for_each(|spec| fields.look_at(spec));
        fields.that_differ().0
    }

    #[test]
    fn only_what_differs_or_is_absent_somewhere_is_listed_in_the_order_of_the_specs() {
        let first = json!({ "seed": 1, "bond": { "modulus_n": 0.4, "sigma": 0.3 }, "spacing": [20, 20, 10] });
        let other = json!({ "seed": 2, "bond": { "modulus_n": 0.4, "sigma": 0.5 }, "spacing": [20, 20, 12],
            "new": { "a~b/c": null } });
        let expected = ["/seed", "/bond/sigma", "/spacing/2", "/new/a~0b~1c"];
        assert_eq!(differing(&[first.clone(), other.clone()]), expected);
        assert!(differing(&[first.clone(), first.clone(), first]).is_empty());
        assert!(differing(&[other]).is_empty());
    }

    #[test]
    fn an_empty_object_is_not_the_same_as_none() {
        let [empty, none] = [json!({ "deposition": {} }), json!({ "deposition": null })];
        assert_eq!(differing(&[empty, none]), ["/deposition"]);
    }

    #[test]
    fn long_lists_are_told_by_length_and_hash_and_differ_in_any_entry() {
        let list = |last: f64| {
            let mut all = vec![0.25; 999];
            all.push(last);
            json!({ "nodes": all })
        };
        assert_eq!(differing(&[list(1.0), list(2.0)]), ["/nodes"]);
        assert!(differing(&[list(1.0), list(1.0)]).is_empty());
        let text = told(&list(1.0)["nodes"]);
        let text = text.as_str().expect("a text");
        assert!(text.starts_with("1000 entries, SHA-256 "), "{text}");
    }

    #[test]
    fn fields_beyond_those_listed_are_counted() {
        let many = |value: usize| {
            let named = (0..MOST_FIELDS + 7).map(|index| (format!("f{index}"), json!(value)));
            Value::Object(named.collect())
        };
        let mut fields = Fields::default();
        fields.look_at(&many(1));
        fields.look_at(&many(2));
        let (listed, beyond) = fields.that_differ();
        assert_eq!((listed.len(), beyond), (MOST_FIELDS, 7));
    }
}
