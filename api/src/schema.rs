//! JSON Schema as the one source of types, units, limits and their error messages.
use jsonschema::error::{TypeKind, ValidationErrorKind};
use jsonschema::{ValidationError, Validator};
use schemars::generate::{Contract, SchemaSettings};
use schemars::{JsonSchema, SchemaGenerator};
use serde_json::{Map, Value};

use crate::problem::Violation;

/// At most this many violations are listed; a hundred are as clear as a million.
const LISTED: usize = 100;

/// A schema compiled for checking, with its text for messages.
pub(crate) struct Checker {
    pub(crate) schema: Value,
    validator: Option<Validator>,
}

/// Schemas by name of what the service reads, for `#/components/schemas`: a field that may be left
/// out is not required.
pub fn body_schemas(add: impl FnOnce(&mut SchemaGenerator)) -> Map<String, Value> {
    component_schemas(Contract::Deserialize, add)
}

/// Schemas by name of what the service writes, for `#/components/schemas`: a field that is always
/// there is required, `null` or not.
pub fn answer_schemas(add: impl FnOnce(&mut SchemaGenerator)) -> Map<String, Value> {
    component_schemas(Contract::Serialize, add)
}

fn component_schemas(
    contract: Contract,
    add: impl FnOnce(&mut SchemaGenerator),
) -> Map<String, Value> {
    let settings = SchemaSettings::draft2020_12().with(|settings| {
        settings.definitions_path = "/components/schemas".into();
        settings.contract = contract;
    });
    let mut generator = settings.into_generator();
    add(&mut generator);
    generator.take_definitions(true)
}

/// `x-unit` of the value that `pointer` names in what `schema` describes, which an array states once
/// for all its entries.
pub(crate) fn unit_at<'a>(schema: &'a Value, pointer: &str) -> Option<&'a str> {
    let (name, rest) = match pointer.strip_prefix('/') {
        None => return schema["x-unit"].as_str(),
        Some(path) => match path.find('/') {
            Some(end) => (&path[..end], &path[end..]),
            None => (path, ""),
        },
    };
    let name = name.replace("~1", "/").replace("~0", "~");
    let of_array = schema.get("items").map(|item| {
        let own = schema["x-unit"].as_str();
        unit_at(item, rest).or(own)
    });
    let of_field = [
        schema["properties"].get(&name),
        schema.get("additionalProperties"),
    ]
    .into_iter()
    .flatten()
    .find_map(|field| unit_at(field, rest));
    of_field.or(of_array.flatten()).or_else(|| {
        let branches = ["oneOf", "anyOf", "allOf"].into_iter();
        let mut branches = branches.filter_map(|keyword| schema[keyword].as_array());
        branches.find_map(|branches| branches.iter().find_map(|branch| unit_at(branch, pointer)))
    })
}

impl Checker {
    /// Whether the schema compiles.
    #[cfg(test)]
    pub(crate) fn is_usable(&self) -> bool {
        self.validator.is_some()
    }

    pub(crate) fn of<T: JsonSchema>() -> Self {
        let settings =
            SchemaSettings::draft2020_12().with(|settings| settings.inline_subschemas = true);
        let schema = settings
            .into_generator()
            .into_root_schema_for::<T>()
            .to_value();
        // a test compiles every schema, so that `None` is not met in service
        let validator = jsonschema::draft202012::new(&schema).ok();
        Self { schema, validator }
    }

    pub(crate) fn violations(&self, value: &Value) -> Vec<Violation> {
        let Some(validator) = &self.validator else {
            return vec![Violation::new(
                "",
                "internal",
                "the schema of this kind is not usable",
            )];
        };
        let mut violations = Vec::new();
        for error in validator.iter_errors(value) {
            self.translate(&error, &mut violations);
            if violations.len() >= LISTED {
                violations.truncate(LISTED);
                break;
            }
        }
        violations
    }

    /// Turns a validator's error into violations a user can act on.
    fn translate(&self, error: &ValidationError<'_>, violations: &mut Vec<Violation>) {
        let pointer = error.instance_path().to_string();
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
            ValidationErrorKind::MinLength { .. } | ValidationErrorKind::MaxLength { .. } => {
                let count = given.as_str().map_or(0, |text| text.chars().count());
                violations.push(at("wrong_length", format!("{count} characters given")));
            }
            ValidationErrorKind::OneOfNotValid { context }
            | ValidationErrorKind::AnyOf { context } => match meant_branch(&pointer, context) {
                Some(branch) => branch
                    .iter()
                    .for_each(|error| self.translate(error, violations)),
                None => violations.push(at(
                    "not_allowed",
                    "this is none of the accepted forms".to_owned(),
                )),
            },
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

fn is_field_error(error: &ValidationError<'_>) -> bool {
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
fn describe(node: &Value) -> String {
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

/// A field name as a part of a JSON pointer (RFC 6901).
pub(crate) fn escape(name: &str) -> String {
    name.replace('~', "~0").replace('/', "~1")
}
