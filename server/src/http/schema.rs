//! What a JSON Schema says about one value, in a few words of HTML.
use serde_json::{Map, Value};

use super::text::text;

/// A schema in a few words: type, limits, unit, default.
pub(super) fn describe(schema: &Value) -> String {
    let Some(schema) = schema.as_object() else {
        return String::new();
    };
    if let Some(target) = schema.get("$ref").and_then(Value::as_str) {
        let name = text(target.rsplit('/').next().unwrap_or(target));
        return format!("<a href=\"#schema-{name}\">{name}</a>");
    }
    let mut words = vec![kind(schema)];
    words.extend(limits(schema));
    if let Some(unit) = schema
        .get("x-unit")
        .and_then(Value::as_str)
        .filter(|unit| *unit != "1")
    {
        words.push(text(unit));
    }
    if let Some(default) = schema.get("default").filter(|default| !default.is_object()) {
        words.push(format!(
            "default <code>{}</code>",
            text(&default.to_string())
        ));
    }
    words.retain(|word| !word.is_empty());
    words.join(", ")
}

fn kind(schema: &Map<String, Value>) -> String {
    if let Some(value) = schema.get("const") {
        return format!("<code>{}</code>", text(&value.to_string()));
    }
    if let Some(values) = schema.get("enum").and_then(Value::as_array) {
        let values = values
            .iter()
            .map(|value| format!("<code>{}</code>", text(&value.to_string())));
        return values.collect::<Vec<_>>().join(" or ");
    }
    for key in ["oneOf", "anyOf", "allOf"] {
        if let Some(forms) = schema.get(key).and_then(Value::as_array) {
            return forms.iter().map(describe).collect::<Vec<_>>().join(" or ");
        }
    }
    let name = match schema.get("type") {
        Some(Value::String(name)) => name.clone(),
        Some(Value::Array(names)) => {
            let names = names.iter().filter_map(Value::as_str);
            names.collect::<Vec<_>>().join(" or ")
        }
        _ => "anything".to_owned(),
    };
    let format = schema.get("format").and_then(Value::as_str);
    let format = format.filter(|format| ["uuid", "date-time"].contains(format));
    match schema.get("items") {
        Some(items) => format!("{} of {}", text(&name), describe(items)),
        None => format.map_or(text(&name), text),
    }
}

fn limits(schema: &Map<String, Value>) -> Vec<String> {
    let pairs = [
        ("minimum", "maximum", ""),
        ("minLength", "maxLength", " characters"),
        ("minItems", "maxItems", " entries"),
    ];
    let limit = |name: &str| schema.get(name).map(number);
    let range = |(low, high, what): &(&str, &str, &str)| match (limit(low), limit(high)) {
        (Some(low), Some(high)) if low == high => Some(format!("{low}{what}")),
        (Some(low), Some(high)) => Some(format!("{low} … {high}{what}")),
        (Some(low), None) => Some(format!("≥ {low}{what}")),
        (None, Some(high)) => Some(format!("≤ {high}{what}")),
        (None, None) => None,
    };
    pairs.iter().filter_map(range).collect()
}

/// Numbers as people write them: 1e12, 0.01, 100000.
fn number(value: &Value) -> String {
    match value.as_f64() {
        Some(number) if number != 0.0 && !(1e-4..1e7).contains(&number.abs()) && value.is_f64() => {
            format!("{number:e}")
        }
        Some(number) if value.is_f64() => format!("{number}"),
        _ => value.to_string(),
    }
}
