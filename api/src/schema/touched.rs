//! What of a schema a value touches: enough to tell whether it fits, without the forms and fields that it
//! does not use.
//!
//! A field that a value does not have says nothing of it, whatever its schema; lists are followed entry by
//! entry, alternatives each by itself. Keywords that are not known here are kept whole, and so are schemas that
//! refer to themselves.
use serde_json::{Map, Value};

/// Keywords that say nothing of whether a value fits.
const REMARKS: [&str; 6] = [
    "title",
    "description",
    "default",
    "examples",
    "format",
    "x-unit",
];

/// A schema that the value fits if and only if it fits this one; `None` where it is not known to be found.
pub(super) fn by(value: &Value, schema: &Value) -> Option<Value> {
    part(schema, &[value])
}

/// What several values at one place touch.
fn part(schema: &Value, values: &[&Value]) -> Option<Value> {
    let Some(keywords) = schema.as_object() else {
        return Some(schema.clone());
    };
    let mut kept = Map::new();
    for (keyword, said) in keywords {
        let said = match keyword.as_str() {
            "$ref" | "$dynamicRef" => return None,
            remark if REMARKS.contains(&remark) => continue,
            "properties" => fields(said, values)?,
            "additionalProperties" if said.is_object() => {
                let others = others(keywords.get("properties"), values);
                if others.is_empty() {
                    continue;
                }
                part(said, &others)?
            }
            "items" if said.is_object() => {
                let entries: Vec<&Value> = lists(values).flatten().collect();
                if entries.is_empty() {
                    continue;
                }
                part(said, &entries)?
            }
            "prefixItems" => entries(said, values)?,
            "oneOf" | "anyOf" | "allOf" => each(said, |_, form| part(form, values))?,
            _ => said.clone(),
        };
        kept.insert(keyword.clone(), said);
    }
    Some(Value::Object(kept))
}

/// The properties that any of the values has.
fn fields(known: &Value, values: &[&Value]) -> Option<Value> {
    let mut touched = Map::new();
    for (name, schema) in known.as_object()? {
        let held: Vec<&Value> = values.iter().filter_map(|value| value.get(name)).collect();
        if !held.is_empty() {
            touched.insert(name.clone(), part(schema, &held)?);
        }
    }
    Some(Value::Object(touched))
}

/// Fields of objects that are not among the properties.
fn others<'a>(known: Option<&Value>, values: &[&'a Value]) -> Vec<&'a Value> {
    let objects = values
        .iter()
        .filter_map(|value| value.as_object())
        .flatten();
    let is_known = |name: &str| known.is_some_and(|known| known.get(name).is_some());
    let others = objects.filter(|(name, _)| !is_known(name));
    others.map(|(_, value)| value).collect()
}

/// The schemas of the first entries of lists, each for its own.
fn entries(schemas: &Value, values: &[&Value]) -> Option<Value> {
    each(schemas, |index, schema| {
        let held: Vec<&Value> = lists(values).filter_map(|list| list.get(index)).collect();
        part(schema, &held)
    })
}

fn lists<'a>(values: &[&'a Value]) -> impl Iterator<Item = &'a Vec<Value>> {
    values.iter().filter_map(|value| value.as_array())
}

fn each(schemas: &Value, of: impl Fn(usize, &Value) -> Option<Value>) -> Option<Value> {
    let all = schemas.as_array()?.iter().enumerate();
    let touched: Option<Vec<Value>> = all.map(|(index, schema)| of(index, schema)).collect();
    touched.map(Value::Array)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::super::validator_of;
    use super::*;
    use crate::JobKind;
    use crate::kind_schemas::kind_schema;

    /// The value with one of its parts changed, for every part and every change.
    fn changed(value: &Value, see: &mut dyn FnMut(Value)) {
        for other in [
            json!(null),
            json!(-1),
            json!(1e300),
            json!("no"),
            json!([]),
            json!({}),
        ] {
            see(other);
        }
        match value {
            Value::Object(fields) => {
                for (name, field) in fields {
                    let mut without = fields.clone();
                    without.remove(name);
                    see(Value::Object(without));
                    changed(field, &mut |field| {
                        let mut with = fields.clone();
                        with.insert(name.clone(), field);
                        see(Value::Object(with));
                    });
                }
                let mut more = fields.clone();
                more.insert("no_such_field".to_owned(), json!(1));
                see(Value::Object(more));
            }
            Value::Array(items) => {
                for (index, item) in items.iter().enumerate().take(3) {
                    changed(item, &mut |item| {
                        let mut with = items.clone();
                        with[index] = item;
                        see(Value::Array(with));
                    });
                }
                see(items.iter().chain(items).cloned().collect());
            }
            _ => {}
        }
    }

    /// Of so many changes one is tried; prime, so that all sorts of changes have their turn.
    const STRIDE: usize = 7;

    #[test]
    fn what_a_value_touches_judges_it_as_the_whole_schema_does() {
        let mut verdicts = [0, 0];
        for kind in JobKind::ALL {
            let schema = kind_schema(*kind);
            let whole = validator_of(schema).expect("it compiles");
            let example: Value = serde_json::from_str(kind.examples()[0].body).expect("JSON");
            let mut judge = |value: Value| {
                let touched = by(&value, schema).expect("no schema refers to itself");
                let judged = validator_of(&touched)
                    .expect("it compiles")
                    .is_valid(&value);
                assert_eq!(judged, whole.is_valid(&value), "{kind}: {value}");
                verdicts[usize::from(judged)] += 1;
            };
            judge(example["spec"].clone());
            // not all of them: each takes a schema to compile
            let mut count = 0;
            changed(&example["spec"], &mut |value| {
                count += 1;
                if count % STRIDE == 0 {
                    judge(value);
                }
            });
        }
        assert!(verdicts.iter().all(|count| *count > 50), "{verdicts:?}");
    }

    #[test]
    fn fields_that_are_not_there_are_left_out_and_unknown_ones_refused() {
        let schema = json!({"type": "object", "additionalProperties": false, "required": ["a"],
            "properties": {"a": {"type": "number", "minimum": 0}, "b": {"type": "string"}}});
        let touched = by(&json!({"a": 1}), &schema);
        let expected = json!({"type": "object", "additionalProperties": false, "required": ["a"],
            "properties": {"a": {"type": "number", "minimum": 0}}});
        assert_eq!(touched, Some(expected));
        assert_eq!(by(&json!(1), &json!({"$ref": "#"})), None);
    }
}
