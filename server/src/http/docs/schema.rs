//! The component schemas of the OpenAPI document, for people.
use serde_json::Value;

use crate::http::schema::describe;
use crate::http::text::{line, prose, text};

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
        Some(_) => format!(
            "<div class=\"wide\" tabindex=\"0\"><table><tbody>{}</tbody></table></div>",
            fields(schema, "")
        ),
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
