//! Schemas, for people.
use serde_json::{Map, Value};

use super::html::{line, prose, text};

/// Every component schema, as a table of its fields.
pub(super) fn all(document: &Value) -> String {
    let schemas = document["components"]["schemas"]
        .as_object()
        .into_iter()
        .flatten();
    schemas
        .map(|(name, schema)| component(name, schema))
        .collect()
}

fn component(name: &str, schema: &Value) -> String {
    let description = prose(schema["description"].as_str().unwrap_or(""));
    let content = match schema["properties"].as_object() {
        Some(_) => format!("<table><tbody>{}</tbody></table>", fields(schema, "")),
        None => format!("<p>{}</p>", describe(schema)),
    };
    let example = schema["examples"].get(0).map(|example| {
        let json = serde_json::to_string_pretty(example).unwrap_or_default();
        format!("<h3>Example</h3><pre>{}</pre>", text(&json))
    });
    format!(
        "<details id=\"schema-{id}\"><summary><code>{id}</code></summary>{description}{content}{}</details>\n",
        example.unwrap_or_default(),
        id = text(name),
    )
}

/// A row for each field, those of nested objects after their owner.
fn fields(schema: &Value, prefix: &str) -> String {
    let needed: Vec<&str> = schema["required"]
        .as_array()
        .map(|names| names.iter().filter_map(Value::as_str).collect())
        .unwrap_or_default();
    let mut rows = String::new();
    for (name, field) in schema["properties"].as_object().into_iter().flatten() {
        let full = format!("{prefix}{name}");
        let mark = if needed.contains(&name.as_str()) {
            "needed"
        } else {
            ""
        };
        rows += &format!(
            "<tr><td><code>{}</code><td>{mark}<td>{}<td>{}</tr>",
            text(&full),
            describe(field),
            line(field["description"].as_str().unwrap_or("")),
        );
        rows += &fields(field, &format!("{full}."));
        for form in ["oneOf", "anyOf"]
            .iter()
            .flat_map(|key| field[*key].as_array())
            .flatten()
        {
            rows += &fields(form, &format!("{full}."));
        }
        rows += &fields(&field["items"], &format!("{full}[]."));
    }
    rows
}

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
    let range = |(low, high, what): &(&str, &str, &str)| match (schema.get(*low), schema.get(*high))
    {
        (Some(low), Some(high)) if low == high => Some(format!("{low}{what}")),
        (Some(low), Some(high)) => Some(format!("{low} … {high}{what}")),
        (Some(low), None) => Some(format!("≥ {low}{what}")),
        (None, Some(high)) => Some(format!("≤ {high}{what}")),
        (None, None) => None,
    };
    pairs.iter().filter_map(range).collect()
}
