//! Specs of any kind, and what can be asked of them without knowing which.
use serde_json::Value;

use super::JobKind;
use crate::calibration::{Calibration, Estimate};
use crate::digest::sha256_hex;
use crate::preview::Extent;
use crate::results::Named;
use crate::spec;
use crate::spec_trait::{Spec, Studied};
use crate::study::{Knob, TurnError};
use crate::violations::Violations;

macro_rules! specs {
    ($($kind:ident($name:literal): $spec:ty, $title:literal, $description:literal, [$($example:literal),+ $(,)?];)+) => {
        /// A checked spec of any kind.
        #[derive(Clone, Debug, PartialEq)]
        pub enum JobSpec {
            $(#[doc = $title] $kind(Box<$spec>),)+
        }

        impl JobKind {
            /// Lets `visitor` work with the kind's spec type.
            pub(crate) fn visit<V: SpecVisitor>(self, visitor: V) -> V::Output {
                match self {
                    $(Self::$kind => visitor.visit::<$spec>(|spec| JobSpec::$kind(Box::new(spec))),)+
                }
            }

            /// Results that its jobs may have.
            pub(crate) fn results(self) -> &'static [&'static [Named]] {
                match self { $(Self::$kind => <$spec as Spec>::RESULTS,)+ }
            }

            /// Whether a job of this kind that is stopped leaves a checkpoint to go on from.
            pub fn is_resumable(self) -> bool {
                match self { $(Self::$kind => <$spec as Spec>::IS_RESUMABLE,)+ }
            }
        }

        impl JobSpec {
            /// The kind of this spec.
            pub fn kind(&self) -> JobKind {
                match self { $(Self::$kind(_) => JobKind::$kind,)+ }
            }

            /// The spec as JSON, all defaults written out: the text behind `spec_sha256`.
            pub fn to_json(&self) -> String {
                match self { $(Self::$kind(spec) => json(&**spec),)+ }
            }

            /// What the job will take.
            pub fn estimate(&self, calibration: &Calibration) -> Estimate {
                match self { $(Self::$kind(spec) => spec.estimate(calibration),)+ }
            }

            /// About how much there is to draw of its specimen.
            pub fn extent(&self) -> Extent {
                match self { $(Self::$kind(spec) => spec.extent(),)+ }
            }

            /// Names of the columns of its curve, in order; the last ones may be missing where what
            /// they tell cannot be measured.
            pub fn curve_columns(&self) -> Vec<String> {
                match self { $(Self::$kind(spec) => spec.curve_columns(),)+ }
            }

            /// The largest abscissa of that curve, where it is a strain and the spec says it.
            pub(crate) fn largest_strain(&self) -> Option<f64> {
                match self { $(Self::$kind(spec) => spec.largest_strain(),)+ }
            }

            /// Seed of the random streams.
            pub fn seed(&self) -> u64 {
                match self { $(Self::$kind(spec) => spec.seed(),)+ }
            }

            /// What an accuracy study may vary.
            pub fn knobs(&self) -> Vec<Knob> {
                match self { $(Self::$kind(spec) => spec.knobs(),)+ }
            }

            /// The spec of one test of this seed, which writes as little as it can.
            pub fn single(&self, seed: u64) -> Self {
                let mut own = self.clone();
                match &mut own { $(Self::$kind(spec) => spec.single(seed),)+ }
                own
            }

            /// The spec of the tests of one specimen of this seed, which writes as little as it can.
            pub fn realisation(&self, seed: u64) -> Self {
                let mut own = self.clone();
                match &mut own { $(Self::$kind(spec) => spec.realise(seed),)+ }
                own
            }

            /// Whether a result may be compared between the settings of a study.
            pub fn compares(&self, result: &str) -> bool {
                match self { $(Self::$kind(_) => <$spec as Studied>::compares(result),)+ }
            }

            /// The spec as a JSON value, all defaults written out.
            pub(crate) fn to_value(&self) -> Value {
                match self { $(Self::$kind(spec) => value(&**spec),)+ }
            }

            /// Reports what the kind's JSON Schema cannot say.
            pub(crate) fn cross_check(&self, violations: &mut Violations) {
                match self { $(Self::$kind(spec) => spec.check(violations),)+ }
            }

            fn set(&mut self, knob: &str, value: &str) -> Option<()> {
                match self { $(Self::$kind(spec) => spec.turn(knob, value),)+ }
            }
        }
    };
}

list_of_kinds!(specs);

/// Work that is the same for every kind, given the spec's type.
pub(crate) trait SpecVisitor {
    type Output;
    fn visit<T: Spec>(self, wrap: fn(T) -> JobSpec) -> Self::Output;
}

fn value<T: Spec>(spec: &T) -> Value {
    // as below
    serde_json::to_value(spec).unwrap_or_default()
}

fn json<T: Spec>(spec: &T) -> String {
    // a spec is plain structs and numbers: writing it to memory has no way to fail
    serde_json::to_string(spec).unwrap_or_default()
}

impl JobSpec {
    /// SHA-256 of the normalised spec.
    pub fn sha256(&self) -> String {
        sha256_hex(self.to_json().as_bytes())
    }

    /// Sets a knob of a study. Whether the value is in range, [`Self::check`] tells.
    ///
    /// # Errors
    /// [`TurnError`] when there is no such knob, or it takes no such value.
    pub fn turn(&mut self, knob: &str, value: &str) -> Result<(), TurnError> {
        let knobs = self.knobs();
        let known = knobs.iter().find(|known| known.name == knob);
        let known = known.ok_or_else(|| TurnError::NoSuchKnob {
            knob: knob.to_owned(),
            known: knobs
                .iter()
                .map(|knob| knob.name)
                .collect::<Vec<_>>()
                .join(", "),
        })?;
        self.set(knob, value).ok_or_else(|| TurnError::NoSuchValue {
            knob: known.name,
            value: value.to_owned(),
            description: known.description,
        })
    }
}
