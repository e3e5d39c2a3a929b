//! What a study of accuracy may vary in a spec, kind by kind.
//!
//! A kind names its [`Knob`]s and says how each is set; what is done with them is the same for all
//! kinds.

/// A setting that trades time for exactness, or asks whether it matters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Knob {
    pub name: &'static str,
    /// What it is and which values it takes, in a sentence without a full stop.
    pub description: &'static str,
    /// The spec's own value.
    pub present: String,
    /// Values tried unless others are named, coarse to fine.
    pub grid: Vec<String>,
    /// The finest setting, against which the errors of this knob are measured: knobs with their
    /// values; those not named stay as they are.
    pub reference: Vec<(&'static str, String)>,
    /// Whether tests of the same seed are tests of the same specimen at all values, so that they
    /// can be compared one by one. Otherwise only their means can.
    pub keeps_specimen: bool,
}

impl Knob {
    /// A knob that keeps the specimen, with values from coarse to fine and the finest besides.
    pub(crate) fn new(
        name: &'static str,
        description: &'static str,
        present: impl ToString,
        grid: &[&str],
        finest: &str,
    ) -> Self {
        Self {
            name,
            description,
            present: present.to_string(),
            grid: grid.iter().map(|value| (*value).to_owned()).collect(),
            reference: vec![(name, finest.to_owned())],
            keeps_specimen: true,
        }
    }

    /// The same, whose values make other specimens of the same seed.
    pub(crate) fn of_other_specimens(self) -> Self {
        Self {
            keeps_specimen: false,
            ..self
        }
    }
}

/// A value a knob does not take.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TurnError {
    #[error("there is no knob {knob:?}; there are: {known}")]
    NoSuchKnob { knob: String, known: String },
    #[error("{value:?} is no value of {knob}: {description}")]
    NoSuchValue {
        knob: &'static str,
        value: String,
        description: &'static str,
    },
}
