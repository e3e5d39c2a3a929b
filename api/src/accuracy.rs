//! How exactly a job is carried out, for the kinds that can choose.
use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// A preset's name, or the knobs it stands for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Accuracy<K> {
    Preset(Preset),
    Knobs(K),
}

/// Names of presets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Preset {
    Draft,
    #[default]
    Standard,
    Reference,
}

/// The knobs of a kind.
pub trait Knobs: Clone + JsonSchema {
    /// What they are about, for the schema.
    const ABOUT: &'static str = "How exactly: a preset's name or its knobs.";
    /// What presets choose, for the schema.
    const PRESETS: &'static str = "Named choices of the knobs.";
    /// What each preset is, in the order of [`Preset`], where there is more to say than its name does.
    const EACH: Option<[&'static str; 3]> = None;

    /// What a preset stands for.
    fn of(preset: Preset) -> Self;
}

impl<K> Default for Accuracy<K> {
    fn default() -> Self {
        Self::Preset(Preset::default())
    }
}

impl<K: Knobs> Accuracy<K> {
    /// The knobs, of a preset those it stands for.
    pub fn knobs(&self) -> K {
        match self {
            Self::Knobs(knobs) => knobs.clone(),
            Self::Preset(preset) => K::of(*preset),
        }
    }

    /// Makes it its knobs.
    pub(crate) fn write_out(&mut self) {
        self.change(|_| {});
    }

    /// Makes it its knobs, with a change.
    pub(crate) fn change(&mut self, change: impl FnOnce(&mut K)) {
        let mut knobs = self.knobs();
        change(&mut knobs);
        *self = Self::Knobs(knobs);
    }
}

/// By hand, because each kind describes its own presets.
impl<K: Knobs> JsonSchema for Accuracy<K> {
    fn schema_name() -> Cow<'static, str> {
        "Accuracy".into()
    }

    fn schema_id() -> Cow<'static, str> {
        format!("{}::Accuracy<{}>", module_path!(), K::schema_id()).into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        const NAMES: [&str; 3] = ["draft", "standard", "reference"];
        // as values, which keep the order in which derived schemas have their keywords
        let presets = match K::EACH {
            None => json!({"type": "string", "enum": NAMES, "description": K::PRESETS}),
            Some(each) => {
                let named = NAMES.iter().zip(each);
                let choices: Vec<Value> = named
                    .map(|(name, about)| json!({"type": "string", "const": name, "description": about}))
                    .collect();
                json!({"oneOf": choices, "description": K::PRESETS})
            }
        };
        let knobs = generator.subschema_for::<K>().to_value();
        json_schema!({"anyOf": [presets, knobs], "description": K::ABOUT})
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Knobs of which only the presets are told apart.
    #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields)]
    struct Fineness {
        cells: u32,
    }

    impl Knobs for Fineness {
        fn of(preset: Preset) -> Self {
            Self {
                cells: match preset {
                    Preset::Draft => 1,
                    Preset::Standard => 2,
                    Preset::Reference => 3,
                },
            }
        }
    }

    fn read(text: &str) -> Option<Accuracy<Fineness>> {
        serde_json::from_str(text).ok()
    }

    #[test]
    fn a_preset_stands_for_its_knobs_and_knobs_for_themselves() {
        let presets = ["\"draft\"", "\"standard\"", "\"reference\""].map(read);
        let cells = presets.map(|accuracy| accuracy.map(|accuracy| accuracy.knobs().cells));
        assert_eq!(cells, [Some(1), Some(2), Some(3)]);
        assert_eq!(
            read("{\"cells\": 7}").map(|read| read.knobs().cells),
            Some(7)
        );
        assert_eq!(read("\"finest\""), None);
        assert_eq!(Accuracy::<Fineness>::default().knobs().cells, 2);
    }

    #[test]
    fn what_is_written_out_is_knobs() {
        let mut accuracy = Accuracy::Preset(Preset::Draft);
        accuracy.write_out();
        assert_eq!(accuracy, Accuracy::Knobs(Fineness { cells: 1 }));
        accuracy.change(|knobs| knobs.cells += 4);
        assert_eq!(accuracy.knobs().cells, 5);
        assert_eq!(
            serde_json::to_string(&accuracy).ok().as_deref(),
            Some("{\"cells\":5}")
        );
    }

    #[test]
    fn the_schema_names_every_preset_that_can_be_read() {
        let schema = schemars::schema_for!(Accuracy<Fineness>).to_value();
        let names = schema["anyOf"][0]["enum"].as_array().cloned();
        let names = names.expect("names of presets");
        assert_eq!(names.len(), 3);
        for name in names {
            assert!(read(&name.to_string()).is_some(), "{name}");
        }
    }
}
