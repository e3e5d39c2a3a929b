//! Many jobs side by side: their curves, the fields in which their specs differ, all of their results;
//! and comparisons that are kept under a name.
//!
//! What belongs to a job stands in lists as long as the list of jobs and in its order, so that a field or
//! a result is named once, however many jobs there are.
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use uuid::Uuid;

use crate::people::Named;
use crate::{JobKind, JobOutcome, JobStatus, Quantity, Timestamp};

/// Most jobs that are compared at once.
pub const MOST_COMPARED: usize = 1_000;

/// `GET /v1/differences`: what tells jobs apart.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Differences {
    pub jobs: Vec<ComparedJob>,
    /// The fields in which the specs differ, in the order of the specs; none where all are alike.
    pub fields: Vec<ComparedField>,
    /// Fields that differ beyond those listed.
    pub fields_left_out: u64,
    /// Jobs whose specs are too large to be looked at field by field; their hashes still tell whether
    /// they are alike.
    pub specs_left_out: Vec<Uuid>,
    pub results: Vec<ComparedResult>,
    /// Ids asked for of which there is no job to be seen.
    pub missing: Vec<Uuid>,
    /// Whether more jobs fit the question than are compared at once; the newest are here.
    pub more: bool,
}

/// A job among others.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ComparedJob {
    pub id: Uuid,
    pub kind: JobKind,
    pub name: String,
    pub tags: Vec<String>,
    pub status: JobStatus,
    pub outcome: Option<JobOutcome>,
    pub created_at: Timestamp,
    /// SHA-256 of the normalised spec.
    pub spec_sha256: String,
    /// Columns of its curve; none while there is no point.
    pub columns: Vec<String>,
    /// Points of its curve.
    pub points: u64,
    /// What forces are divided by, as far as spec and results tell it.
    pub dimensions: Dimensions,
}

/// Sizes of a specimen by which tests of different specimens are compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Dimensions {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "mm"))]
    pub width_mm: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "g/m2"))]
    pub grammage_g_per_m2: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "mm"))]
    pub thickness_mm: Option<f64>,
}

/// Where specs state the sizes of their specimens, and in which results they are told instead, with the
/// factor to the unit asked for.
type Places = (
    &'static [&'static str],
    &'static str,
    &'static [(&'static str, f64)],
);

const WIDTH: Places = (
    &[
        "/specimen/sheet/width_mm",
        "/specimen/explicit/width_mm",
        "/fabric/network/width_mm",
    ],
    "specimen_width",
    &[("mm", 1.0)],
);
const GRAMMAGE: Places = (
    &[
        "/fabric/lattice/grammage_g_per_m2",
        "/fabric/network/grammage_g_per_m2",
        "/specimen/sheet/grammage_g_per_m2",
    ],
    "grammage",
    &[("g/m2", 1.0)],
);
const THICKNESS: Places = (
    &[
        "/fabric/lattice/thickness_mm",
        "/fabric/network/thickness_mm",
        "/section/thickness_mm",
    ],
    "thickness",
    &[("mm", 1.0), ("µm", 1e-3)],
);

impl Dimensions {
    /// Sizes that a normalised spec or the results of its job tell; the results count first, for they are
    /// those of the specimen as it was made.
    pub fn of(spec: &Value, results: Option<&IndexMap<String, Quantity>>) -> Self {
        let find = |(pointers, name, units): Places| {
            let told = results.and_then(|results| {
                let result = results.get(name)?;
                let (_, factor) = units.iter().find(|(unit, _)| *unit == result.unit)?;
                Some(result.value? * factor)
            });
            let stated = || {
                pointers
                    .iter()
                    .find_map(|place| spec.pointer(place)?.as_f64())
            };
            told.or_else(stated)
                .filter(|size| size.is_finite() && *size > 0.0)
        };
        Self {
            width_mm: find(WIDTH),
            grammage_g_per_m2: find(GRAMMAGE),
            thickness_mm: find(THICKNESS),
        }
    }
}

/// A field in which specs differ.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ComparedField {
    /// JSON pointer into the body of a submission, such as `/spec/bond/modulus_n`; `/kind` is one too.
    pub pointer: String,
    /// Unit of the field; none where it has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// The value in every job; `null` where it is null or absent. Long lists and texts are told by their
    /// length and the beginning of their SHA-256.
    pub values: Vec<Value>,
}

