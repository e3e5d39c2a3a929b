//! JSON Schema as the one source of types, units, limits and their error messages.
//!
//! Whether a value fits, the validator of the whole schema tells in one walk that keeps nothing.
//! What is wrong with one that does not fit, [`descent`] finds where the value is large and
//! [`translate`] says where it is small. The first value of a process is held against what it touches of the
//! schema alone ([`touched`]), which takes a fraction of the time that the whole takes to compile.
mod descent;
mod pointer;
mod touched;
mod translate;

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use jsonschema::{Draft, Registry, Validator};
use schemars::generate::{Contract, SchemaSettings};
use schemars::{JsonSchema, SchemaGenerator};
use serde_json::{Map, Value, json};

use crate::problem::Violation;
use crate::violations::Violations;
pub(crate) use pointer::escape;
use translate::Place;

/// A schema for checking, with its text for messages.
pub(crate) struct Checker {
    pub(crate) schema: Value,
    /// Of the whole schema, compiled for the second value: most processes read one spec.
    whole: OnceLock<Option<Validator>>,
    has_read: AtomicBool,
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
        self.whole().is_some()
    }

    /// A test compiles every schema, so that `None` is not met in service.
    fn whole(&self) -> Option<&Validator> {
        let compiled = self.whole.get_or_init(|| validator_of(&self.schema));
        compiled.as_ref()
    }

    fn fits(&self, value: &Value) -> Option<bool> {
        if !self.has_read.swap(true, Ordering::Relaxed)
            && let Some(touched) = touched::by(value, &self.schema)
        {
            return validator_of(&touched).map(|validator| validator.is_valid(value));
        }
        self.whole().map(|validator| validator.is_valid(value))
    }

    pub(crate) fn of<T: JsonSchema>() -> Self {
        let settings =
            SchemaSettings::draft2020_12().with(|settings| settings.inline_subschemas = true);
        let schema = settings
            .into_generator()
            .into_root_schema_for::<T>()
            .to_value();
        Self {
            schema,
            whole: OnceLock::new(),
            has_read: AtomicBool::new(false),
        }
    }

    /// What is wrong with a value, with pointers relative to it: the first mistakes of many.
    pub(crate) fn violations(&self, value: &Value) -> Vec<Violation> {
        match self.fits(value) {
            Some(true) => return Vec::new(),
            Some(false) => {}
            None => {
                let detail = "the schema of this kind is not usable";
                return vec![Violation::new("", "internal", detail)];
            }
        }
        let mut found = Violations::default();
        Place::root(&self.schema).search(value, &mut found);
        if found.is_empty() {
            // what does not fit never passes, even where nobody can say why
            found.push(Violation::new("", "not_allowed", "this is not accepted"));
        }
        found.into_vec()
    }
}

/// A validator that tells whether values fit.
///
/// The library holds what it compiles against the meta-schema of its draft, and to compile that of draft
/// 2020-12 takes three times as long as a kind's schema, milliseconds at the start of every program. So a
/// reference to the schema is compiled, by draft 4, whose meta-schema is short; what is referred to keeps the
/// draft it names. The tests hold every schema against its meta-schema.
fn validator_of(schema: &Value) -> Option<Validator> {
    const NAME: &str = "urn:loadframe:schema";
    let registry = Registry::new().add(NAME, schema).ok()?.prepare().ok()?;
    jsonschema::options()
        .with_draft(Draft::Draft4)
        .with_registry(&registry)
        .build(&json!({"$ref": NAME}))
        .ok()
}
