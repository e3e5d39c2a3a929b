//! Mistakes in large values, part by part.
//!
//! A validator that lists what is wrong gathers all of it first, with a copy of whatever takes one of
//! several forms: a million wrong entries are a million errors in memory. So a large value is taken
//! apart along the schema: at each level only what the level itself says of it, and of its parts only
//! those that do not fit, which a walk that keeps nothing tells. The validator's own lists are asked of
//! small values alone.
use jsonschema::Validator;
use serde_json::{Map, Value};

use super::escape;
use super::translate::{Place, describe, is_field_error};
use crate::problem::Violation;
use crate::violations::{Violations, shorten};

/// What a validator is asked to list everything of: so many values, so many bytes of text at most.
/// An error takes about half a kilobyte, and one of several forms a copy of the value for each.
const SMALL_VALUES: usize = 1_000;
const SMALL_TEXT: usize = 64 << 10;

impl<'a> Place<'a> {
    /// Tells what is wrong with a value that does not fit.
    pub(super) fn search(&self, value: &Value, found: &mut Violations) {
        if is_small(value) {
            if let Some(validator) = compiled(self.schema) {
                self.list(&validator, value, found);
            }
            return;
        }
        if let Some(validator) = compiled(&own_level(self.schema)) {
            self.list(&validator, value, found);
        }
        for branch in branches(self.schema, "allOf") {
            self.same(branch).search_if_wrong(value, found);
        }
        for keyword in ["oneOf", "anyOf"] {
            self.search_forms(keyword, value, found);
        }
        match value {
            Value::Array(items) => self.search_items(items, found),
            Value::Object(fields) => self.search_fields(fields, found),
            _ => {}
        }
    }

    fn search_if_wrong(&self, value: &Value, found: &mut Violations) {
        if let Some(validator) = compiled(self.schema)
            && !validator.is_valid(value)
        {
            self.search(value, found);
        }
    }

    fn search_items(&self, items: &[Value], found: &mut Violations) {
        let Some(schema) = self.schema.get("items") else {
            return;
        };
        let Some(validator) = compiled(schema) else {
            return;
        };
        let unit = self.schema["x-unit"].as_str().or(self.unit);
        for (index, item) in items.iter().enumerate() {
            if found.is_full() {
                return;
            }
            if validator.is_valid(item) {
                continue;
            }
            let place = Place {
                schema,
                pointer: format!("{}/{index}", self.pointer),
                unit,
            };
            if is_small(item) {
                place.list(&validator, item, found);
            } else {
                place.search(item, found);
            }
        }
    }

    fn search_fields(&self, fields: &Map<String, Value>, found: &mut Violations) {
        let known = self.schema["properties"].as_object();
        let other = self.schema.get("additionalProperties");
        let other = other.filter(|schema| schema.is_object());
        let of_other = other.and_then(compiled);
        for (name, field) in fields {
            if found.is_full() {
                return;
            }
            let known = known.and_then(|known| known.get(name));
            let of_known = known.and_then(compiled);
            let (Some(schema), Some(validator)) =
                (known.or(other), of_known.as_ref().or(of_other.as_ref()))
            else {
                continue;
            };
            if !validator.is_valid(field) {
                let mut pointer = format!("{}/{}", self.pointer, escape(name));
                shorten(&mut pointer);
                let unit = None;
                Place {
                    schema,
                    pointer,
                    unit,
                }
                .search(field, found);
            }
        }
    }

    /// Of several accepted forms, the one the user was writing: the only one that fits at its own
    /// level.
    fn search_forms(&self, keyword: &str, value: &Value, found: &mut Violations) {
        let forms = branches(self.schema, keyword);
        let fitting = forms.iter().filter(|form| {
            let validator = compiled(form);
            validator.is_some_and(|validator| validator.is_valid(value))
        });
        match (fitting.count(), keyword) {
            _ if forms.is_empty() => return,
            (1, _) | (2.., "anyOf") => return,
            _ => {}
        }
        // a form's own field is what tells it from its siblings, so that it has to be there
        let may_miss_fields = keyword == "anyOf";
        let mut meant = forms.iter().filter(|form| {
            let Some(validator) = compiled(&own_level(form)) else {
                return false;
            };
            let mut errors = validator.iter_errors(value);
            errors.all(|error| may_miss_fields && is_field_error(&error))
        });
        match (meant.next(), meant.next()) {
            (Some(form), None) => self.same(form).search(value, found),
            _ => {
                let detail = "this is none of the accepted forms";
                let violation = Violation::new(&self.pointer, "not_allowed", detail).given(value);
                let violation = violation.allowed(describe(self.schema));
                found.push(match self.unit {
                    Some(unit) => violation.unit(unit),
                    None => violation,
                });
            }
        }
    }

    /// Another schema for the same value.
    fn same(&self, schema: &'a Value) -> Self {
        Self {
            schema,
            pointer: self.pointer.clone(),
            unit: self.unit,
        }
    }
}