/// A result that at least one of the jobs has.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ComparedResult {
    pub name: String,
    pub unit: String,
    /// The value of every job; `null` where it has none in this unit.
    pub values: Vec<Option<f64>>,
}

/// `GET /v1/curves`: one column over another, of many jobs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Curves {
    /// Points of a curve at most.
    pub points: u64,
    pub curves: Vec<ComparedCurve>,
    /// Jobs whose curves have no such columns.
    pub without: Vec<Uuid>,
    /// Ids asked for of which there is no job to be seen.
    pub missing: Vec<Uuid>,
    /// Whether more jobs fit the question than are compared at once; the newest are here.
    pub more: bool,
}

/// A curve of two columns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ComparedCurve {
    pub job: Uuid,
    /// The column it is drawn over.
    pub over: String,
    pub of: String,
    pub x: Vec<f64>,
    pub y: Vec<f64>,
    /// Points that the whole curve has.
    pub of_points: u64,
    /// No more points will come.
    pub complete: bool,
}

/// `POST /v1/curves/measured` answers: a measured curve as it was understood.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MeasuredReading {
    /// The columns of jobs that it is read as, in their units.
    pub columns: [String; 2],
    pub x: Vec<f64>,
    pub y: Vec<f64>,
    /// What was understood, a sentence each.
    pub read_as: Vec<String>,
}

/// `POST /v1/comparisons`: jobs to be compared under a name.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NewComparison {
    pub name: String,
    /// The jobs, in the order in which they are listed; never changed afterwards.
    #[schemars(length(min = 1, max = 1_000))]
    pub jobs: Vec<Uuid>,
    /// How the page shows them, as the query of its address.
    #[serde(default)]
    #[schemars(length(max = 2_000))]
    pub view: String,
    /// The project whose people see it, where there are people; left out, only you do.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Uuid")]
    pub project: Option<Uuid>,
}

/// `PATCH /v1/comparisons/{id}`: what is left out stays.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ComparisonChanges {
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "String")]
    pub name: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "String", length(max = 2_000))]
    pub view: Option<String>,
}

/// A comparison that is kept under a name.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct ComparisonView {
    pub id: Uuid,
    pub name: String,
    /// How the page shows it, as the query of its address.
    pub view: String,
    /// The number of its jobs, whether or not you see them.
    pub count: u64,
    /// Its jobs, in order, as far as you see them; left out in lists.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub jobs: Option<Vec<Uuid>>,
    pub created_at: Timestamp,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub owner: Option<Named>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub project: Option<Named>,
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::JobSpec;

    #[test]
    fn sizes_come_from_results_first_and_from_the_spec_else() {
        let spec =
            json!({ "specimen": { "sheet": { "width_mm": 5.0, "grammage_g_per_m2": 60.0 } } });
        let results = json!({
            "grammage": { "value": 58.5, "unit": "g/m2" }, "thickness": { "value": 90.0, "unit": "µm" },
            "specimen_width": { "value": null, "unit": "mm" },
        });
        let results = serde_json::from_value(results).expect("results");
        let sizes = Dimensions::of(&spec, Some(&results));
        assert_eq!(sizes.width_mm, Some(5.0));
        assert_eq!(sizes.grammage_g_per_m2, Some(58.5));
        assert_eq!(sizes.thickness_mm, Some(90.0 * 1e-3));
        assert_eq!(Dimensions::of(&json!({}), None), Dimensions::default());
    }

    #[test]
    fn the_places_of_sizes_are_those_of_examples() {
        let mut found = [0, 0, 0];
        for example in JobKind::ALL.iter().flat_map(|kind| kind.examples()) {
            let submission = crate::Submission::from_slice(example.body.as_bytes());
            let spec: JobSpec = submission.expect("an example").spec;
            let sizes = Dimensions::of(&spec.to_value(), None);
            let all = [sizes.width_mm, sizes.grammage_g_per_m2, sizes.thickness_mm];
            for (count, size) in found.iter_mut().zip(all) {
                *count += usize::from(size.is_some());
            }
        }
        assert!(found.iter().all(|count| *count > 0), "{found:?}");
    }
}
