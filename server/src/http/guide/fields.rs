//! `/guide/{kind}/fields`: every field of a kind's spec and every result of its jobs, written from its
//! JSON Schema.
//!
//! The anchor of a field is its JSON pointer with dots for slashes, `test.strain_step`; the entries
//! of a list, and what is named freely, are all `*`: `stages.*.run.steps`.
use loadframe_api::{JobKind, kind_schema};
use serde_json::Value;

use super::page::{Page, home_of};
use super::search::Entry;
use crate::http::schema;
use crate::http::sheet::{Content, Room, Sheet};
use crate::http::text::{line, prose, text};

/// A field of a spec.
struct Field<'a> {
    /// Its anchor.
    name: String,
    is_needed: bool,
    /// What it may be: the field itself, and from choices that share its name.
    forms: Vec<&'a Value>,
}

/// The page of a kind, and its fields for searching.
pub(super) fn page(kind: JobKind) -> (Page, Vec<Entry>) {
    let address = format!("/guide/{kind}/fields");
    let title = format!("Fields of {kind}");
    let fields = all(kind_schema(kind));
    let entries = fields.iter().map(|field| {
        let address = format!("{address}#{}", field.name);
        Entry::new(address, &title, &field.name, &field.meaning())
    });
    let entries = entries.collect();

    let mut contents = String::from("<ul>");
    let mut list = String::new();
    for field in &fields {
        if !field.name.contains('.') {
            let name = text(&field.name);
            contents += &format!("<li><a href=\"#{name}\"><code>{name}</code></a></li>");
        }
        list += &field.html();
    }
    contents += "<li><a href=\"#results\">Results</a></li></ul>";
    let results = results(kind_schema(kind));
    let home = home_of(kind);
    let main = format!(
        "<h1>Fields of <code>{kind}</code></h1>\
         <p>{description} <a href=\"{home}\">{title}</a> tells how to use them. This page is written from the \
         JSON Schema that every spec is held against, <a href=\"/v1/kinds/{kind}/schema\"><code>/v1/kinds/{kind}/schema</code></a>; \
         <code>loadframe schema {kind}</code> prints it. Entries of a list, and what you name yourself, are written <code>*</code>. \
         A dimensionless number has no unit.</p>\n<dl class=\"fields\">\n{list}</dl>\n\
         <h2 id=\"results\">Results</h2>\n<p>What its jobs may give; which of these a job gives depends on its spec. \
         <code>*</code> stands for a moment of the test or another result.</p>\n{results}",
        description = text(kind.description()),
        title = text(kind.title()),
    );
    let sheet = Sheet::new(&Content {
        room: Room::Guide,
        title: &title,
        contents: &contents,
        main: &main,
        query: "",
    });
    let page = Page { address, sheet };
    (page, entries)
}

/// The results that jobs of a kind may have.
fn results(spec: &Value) -> String {
    let words = |result: &Value, key: &str| text(result[key].as_str().unwrap_or(""));
    let rows = spec["x-results"].as_array().into_iter().flatten();
    let rows = rows.map(|result| {
        format!(
            "<tr><td><code>{}</code></td><td>{}</td></tr>\n",
            words(result, "name"),
            words(result, "unit")
        )
    });
    let rows = rows.collect::<String>();
    match rows.as_str() {
        "" => "<p>They have the names of the parameters that are found.</p>\n".to_owned(),
        rows => format!(
            "<table><thead><tr><th scope=\"col\">result</th><th scope=\"col\">unit</th></tr></thead>\
             <tbody>\n{rows}</tbody></table>\n"
        ),
    }
}

fn all(spec: &Value) -> Vec<Field<'_>> {
    let mut fields = Vec::new();
    inside(spec, "", &mut fields);
    fields
}

/// The fields of an object, each followed by those inside it; of choices, those of all.
fn inside<'a>(schema: &'a Value, prefix: &str, fields: &mut Vec<Field<'a>>) {
    let needed = schema["required"].as_array();
    let is_needed = |name: &str| needed.is_some_and(|names| names.iter().any(|one| one == name));
    for (name, field) in schema["properties"].as_object().into_iter().flatten() {
        add(format!("{prefix}{name}"), is_needed(name), field, fields);
    }
    if let Some(any) = schema
        .get("additionalProperties")
        .filter(|any| any.is_object())
    {
        add(format!("{prefix}*"), false, any, fields);
    }
    for key in ["oneOf", "anyOf", "allOf"] {
        for form in schema[key].as_array().into_iter().flatten() {
            inside(form, prefix, fields);
        }
    }
    // entries that are plain values are told with their list
    if let Some(entry) = schema.get("items") {
        inside(entry, &format!("{prefix}*."), fields);
    }
}

fn add<'a>(name: String, is_needed: bool, field: &'a Value, fields: &mut Vec<Field<'a>>) {
    let prefix = format!("{name}.");
    match fields.iter_mut().find(|known| known.name == name) {
        Some(known) => known.forms.push(field),
        None => fields.push(Field {
            name,
            is_needed,
            forms: vec![field],
        }),
    }
    inside(field, &prefix, fields);
}

