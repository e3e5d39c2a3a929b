//! Boxes in which a scene is measured.
use std::collections::BTreeSet;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{GranularScene, part_checks::check_material};
use crate::{Violation, Violations};

/// A box in which porosity, coordination number, inertial number and the stress between the bodies
/// are measured for every row of `curve.csv`. Stresses are positive in compression.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Region {
    /// Name for the columns of the table.
    #[schemars(length(min = 1, max = 60), regex(pattern = "^[A-Za-z][A-Za-z0-9_]*$"))]
    pub name: String,
    /// Its lower corner; left out, that of the bodies' own box between the planes, at the time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(inner(range(min = -1e9, max = 1e9))), extend("x-unit" = "m"))]
    pub low_m: Option<[f64; 3]>,
    /// Its upper corner, likewise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(inner(range(min = -1e9, max = 1e9))), extend("x-unit" = "m"))]
    pub high_m: Option<[f64; 3]>,
    /// Only bodies of this material are measured, others are walls to them; left out, all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
}

pub(super) fn check(spec: &GranularScene, violations: &mut Violations) {
    let mut names: BTreeSet<&str> = spec.record.planes.iter().map(String::as_str).collect();
    for (index, region) in spec.record.regions.iter().enumerate() {
        let pointer = format!("/record/regions/{index}");
        if !names.insert(&region.name) {
            let detail = "another region or a recorded plane has this name";
            violations.push(
                Violation::new(format!("{pointer}/name"), "name_taken", detail)
                    .value(region.name.as_str())
                    .allowed("a name of its own"),
            );
        }
        if let Some(name) = &region.material {
            violations.extend(check_material(spec, &pointer, name));
        }
        if let (Some(low), Some(high)) = (region.low_m, region.high_m)
            && (0..3).any(|axis| low[axis] >= high[axis])
        {
            let detail = "the box has no inside";
            violations.push(
                Violation::new(format!("{pointer}/high_m"), "empty", detail)
                    .value(high.to_vec())
                    .allowed("above low_m along every axis")
                    .unit("m"),
            );
        }
    }
}
