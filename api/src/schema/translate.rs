//! What a validator finds in a small value, in words a user can act on.
use jsonschema::error::{TypeKind, ValidationErrorKind};
use jsonschema::{ValidationError, Validator};
use serde_json::{Map, Value};

use super::escape;
use crate::problem::Violation;
use crate::violations::Violations;

/// A part of a schema, and where in a value it is asked for.
pub(super) struct Place<'a> {
    pub(super) schema: &'a Value,
    /// JSON pointer of the value.
    pub(super) pointer: String,
    /// Unit that a list above states for its entries.
    pub(super) unit: Option<&'a str>,
}

impl<'a> Place<'a> {
    /// The whole schema, for the whole value.
    pub(super) fn root(schema: &'a Value) -> Self {
        Self {
            schema,
            pointer: String::new(),
            unit: None,
        }
    }
}

impl Place<'_> {
    /// Tells all that `validator`, of this place's schema or a part of it, finds in `value`.
    pub(super) fn list(&self, validator: &Validator, value: &Value, found: &mut Violations) {
        for error in validator.iter_errors(value) {
            if found.is_full() {
                return;
            }
            self.translate(&error, found);
        }
    }

    /// Turns a validator's error into violations a user can act on.
    fn translate(&self, error: &ValidationError<'_>, violations: &mut Violations) {
        let pointer = format!("{}{}", self.pointer, error.instance_path());
        let keyword_path = error.schema_path().to_string();
        let node_path = keyword_path.rsplit_once('/').map_or("", |(node, _)| node);
        let node = self.schema.pointer(node_path).unwrap_or(&Value::Null);
        let given = error.instance();
        let at = |code: &str, detail: String| {
            let violation = Violation::new(pointer.clone(), code, detail).given(given);
            let violation = violation.allowed(describe(node));
            match self.unit(node_path) {
                Some(unit) => violation.unit(unit),
                None => violation,
            }
        };
        match error.kind() {
            ValidationErrorKind::AdditionalProperties { unexpected } => {
                let known = node["properties"]
                    .as_object()
                    .map(names)
                    .unwrap_or_default();
                violations.extend(unexpected.iter().map(|name| {
                    Violation::new(
                        format!("{pointer}/{}", escape(name)),
                        "unknown_field",
                        format!("there is no field {name:?} here"),
                    )
                    .given(given.get(name).unwrap_or(&Value::Null))
                    .allowed(format!("fields: {known}"))
                }));
            }
            ValidationErrorKind::Required { property } => {
                let name = property.as_str().unwrap_or_default();
                let wanted = &node["properties"][name];
                let violation = Violation::new(
                    format!("{pointer}/{}", escape(name)),
                    "missing_field",
                    format!("the field {name:?} is missing"),
                )
                .allowed(describe(wanted));
                violations.push(match wanted["x-unit"].as_str() {
                    Some(unit) => violation.unit(unit),
                    None => violation,
                });
            }
            ValidationErrorKind::Minimum { .. }
            | ValidationErrorKind::Maximum { .. }
            | ValidationErrorKind::ExclusiveMinimum { .. }
            | ValidationErrorKind::ExclusiveMaximum { .. } => {
                violations.push(at("out_of_range", format!("{given} is out of range")));
            }
            ValidationErrorKind::Type { kind } => {
                violations.push(at(
                    "wrong_type",
                    format!("expected {}, found {}", expected(kind), type_name(given)),
                ));
            }
            ValidationErrorKind::MinItems { .. } | ValidationErrorKind::MaxItems { .. } => {
                let count = given.as_array().map_or(0, Vec::len);
                violations.push(at("wrong_length", format!("{count} entries given")));
            }
            ValidationErrorKind::UniqueItems => violations.push(at(
                "not_unique",
                "an entry is given more than once".to_owned(),
            )),
            ValidationErrorKind::MinProperties { .. }
            | ValidationErrorKind::MaxProperties { .. } => {
                let count = given.as_object().map_or(0, Map::len);
                violations.push(at("wrong_length", format!("{count} entries given")));
            }
            ValidationErrorKind::MinLength { .. } | ValidationErrorKind::MaxLength { .. } => {
                let count = given.as_str().map_or(0, |text| text.chars().count());
                violations.push(at("wrong_length", format!("{count} characters given")));
            }
            ValidationErrorKind::OneOfNotValid { context }
            | ValidationErrorKind::AnyOf { context } => {
                match meant_branch(error.instance_path().as_str(), context) {
                    Some(branch) => branch
                        .iter()
                        .for_each(|error| self.translate(error, violations)),
                    None => violations.push(at(
                        "not_allowed",
                        "this is none of the accepted forms".to_owned(),
                    )),
                }
            }
            _ => violations.push(at("not_allowed", error.to_string())),
        }
    }

    /// `x-unit` of the quantity at `path`, which an array states once for all its entries.
    fn unit(&self, path: &str) -> Option<&str> {
        let mut path = path;
        loop {
            let node = self.schema.pointer(path)?;
            if let Some(unit) = node["x-unit"].as_str() {
                return Some(unit);
            }
            if path.is_empty() {
                return self.unit;
            }
            path = path.strip_suffix("/items")?;
        }
    }
}