impl Field<'_> {
    /// What the schema says about it, once.
    fn meaning(&self) -> String {
        let mut meanings: Vec<&str> = Vec::new();
        for form in &self.forms {
            let words = form["description"].as_str().unwrap_or("").trim();
            if !words.is_empty() && !meanings.contains(&words) {
                meanings.push(words);
            }
        }
        meanings.join("\n\n")
    }

    fn html(&self) -> String {
        let mut facts: Vec<String> = Vec::new();
        for form in &self.forms {
            let words = facts_of(form);
            if !words.is_empty() && !facts.contains(&words) {
                facts.push(words);
            }
        }
        let options = self
            .forms
            .iter()
            .flat_map(|form| options(form))
            .collect::<String>();
        let options = match options.as_str() {
            "" => String::new(),
            options => format!("<ul>{options}</ul>"),
        };
        let (name, depth) = (text(&self.name), self.name.matches('.').count().min(5));
        format!(
            "<dt id=\"{name}\" class=\"depth{depth}\"><a href=\"#{name}\"><code>{name}</code></a>{needed}</dt>\
             <dd class=\"depth{depth}\"><p class=\"facts\">{facts}</p>{meaning}{options}</dd>\n",
            needed = if self.is_needed { " <b>needed</b>" } else { "" },
            facts = facts.join(" or "),
            meaning = prose(&self.meaning()),
        )
    }
}

/// Type, range, unit and default; of a choice between objects, that it is one.
fn facts_of(schema: &Value) -> String {
    let choices = ["oneOf", "anyOf"]
        .into_iter()
        .filter_map(|key| schema[key].as_array());
    let mut kinds: Vec<String> = Vec::new();
    for choice in choices.flatten().filter(|choice| choice["type"] != "null") {
        let words = match choice["properties"].as_object() {
            Some(_) => "object".to_owned(),
            None => schema::describe(choice),
        };
        if !kinds.contains(&words) {
            kinds.push(words);
        }
    }
    let default = schema.get("default").filter(|default| !default.is_object());
    let mut own = schema.clone();
    if let Some(own) = own.as_object_mut() {
        own.remove("default");
        // nothing is what a field says that is left out
        if let Some(types) = own.get_mut("type").and_then(Value::as_array_mut) {
            types.retain(|name| name != "null");
        }
    }
    let kind = match kinds.is_empty() {
        true => schema::describe(&own),
        false => kinds.join(" or "),
    };
    match default {
        Some(Value::Null) => format!("{kind}, may be left out"),
        Some(default) => format!(
            "{kind}, default <code>{}</code>",
            text(&default.to_string())
        ),
        None => kind,
    }
}

/// The words a field may be, each with its meaning.
fn options(schema: &Value) -> Vec<String> {
    let forms = ["oneOf", "anyOf"]
        .into_iter()
        .filter_map(|key| schema[key].as_array());
    let mut found = Vec::new();
    for form in forms.flatten() {
        let meaning = form["description"].as_str().unwrap_or("");
        if let Some(word) = form.get("const").filter(|_| !meaning.is_empty()) {
            found.push(format!(
                "<li><code>{}</code>: {}</li>",
                text(&word.to_string()),
                line(meaning)
            ));
        }
        found.extend(options(form));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn every_kind_has_its_fields_once() {
        for kind in JobKind::ALL {
            let fields = all(kind_schema(*kind));
            let names: HashSet<_> = fields.iter().map(|field| field.name.as_str()).collect();
            assert_eq!(names.len(), fields.len(), "{kind}");
            assert!(
                names.contains("seed") && names.contains("version"),
                "{kind}"
            );
        }
    }

    #[test]
    fn results_stand_with_their_units() {
        let table = results(kind_schema(JobKind::NonwovenTensile));
        assert!(
            table.contains("<td><code>strength</code></td><td>N/m</td>"),
            "{table}"
        );
        assert!(results(kind_schema(JobKind::Calibrate)).contains("parameters"));
    }

    #[test]
    fn a_field_tells_unit_range_default_and_meaning() {
        let fields = all(kind_schema(JobKind::NonwovenTensile));
        let html = |name: &str| {
            let field = fields.iter().find(|field| field.name == name);
            field.map(Field::html).unwrap_or_else(|| panic!("{name}"))
        };
        let step = html("test.strain_step");
        assert!(
            step.contains("id=\"test.strain_step\"") && step.contains("default <code>0.01</code>"),
            "{step}"
        );
        assert!(
            html("bond.mean_strength_n")
                .contains("<p class=\"facts\">number, 0 … 1e12, N, may be left out</p>")
        );
        assert!(html("test.breaking").contains("<li><code>&quot;weakest_first&quot;</code>: "));
        // of a list of objects, and of what the user names
        html("fabric.network.bonds.*.rest_length_mm");
        let scene = all(kind_schema(JobKind::GranularScene));
        for name in ["materials.*.density_kg_per_m3", "stages.*.run.steps"] {
            assert!(scene.iter().any(|field| field.name == name), "{name}");
        }
    }
}