fn branches<'a>(schema: &'a Value, keyword: &str) -> &'a [Value] {
    schema[keyword].as_array().map_or(&[], Vec::as_slice)
}

/// A test compiles every schema and with it all its parts, so that `None` is not met in service.
fn compiled(schema: &Value) -> Option<Validator> {
    jsonschema::draft202012::new(schema).ok()
}

/// A schema without what it says of parts: whether a field is known, how many entries there are.
fn own_level(schema: &Value) -> Value {
    let Some(keywords) = schema.as_object() else {
        return schema.clone();
    };
    let own = keywords.iter().filter_map(|(keyword, said)| {
        let said = match keyword.as_str() {
            "items" | "prefixItems" | "contains" | "oneOf" | "anyOf" | "allOf" => return None,
            "properties" => {
                let names = said.as_object().into_iter().flat_map(Map::keys);
                names
                    .map(|name| (name.clone(), Value::Bool(true)))
                    .collect()
            }
            "additionalProperties" => Value::Bool(*said != Value::Bool(false)),
            _ => said.clone(),
        };
        Some((keyword.clone(), said))
    });
    own.collect()
}

fn is_small(value: &Value) -> bool {
    fn fits(value: &Value, values: &mut usize, text: &mut usize) -> bool {
        let mut takes = |bytes: usize| {
            let room = text.checked_sub(bytes);
            *text = room.unwrap_or_default();
            room.is_some()
        };
        let Some(left) = values.checked_sub(1) else {
            return false;
        };
        *values = left;
        match value {
            Value::String(string) => takes(string.len()),
            Value::Array(items) => items.iter().all(|item| fits(item, values, text)),
            Value::Object(fields) => fields.iter().all(|(name, field)| {
                let room = text.checked_sub(name.len());
                *text = room.unwrap_or_default();
                room.is_some() && fits(field, values, text)
            }),
            Value::Null | Value::Bool(_) | Value::Number(_) => true,
        }
    }
    let (mut values, mut text) = (SMALL_VALUES, SMALL_TEXT);
    fits(value, &mut values, &mut text)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn schema() -> Value {
        json!({
            "type": "object", "additionalProperties": false, "required": ["form"],
            "properties": {
                "form": {"oneOf": [
                    {"type": "object", "additionalProperties": false, "required": ["grid"],
                     "properties": {"grid": {"type": "integer"}}},
                    {"type": "object", "additionalProperties": false, "required": ["list"],
                     "properties": {"list": {"type": "array", "maxItems": 100_000, "x-unit": "mm",
                        "items": {"type": "array", "items": {"type": "number", "minimum": 0}}}}},
                ]},
                "names": {"type": "object", "additionalProperties": {"type": "integer"}},
            },
        })
    }

    fn found(value: &Value) -> Vec<Violation> {
        let mut found = Violations::default();
        Place::root(&schema()).search(value, &mut found);
        found.into_vec()
    }

    #[test]
    fn an_entry_deep_in_a_large_list_is_found_with_its_unit() {
        let mut list = vec![json!([1.0, 2.0]); 50_000];
        list[40_000] = json!([1.0, -2.0]);
        let found = found(&json!({"form": {"list": list}}));
        assert_eq!(found.len(), 1, "{found:#?}");
        assert_eq!(found[0].pointer, "/form/list/40000/1");
        assert_eq!(found[0].code, "out_of_range");
        assert_eq!(found[0].unit.as_deref(), Some("mm"));
    }

    #[test]
    fn each_level_says_what_is_wrong_with_itself() {
        let long = vec![json!([1.0]); 100_001];
        let found = found(&json!({"form": {"list": long, "grid": 1}, "nmaes": {}}));
        let places: Vec<_> = found.iter().map(|v| (&*v.pointer, &*v.code)).collect();
        // two forms at once are none; the unknown field is told beside it
        assert_eq!(
            places,
            [("/nmaes", "unknown_field"), ("/form", "not_allowed")]
        );
        let long = vec![json!([1.0]); 100_001];
        let found = super::tests::found(&json!({"form": {"list": long}}));
        assert_eq!(
            (&*found[0].pointer, &*found[0].code),
            ("/form/list", "wrong_length")
        );
    }

    #[test]
    fn a_large_object_and_a_long_name_are_searched_too() {
        let many = (0..20_000).map(|number| (format!("name{number}"), json!(number)));
        let mut names: Map<String, Value> = many.collect();
        names.insert("x".repeat(2 << 20), json!("no number"));
        let found = found(&json!({"form": {"grid": 1}, "names": names}));
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].code, "wrong_type");
        assert!(found[0].pointer.len() < 3000);
    }

    #[test]
    fn a_million_mistakes_are_as_many_as_are_shown() {
        let found = found(&json!({"form": {"list": vec![json!(null); 1_000_000]}}));
        assert_eq!(found.len(), 100);
    }
}
