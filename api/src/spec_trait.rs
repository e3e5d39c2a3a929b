//! What the spec of every kind can do.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::calibration::{Calibration, Estimate};
use crate::earlier::Earlier;
use crate::outcome::Tenth;
use crate::preview::Extent;
use crate::results::Named;
use crate::study::Knob;
use crate::violations::Violations;

/// What the spec of every kind can do beyond being parsed.
pub trait Spec: Studied + Sized + Serialize + for<'de> Deserialize<'de> + JsonSchema {
    /// Results that its jobs may have, list by list.
    const RESULTS: &'static [&'static [Named]];

    /// Whether a job that is stopped leaves a checkpoint to go on from.
    const IS_RESUMABLE: bool;

    /// Reports what its JSON Schema cannot say, with pointers relative to the spec.
    fn check(&self, violations: &mut Violations);

    /// Takes over what `earlier` jobs found where it refers to them; reports references that lead
    /// nowhere.
    fn learn(&mut self, _earlier: &Earlier, _violations: &mut Violations) {}

    /// Writes out what stands behind names (a preset's knobs).
    fn normalise(&mut self);

    /// What the job will take on a machine of the measured speed.
    fn estimate(&self, calibration: &Calibration) -> Estimate;

    /// About how much there is to draw of its specimen; of repeats, of one.
    fn extent(&self) -> Extent;

    /// What `changed` buys and costs in place of this spec: a part of an error becomes a tenth, for
    /// the time at which both are estimated. `None` where there is no such time.
    fn tenth(&self, change: String, changed: &Self) -> Option<Tenth> {
        let wall_s = |spec: &Self| spec.estimate(&Calibration::default()).wall_s;
        let time_factor = wall_s(changed) / wall_s(self);
        (time_factor.is_finite() && time_factor > 0.0).then_some(Tenth {
            change,
            time_factor,
        })
    }

    /// Names of the columns of its curve, in order; the last ones may be missing where what they tell
    /// cannot be measured.
    fn curve_columns(&self) -> Vec<String>;

    /// The largest abscissa of that curve, where it is a strain and the spec says how far it goes.
    fn largest_strain(&self) -> Option<f64> {
        None
    }

    /// Seed of the random streams.
    fn seed(&self) -> u64;
}

/// What studies and calibrations do with the spec of every kind.
pub trait Studied {
    /// What an accuracy study may vary.
    fn knobs(&self) -> Vec<Knob>;

    /// Sets a knob; `None` when the value is not one it takes.
    fn turn(&mut self, knob: &str, value: &str) -> Option<()>;

    /// Makes it one test of this seed, on the thread it is run on, that writes as little as it can.
    fn single(&mut self, seed: u64);

    /// Makes it the tests of one specimen of this seed, as a calibration runs it: unlike
    /// [`Self::single`] it keeps what is compared within a specimen, such as directions.
    fn realise(&mut self, seed: u64) {
        self.single(seed);
    }

    /// Whether a result may be compared between settings: not when it grows with the specimen.
    fn compares(result: &str) -> bool;
}