/// Of several accepted forms, the one the user was writing: the only one that fits at its own
/// level, its errors lying deeper.
fn meant_branch<'a>(
    pointer: &str,
    context: &'a [Vec<ValidationError<'static>>],
) -> Option<&'a [ValidationError<'static>]> {
    let fits_above = |branch: &&Vec<ValidationError<'static>>| {
        branch.iter().all(|error| {
            error.instance_path().as_str() != pointer || (is_field_error(error) && !is_tag(error))
        })
    };
    let mut fitting = context.iter().filter(fits_above);
    let first = fitting.next()?;
    fitting.next().is_none().then_some(first)
}

pub(super) fn is_field_error(error: &ValidationError<'_>) -> bool {
    matches!(
        error.kind(),
        ValidationErrorKind::AdditionalProperties { .. } | ValidationErrorKind::Required { .. }
    )
}

/// Whether a missing or unknown field is the one that names an enum's variant.
fn is_tag(error: &ValidationError<'_>) -> bool {
    let path = error.schema_path().to_string();
    path.rsplit('/').nth(2) == Some("oneOf")
}

/// What a schema accepts, in a few words.
pub(super) fn describe(node: &Value) -> String {
    if let Some(value) = node.get("const") {
        return value.to_string();
    }
    if let Some(options) = node["enum"].as_array() {
        return join(options.iter().map(Value::to_string));
    }
    for keyword in ["oneOf", "anyOf"] {
        if let Some(branches) = node[keyword].as_array() {
            return join(branches.iter().map(describe));
        }
    }
    let limit = |keyword: &str| node[keyword].as_f64().map(number);
    let kind = match &node["type"] {
        Value::String(kind) => kind.clone(),
        Value::Array(kinds) => join(kinds.iter().filter_map(Value::as_str).map(str::to_owned)),
        _ => "value".to_owned(),
    };
    let range = |low: Option<String>, high: Option<String>| match (low, high) {
        (Some(low), Some(high)) if low == high => Some(low),
        (Some(low), Some(high)) => Some(format!("{low} … {high}")),
        (Some(low), None) => Some(format!("≥ {low}")),
        (None, Some(high)) => Some(format!("≤ {high}")),
        (None, None) => None,
    };
    if let Some(range) = range(limit("minimum"), limit("maximum")) {
        return if kind.contains("integer") {
            format!("whole numbers {range}")
        } else {
            range
        };
    }
    if let Some(range) = range(limit("minItems"), limit("maxItems")) {
        let unique = node["uniqueItems"].as_bool() == Some(true);
        let unique = if unique { ", all different" } else { "" };
        return format!("{range} entries{unique}");
    }
    if let Some(range) = range(limit("minProperties"), limit("maxProperties")) {
        return format!("{range} entries");
    }
    if let Some(range) = range(limit("minLength"), limit("maxLength")) {
        return format!("{range} characters");
    }
    match node["properties"].as_object() {
        Some(fields) => format!("object with fields: {}", names(fields)),
        None => kind,
    }
}

fn expected(kind: &TypeKind) -> String {
    match kind {
        TypeKind::Single(kind) => kind.to_string(),
        TypeKind::Multiple(kinds) => join(kinds.iter().map(|kind| kind.to_string())),
    }
}

fn type_name(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "boolean",
        Value::Number(_) => "number",
        Value::String(_) => "string",
        Value::Array(_) => "array",
        Value::Object(_) => "object",
    }
}

fn names(fields: &Map<String, Value>) -> String {
    fields
        .keys()
        .map(String::as_str)
        .collect::<Vec<_>>()
        .join(", ")
}

fn join(parts: impl Iterator<Item = String>) -> String {
    parts.collect::<Vec<_>>().join(" or ")
}

/// Numbers as people write them: 1e12, 0.01, 100000.
fn number(value: f64) -> String {
    if value != 0.0 && !(1e-4..1e7).contains(&value.abs()) {
        format!("{value:e}")
    } else {
        format!("{value}")
    }
}
