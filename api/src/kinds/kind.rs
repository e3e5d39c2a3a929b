//! Kinds of jobs by name, with what there is to say of them.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

macro_rules! kinds {
    ($($kind:ident($name:literal): $spec:ty, $title:literal, $description:literal, [$($example:literal),+ $(,)?];)+) => {
        /// Kind of a job.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
        pub enum JobKind {
            $(#[doc = $title] #[serde(rename = $name)] $kind,)+
        }

        impl JobKind {
            /// Every kind, in the order of the list.
            pub const ALL: &[Self] = &[$(Self::$kind),+];

            /// Name on the wire.
            pub fn name(self) -> &'static str {
                match self { $(Self::$kind => $name,)+ }
            }

            /// Title for people.
            pub fn title(self) -> &'static str {
                match self { $(Self::$kind => $title,)+ }
            }

            /// A sentence on what the test does.
            pub fn description(self) -> &'static str {
                match self { $(Self::$kind => $description,)+ }
            }

            /// Example jobs; the first is the one to start from, and has the kind's name.
            pub fn examples(self) -> &'static [Example] {
                match self {
                    $(Self::$kind => &[$(Example {
                        name: $example,
                        body: include_str!(concat!("../../examples/", $example, ".json")),
                    }),+],)+
                }
            }
        }
    };
}

list_of_kinds!(kinds);

/// An example job of a kind.
#[derive(Clone, Copy, Debug)]
pub struct Example {
    /// File name without `.json`.
    pub name: &'static str,
    /// The POST body.
    pub body: &'static str,
}

impl std::fmt::Display for JobKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

impl std::str::FromStr for JobKind {
    type Err = UnknownKind;

    fn from_str(name: &str) -> Result<Self, UnknownKind> {
        let found = Self::ALL.iter().find(|kind| kind.name() == name);
        found.copied().ok_or_else(|| UnknownKind {
            name: name.chars().take(100).collect(),
        })
    }
}

/// There is no kind of this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no job kind named {name:?}; there are: {}", all_names())]
pub struct UnknownKind {
    pub name: String,
}

fn all_names() -> String {
    JobKind::ALL
        .iter()
        .map(|kind| kind.name())
        .collect::<Vec<_>>()
        .join(", ")
}
